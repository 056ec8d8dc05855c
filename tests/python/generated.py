"""Generated calls with bad arguments, and what is expected of them.

HARDBODY_PYTHON_CALLS is the number of generated calls, default 2000.
"""

import math
import os
import re

import numpy as np
from hypothesis import strategies as st

import hardbody as hb

CALLS = int(os.environ.get("HARDBODY_PYTHON_CALLS", "2000"))

E, S, X = hb.Ellipsoid([1, 1, 3]), hb.Superellipsoid([1, 2, 3], 0.5, 0.7), hb.Pose([4, 0, 2.4])

HUGE = np.broadcast_to(np.zeros(3), (10**13, 3))
HUGE_INDICES = np.broadcast_to(np.zeros(2, np.int8), (10**13, 2))


class Hostile:
    """Object whose conversions fail."""

    def __float__(self):
        raise ZeroDivisionError("no number")

    def __repr__(self):
        raise ZeroDivisionError("no text")


def frozen(array):
    array.flags.writeable = False
    return array


shapes_of_arrays = st.lists(st.integers(0, 5), max_size=3).map(tuple)
dtypes = st.sampled_from(["f8", "f4", "f2", ">f8", "g", "i8", "i1", "u8", ">i4", "?", "c16", "O", "U3", "M8[s]", "V8"])
numbers = st.one_of(
    st.floats(), st.integers(-5, 5), st.integers(), st.sampled_from([math.nan, math.inf, 1e101, -0.0, 5e-324, 2**63])
)
arrays = st.builds(
    lambda shape, dtype, number: np.full(shape, number).astype(dtype),
    shapes_of_arrays,
    dtypes.filter(lambda d: d not in ("M8[s]", "V8")),
    st.integers(-3, 3),
)
junk = st.one_of(
    st.none(),
    st.booleans(),
    numbers,
    st.text(max_size=5),
    st.binary(max_size=5),
    st.complex_numbers(),
    arrays,
    arrays.map(lambda a: a.T[::-1] if a.ndim else a),
    arrays.map(lambda a: frozen(a.copy())),
    st.lists(numbers, max_size=5),
    st.lists(st.lists(numbers, min_size=2, max_size=4), max_size=4),
    st.lists(st.sampled_from([E, S, X, None, 1]), max_size=4),
    st.sampled_from(
        [
            E,
            S,
            X,
            hb.Motion(),
            hb,
            hb.Pose,
            object(),
            Hostile(),
            HUGE,
            HUGE_INDICES,
            {},
            {1: 2},
            {1, 2},
            range(3),
            slice(3),
            np.zeros((2, 3)),
            np.full((2, 3), np.nan),
            np.full((2, 4), 0.5),
            np.zeros(2),
            np.array([[1, -1], [0, 2]]),
            np.array([[0, 2**64 - 1]], np.uint64),
            np.datetime64("2024-01-01"),
            np.zeros((2, 3), "V8"),
            np.ma.masked_array(np.zeros((2, 3)), mask=True),
            np.array(3.0),
            np.zeros((3, 0)),
            memoryview(b"abc"),
            np.zeros(2, [("x", "f8")]),
            10**400,
            hb.Ellipsoid.__new__(hb.Ellipsoid),
            hb.Pose.__new__(hb.Pose),
        ]
    ),
)


def is_named(message, arguments, other_words):
    """Whether a message names one of these arguments as what was found, or "as many as" of it as what is accepted."""
    found = re.sub(r"\baccepted: (?!as many as).*", "", message, flags=re.DOTALL)
    return any(
        re.search(rf"\b{name}\b", found) or (name in other_words and re.search(other_words[name], message))
        for name in arguments
    )


class Call:
    """Function by name, its arguments, and the names of those that are bad. It has a text whatever theirs raise."""

    def __init__(self, name, function, arguments, changed):
        self.name, self.function, self.arguments, self.changed = name, function, arguments, changed

    def __repr__(self):
        def text(value):
            try:
                return repr(value)
            except Exception as error:
                return f"<{type(value).__name__} whose repr raises {type(error).__name__}>"

        return f"{self.name}({', '.join(f'{key}={text(self.arguments[key])}' for key in self.changed)})"


@st.composite
def bad_calls(draw, functions, values=lambda name: junk, alone=()):
    """Call of one of these functions with its arguments, of which one or two are bad.

    values: strategy of an argument's bad values. alone: arguments beside which no other is changed.
    """
    name = draw(st.sampled_from(sorted(functions)))
    function, arguments = functions[name]
    changed = draw(st.lists(st.sampled_from(sorted(arguments)), min_size=1, max_size=2, unique=True))
    changed = [key for key in changed if key in alone] or changed
    return Call(name, function, {**arguments, **{key: draw(values(key)) for key in changed}}, changed)


def check_refusal(call, other_words, errors):
    """Makes a call, which may succeed. An exception of these kinds has to name an argument that was changed."""
    try:
        call.function(**call.arguments)
    except ZeroDivisionError as error:
        assert str(error) in ("no number", "no text")
    except errors as error:
        assert is_named(str(error), call.changed, other_words), f"{call.name}, {call.changed}: {error}"
