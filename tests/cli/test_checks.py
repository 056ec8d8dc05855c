"""`hardbody check` of trajectories: "sound" is said only of what has been looked at.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_checks.py [TestClass[.test]]
"""

import re
import shutil
import unittest

import numpy

import walks
from test_cases import Analyses
from walks import BALL, EDGE, ROD, Walk, dump, gsd_file

X, QUAT, SHAPE, VEL = "x y z", "quatw quati quatj quatk", "shapex shapey shapez", "vx vy vz"
OBLONG = [EDGE, EDGE, 2 * EDGE, 0, 0, 0]
FIRST = lambda box: lambda k: box if k == 0 else None


def bodies(apart):
    """Two frames of eight; in the second one bodies 2 and 5 are so far apart, across a face of the box."""
    w = walks.walk(0.2, frames=2)
    w.orientation[:] = [1, 0, 0, 0]
    w.position[1, 2] = [EDGE / 2 - apart / 2, 0, 0]
    w.position[1, 5] = [-EDGE / 2 + apart / 2, 0, 0]
    return Walk(w.position, w.orientation, w.velocity, [100, 200])


FAR, NEAR = bodies(1.25), bodies(0.125)


def column(name, values):
    return {name: lambda k, i: values[i] if isinstance(values, list) else values}


