"""Results of runs as Python objects."""

from __future__ import annotations

import builtins
import csv
import fractions
import importlib
import json
import os
import re
import shutil

import numpy as np
import pytest
from runs import CONFIG, with_values

import hardbody as hb
from hardbody._tables import read_table


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return hb.run(CONFIG, tmp_path_factory.mktemp("results") / "a run")


def test_summary_and_config(run):
    assert run.is_finished
    assert run.summary == json.loads((run.path / "summary.json").read_text())
    assert run.summary["observables"]["kT_trans"]["value"] == pytest.approx(1, abs=0.2)
    assert run.config["system"]["number"] == 48
    assert run.config["production"]["time"] == 3.0
    assert os.fspath(run) == str(run.path)
    assert repr(run) == f"Run({str(run.path)!r})  # not shown to be equilibrated"
    assert eval(repr(run), {"Run": hb.Run}) == run


def test_runs_say_what_limits_them(run, tmp_path):
    assert not run.summary["equilibrated"]
    assert "<b>not shown to be equilibrated</b>" in run._repr_html_()
    copy = shutil.copytree(run.path, tmp_path / "copy")
    summary = run.summary | {"equilibrated": True}
    (copy / "summary.json").write_text(json.dumps(summary))
    assert repr(hb.Run(copy)) == f"Run({str(copy)!r})"
    assert "equilibrated" not in hb.Run(copy)._repr_html_().split("<table>")[0]
    (copy / "summary.json").write_text(json.dumps(summary | {"sound": False, "interrupted": True}))
    assert repr(hb.Run(copy)).endswith("  # interrupted: not finished, NOT SOUND")
    (copy / "summary.json").write_text("{")
    assert repr(hb.Run(copy)) == f"Run({str(copy)!r})"
    (copy / "summary.json").unlink()
    assert repr(hb.Run(copy)).endswith("  # not finished")


def test_a_file_is_no_directory_of_a_run(run):
    with pytest.raises(ValueError, match=r"summary.json: is not a directory; accepted: the directory of a run$"):
        hb.Run(run.path / "summary.json")


def test_curves_are_those_of_the_files(run):
    assert set(run.observables) == {path.stem for path in (run.path / "observables").iterdir()}
    assert len(run.observables) == len(list(run.observables)) > 5
    for name, table in run.observables.items():
        with open(run.path / "observables" / f"{name}.csv", newline="") as file:
            head, *rows = csv.reader(file)
        assert [f"{column} [{table.units[column]}]" for column in table.names] == head
        expected = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
        np.testing.assert_array_equal(np.stack([table[column] for column in table.names], axis=1), expected)


def test_tables_are_arrays(run):
    msd = run.observables["msd"]
    assert msd.names == ("t", "msd", "msd_error")
    assert msd.units == {"t": "l sqrt(m/kT)", "msd": "l^2", "msd_error": "l^2"}
    assert type(msd["msd"]) is np.ndarray
    assert msd["msd"].dtype == np.float64
    late = msd[msd["t"] > 0.1]
    assert isinstance(late, hb.Table)
    assert late.units == msd.units
    assert msd[["t", "msd"]].units == {"t": "l sqrt(m/kT)", "msd": "l^2"}
    with pytest.raises(KeyError, match="no column 'nope'; there are: t, msd, msd_error"):
        msd["nope"]
    assert msd[0]["t"] == msd["t"][0]
    slope = np.polyfit(np.log(msd["t"][:5]), np.log(msd["msd"][:5]), 1)[0]
    assert slope == pytest.approx(2, abs=0.05)  # ballistic
    with pytest.raises(KeyError, match=r"has no msx.csv; there are: alpha2, "):
        run.observables["msx"]


def test_pandas(run):
    pandas = pytest.importorskip("pandas")
    frame = run.observables["msd"].to_pandas()
    expected = pandas.read_csv(run.path / "observables" / "msd.csv")
    np.testing.assert_array_equal(frame.to_numpy(), expected.to_numpy())
    assert list(frame.columns) == ["t", "msd", "msd_error"]
    assert frame.attrs["units"]["msd"] == "l^2"


