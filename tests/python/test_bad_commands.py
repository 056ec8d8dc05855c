"""Bad input to the program's commands: an exception that names the argument and what is accepted, never a crash.

The commands themselves are replaced by functions
that take what the extension takes, and raise Reached.
"""

import pathlib
import tempfile

import pytest
from generated import CALLS, bad_calls, check_refusal, junk
from hypothesis import given, settings
from runs import CONFIG

import hardbody as hb
from hardbody import _core

DIRECTORY = tempfile.TemporaryDirectory()
HERE = pathlib.Path(DIRECTORY.name)
(HERE / "config.toml").write_text("")
(HERE / "sweep.csv").write_text("aspect_ratio,status\n2,done\n")
(HERE / "observables").mkdir()
(HERE / "observables/msd.csv").write_text("t [1],msd [1],msd_error [1]\n1,1,1\n2,2,1\n")
RUN, SWEEP = hb.Run(HERE), hb.Sweep(HERE)
CONSOLE = dict(quiet=True, progress=None)
CURVES = dict(
    x="aspect_ratio",
    y="packing_fraction",
    values=["Z", "S"],
    levels={"Z": [1, 2], "S": [0.5]},
    where={"seed": 1},
    log_x=False,
    log_y=True,
    out="map.svg",
    csv="map.csv",
    quiet=True,
)

# Functions and arguments that they accept.
FUNCTIONS = {
    "run": (hb.run, dict(config=CONFIG, out="out", overrides={"system.number": 40}, force=False, **CONSOLE)),
    "run of a file": (hb.run, dict(config="run.toml", overrides=None, force=True, **CONSOLE)),
    "resume": (hb.resume, dict(run=RUN, **CONSOLE)),
    "sweep": (hb.sweep, dict(config=CONFIG | {"grid": {"seed": [1, 2]}}, out=HERE, jobs=2, **CONSOLE)),
    "check": (hb.check, dict(path=RUN, quiet=True)),
    "analyze": (
        hb.analyze,
        dict(path=RUN, out=HERE / "a", time_step=0.1, longest_lag=2, fit_from=1.5, every=2, quiet=True),
    ),
    "report": (hb.report, dict(paths=[RUN, "other"], out="report.html", quiet=True)),
    "map": (hb.map, dict(table=SWEEP, **CURVES)),
    "Sweep.map": (SWEEP.map, CURVES),
    "Run": (hb.Run, dict(path=HERE)),
    "Sweep": (hb.Sweep, dict(path=HERE)),
    "Analysis": (lambda path: hb.Analysis(path), dict(path="none")),
    "Run.plot": (lambda names: RUN.plot(names), dict(names="msd")),
    "Run.report": (RUN.report, dict(out="report.html")),
    "Sweep.report": (SWEEP.report, dict(out="report.html")),
}

# What messages say in place of an argument's name.
OTHER_WORDS = {
    "path": r": (is not there|has no \S+); accepted: the directory of (a run|a sweep|an analysis)$",
    "config": r"^out is None; accepted: the name of a directory, as a dict has no name",
    "values": r"^levels",
    "paths": r"^out is None; accepted: the name of an HTML file, as there are several directories",
}


class Reached(Exception):
    """Raised by commands in place of a result."""


def utf8(text):
    return isinstance(text, str) and text.encode() is not None and "\0" not in text


def texts(values):
    return isinstance(values, list) and all(utf8(value) for value in values)


def real_or_none(value):
    return value is None or type(value) is float


def text_or_none(text):
    return text is None or utf8(text)


def flag(value):
    return type(value) is bool


def count(value):
    return type(value) is int and 0 < value < 2**31


# What the extension takes after the functions of the console.
TAKEN = {
    "run": (utf8, text_or_none, text_or_none, texts, flag),
    "resume": (utf8,),
    "sweep": (utf8, text_or_none, text_or_none, lambda value: value is None or count(value), texts),
    "check": (utf8,),
    "analyze": (utf8, text_or_none, real_or_none, real_or_none, real_or_none, count),
    "report": (texts, text_or_none),
    "map": (utf8, utf8, utf8, texts, texts, texts, flag, flag, text_or_none, text_or_none),
}


@pytest.fixture(scope="module", autouse=True)
def commands():
    def replacement(name):
        def command(console, *arguments):
            assert len(console) == 4 and (console[2] is None or callable(console[2]))
            for argument, accepts in zip(arguments, TAKEN[name], strict=True):
                assert accepts(argument), argument
            raise Reached

        return command

    with pytest.MonkeyPatch.context() as patch:
        for name in TAKEN:
            patch.setattr(_core, name, replacement(name))
        yield


def bad_values(name):
    """Progress that is True needs tqdm, and prints."""
    return junk.filter(lambda value: value is not True) if name == "progress" else junk


@pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - {"Run", "Sweep", "Analysis", "Run.plot"}))
def test_right_arguments_are_accepted(name):
    function, arguments = FUNCTIONS[name]
    with pytest.raises(Reached):
        function(**arguments)


@pytest.mark.filterwarnings("ignore:nanobind.*uninitialized:RuntimeWarning")
@settings(max_examples=CALLS)
@given(bad_calls(FUNCTIONS, bad_values))
def test_bad_arguments_are_named(call):
    try:
        check_refusal(call, OTHER_WORDS, (ValueError, TypeError, OSError))
    except Reached:
        pass
