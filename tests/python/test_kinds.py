"""Runs of capsules, boxes and polyhedra, and the files that they leave."""

import numpy as np
import pytest

import hardbody as hb

TIMES = {"equilibration": {"time": 0.5}, "production": {"time": 1.0}, "output": {"trajectory": ["gsd"], "frames": 3}}
PYRAMID = np.array([[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1], [0, 0, 2]])
SHAPES = [
    pytest.param({"kind": "sphere", "diameter": 3}, hb.Sphere, id="sphere"),
    pytest.param({"kind": "capsule", "length": 2, "diameter": 1}, hb.Capsule, id="capsule"),
    pytest.param({"kind": "box", "edges": (1, 2, 3)}, hb.Box, id="box"),
    pytest.param({"kind": "box", "edges": np.ones(3), "rounding": 0.1}, hb.RoundedBox, id="rounded"),
    pytest.param({"kind": "polyhedron", "solid": "octahedron"}, hb.ConvexPolyhedron, id="octahedron"),
    pytest.param({"kind": "cylinder", "length": 2, "diameter": 1}, hb.Cylinder, id="cylinder"),
    pytest.param({"kind": "cone", "length": 1, "diameter": 1, "rounding": 0.1}, hb.RoundedCone, id="rounded cone"),
    pytest.param({"kind": "polyhedron", "vertices": PYRAMID}, hb.ConvexPolyhedron, id="pyramid"),
]


@pytest.mark.parametrize("shape, kind", SHAPES)
def test_runs_and_their_states(tmp_path, shape, kind):
    config = {"system": {"number": 48, "packing_fraction": 0.15}, "shape": shape, **TIMES}
    run = hb.run(config, tmp_path / "run")
    assert run.summary["sound"] and run.summary["state"]["shape"]["kind"] == shape["kind"]
    system = hb.from_gsd(tmp_path / "run" / "trajectory.gsd")
    assert isinstance(system.species[0].shape, kind)
    assert hb.mass_properties(system.species[0].shape).volume == pytest.approx(4 / 3 * np.pi, rel=1e-12)
    again = hb.from_gsd(tmp_path / "run" / "trajectory.gsd", components=system.species[0])
    np.testing.assert_array_equal(again.positions, system.positions)
    np.testing.assert_array_equal(again.orientations, system.orientations)
    simulation = hb.Simulation(system)
    simulation.run(collisions=50)
    assert simulation.counters.overlaps == 0


def test_bad_shapes_are_refused(tmp_path):
    config = {"system": {"number": 48, "packing_fraction": 0.15}, "shape": {"kind": "capsule", "length": 1}, **TIMES}
    with pytest.raises(ValueError, match="shape.diameter of a capsule is missing"):
        hb.run(config, tmp_path / "run")
    with pytest.raises(ValueError, match='did you mean "cube"'):
        hb.run(config | {"shape": {"kind": "polyhedron", "solid": "cubes"}}, tmp_path / "run")