def test_columns_of_tables(tmp_path):
    (tmp_path / "a.csv").write_text('a,b [l],c,d,e\n1,1,true,x,\n-2,2.5,false,"y, z",3\n')
    table = read_table(tmp_path / "a.csv")
    assert [table[name].dtype.kind for name in table.names] == list("ifbUf")
    assert table.units == {"a": "", "b": "l", "c": "", "d": "", "e": ""}
    assert list(table["d"]) == ["x", "y, z"]
    assert np.isnan(table["e"][0])
    (tmp_path / "a.csv").write_text("a,b\n1\n")
    with pytest.raises(ValueError, match=r"a.csv: is not a table"):
        read_table(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("a [l]\n")
    assert read_table(tmp_path / "a.csv").shape == (0,)


def test_events(run):
    events = run.events
    assert events.names == ("time", "i", "j")
    assert len(events) == 10
    assert (np.diff(events["time"]) >= 0).all()
    assert events["i"].dtype == np.int64


def test_trajectory(run):
    pytest.importorskip("gsd")
    with run.trajectory() as frames:
        assert len(frames) == 4
        assert frames[-1].particles.position.shape == (48, 3)
        assert frames[-1].log["hardbody/time"][0] == pytest.approx(3)


def test_report(run, tmp_path):
    report = run.report()
    assert report.path == run.path / "report.html"
    assert report.html.startswith("<!doctype html>")
    shown = report._repr_html_()
    assert shown.startswith('<iframe sandbox="allow-scripts" srcdoc="&lt;!doctype html&gt;')
    assert shown.count('"') == 6  # the page is escaped
    assert len(shown) < 2_000_000
    both = hb.report([run, run.path], tmp_path / "both.html")
    assert os.fspath(both) == str(tmp_path / "both.html")
    assert both.is_interactive == report.is_interactive
    with pytest.raises(ValueError, match="out is None; accepted: the name of an HTML file"):
        hb.report([run, run])
    both.path.write_text(" " * 3_000_000)
    assert re.fullmatch(r'<p>Report of 3.0 MB: <a href=".*both.html">.*both.html</a></p>', both._repr_html_())


def test_html_of_a_run(run):
    shown = run._repr_html_()
    assert "<th>kT_trans</th>" in shown
    assert "report</a>" in shown
    assert len(shown) < 10_000


def test_plot(run, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    figure = run.plot()
    assert [axis.get_title() for axis in figure.axes] == [
        "Mean square displacement",
        "Orientation, second order",
        "Self-intermediate scattering",
        "Pair correlations",
    ]
    assert len(figure.axes[2].get_legend().texts) == 4
    figure = run.plot("rotational_msd")
    assert [text.get_text() for text in figure.axes[0].get_legend().texts] == ["world frame", "body frame"]
    line = run.plot("msd").axes[0].containers[0].lines[0]
    np.testing.assert_array_equal(line.get_ydata(), run.observables["msd"]["msd"])
    assert len(run.plot("pressure", "velocity", "s_q").axes) == 3
    with pytest.raises(ValueError, match=r"'energy' is no plot of .*; accepted: msd, "):
        run.plot("energy")
    (tmp_path / "config.toml").write_text("")
    with pytest.raises(FileNotFoundError, match="has no curves to draw"):
        hb.Run(tmp_path).plot("msd")


@pytest.mark.parametrize(
    ("package", "what"),
    [
        ("gsd", lambda run: run.trajectory()),
        ("pandas", lambda run: run.observables["msd"].to_pandas()),
        ("matplotlib", lambda run: run.plot()),
        ("tqdm", lambda run: hb.resume(run, progress=True)),
    ],
)
def test_missing_packages_are_named(run, monkeypatch, package, what):
    import_module = importlib.import_module

    def without(name: str, *arguments: object) -> object:
        if name.split(".")[0] == package:
            raise ModuleNotFoundError(name, name=package)
        return import_module(name)

    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(ImportError, match=f"needs the package {package}: pip install {package}$"):
        what(run)


def test_packages_that_do_not_load_say_why(run, monkeypatch):
    def broken(name):
        raise ImportError("libgsd.so: cannot open")

    monkeypatch.setattr(importlib, "import_module", broken)
    with pytest.raises(ImportError, match=r"^libgsd\.so: cannot open$"):
        run.trajectory()


def test_relative_paths_outlive_the_working_directory(run, tmp_path, monkeypatch):
    shutil.copytree(run.path, tmp_path / "here" / "copy")
    (tmp_path / "there").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    copy, summary = hb.Run("copy"), run.summary
    report = copy.report()
    assert (os.fspath(copy), os.fspath(report)) == ("copy", "copy/report.html")
    assert copy == hb.Run(tmp_path / "here" / "copy")
    monkeypatch.chdir(tmp_path / "there")
    assert os.fspath(copy.path) == "copy"
    assert repr(copy).startswith("Run('copy')")
    assert os.fspath(copy) == str(tmp_path / "here" / "copy")
    assert copy.is_finished and copy.summary == summary and copy.config == run.config
    assert len(copy.events) == 10 and len(copy.observables["msd"]) == len(run.observables["msd"])
    assert hb.check(copy).endswith("sound\n")
    assert hb.resume(copy) == copy
    assert report.html.startswith("<!doctype html>")
    assert "kT_trans" in copy._repr_html_()
    shutil.rmtree(tmp_path / "here")
    with pytest.raises(FileNotFoundError, match="here/copy is not there any more$"):
        copy.summary  # noqa: B018


def test_directories_without_a_run(tmp_path):
    with pytest.raises(ValueError, match=r"nothing: is not there; accepted: the directory of a run$"):
        hb.Run(tmp_path / "nothing")
    with pytest.raises(ValueError, match=r"has no config.toml; accepted: the directory of a run$"):
        hb.Run(tmp_path)
    with pytest.raises(ValueError, match=r"has no sweep.csv; accepted: the directory of a sweep$"):
        hb.Sweep(tmp_path)
    (tmp_path / "config.toml").write_text("")
    run = hb.Run(tmp_path)
    assert not run.is_finished
    assert "not finished" in run._repr_html_()
    with pytest.raises(FileNotFoundError, match=r"summary.json is not there: the run is not finished"):
        run.summary  # noqa: B018
    with pytest.raises(ValueError, match=r"trajectory.gsd is not there; accepted: a run with \[output\] trajectory"):
        run.trajectory()


# ---- check and analyze


def test_check(run, capsys):
    said = hb.check(run)
    assert said.endswith("\nsound\n")
    assert capsys.readouterr() == ("", "")
    assert hb.check(run.path / "trajectory.gsd", quiet=False) == capsys.readouterr().out
    with pytest.raises(ValueError, match="cannot be read"):
        hb.check(run.path / "nothing")


def test_check_of_an_overlap(tmp_path):
    dump = tmp_path / "a.lammpstrj"
    dump.write_text(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 10\n0 10\n"
        "ITEM: ATOMS id type x y z radius\n1 1 1 1 1 1\n2 1 2 1 1 1\n"
    )
    with pytest.raises(hb.NumericalError, match=r"NOT SOUND: frame 0: ") as caught:
        hb.check(dump)
    assert str(caught.value).endswith("\nNOT SOUND")


def test_analyze(run, tmp_path, capsys):
    analysis = hb.analyze(run, tmp_path / "b", longest_lag=1.5)
    assert analysis.summary["frames"]["read"] == 4
    assert analysis.observables["order"].names == ("t", "S", "energy")
    assert analysis.observables["msd"]["t"][0] == pytest.approx(1)
    # The same displacements as those of the run where lags are the same.
    assert hb.analyze(run).path == run.path / "analysis"
    capsys.readouterr()
    (tmp_path / "a.lammpstrj").write_text(
        "".join(
            f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 10\n0 10\n"
            f"ITEM: ATOMS id type xu yu zu radius\n1 1 1 1 {step} 1\n2 1 5 1 1 1\n"
            for step in range(8)
        )
    )
    with pytest.raises(ValueError, match="has no time; accepted: time_step, the time between two steps$"):
        hb.analyze(tmp_path / "a.lammpstrj")
    hb.analyze(tmp_path / "a.lammpstrj", time_step=0.5, quiet=False)
    assert "\nno fits of decays: fit_from sets the first lag" in capsys.readouterr().out
    with pytest.raises(ValueError, match="^longest_lag is 99; accepted: at most the time between"):
        hb.analyze(run, longest_lag=99)
    with pytest.raises(ValueError, match="^every is 0; accepted: an integer from 1 to 1000000"):
        hb.analyze(run, every=0)
    with pytest.raises(TypeError, match="^every is 1.5; accepted: an integer"):
        hb.analyze(run, every=1.5)
    with pytest.raises(ValueError, match="^time_step is -1; accepted: a positive finite number"):
        hb.analyze(run, time_step=-1)


@pytest.mark.parametrize("value", [True, np.True_, "0.05", np.str_("0.05"), [0.5], np.array([0.5]), 1 + 0j, b"1"])
@pytest.mark.parametrize("name", ["time_step", "longest_lag", "fit_from"])
def test_times_are_numbers(run, name, value):
    with pytest.raises(TypeError, match=f"^{name} is .*; accepted: a positive finite number$"):
        hb.analyze(run, **{name: value})


@pytest.mark.parametrize("value", [0, -1.0, np.nan, np.inf, 10**400, np.float32(-1)])
def test_times_are_positive(run, value):
    with pytest.raises(ValueError, match="^longest_lag is .*; accepted: a positive finite number$"):
        hb.analyze(run, longest_lag=value)


def test_times_may_be_of_any_real_type(run, tmp_path):
    expected = hb.analyze(run, tmp_path / "a", longest_lag=1.5).observables["msd"]
    for number, value in enumerate([np.float32(1.5), np.array(1.5), fractions.Fraction(3, 2)]):
        found = hb.analyze(run, tmp_path / f"{number}", longest_lag=value).observables["msd"]
        np.testing.assert_array_equal(found["msd"], expected["msd"])


@pytest.mark.parametrize("value", [np.array(2.5), np.array([1, 2]), np.True_, "2"])
def test_counts_are_integers(run, value):
    with pytest.raises(TypeError, match="^every is .*; accepted: an integer from 1 to 1000000$"):
        hb.analyze(run, every=value)


def test_star_import_keeps_map():
    names: dict[str, object] = {}
    exec("from hardbody import *", names)
    assert "map" not in names
    assert hb.map is not builtins.map


def test_values_of_a_config_reach_the_run(tmp_path):
    """NumPy values in a dict give the bits of the same numbers."""
    config = with_values(CONFIG, system={"number": np.int64(48), "packing_fraction": np.float64(0.3)})
    run = hb.run(with_values(config, production={"time": np.array(0.5)}), tmp_path / "a")
    assert run.config["system"]["packing_fraction"] == 0.3
