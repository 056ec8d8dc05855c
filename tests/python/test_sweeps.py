"""Sweeps and maps."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from runs import CONFIG, call, results, with_values

import hardbody as hb
from hardbody import _calls

GRID = {"shape.aspect_ratio": [1.5, 2.0], "system.packing_fraction": {"from": 0.2, "to": 0.3, "count": 2}}
SWEEP = with_values(CONFIG, output={"trajectory": [], "events": 0}, production={"time": 2.0}) | {"grid": GRID}
TEXT = """
seed = 3
[system]
number = 48
[equilibration]
time = 1.0
[production]
time = 2.0
[output]
trajectory = []
frames = 4
events = 0
[grid]
shape.aspect_ratio = [1.5, 2.0]
system.packing_fraction = [0.2, 0.3]
"""


def table_bytes(directory: os.PathLike[str] | str) -> list[str]:
    """Rows of sweep.csv but the last two columns, which are times."""
    return [line.rsplit(",", 2)[0] for line in (pathlib.Path(directory) / "sweep.csv").read_text().splitlines()]


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    return hb.sweep(SWEEP, tmp_path_factory.mktemp("sweeps") / "a", jobs=2)


def test_overrides_and_larger_grids(tmp_path):
    made = hb.sweep(SWEEP, tmp_path / "a", overrides={"system.number": 40, "grid.shape.aspect_ratio": [1.5]}, jobs=2)
    assert list(made.table["status"]) == ["done"] * 2
    assert all(run is not None and run.config["system"]["number"] == 40 for run in made.runs)
    first = table_bytes(made)
    larger = hb.sweep(SWEEP, tmp_path / "a", overrides={"system.number": 40}, jobs=2)
    assert list(larger.table["shape.aspect_ratio"]) == [1.5, 1.5, 2.0, 2.0]
    assert table_bytes(larger)[:3] == first
    with pytest.raises(ValueError, match=r"^overrides: system\.number=-4: system\.number is -4; accepted"):
        hb.sweep(SWEEP, tmp_path / "b", overrides={"system.number": -4})


def test_table_and_runs(sweep):
    table = sweep.table
    assert list(table["status"]) == ["done"] * 4
    np.testing.assert_array_equal(table["shape.aspect_ratio"], [1.5, 1.5, 2.0, 2.0])
    np.testing.assert_array_equal(table["system.packing_fraction"], [0.2, 0.3, 0.2, 0.3])
    assert (table["Z"][1::2] > table["Z"][0::2]).all()  # denser fluids have the higher pressure
    for row, run in zip(table, sweep.runs, strict=True):
        assert run is not None
        assert run.config["shape"]["aspect_ratio"] == row["shape.aspect_ratio"]
        assert run.config["system"]["packing_fraction"] == row["system.packing_fraction"]
        assert run.summary["observables"]["Z"]["value"] == row["Z"]
    assert "4 of 4 points done" in sweep._repr_html_()


def test_pandas(sweep):
    pytest.importorskip("pandas")
    frame = sweep.to_pandas()
    assert len(frame.groupby("shape.aspect_ratio")["Z"].mean()) == 2


def test_points_are_runs(sweep, tmp_path):
    config = {key: value for key, value in SWEEP.items() if key != "grid"}
    config = with_values(config, shape={"aspect_ratio": 1.5}, system={"packing_fraction": 0.3})
    assert results(hb.run(config, tmp_path / "b")) == {
        name: content for name, content in results(sweep.runs[1]).items() if name != "state.json"
    }


def test_program_of_the_package_sweeps(sweep, tmp_path):
    (tmp_path / "mine.toml").write_text(TEXT)
    ended = call("sweep", "mine.toml", "--jobs", "2", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout == "out/mine: 4 points: 4 done, 0 failed\n"
    assert table_bytes(tmp_path / "out" / "mine") == table_bytes(sweep)


def test_workers_do_not_depend_on_the_path(sweep, tmp_path):
    """The package may be found by a sys.path of this process alone."""
    package = pathlib.Path(hb.__file__).resolve().parent
    script = f"""
