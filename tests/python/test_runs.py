"""Runs: the same as those of the program, errors, signals, threads."""

from __future__ import annotations

import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import time

import pytest
from runs import CONFIG, ROOT, TEXT, call, program, results, with_values

import hardbody as hb


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A finished run. Tests must not change it."""
    return hb.run(CONFIG, tmp_path_factory.mktemp("runs") / "a")


BUILT = os.environ.get("HARDBODY")
COMMANDS = [
    pytest.param(program(), id="python -m hardbody"),
    pytest.param([BUILT], id="binary", marks=pytest.mark.skipif(not BUILT, reason="HARDBODY names no program")),
]


# ---- One code path


@pytest.mark.parametrize("command", COMMANDS)
def test_same_bytes_as_the_program(done, tmp_path, command):
    (tmp_path / "config.toml").write_text(TEXT)
    ended = call("run", "config.toml", "--out", "b", cwd=tmp_path, command=command)
    assert ended.returncode == 0, ended.stderr
    assert "kT_trans" in ended.stdout
    files = results(done)
    assert set(files) >= {"config.toml", "summary.json", "events.csv", "observables/msd.csv"}
    assert set(files) >= {"trajectory.gsd", "trajectory.lammpstrj", "trajectory.vtp"}
    assert files == results(tmp_path / "b")


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("word", "what"), [("nope", '"nope" is no command'), (None, "no command"), ("", '"" is no command')]
)
def test_unknown_commands_are_named(tmp_path, command, word, what):
    ended = call(*([] if word is None else [word]), cwd=tmp_path, command=command)
    assert ended.returncode == 2 and not ended.stdout
    assert re.match(
        f"command line: {what}; accepted: init, run, resume, extend, .*distance, query; "
        "hardbody --help explains them\\n$",
        ended.stderr,
    )


def test_files_and_overrides(done, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pathlib.Path("mine.toml").write_text(TEXT.replace("seed = 3", "seed = 4").replace("48", "50"))
    run = hb.run("mine.toml", overrides={"seed": 3, "system.number": 48})
    assert os.fspath(run) == "out/mine"
    assert results(run) == results(done)


def test_config_of_a_run_runs_again(done, tmp_path):
    assert results(hb.run(done.config, tmp_path / "b")) == results(done)


def test_directories_are_kept(done, tmp_path):
    directory = tmp_path / "b"
    first = hb.run(with_values(CONFIG, production={"time": 1.0}), directory)
    advice = "another directory, hardbody.resume to continue it, or force=True to overwrite it"
    with pytest.raises(ValueError, match=rf"already holds a run \(.*\); accepted: {advice}$"):
        hb.run(CONFIG, directory)
    with pytest.raises(ValueError, match=r": force=True would delete .*config.toml, which is an input of this run"):
        hb.run(directory / "config.toml", directory, force=True)
    assert first.config["production"]["time"] == 1
    assert results(hb.run(CONFIG, directory, force=True)) == results(done)


def test_program_of_the_package(tmp_path):
    ended = call("--version", cwd=tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.startswith(f"hardbody {hb.__version__}\n")
    ended = call("run", "none.toml", cwd=tmp_path)
    assert ended.returncode == 2
    assert ended.stderr.startswith("none.toml: cannot be read: No such file or directory")
    assert call("run", cwd=tmp_path).returncode == 2


# ---- Errors


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"system": {"packing_fraction": 1.5}}, r"^config: system\.packing_fraction is 1\.5; accepted: "),
        ({"system": {"number": "many"}}, r'^config: system\.number is "many"; accepted: '),
        ({"sytem": {"number": 3}}, r"^config: .*sytem.*did you mean"),
        ({"shape": {"aspect_ratio": -1}}, r"^config: shape\.aspect_ratio is -1; accepted: "),
    ],
)
def test_bad_configs(tmp_path, sections, message):
    with pytest.raises(ValueError, match=message) as caught:
        hb.run(with_values(CONFIG, **sections), tmp_path / "b")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "b").exists()


def test_bad_arguments(tmp_path):
    with pytest.raises(TypeError, match=r"^config: system\.number is None"):
        hb.run({"system": {"number": None}}, tmp_path / "b")
    with pytest.raises(ValueError, match="^out is None; accepted: the name of a directory"):
        hb.run(CONFIG)
    with pytest.raises(TypeError, match="^config is 3; accepted: a dict, or the path of a TOML file"):
        hb.run(3, tmp_path / "b")
    with pytest.raises(ValueError, match=r"^out is 'a\\x00b'"):
        hb.run(CONFIG, "a\0b")
    with pytest.raises(TypeError, match=r"^overrides is \['seed=1'\]; accepted: a dict"):
        hb.run(CONFIG, tmp_path / "b", overrides=["seed=1"])
    with pytest.raises(ValueError, match=r"^overrides: system\.number=-4: system\.number is -4; accepted"):
        hb.run(CONFIG, tmp_path / "b", overrides={"system.number": -4})
    with pytest.raises(TypeError, match="^progress is 3; accepted: None, True, or a function"):
        hb.run(CONFIG, tmp_path / "b", progress=3)
    with pytest.raises(ValueError, match="^none.toml: cannot be read"):
        hb.run("none.toml", tmp_path / "b")
    with pytest.raises(ValueError, match="nowhere: is not there; accepted: the directory of a run"):
        hb.resume(tmp_path / "nowhere")
    assert not (tmp_path / "b").exists()


def test_runs_that_are_not_equilibrated_warn(tmp_path):
    with pytest.warns(hb.NotEquilibratedWarning, match="a: not shown to be equilibrated: ") as caught:
        run = hb.run(CONFIG, tmp_path / "a")
    assert caught[0].filename == __file__
    with pytest.warns(hb.NotEquilibratedWarning):
        hb.resume(run)


def test_failures_are_runtime_errors(tmp_path):
    script = f"""
        import resource, hardbody as hb
        from runs import CONFIG
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
        try:
            hb.run(CONFIG, {str(tmp_path / "b")!r})
        except RuntimeError as error:
            print(type(error).__name__, error)
    """
    said = python(script).communicate()[0]
    assert re.match(r"RuntimeError .*: File too large; .*hardbody resume .*\n$", said), said


def test_unsound_results_raise(tmp_path):
    """Spheres that are packed so closely that 2000 events a body take next to no time."""
    config = {
        "seed": 3,
        "system": {"number": 108, "packing_fraction": 0.7404804896, "start": "fcc"},
        "shape": {"aspect_ratio": 1},
        "equilibration": {"time": 1.0},
        "production": {"time": 1.0},
    }
    why = r"b: NOT SOUND: equilibration stalled at time \S+: 217000 events in "
    for call_of in (lambda: hb.run(config, tmp_path / "b"), lambda: hb.resume(tmp_path / "b")):
        with pytest.raises(hb.NumericalError, match=why) as caught:
            call_of()
        assert isinstance(caught.value, hb.UnsoundError)
        unsound = caught.value.run
        assert unsound == hb.Run(tmp_path / "b") and not unsound.is_finished
        assert "stalled at time" in unsound.summary["stalled"] and not unsound.summary["sound"]
        assert "<b>NOT SOUND</b>" in unsound._repr_html_()
        assert unsound.failures == []  # a stall has no pairs


def test_runs_that_fail_have_their_pairs(tmp_path):
    """Steps of half a body step over contacts."""
    config = {
        "seed": 1,
        "system": {"number": 64, "packing_fraction": 0.5},
        "shape": {"aspect_ratio": 1.5},
        "dynamics": {"finder": "bracketing", "eps_d": 0.85, "neighbours": "cells"},
        "equilibration": {"time": 0.0},
        "production": {"time": 0.8},
    }
    with pytest.raises(hb.UnsoundError, match="b: NOT SOUND: .* overlaps were met during production") as caught:
        hb.run(config, tmp_path / "b")
    failures = caught.value.run.failures
    assert 0 < len(failures) <= 16 and not caught.value.run.summary["sound"]
    for pair in failures:
        assert pair["reason"] == "the bodies overlap by more than rounding" and 0 < pair["time"] <= 0.8
        bodies = [pair[name] for name in ("a", "b")]
        shapes = [hb.Ellipsoid(body["shape"]["semi_axes"]) for body in bodies]
        poses = [hb.Pose(body["position"], body["rotation"]) for body in bodies]
        assert hb.distance(shapes[0], poses[0], shapes[1], poses[1]).distance < -1e-12


def test_failures_are_those_of_the_files(done, tmp_path):
    run = hb.Run(shutil.copytree(done.path, tmp_path / "b"))
    (run.path / "failures").mkdir()
    for number in (2, 1):
        (run.path / "failures" / f"pair_{number:02}.json").write_text(json.dumps({"i": number}))
    assert run.failures == [{"i": 1}, {"i": 2}]
    assert done.failures == []


# ---- Stopping


def python(script: str, **options) -> subprocess.Popen[str]:
    """Starts a Python process."""
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=pathlib.Path(__file__).parent,
        **options,
    )


def wait_for(path: pathlib.Path, process: subprocess.Popen[str]) -> None:
    """Waits until production has begun: its first frame is there."""
    for _ in range(1200):
        if path.exists() and path.stat().st_size > 0:
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    raise AssertionError(f"{path} is not written")


@pytest.fixture(scope="module")
def longer(tmp_path_factory):
    """A run of a second or more, and its config."""
    config = with_values(CONFIG, production={"time": 240.0})
    return config, hb.run(config, tmp_path_factory.mktemp("runs") / "long")


def test_ctrl_c_saves_and_raises(tmp_path, longer):
    script = """
        import signal, sys, hardbody as hb
        from runs import CONFIG, with_values
        before = signal.getsignal(signal.SIGINT)
        try:
            hb.run(with_values(CONFIG, production={"time": 240.0}), OUT)
        except KeyboardInterrupt as error:
            print(error)
        assert signal.getsignal(signal.SIGINT) is before is signal.default_int_handler
        print(hb.run(CONFIG, OUT + "2").is_finished)
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            print("Python's handler is back")
    """.replace("OUT", repr(str(tmp_path / "b")))
    process = python(script)
    wait_for(tmp_path / "b" / "trajectory.lammpstrj", process)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGINT)  # no harm
    said, errors = process.communicate()
    assert process.returncode == 0, errors
    lines = said.splitlines()
    assert re.search(
        r"b: stopped by SIGINT during production at time .*: results so far are written, hardbody.resume\(...\)",
        lines[0],
    )
    assert lines[1:] == ["True", "Python's handler is back"]

    stopped = hb.Run(tmp_path / "b")
    assert not stopped.is_finished
    assert stopped.summary["interrupted"]
    assert "interrupted: not finished" in stopped._repr_html_()
    again = hb.resume(stopped)
    assert again.is_finished
    assert "not finished" not in again._repr_html_()
    assert results(again) == results(longer[1])
    assert hb.resume(again) == again  # nothing to do


def test_sigterm_saves_and_ends_the_process(tmp_path):
    script = f"""
        import hardbody as hb
        from runs import CONFIG, with_values
        hb.run(with_values(CONFIG, production={{"time": 240.0}}), {str(tmp_path / "b")!r})
    """
    process = python(script)
    wait_for(tmp_path / "b" / "trajectory.lammpstrj", process)
    process.send_signal(signal.SIGTERM)
    process.communicate()
    assert process.returncode == -signal.SIGTERM
    assert hb.Run(tmp_path / "b").summary["interrupted"]


def test_sigterm_with_a_handler(tmp_path):
    script = f"""
        import signal, hardbody as hb
        from runs import CONFIG, with_values
        signal.signal(signal.SIGTERM, lambda *_: print("handled"))
        try:
            hb.run(with_values(CONFIG, production={{"time": 240.0}}), {str(tmp_path / "b")!r})
        except RuntimeError as error:
            print(error)
    """
    process = python(script)
    wait_for(tmp_path / "b" / "trajectory.lammpstrj", process)
    process.send_signal(signal.SIGTERM)
    said, errors = process.communicate()
    assert process.returncode == 0, errors
    assert re.match(r"handled\n.*b: stopped by SIGTERM during production", said)


# ---- Progress and output


def test_progress(longer, tmp_path):
    config, undisturbed = longer
    calls: list[tuple[str, float | None]] = []

    def stop_late(text: str, done: float | None) -> None:
        calls.append((text, done))
        if text.startswith("production") and done is not None and done > 0.1:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        hb.run(config, tmp_path / "b", progress=stop_late)
    assert all(done is None or 0 <= done <= 1 for _, done in calls)
    assert "stopped by its caller during production" in (tmp_path / "b" / "log.txt").read_text()
    assert results(hb.resume(tmp_path / "b")) == results(undisturbed)


def test_quiet(tmp_path, capfd):
    hb.run(CONFIG, tmp_path / "a")
    assert capfd.readouterr() == ("", "")


def test_output_goes_to_the_streams_of_python(tmp_path, capsys):
    config = with_values(CONFIG, system={"nematic_order": 0.9})  # of which the compression leaves less
    hb.run(config, tmp_path / "a", quiet=False)
    out, errors = capsys.readouterr()
    assert out.startswith(f"hardbody {hb.__version__}: 48 hard ellipsoids")
    assert "\nfiles: " in out
    assert errors.startswith("start: S = ")


def test_tqdm(tmp_path, capsys):
    pytest.importorskip("tqdm")
    hb.run(CONFIG, tmp_path / "a", progress=True)
    assert re.search(r"done: 100%\|[^|\r\n]*\|\s*$", capsys.readouterr().err)


def test_messages_and_the_bar_have_lines_of_their_own(tmp_path):
    pytest.importorskip("tqdm")
    config = with_values(CONFIG, system={"nematic_order": 0.9})
    # In a process of its own, whose two streams are one, as on a terminal.
    script = f"""
        import sys, hardbody as hb
        sys.stdout = sys.stderr
        hb.run({config!r}, {str(tmp_path / "a")!r}, quiet=False, progress=True)
    """
    process = python(script)
    said, errors = process.communicate()
    assert process.returncode == 0, errors
    shown = [re.sub(r".*\r", "", line) for line in errors.split("\n")]  # what later characters leave of each line
    assert any(line.startswith("start: S = ") for line in shown)
    assert f"files: {tmp_path / 'a'}" in errors
    assert all(line.rstrip().endswith("|") for line in shown if "%|" in line), shown


def test_an_inner_run_that_fails_does_not_stop_the_outer_one(longer, tmp_path):
    config, _ = longer
    failed = []

    def fail(text, done):
        raise LookupError("inner")

    def progress(text, done):
        if not failed:
            failed.append(True)
            with pytest.raises(LookupError, match="inner"):
                hb.run(config, tmp_path / "inner", progress=fail)

    outer = hb.run(config, tmp_path / "outer", progress=progress)
    assert failed and not outer.summary["interrupted"]


@pytest.mark.parametrize("name", ["force", "quiet"])
def test_flags_are_bools(tmp_path, name):
    with pytest.raises(TypeError, match=f"{name} is 'no'; accepted: True or False"):
        hb.run({"system": {"packing_fraction": 0.1}}, tmp_path / "run", **{name: "no"})


def test_a_dotted_section_is_refused(tmp_path):
    with pytest.raises(
        ValueError, match="a key is 'system.number'; accepted: a section with keys of its own, or overrides"
    ):
        hb.run({"system": {"number": 32}, "system.number": 40}, tmp_path / "run")


def test_empty_lists_are_refused(tmp_path):
    with pytest.raises(ValueError, match="paths is empty"):
        hb.report([], tmp_path / "x.html")
    with pytest.raises(ValueError, match="values is empty"):
        hb.map(tmp_path, "x", "y", [])


def test_threads(done, tmp_path):
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        runs = list(pool.map(lambda name: hb.run(CONFIG, tmp_path / name), "abcd"))
    assert [results(run) == results(done) for run in runs] == [True] * 4


def test_ctrl_c_with_threads(tmp_path):
    script = """
        import concurrent.futures, time, hardbody as hb
        from runs import CONFIG, with_values
        config = with_values(CONFIG, production={"time": 4000.0})
        pool = concurrent.futures.ThreadPoolExecutor(2)
        runs = [pool.submit(hb.run, config, OUT + name) for name in "12"]
        try:
            concurrent.futures.wait(runs)
            time.sleep(60)
        except KeyboardInterrupt:
            print("main")
        print([type(run.exception()).__name__ for run in runs])
    """.replace("OUT", repr(str(tmp_path / "b")))
    process = python(script)
    wait_for(tmp_path / "b1" / "trajectory.lammpstrj", process)
    wait_for(tmp_path / "b2" / "trajectory.lammpstrj", process)
    process.send_signal(signal.SIGINT)
    said, errors = process.communicate()
    assert process.returncode == 0, errors
    assert said == "main\n['KeyboardInterrupt', 'KeyboardInterrupt']\n"


def test_guide_runs(tmp_path, monkeypatch):
    """The examples of docs/python-runs.md, in order, in one name space."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/python-runs.md").read_text(), re.DOTALL)
    assert len(blocks) == 4
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "docs/python-runs.md", "exec"), names)
    assert names["run"].is_finished
