"""Kinds of shapes in lines of `hardbody distance`: known answers, and messages for bad ones.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_shapes.py [TestClass[.test]]
"""

import json
import math
import os
import subprocess
import unittest

HARDBODY = os.environ.get("HARDBODY", "hardbody")
R2 = math.sqrt(2)
CORNERS = [[x, y, z] for x in (-1, 1) for y in (-2, 2) for z in (-3, 3)]
TETRAHEDRON = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]

SPHERE = {"kind": "sphere", "radius": 0.5}
CAPSULE = {"kind": "capsule", "half_length": 2, "radius": 0.5}
BOX = {"kind": "box", "half_extents": [1, 2, 3]}
HULL = {"kind": "polyhedron", "vertices": CORNERS}
CUBE = {"kind": "polyhedron", "solid": "cube", "circumradius": math.sqrt(3)}
CYLINDER = {"kind": "cylinder", "half_length": 2, "radius": 0.5}
CONE = {"kind": "cone", "height": 2, "radius": 0.8}
FLOOR = {"kind": "half_space"}
BALL = {"kind": "ellipsoid", "semi_axes": [1, 1, 1]}
BARREL = {"kind": "superellipsoid", "semi_axes": [1, 1, 1], "exponents": [1, 1]}
ALL = [
    SPHERE,
    CAPSULE,
    BOX,
    {**BOX, "rounding": 0.25},
    HULL,
    {**HULL, "rounding": 0.25},
    CUBE,
    CYLINDER,
    {**CYLINDER, "rounding": 0.25},
    BALL,
    BARREL,
]


def body(shape, position=(0, 0, 0), **more):
    return {"shape": shape, "position": list(position), **more}


def reach(shape, axis):
    """Extent along body x, y or z."""
    size = {
        "sphere": lambda s: s["radius"],
        "cylinder": lambda s: s["half_length"] if axis == 2 else s["radius"],
        "capsule": lambda s: s["radius"] + (s["half_length"] if axis == 2 else 0),
        "box": lambda s: s["half_extents"][axis],
        "polyhedron": lambda s: max(v[axis] for v in s["vertices"]) if "vertices" in s else 1,
        "ellipsoid": lambda s: s["semi_axes"][axis],
        "superellipsoid": lambda s: s["semi_axes"][axis],
    }[shape["kind"]](shape)
    return size + shape.get("rounding", 0)