# Name, how it is written, whether overlaps can be looked for: "yes", or "may be" (then it is said that they were not).
GSD = [
    ("rods", {}, "yes"),
    ("balls", {"shapes": (BALL,)}, "yes"),
    ("no shapes", {"shapes": None}, "may be"),
    ("empty shapes", {"shapes": ({},)}, "may be"),
    ("unknown shapes", {"shapes": ({"type": "Polyhedron"},)}, "may be"),
    ("polyhedra", {"shapes": ({"type": "ConvexPolyhedron", "vertices": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},)}, "may be"),
    ("one shape of two missing", {"shapes": (BALL, {}), "more": {
        "particles/typeid": lambda k: numpy.arange(8, dtype=numpy.uint32) // 4}}, "may be"),
    ("diameters", {"shapes": None, "more": {"particles/diameter": lambda k: numpy.ones(8, numpy.float32)}}, "may be"),
    ("oblong", {"box": FIRST(OBLONG)}, "may be"),
    ("oblong, balls", {"box": FIRST(OBLONG), "shapes": (BALL,)}, "may be"),
    ("tilted", {"box": FIRST([EDGE, EDGE, EDGE, 0.25, 0, 0])}, "may be"),
    ("rods, orientations never", {"orientation": "never"}, "may be"),
    ("rods, orientations of frame 0", {"orientation": "first"}, "may be"),
    ("flat", {"more": {"configuration/dimensions": lambda k: numpy.array([2], numpy.uint8)}}, "may be"),
]
DUMPS = [
    ("rods", {"columns": [X, QUAT, SHAPE]}, "yes"),
    ("balls", {"columns": [X, "shapex", "shapey", "shapez"],
               "override": {n: lambda k, i: 1 for n in ("shapex", "shapey", "shapez")}}, "yes"),
    ("radius", {"columns": [X, "radius"]}, "may be"),
    ("diameter", {"columns": [X, "diameter"]}, "may be"),
    ("radii and diameters", {"columns": [X, "radius", "diameter"]}, "may be"),
    ("no shape", {"columns": [X, QUAT, VEL]}, "may be"),
    ("rods without orientations", {"columns": [X, SHAPE]}, "may be"),
    ("points, as LAMMPS has shapes of bodies that have none", {
        "columns": [X, QUAT, "shapex", "shapey", "shapez"],
        "override": {n: lambda k, i: 0 for n in ("shapex", "shapey", "shapez")}}, "may be"),
    ("half of them points", {"columns": [X, "radius"], "override": column("radius", 4 * [0.5] + 4 * [0])}, "may be"),
    ("no ids", {"columns": ["type", X, QUAT, SHAPE]}, "may be"),
    ("oblong", {"columns": [X, QUAT, SHAPE], "box": lambda k: ["-5 5", "-5 5", "-10 10"]}, "may be"),
    ("tilted", {"columns": [X, QUAT, SHAPE], "bounds": "xy xz yz pp pp pp", "tilt": " 0.25"}, "may be"),
    ("tilts of 0", {"columns": [X, QUAT, SHAPE], "bounds": "xy xz yz pp pp pp", "tilt": " 0"}, "yes"),
    ("unwrapped", {"columns": ["xu yu zu", QUAT, SHAPE]}, "yes"),
    ("scaled, from 0", {"columns": ["xs ys zs", QUAT, SHAPE], "low": 0.0}, "yes"),
    ("walls", {"columns": [X, QUAT, SHAPE], "bounds": "ff ff ff"}, "may be"),
]


class ChecksOfTrajectories(Analyses):
    def sound(self, result):
        return re.search(r"^sound$", result.stdout, re.M) is not None

    def judge(self, name, overlap, looked, who):
        result = self.hardbody("check", name)
        said = result.stdout + result.stderr
        if result.returncode == 2:
            self.assert_refused(result, "accepted: ")
            self.assertEqual(looked, "may be", said)
            return
        found = re.search(r"^ *overlaps +(.+)$", said, re.M)
        self.assertIsNotNone(found, said)
        seen = "not looked" not in found.group(1)
        self.assertTrue(seen or looked == "may be", said)
        if overlap and seen:
            self.assertFalse(self.sound(result), said)
            self.assertEqual(result.returncode, 1, said)
            self.assertRegex(said, "frame 1\\b")
            self.assertRegex(said, who or "frame 1")
        elif seen:
            self.assertEqual(int(re.match(r"\d+", found.group(1)).group()), 0, said)
            self.assertEqual(result.returncode, 0, said)
            self.assertTrue(self.sound(result), said)
        else:
            self.assertFalse(self.sound(result), said)
            self.assertRegex(said, "shape|cube|oblong|tilt|orientation|edges|box")

    def test_gsd(self):
        for name, how, looked in GSD:
            for apart, w in [(1.25, FAR), (0.125, NEAR)]:
                with self.subTest(name, apart=apart):
                    gsd_file(self.path("walk.gsd"), w, **{"shapes": (ROD,), **how})
                    self.judge("walk.gsd", w is NEAR and "polyhedra" not in name, looked, r"\b2\b.*\b5\b")

    def test_dumps(self):
        for name, how, looked in DUMPS:
            for apart, w in [(1.25, FAR), (0.125, NEAR)]:
                with self.subTest(name, apart=apart):
                    columns = how["columns"] if "type" in how["columns"] else ["id", "type", *how["columns"]]
                    ids = {"id": lambda k, i: 10 * i + 7}
                    override = {**ids, **how.get("override", {})}
                    dump(self.path("walk.lammpstrj"), w, **{**how, "columns": columns, "override": override})
                    who = r"\b27\b.*\b57\b" if "id" in columns else ""
                    self.judge("walk.lammpstrj", w is NEAR and "points" not in name, looked, who)

    def test_other_names(self):
        for apart, w in [(1.25, FAR), (0.125, NEAR)]:
            for written, name in [("dump", "a.gsd"), ("dump", "a.txt"), ("gsd", "a.lammpstrj"), ("gsd", "a"), ("dump", "a b")]:
                with self.subTest(written=written, name=name, apart=apart):
                    if written == "gsd":
                        gsd_file(self.path("file"), w)
                    else:
                        dump(self.path("file"), w, ["id", "type", X, QUAT, SHAPE])
                    shutil.move(self.path("file"), self.path(name))
                    self.judge(name, w is NEAR, "yes", r"\b2\b.*\b5\b" if written == "gsd" else r"\b3\b.*\b6\b")

    def test_a_directory(self):
        """A run is checked by its checkpoint; a directory without one is named."""
        gsd_file(self.path("walk.gsd"), FAR)
        self.assert_refused(self.hardbody("check", "."), "accepted: ")

    def test_numbers_that_are_none(self):
        """The body is named: by its id in dumps, by its index in GSD files."""
        for bad in (numpy.nan, numpy.inf):
            w = bodies(1.25)
            w.wrapped[1, 4, 1] = bad
            gsd_file(self.path("walk.gsd"), w)
            self.assert_refused(self.hardbody("check", "walk.gsd"), "frame 1", "body 4")
            dump(self.path("walk.lammpstrj"), w, ["id", "type", X, QUAT, SHAPE], override={"id": lambda k, i: 10 * i + 7})
            for command in [("check", "walk.lammpstrj"), ("analyze", "walk.lammpstrj", "--time-step", "1")]:
                result = self.hardbody(*command)
                self.assert_refused(result, "frame 1", "47")

    def test_quaternions_that_are_none(self):
        for length in (0, 0.5, 1.004):
            w = bodies(1.25)
            w.orientation[1, 4] *= length
            gsd_file(self.path("walk.gsd"), w)
            self.assert_refused(self.hardbody("check", "walk.gsd"), "frame 1", "4", f"length {length:g}")
            dump(self.path("walk.lammpstrj"), w, ["id", "type", X, QUAT, SHAPE], override={"id": lambda k, i: 10 * i + 7})
            self.assert_refused(self.hardbody("check", "walk.lammpstrj"), "frame 1", "47", f"length {length:g}")
        for length in (0.9992, 1.0008):
            w = bodies(1.25)
            w.orientation[1, 4] *= length
            dump(self.path("walk.lammpstrj"), w, ["id", "type", X, QUAT, SHAPE])
            gsd_file(self.path("walk.gsd"), w)
            for name in ("walk.lammpstrj", "walk.gsd"):
                result = self.hardbody("check", name)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertTrue(self.sound(result))
                self.assertIn("normalized", result.stdout + result.stderr)


if __name__ == "__main__":
    unittest.main()
