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


LOOKED = "looked"  # overlaps are looked for among all bodies, and found
# Why they are not looked for among some.
NO_SHAPE = "bodies of type %s have no shape in the file"
NO_ORIENTATION = "orientations of bodies that are near each other are not known"
REFUSED = "refused: "

# Name, how it is written, what becomes of it: LOOKED, the reason for which it is not, or REFUSED and the words of the message.
GSD = [
    ("rods", {}, LOOKED),
    ("balls", {"shapes": (BALL,)}, LOOKED),
    ("no shapes", {"shapes": None}, NO_SHAPE % "A"),
    ("empty shapes", {"shapes": ({},)}, NO_SHAPE % "A"),
    ("unknown shapes", {"shapes": ({"type": "Polyhedron"},)}, NO_SHAPE % "A"),
    ("polyhedra", {"shapes": ({"type": "ConvexPolyhedron", "vertices": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},)}, NO_SHAPE % "A"),
    ("one shape of two missing", {"shapes": (BALL, {}), "more": {
        "particles/typeid": lambda k: numpy.arange(8, dtype=numpy.uint32) // 4}}, NO_SHAPE % "B"),
    ("diameters", {"shapes": None, "more": {"particles/diameter": lambda k: numpy.ones(8, numpy.float32)}}, NO_SHAPE % "A"),
    ("oblong", {"box": FIRST(OBLONG)}, LOOKED),
    ("oblong, balls", {"box": FIRST(OBLONG), "shapes": (BALL,)}, LOOKED),
    ("tilted", {"box": FIRST([EDGE, EDGE, EDGE, 0.25, 0, 0])}, LOOKED),
    ("rods, orientations never", {"orientation": "never"}, NO_ORIENTATION),
    ("rods, orientations of frame 0", {"orientation": "first"}, NO_ORIENTATION),
    ("flat", {"more": {"configuration/dimensions": lambda k: numpy.array([2], numpy.uint8)}}, REFUSED + "is not of three dimensions; accepted: three"),
]
DUMPS = [
    ("rods", {"columns": [X, QUAT, SHAPE]}, LOOKED),
    ("balls", {"columns": [X, "shapex", "shapey", "shapez"],
               "override": {n: lambda k, i: 1 for n in ("shapex", "shapey", "shapez")}}, LOOKED),
    ("radius", {"columns": [X, "radius"]}, LOOKED),
    ("diameter", {"columns": [X, "diameter"]}, LOOKED),
    ("radii and diameters", {"columns": [X, "radius", "diameter"]}, LOOKED),
    ("no shape", {"columns": [X, QUAT, VEL]}, NO_SHAPE % "1"),
    ("rods without orientations", {"columns": [X, SHAPE]}, NO_ORIENTATION),
    ("points, as LAMMPS has shapes of bodies that have none", {
        "columns": [X, QUAT, "shapex", "shapey", "shapez"],
        "override": {n: lambda k, i: 0 for n in ("shapex", "shapey", "shapez")}}, NO_SHAPE % "1"),
    ("half of them points", {"columns": [X, "radius"], "override": column("radius", 4 * [0.5] + 4 * [0])}, NO_SHAPE % "1"),
    ("no ids", {"columns": ["type", X, QUAT, SHAPE]}, LOOKED),
    ("oblong", {"columns": [X, QUAT, SHAPE], "box": lambda k: ["-5 5", "-5 5", "-10 10"]}, LOOKED),
    ("tilted", {"columns": [X, QUAT, SHAPE], "bounds": "xy xz yz pp pp pp", "tilt": " 0.25"}, LOOKED),
    ("tilts of 0", {"columns": [X, QUAT, SHAPE], "bounds": "xy xz yz pp pp pp", "tilt": " 0"}, LOOKED),
    ("unwrapped", {"columns": ["xu yu zu", QUAT, SHAPE]}, LOOKED),
    ("scaled, from 0", {"columns": ["xs ys zs", QUAT, SHAPE], "low": 0.0}, LOOKED),
    ("walls", {"columns": [X, QUAT, SHAPE], "bounds": "ff ff ff"}, REFUSED + "its box has boundaries ff; accepted: a periodic box, pp pp pp"),
]


class ChecksOfTrajectories(Analyses):
    def sound(self, result):
        return re.search(r"^sound$", result.stdout, re.M) is not None

    def judge(self, name, overlap, outcome, who):
        result = self.hardbody("check", name)
        said = result.stdout + result.stderr
        if outcome.startswith(REFUSED):
            self.assert_refused(result, name, outcome.removeprefix(REFUSED))
            return
        self.assertEqual(result.stderr, "")
        found = re.search(r"^ *overlaps +(.+)$", said, re.M)
        self.assertIsNotNone(found, said)
        sound = outcome == LOOKED and not overlap
        self.assertEqual(result.returncode, 0 if sound else 1, said)
        self.assertEqual(self.sound(result), sound, said)
        if outcome == LOOKED:
            self.assertRegex(found.group(1), r"^%d, more than the rounding of the numbers" % overlap)
            if overlap:
                self.assertRegex(said, "frame 1\\b")
                self.assertRegex(said, who or "frame 1")
        else:
            self.assertEqual(found.group(1), f"0 found; not tested everywhere: {outcome}")

    def test_gsd(self):
        for name, how, outcome in GSD:
            for apart, w in [(1.25, FAR), (0.125, NEAR)]:
                with self.subTest(name, apart=apart):
                    gsd_file(self.path("walk.gsd"), w, **{"shapes": (ROD,), **how})
                    self.judge("walk.gsd", w is NEAR, outcome, r"\b2\b.*\b5\b")

    def test_dumps(self):
        for name, how, outcome in DUMPS:
            for apart, w in [(1.25, FAR), (0.125, NEAR)]:
                with self.subTest(name, apart=apart):
                    columns = how["columns"] if "type" in how["columns"] else ["id", "type", *how["columns"]]
                    ids = {"id": lambda k, i: 10 * i + 7}
                    override = {**ids, **how.get("override", {})}
                    dump(self.path("walk.lammpstrj"), w, **{**how, "columns": columns, "override": override})
                    who = r"\b27\b.*\b57\b" if "id" in columns else ""
                    self.judge("walk.lammpstrj", w is NEAR, outcome, who)

    def test_other_names(self):
        for apart, w in [(1.25, FAR), (0.125, NEAR)]:
            for written, name in [("dump", "a.gsd"), ("dump", "a.txt"), ("gsd", "a.lammpstrj"), ("gsd", "a"), ("dump", "a b")]:
                with self.subTest(written=written, name=name, apart=apart):
                    if written == "gsd":
                        gsd_file(self.path("file"), w)
                    else:
                        dump(self.path("file"), w, ["id", "type", X, QUAT, SHAPE])
                    shutil.move(self.path("file"), self.path(name))
                    self.judge(name, w is NEAR, LOOKED, r"\b2\b.*\b5\b" if written == "gsd" else r"\b3\b.*\b6\b")

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