import sys
sys.path = {sys.path!r}
import hardbody as hb
from test_sweeps import SWEEP
hb.sweep(SWEEP, {str(tmp_path / "a")!r}, jobs=2)
"""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    subprocess.run([sys.executable, "-c", script], check=True, cwd=package, env=environment)
    assert table_bytes(tmp_path / "a") == table_bytes(sweep)


def test_workers_start_tasks(sweep, tmp_path):
    """A cluster starts its tasks by the command of workers, which in turn start the runs."""
    (tmp_path / "mine.toml").write_text(TEXT)
    planned = call("sweep", "plan", "mine.toml", "--task-time", "1000", cwd=tmp_path)
    assert planned.returncode == 0, planned.stderr
    task = [*_calls.worker_program(), "sweep", "point", "mine.toml", "1"]
    ended = subprocess.run(task, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert ended.returncode == 0, ended.stderr
    assert call("sweep", "collect", "mine.toml", cwd=tmp_path).returncode == 0
    assert table_bytes(tmp_path / "out" / "mine") == table_bytes(sweep)


def test_replicas(sweep, tmp_path):
    grid = {"shape.aspect_ratio": [1.5], "system.packing_fraction": [0.2]}
    made = hb.sweep(SWEEP | {"replicas": 3, "grid": grid}, tmp_path / "a", jobs=2)
    assert list(made.table["replicas"]) == [3]
    assert [len(runs) for runs in made.replicas] == [3]
    values = [run.summary["observables"]["Z"]["value"] for run in made.replicas[0]]
    assert values[0] == sweep.table["Z"][0]  # replica 0 is the run of the sweep without replicas
    assert len(set(values)) == 3
    np.testing.assert_allclose(made.table["Z"], np.mean(values), rtol=1e-12)
    row = made.agreement[made.agreement["observable"] == "Z"][0]
    assert row["error"] == made.table["Z_error"][0] >= row["error_within"]
    assert [[run is not None for run in runs] for runs in sweep.replicas] == [[True]] * 4
    with pytest.raises(ValueError, match="agreement.csv is not there; accepted: a sweep with replicas"):
        _ = sweep.agreement
    single = {key: value for key, value in SWEEP.items() if key != "grid"} | {"replicas": 2}
    assert hb.sweep(single, tmp_path / "b").table["replicas"][0] == 2


def test_one_state_point_with_replicas(tmp_path):
    config = with_values(CONFIG, output={"trajectory": [], "events": 0}, production={"time": 2.0})
    made = hb.run(config, tmp_path / "a", replicas=2)
    assert isinstance(made, hb.Sweep)
    assert list(made.table["replicas"]) == [2] and len(made.replicas[0]) == 2
    with pytest.raises(ValueError, match=r"^replicas is 0; accepted: an integer from 1 to 1000"):
        hb.run(config, tmp_path / "b", replicas=0)
    with pytest.raises(ValueError, match=r"^force=True cannot be combined with replicas; accepted: another directory"):
        hb.run(config, tmp_path / "a", replicas=2, force=True)


def test_dask(sweep, tmp_path):
    """Workers of a cluster run the same tasks; one of them is killed on the way."""
    import distributed

    longer = SWEEP | {"production": {"time": 60.0}}
    here = hb.sweep(longer, tmp_path / "here")
    shown = []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            workers = list(client.run(os.getpid).values())

            def progress(text: str, done: float | None) -> None:
                if not shown:
                    os.kill(workers[0], signal.SIGKILL)
                shown.append((text, done))

            made = hb.sweep(longer, tmp_path / "a", client=client, task_time=1e-3, progress=progress)
            again = hb.sweep(longer, tmp_path / "a", client=client, progress=True)
            with pytest.raises(TypeError, match=r"^progress is 3; accepted: None, True, or a function"):
                hb.sweep(longer, tmp_path / "c", client=client, progress=3)  # type: ignore[arg-type]
    assert table_bytes(made) == table_bytes(here) == table_bytes(again)
    assert shown[0][0] == "sweep on Dask: 0 of 4 tasks done" and shown[-1] == ("sweep on Dask: 4 of 4 tasks done", 1.0)
    with pytest.raises(TypeError, match=r"^client is 3; accepted: None, or a dask\.distributed\.Client"):
        hb.sweep(SWEEP, tmp_path / "b", client=3)
    with pytest.raises(ValueError, match=r"^jobs is 2 with a client"):
        hb.sweep(SWEEP, tmp_path / "b", client=client, jobs=2)
    assert not (tmp_path / "b").exists() and not (tmp_path / "c").exists()


LONG = with_values(SWEEP, production={"time": 1e6}, output={"checkpoint_every": "0.1s"})


def tasks_of(directory: pathlib.Path) -> list[int]:
    """Processes of tasks of a sweep, and of their runs."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")
            here = (entry / "cwd").readlink()
        except OSError:
            continue
        if (b"point" in words and os.fsencode(directory) in words) or (b"base.toml" in words and here == directory):
            found.append(int(entry.name))
    return found


