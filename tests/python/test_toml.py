"""Dictionaries as TOML documents."""

from __future__ import annotations

import math
import pathlib
import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hardbody._toml import toml_text, value_text

keys = st.text(st.characters(codec="utf-8"), max_size=8)
scalars = st.one_of(
    st.booleans(),
    st.integers(-(2**63), 2**63 - 1),
    st.floats(allow_nan=False),
    st.text(st.characters(codec="utf-8"), max_size=12),
)
values = st.recursive(scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=3))


def bits(value: object) -> object:
    """Values with floats by their bits, and no difference between 1, 1.0 and True hidden."""
    if isinstance(value, dict):
        return {key: bits(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [bits(inner) for inner in value]
    return (type(value), value.hex() if isinstance(value, float) else value)


@given(st.dictionaries(keys.filter(lambda key: "." not in key), values, max_size=4))
def test_round_trip(config):
    assert bits(tomllib.loads(toml_text(config))) == bits(config)


@given(st.floats())
def test_floats_keep_every_bit(x):
    again = tomllib.loads("x = " + value_text(x, "config", "x"))["x"]
    assert isinstance(again, float)
    assert math.isnan(again) if math.isnan(x) else again.hex() == x.hex()


def test_layout():
    config = {
        "shape": {"aspect_ratio": 3.0},
        "seed": 1,
        "species": [{"mass": 1e-6}, {"mass": 2}],
        "grid": {"system.packing_fraction": {"from": 0.1, "to": 0.2, "step": 0.1}},
    }
    assert toml_text(config) == (
        "seed = 1\n\n[shape]\naspect_ratio = 3.0\n\n[[species]]\nmass = 1e-06\n\n[[species]]\nmass = 2\n\n"
        '[grid]\n"system.packing_fraction" = {from = 0.1, to = 0.2, step = 0.1}\n'
    )


def test_numpy_and_paths():
    config = {
        "a": np.float64(0.1),
        "b": np.int32(4),
        "c": np.bool_(True),
        "d": np.array([[1.0, 2.5], [3.0, np.inf]]),
        "e": np.float32(0.1),
        "f": pathlib.Path("a") / "b.toml",
        "g": np.array(3),
        "h": (1, "x"),
        "i": np.str_("text"),
        "j": np.array([1, "x"], dtype=object),
        "k": range(3),
    }
    assert tomllib.loads(toml_text(config)) == {
        "a": 0.1,
        "b": 4,
        "c": True,
        "d": [[1.0, 2.5], [3.0, math.inf]],
        "e": float(np.float32(0.1)),
        "f": "a/b.toml",
        "g": 3,
        "h": [1, "x"],
        "i": "text",
        "j": [1, "x"],
        "k": [0, 1, 2],
    }


@pytest.mark.parametrize(
    ("config", "error", "message"),
    [
        (
            {"system": {"number": None}},
            TypeError,
            r"config: system\.number is None \(NoneType\); accepted: a bool, int",
        ),
        ({"shape": {"semi_axes": [1, 2, 1j]}}, TypeError, r"config: shape\.semi_axes\[2\] is 1j \(complex\)"),
        ({"species": [{"mass": 1}, {"mass": b"x"}]}, TypeError, r"config: species\[2\]\.mass is b'x' \(bytes\)"),
        ({"seed": 2**63}, ValueError, r"config: seed is 9223372036854775808; accepted: integers of 64 bits"),
        ({"a": {3: 1}}, TypeError, r"config: a key of a is 3 \(int\); accepted: a str"),
        ({3: 1}, TypeError, r"config: a key is 3 \(int\); accepted: a str"),
        ({"a": np.array(["2020"], dtype="M8[D]")}, TypeError, r"config: a is an array of datetime64\[D\]"),
        ({"a": np.zeros(2, dtype=[("x", float)])}, TypeError, r"config: a is an array of \[\('x'"),
        ({"a": np.longdouble(1) / 3}, TypeError, r"config: a is .*; accepted: a bool"),
        ({"a": "\ud800"}, ValueError, r"config: a is '\\ud800', which is not Unicode"),
        ({"a": {"b": {1, 2}}}, TypeError, r"config: a\.b is \{1, 2\} \(set\)"),
    ],
)
def test_values_without_a_form(config, error, message):
    with pytest.raises(error, match=message):
        toml_text(config)


def test_loops_end():
    config: dict[str, object] = {}
    config["a"] = [config]
    with pytest.raises(ValueError, match="nested more than"):
        toml_text({"x": config})
