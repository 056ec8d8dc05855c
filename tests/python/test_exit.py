"""Interpreters that end while daemon threads are within calls: Python must not abort."""

import subprocess
import sys

SCRIPT = """
import threading, time
import numpy as np
import hardbody as hb

class Ball:
    bounding_radius = inscribed_radius = min_curvature_radius = 1.0
    volume = 4 / 3 * np.pi

    def support(self, n):
        return float(np.sqrt(n @ n)), n / np.sqrt(n @ n)

def fluid(shape, number=8):
    return hb.Simulation(hb.random_start(shape, number=number, packing_fraction=0.02))

def arrays():
    positions = np.array([[0, 0, 0], [0.3, 0, 0]])
    hb.distance_many(hb.Ellipsoid([1, 1, 1000]), positions, None, np.tile([0, 1], (10**6, 1)), threads=2)

rod = hb.Ellipsoid.spheroid(3.0)
called = threading.Event()
calls = [  # without end
    lambda: fluid(rod).run(time=1e9),
    lambda: fluid(rod).run(time=1e9, every=0.001, callback=lambda s: called.set()),
    lambda: fluid(hb.Species(Ball(), inertia=[0.4] * 3)).run(time=1e9),
    lambda: hb.random_start(rod, number=4000, packing_fraction=0.55, most_compressed=4000, progress=lambda p: None),
    lambda: hb.run({"system": {"packing_fraction": 0.3}, "shape": {"aspect_ratio": 2.0}}, out="out",
                   progress=lambda text, done: None),
    arrays,
]
for call in calls:
    threading.Thread(target=call, daemon=True).start()
called.wait(30)
time.sleep(0.3)
print("end", flush=True)
"""


def test_threads_in_calls_do_not_abort_the_process(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")
