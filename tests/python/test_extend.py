"""Finished runs that go on to a longer production, and keys that may change when a run is resumed."""

from __future__ import annotations

import re
import shutil

import pytest
from runs import CONFIG, results, with_values

import hardbody as hb


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A finished run. Tests must not change it."""
    return hb.run(CONFIG, tmp_path_factory.mktemp("runs") / "a")


def test_extended_runs_are_longer_runs(tmp_path):
    short = with_values(CONFIG, output={"trajectory": []})
    run = hb.run(short, tmp_path / "a")
    longer = hb.run(short, tmp_path / "b", overrides={"production.time": 7.0, "production.longest_lag": 3.0 / 16})
    again = hb.extend(run, time=5)
    assert again == run
    assert again.config["production"] == longer.config["production"] | {"time": 5.0}
    assert results(run.extend(7)) == results(longer)
    assert hb.resume(run) == run  # nothing to do


def test_extensions_that_are_refused(done, tmp_path):
    before = results(done)
    with pytest.raises(ValueError, match=r"^time is 3, production has lasted 3 already; accepted: a longer time"):
        hb.extend(done, time=3)
    accepted = r"accepted: a run with output\.frames_every or without output\.trajectory"
    with pytest.raises(ValueError, match=rf"^output\.frames is 4: .* {accepted}"):
        done.extend(30)
    with pytest.raises(ValueError, match=r"^time is nan; accepted: a positive finite number"):
        done.extend(float("nan"))
    assert results(done) == before
    shutil.copytree(done, tmp_path / "b")
    (tmp_path / "b/summary.json").unlink()
    with pytest.raises(ValueError, match=r"b: the run is not finished; accepted: a finished run: hardbody\.resume "):
        hb.extend(tmp_path / "b", time=5)


def test_keys_that_resume_changes(done, tmp_path):
    shutil.copytree(done, tmp_path / "b")
    (tmp_path / "b/summary.json").unlink()
    for key in ("system.number", "output.events", "nonsense"):
        with pytest.raises(
            ValueError, match=rf"^overrides: {re.escape(key)}=4: .*; accepted: output\.checkpoint_every$"
        ):
            hb.resume(tmp_path / "b", overrides={key: 4})
    run = hb.resume(tmp_path / "b", overrides={"output.checkpoint_every": "9h"})
    assert run.config["output"]["checkpoint_every"] == "9h"
    assert run.summary["observables"] == done.summary["observables"]
