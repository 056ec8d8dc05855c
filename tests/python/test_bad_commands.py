"""Bad input to the program's commands: an exception that names the argument and what is accepted, never a crash.

The commands themselves are replaced by functions
that take what the extension takes, and raise Reached.
"""

import json
import pathlib
import re
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
    "run": (
        hb.run,
        dict(config=CONFIG, out="out", overrides={"system.number": 40}, force=False, replicas=2, **CONSOLE),
    ),
    "run of a file": (hb.run, dict(config="run.toml", overrides=None, force=True, **CONSOLE)),
    "resume": (hb.resume, dict(run=RUN, overrides={"output.checkpoint_every": "9s"}, **CONSOLE)),
    "extend": (hb.extend, dict(run=RUN, time=20.0, **CONSOLE)),
    "Run.extend": (RUN.extend, dict(time=20.0, **CONSOLE)),
    "sweep": (
        hb.sweep,
        dict(config=CONFIG | {"grid": {"seed": [1, 2]}}, out=HERE, overrides={"grid.seed": [3]}, jobs=2, **CONSOLE),
    ),
    "check": (hb.check, dict(path=RUN, quiet=True)),
    "analyze": (
        hb.analyze,
        dict(
            path=RUN, out=HERE / "a", time_step=0.1, longest_lag=2, fit_from=1.5, every=2, collective=True, quiet=True
        ),
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

# Options that messages name, where Python has refused the argument before.
UNREACHABLE = ("--jobs is", "--out is empty", "--value is not given", "--levels", "--where {}: is not a condition")
# Those of commands that Python does not have.
UNREACHABLE += (
    "--template {}",
    "command line: --on",
    "snakemake --version",
)
SOURCES = pathlib.Path(__file__).resolve().parents[2] / "apps"


def test_messages_of_commands_name_arguments_of_python():
    """All texts with options of the command line are among those that the extension translates."""
    table = (SOURCES / "python/src/runs/words.cpp").read_text()
    translated = [json.loads(f'"{text}"') for text in re.findall(r'\{"((?:[^"\\]|\\.)*)",\s', table)]
    assert len(translated) > 8
    for path in sorted((SOURCES / "hardbody").rglob("*.cpp")):
        if path.name == "command_line.cpp":
            continue
        joined = re.sub(r'(?<!\\)"\s*\n\s*"', "", path.read_text())
        for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', joined):
            # An option alone is an argument of a process, or a part of a message that has it.
            if re.search(r"(^|\s)(--[a-z]|-o )", text) and not re.fullmatch(r"--[a-z-]+", text):
                known = any(phrase in text for phrase in translated) or text.startswith(UNREACHABLE)
                known = known or any(f"; {text}".startswith(phrase) for phrase in translated)
                assert known or "-o FILE" in text, f"{path}: {text}"


def test_the_program_still_has_the_phrases_that_are_translated():
    """The extension finds phrases by their text: a message that is worded anew must be so in its table, too."""
    joined = "\n".join(
        re.sub(r'(?<!\\)"\s*\n\s*"', "", path.read_text())
        for folder in ("apps/hardbody", "libed/src")
        for path in sorted((SOURCES.parent / folder).rglob("*.cpp"))
    )
    texts = re.findall(r'"((?:[^"\\\n]|\\.)*)"', joined)
    table = (SOURCES / "python/src/runs/words.cpp").read_text()
    table = re.sub(r'(?<!\\)"\s*\n\s*"', "", table)
    for kind in ("kBeginnings", "kPhrases"):
        rows = re.search(rf"{kind} = {{{{(.*?)}}}};", table, re.DOTALL)[1]
        phrases = re.findall(r'\{"((?:[^"\\]|\\.)*)",', rows)
        assert len(phrases) == int(re.search(rf"Words, (\d+)> {kind}", table)[1])
        for phrase in phrases:
            if kind == "kBeginnings":
                assert any(text.startswith(phrase) for text in texts), phrase
            else:  # a reason begins after what the command says of it
                assert any(phrase in text or phrase in f"; {text}" for text in texts), phrase


# What messages say in place of an argument's name.
OTHER_WORDS = {
    "path": r": (is not there|is not a directory|has no \S+); accepted: the directory of (a run|a sweep|an analysis)$",
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
    "run": (utf8, text_or_none, text_or_none, texts, flag, count, texts),
    "resume": (utf8, texts),
    "extend": (utf8, real_or_none),
    "sweep": (utf8, text_or_none, text_or_none, lambda value: value is None or count(value), texts, texts),
    "check": (utf8,),
    "analyze": (utf8, text_or_none, real_or_none, real_or_none, real_or_none, count, flag),
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