def test_dask_is_stopped(tmp_path):
    """An exception ends the tasks, which save their states; the tasks are one for each thread of the workers."""
    import distributed

    directory = tmp_path / "a"

    def stop(text: str, done: float | None) -> None:
        shown.append(text)
        if len(list(directory.glob("*/checkpoint.bin"))) == 2:
            raise InterruptedError

    with distributed.LocalCluster(n_workers=1, threads_per_worker=2, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            for _ in range(2):
                shown: list[str] = []
                begin = time.monotonic()
                with pytest.raises(InterruptedError):
                    hb.sweep(LONG, directory, client=client, task_time=1e9, progress=stop)
                assert time.monotonic() - begin < 60
                assert shown[0] == "sweep on Dask: 0 of 2 tasks done"
                assert tasks_of(directory) == []
                assert list(hb.Sweep(directory).table["status"]).count("stopped") == 2
                assert not list(directory.glob("dask.*")) and not list(directory.glob("*/task.lock"))


def test_dask_worker_ends_with_its_tasks(tmp_path):
    """A task whose worker is killed saves its state and ends, so that it can continue elsewhere at once."""
    import distributed

    directory = tmp_path / "a"
    killed: list[int] = []

    def kill(text: str, done: float | None) -> None:
        running = tasks_of(directory)
        if not killed and list(directory.glob("*/checkpoint.bin")):
            os.kill(worker, signal.SIGKILL)
            killed.extend(running)
        # The worker is started again, and the task with it.
        elif killed and running and not set(killed) & set(running):
            raise InterruptedError

    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            worker = next(iter(client.run(os.getpid).values()))
            begin = time.monotonic()
            with pytest.raises(InterruptedError):
                hb.sweep(LONG, directory, client=client, progress=kill)
            assert time.monotonic() - begin < 60
    assert tasks_of(directory) == []


def test_dask_without_a_shared_directory(tmp_path):
    from hardbody import _dask

    with pytest.raises(_dask.TaskStopped, match=r"is not there on .*; accepted: a directory"):
        _dask.run_task(str(tmp_path / "a"), 1, "dask.1")


def test_failed_points(tmp_path):
    grid = {"system.packing_fraction": [0.2, 0.99]}
    with pytest.raises(hb.SweepError, match=r"2 points: 1 done, 1 failed; failed: .*0\.99.*accepted") as caught:
        hb.sweep(SWEEP | {"grid": grid}, tmp_path / "a")
    failed = caught.value.sweep
    assert list(failed.table["status"]) == ["done", "failed"]
    assert failed.runs[0] is not None
    assert failed.runs[1] is None


def test_errors(tmp_path):
    with pytest.raises(
        ValueError, match=r'^config: has no \[grid\]: hardbody\.run takes .*, with \{"grid": \{key: values\}\}$'
    ):
        hb.sweep(CONFIG, tmp_path / "a")
    with pytest.raises(ValueError, match=r"^config: system.number is \[\]; accepted: a list of values"):
        hb.sweep(CONFIG | {"grid": {"system": {"number": []}}}, tmp_path / "a")
    with pytest.raises(ValueError, match="^jobs is 0; accepted: an integer from 1 to 1024"):
        hb.sweep(SWEEP, tmp_path / "a", jobs=0)
    with pytest.raises(ValueError, match="out is None"):
        hb.sweep(SWEEP)
    assert not (tmp_path / "a").exists()


def test_runs_of_several_grids(tmp_path):
    """Points are found by their values, whatever their types; those of each grid have keys of their own."""
    made = tmp_path / "a"
    states = [
        ({"shape.aspect_ratio": 2, "output.trajectory": ["gsd"]}, 1),
        ({"shape.aspect_ratio": 2.5, "output.trajectory": []}, 1),
        ({"system.number": 64}, 2),
        ({"system.number": 64}, 3),
    ]
    for k, (keys, seed) in enumerate(states):
        (made / f"point{k}").mkdir(parents=True)
        (made / f"point{k}/state.json").write_text(json.dumps({"name": f"point{k}", "keys": keys, "seed": seed}))
        (made / f"point{k}/config.toml").write_text("")
    (made / "point3/config.toml").unlink()
    (made / "sweep.csv").write_text(
        "shape.aspect_ratio,output.trajectory,system.number,seed\n"
        '2.5,[],32,1\n2.0,"[""gsd""]",32,1\n1.0,[],64,2\n1.0,[],64,3\n1.0,[],64,4\n'
    )
    names = [None if run is None else run.path.name for run in hb.Sweep(made).runs]
    assert names == ["point1", "point0", "point2", None, None]


def test_other_sweep_is_refused(sweep):
    with pytest.raises(ValueError, match="seed is 4, but 3 in the sweep"):
        hb.sweep(SWEEP | {"seed": 4}, sweep)
    assert hb.sweep(SWEEP, sweep) == sweep  # nothing to do


def test_ctrl_c_and_again(sweep, tmp_path):
    script = """
        import sys, hardbody as hb
        from test_sweeps import SWEEP
        try:
            hb.sweep(SWEEP, sys.argv[1], jobs=1)
        except KeyboardInterrupt as error:
            print(error)
    """.replace("\n        ", "\n")
    process = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path / "a")],
        stdout=subprocess.PIPE,
        text=True,
        cwd=pathlib.Path(__file__).parent,
    )
    for _ in range(600):
        if list(tmp_path.glob("a/*/config.toml")):
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    said = process.communicate()[0]
    assert said == f"{tmp_path / 'a'}: stopped by SIGINT: the same call continues\n"
    calls: list[float | None] = []
    again = hb.sweep(SWEEP, tmp_path / "a", jobs=2, progress=lambda text, done: calls.append(done))
    assert table_bytes(again) == table_bytes(sweep)