class ShapeLines(unittest.TestCase):
    def reply(self, *queries):
        text = "".join((q if isinstance(q, str) else json.dumps(q)) + "\n" for q in queries)
        return subprocess.run([HARDBODY, "distance"], input=text, capture_output=True, text=True, timeout=120)

    def answers(self, *queries):
        result = self.reply(*queries)
        self.assertEqual((result.returncode, result.stderr), (0, ""), result.stdout)
        return [json.loads(line) for line in result.stdout.splitlines()]

    def test_bodies_side_by_side(self):
        """All pairs of kinds: apart and overlapping along each axis."""
        cases = []
        for a in ALL:
            for b in ALL:
                for axis in range(3):
                    for gap in (0.5, -0.125):
                        position = [0.0, 0.0, 0.0]
                        position[axis] = reach(a, axis) + reach(b, axis) + gap
                        cases.append((gap, axis, {"a": body(a), "b": body(b, position)}))
        for (gap, axis, query), answer in zip(cases, self.answers(*(c[2] for c in cases))):
            self.assertAlmostEqual(answer["distance"], gap, 9 if gap < 0 else 12, msg=query)
            self.assertEqual(answer["status"], "separated" if gap > 0 else "overlapping")
            if gap > 0:
                self.assertAlmostEqual(answer["normal"][axis], 1, 9)

    def test_edges_and_corners(self):
        turned = [math.cos(math.pi / 8), 0, 0, math.sin(math.pi / 8)]
        cube = {"kind": "box", "half_extents": [1, 1, 1]}
        cases = [
            (R2 * 0.5, {"a": body(cube), "b": body(cube, [2.5, 2.5, 0])}),
            (math.sqrt(3) * 0.5 - 0.25, {"a": body({**cube, "rounding": 0.25}), "b": body(cube, [2.5, 2.5, 2.5])}),
            (3 - 1 - R2, {"a": body(cube, orientation=turned), "b": body(cube, [3, 0, 0])}),
            (2 * R2 - 1, {"a": body(CAPSULE, [2, 2, 2]), "b": body({**CAPSULE, "half_length": 0})}),
            (1.5, {"a": body({"kind": "polyhedron", "solid": "octahedron"}), "b": body(SPHERE, [3, 0, 0])}),
            (2.5, {"a": body(CONE), "b": body(CYLINDER, [0.25, 0, 6])}),
            (0.25, {"a": body({**CONE, "base": -1.25, "rounding": 0.25}), "b": body(SPHERE, [0, 0, 1.75])}),
            (5 - 2 - 0.8, {"a": body(CONE), "b": body(CYLINDER, [5, 0, -0.5], orientation=[R2 / 2, 0, R2 / 2, 0])}),
            (R2, {"a": body(CYLINDER), "b": body(CYLINDER, [2, 0, 5])}),
            (
                3 - 1 / math.sqrt(3) - 0.5,
                {"a": body({"kind": "polyhedron", "solid": "octahedron"}), "b": body(SPHERE, [3 / math.sqrt(3)] * 3)},
            ),
        ]
        for (wanted, query), answer in zip(cases, self.answers(*(c[1] for c in cases))):
            self.assertAlmostEqual(answer["distance"], wanted, 13, msg=query)

    def test_half_spaces(self):
        slope = {"kind": "half_space", "normal": [3, 0, 4], "offset": 1}
        cases = [(0.75, {"a": body(FLOOR), "b": body(s, [5, -7, reach(s, 2) + 0.75])}) for s in ALL]
        cases += [
            (0.75, {"b": body(FLOOR), "a": body(SPHERE, [5, -7, 1.25])}),
            (-0.25, {"a": body(FLOOR), "b": body(SPHERE, [0, 0, 0.25])}),
            (4 - 1 - 0.5, {"a": body(slope), "b": body(SPHERE, [0, 9, 5])}),
            (0.5, {"a": body(FLOOR, [0, 0, -1]), "b": body(SPHERE, [0, 0, 0])}),
        ]
        answers = self.answers(*(c[1] for c in cases))
        for (wanted, query), answer in zip(cases, answers):
            self.assertAlmostEqual(answer["distance"], wanted, 14, msg=query)
        self.assertEqual(answers[0]["normal"], [0, 0, 1])
        self.assertEqual(answers[len(ALL)]["normal"], [0, 0, -1])

    def test_every_solid_is_known(self):
        message = json.loads(self.reply({"a": body({"kind": "polyhedron", "solid": "ball"}), "b": body(SPHERE)}).stdout)
        solids = message["error"].split("; accepted: ")[1].split(", ")
        self.assertEqual((len(solids), solids[0], solids[-1]), (18, "tetrahedron", "snub dodecahedron"))
        queries = [{"a": body({"kind": "polyhedron", "solid": s}), "b": body(SPHERE, [9, 0, 0])} for s in solids]
        for answer in self.answers(*queries):
            self.assertTrue(7.5 <= answer["distance"] <= 8.2, answer)

    def test_the_papers_equations(self):
        """Spheres have equations, and no shape with edges has."""
        pair = {"a": body(SPHERE), "b": body(BALL, [3, 0, 0])}
        for method in ["newton8", "newton5"]:
            self.assertAlmostEqual(self.answers({**pair, "method": method})[0]["distance"], 1.5, 13)
            for name, shape in [("box of half extents 1 x 2 x 3", BOX), ("half-space", FLOOR)]:
                self.assert_refused(
                    {**pair, "b": body(shape, [9, 0, 9]), "method": method},
                    f"b.shape is a {name}, for which there are no equations; accepted: with \"newton8\" and \"newton5\"",
                )

    def assert_refused(self, query, *words):
        result = self.reply(query)
        self.assertEqual(result.returncode, 2, result.stdout)
        error = json.loads(result.stdout)["error"]
        self.assertTrue(error.startswith("line 1: "), error)
        for word in words:
            self.assertIn(word, error)

    def test_bad_shapes(self):
        for shape, *words in [
            ({"kind": "ball"}, 'a.shape.kind is "ball"', '"box", "polyhedron", "cylinder", "cone", "half_space"'),
            ({"kind": 3}, "a.shape.kind is 3"),
            ({"kind": "sphere"}, "a.shape.radius is missing; accepted: a positive number"),
            ({"kind": "sphere", "radius": 0}, "a.shape.radius is 0 (Sphere: radius is 0)"),
            ({"kind": "sphere", "radius": -1}, "a.shape.radius is -1"),
            ({"kind": "sphere", "radius": "1"}, 'a.shape.radius is "1"', "a finite number"),
            ({"kind": "sphere", "radius": None}, "a.shape.radius is null"),
            ({**SPHERE, "rounding": 1}, "unknown key a.shape.rounding", "accepted: kind, radius"),
            ({"kind": "capsule", "radius": 1}, "a.shape.half_length is missing"),
            ({**CAPSULE, "half_length": -1}, "a.shape is", "Capsule: half-length is -1"),
            ({**CAPSULE, "half_length": 1e5}, "a.shape is", "accepted: at most 10000"),
            ({**CAPSULE, "radius": 0}, "Capsule: radius is 0"),
            ({"kind": "box", "half_extents": [1, 2]}, "a.shape.half_extents is [1,2]", "three finite numbers"),
            ({"kind": "box", "half_extents": [1, 0, 2]}, "a.shape.half_extents is [1,0,2]", "half extent y is 0"),
            ({"kind": "box", "half_extents": [1, 1, 1e5]}, "a.shape.half_extents is", "10000"),
            ({**BOX, "rounding": -0.5}, "a.shape.rounding is -0.5; accepted: a number of at least 0"),
            ({**BOX, "rounding": 1e60}, "a.shape.rounding is 1e+60"),
            ({**BOX, "half_extent": 1}, "unknown key a.shape.half_extent, did you mean a.shape.half_extents?"),
            ({"kind": "cylinder", "radius": 1}, "a.shape.half_length is missing; accepted: a positive number"),
            ({**CYLINDER, "half_length": 0}, "a.shape is", "Cylinder: half-length is 0"),
            ({**CYLINDER, "radius": 1e5}, "a.shape is", "ratio of radius to half-length"),
            ({**CYLINDER, "rounding": -1}, "a.shape.rounding is -1; accepted: a number of at least 0"),
            ({**CYLINDER, "height": 1}, "unknown key a.shape.height", "kind, half_length, radius, rounding"),
            ({"kind": "cone", "radius": 1}, "a.shape.height is missing"),
            ({**CONE, "height": -1}, "a.shape is", "Cone: height is -1"),
            ({**CONE, "base": 0.5}, "a.shape is", "Cone: base is 0.5", "accepted: more than -2, less than 0"),
            ({"kind": "polyhedron"}, "a.shape is", '"vertices"', '"solid"'),
            ({**HULL, "solid": "cube"}, "a.shape is", '"vertices"', '"solid"'),
            ({"kind": "polyhedron", "vertices": 3}, "a.shape.vertices is 3", "four points"),
            ({"kind": "polyhedron", "vertices": CORNERS[:3]}, "a.shape.vertices is", "four points"),
            ({"kind": "polyhedron", "vertices": [*CORNERS, [1, 2]]}, "a.shape.vertices[8] is [1,2]", "three finite numbers"),
            ({"kind": "polyhedron", "vertices": [[x, y, 0] for x, y, _ in CORNERS]}, "a.shape.vertices is", "in a plane"),
            ({"kind": "polyhedron", "vertices": [[x + 3, y, z] for x, y, z in CORNERS]}, "the origin is not inside"),
            ({"kind": "polyhedron", "vertices": [[1, 1, 1]] * 4}, "in a plane"),
            ({"kind": "polyhedron", "vertices": TETRAHEDRON, "rounding": "a"}, 'a.shape.rounding is "a"'),
            ({"kind": "polyhedron", "solid": 3}, "a.shape.solid is 3", "tetrahedron, cube"),
            ({"kind": "polyhedron", "solid": "cubes"}, 'a.shape.solid is "cubes"', "tetrahedron, cube"),
            ({**CUBE, "circumradius": 0}, "a.shape.circumradius is 0; accepted: a positive number"),
            ({**FLOOR, "normal": [0, 0, 0]}, "a.shape is", "HalfSpace: normal is (0, 0, 0)"),
            ({**FLOOR, "offset": "x"}, 'a.shape.offset is "x"'),
            ({**FLOOR, "radius": 1}, "unknown key a.shape.radius", "kind, normal, offset"),
        ]:
            with self.subTest(shape):
                self.assert_refused({"a": body(shape), "b": body(SPHERE, [9, 0, 0])}, *words)
        self.assert_refused({"a": body(FLOOR), "b": body(FLOOR)}, "a.shape and b.shape are half-spaces")

    def test_circumradius_is_of_solids(self):
        self.assert_refused(
            {"a": body({**HULL, "circumradius": 2}), "b": body(SPHERE, [9, 0, 0])}, "a.shape.circumradius", "solid"
        )


if __name__ == "__main__":
    unittest.main()
