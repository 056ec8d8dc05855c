"""Random bodies and manufactured answers."""

from __future__ import annotations

import pathlib
import signal
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import settings

import hardbody as hb

REFERENCE = pathlib.Path(__file__).resolve().parents[1] / "reference"

# Where interrupts are ignored, as under nohup, tests that send them would never end.
signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(20240601)


def work_after_interrupt(call: Callable[[], object], delay: float = 0.4) -> float:
    """Processor seconds that a call goes on for after Ctrl-C: other work on the machine does not lengthen them."""
    main = threading.main_thread().ident
    assert main is not None
    begins = []

    def interrupt() -> None:
        begins.append(time.process_time())
        signal.pthread_kill(main, signal.SIGINT)

    timer = threading.Timer(delay, interrupt)
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        call()
        pytest.fail("the call has returned")
    timer.join()
    return time.process_time() - begins[0]


def unit_rows(random: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    """Random unit vectors or quaternions."""
    v = random.normal(size=(rows, columns))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def rotations(q: np.ndarray) -> np.ndarray:
    """Rotation matrices of unit quaternions (w, x, y, z), by the product v -> q v q*."""
    w, u = q[:, :1, None], q[:, 1:, None]
    cross = np.zeros((len(q), 3, 3))
    x, y, z = q[:, 1], q[:, 2], q[:, 3]
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross[:, 1, 0], cross[:, 2, 0], cross[:, 2, 1] = z, -y, x
    return np.eye(3) * (w * w - (u * u).sum(axis=1, keepdims=True)) + 2 * u * u.transpose(0, 2, 1) + 2 * w * cross


def support_points(axes: np.ndarray, R: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Support points of ellipsoids at the origin in the directions n, all in the world frame: D^2 n / |D n|."""
    local = np.einsum("kji,kj->ki", R, n)
    scaled = axes * local
    return np.einsum("kij,kj->ki", R, axes * scaled / np.linalg.norm(scaled, axis=1, keepdims=True))


class Pairs:
    """Pairs of equal ellipsoids whose distance is known: support points in one direction, moved apart along it."""

    def __init__(self, random: np.random.Generator, axes: tuple[float, float, float], number: int) -> None:
        self.axes = np.array(axes)
        self.quaternions = unit_rows(random, 2 * number, 4)
        self.normal = unit_rows(random, number, 3)
        self.gap = 10 ** random.uniform(-6, 1, number)
        R = rotations(self.quaternions)
        at_a = support_points(self.axes, R[0::2], self.normal)
        at_b = support_points(self.axes, R[1::2], -self.normal)
        self.positions = np.zeros((2 * number, 3))
        self.positions[0::2] = random.uniform(-5, 5, (number, 3))
        self.positions[1::2] = self.positions[0::2] + at_a + self.gap[:, None] * self.normal - at_b
        self.point_a = self.positions[0::2] + at_a
        self.point_b = self.positions[1::2] + at_b
        self.pairs = np.arange(2 * number).reshape(number, 2)


@pytest.fixture(scope="module")
def mixture():
    """60 bodies of three shapes and 400 pairs of them, of which many overlap."""
    random = np.random.default_rng(3)
    shapes = [hb.Ellipsoid([1, 1, 3]), hb.Ellipsoid([1, 2, 3]), hb.Superellipsoid([1, 1.5, 2], 0.6, 0.7)]
    return dict(
        shapes=shapes,
        positions=random.uniform(-6, 6, (60, 3)),
        quaternions=unit_rows(random, 60, 4),
        pairs=random.integers(0, 60, (400, 2)),
        shape_of=random.integers(0, 3, 60),
    )