def test_map(sweep, tmp_path):
    drawn = sweep.map("aspect_ratio", "packing_fraction", "Z", levels=[2.5], where={"seed": np.int64(3)})
    assert drawn.path == sweep.path / "map_Z.svg"
    assert drawn._repr_svg_().startswith("<svg ")
    lines = drawn.lines
    assert lines.names[:3] == ("value", "level", "line")
    assert set(lines["level"]) == {2.5}
    assert ((lines["system.packing_fraction"] > 0.2) & (lines["system.packing_fraction"] < 0.3)).all()
    both = hb.map(
        sweep, "aspect_ratio", "packing_fraction", ["Z", "collision_rate"],
        levels={"Z": [2.5], "collision_rate": [4, 5]}, log_x=True, out=tmp_path / "a.svg", csv=tmp_path / "a.csv",
    )  # fmt: skip
    assert both.path == tmp_path / "a.svg"
    with pytest.raises(ValueError, match="levels is .*; accepted with several values: a dict"):
        hb.map(sweep, "aspect_ratio", "packing_fraction", ["Z", "S"], levels=[1])
    with pytest.raises(TypeError, match=r"levels: Z has \['x'\]; accepted: a list of numbers"):
        hb.map(sweep, "aspect_ratio", "packing_fraction", "Z", levels=["x"])
    for levels in ("25", [True], [np.str_("2")], [[1.0, 2.0]], 2.5):
        with pytest.raises(TypeError, match="levels: Z has .*; accepted: a list of numbers"):
            hb.map(sweep, "aspect_ratio", "packing_fraction", "Z", levels=levels)
    for level in (np.nan, np.inf, 10**400):
        with pytest.raises(ValueError, match=r"^levels: Z\[1\] is .*; accepted: a finite number$"):
            hb.map(sweep, "aspect_ratio", "packing_fraction", "Z", levels=[2.5, level])
    for column in (1, "seed=1"):
        with pytest.raises(TypeError, match="^where: a column is .*; accepted: a str"):
            hb.map(sweep, "aspect_ratio", "packing_fraction", "Z", where={column: 1})
    with pytest.raises(ValueError, match="nothing"):
        hb.map(sweep, "nothing", "packing_fraction", "Z")
    with pytest.raises(ValueError, match=r"^where: seed=9: no row of .* has this value; accepted: a value of that"):
        hb.map(sweep, "aspect_ratio", "packing_fraction", "Z", where={"seed": 9})


def test_report(sweep):
    report = sweep.report()
    assert report.path == sweep.path / "report.html"
    assert "aspect_ratio" in report.html
