"""Queries of `hardbody query` other than distances, by answers that are known.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_queries.py [TestClass[.test]]
"""

import json
import subprocess
import unittest

from test_cli import HARDBODY, Case


def ball(position, radius=1.0):
    return {"shape": {"kind": "sphere", "radius": radius}, "position": position}


def box(position):
    return {"shape": {"kind": "box", "half_extents": [1, 1, 1]}, "position": position}


FLOOR = {"shape": {"kind": "half_space"}, "position": [0, 0, 0]}


class Queries(Case):
    def lines(self, *queries, code=0):
        text = "".join(json.dumps(q) + "\n" for q in queries)
        result = subprocess.run([HARDBODY, "query"], cwd=self.here, input=text, capture_output=True, timeout=120, text=True)
        self.assertEqual((result.returncode, result.stderr), (code, ""), result.stdout)
        answers = [json.loads(line) for line in result.stdout.splitlines()]
        self.assertEqual(len(answers), len(queries))
        return answers

    def answer(self, **query):
        return self.lines(query)[0]

    def assert_close(self, found, wanted, tolerance=1e-12):
        self.assertEqual(len(found), len(wanted))
        for x, y in zip(found, wanted):
            self.assertAlmostEqual(x, y, delta=tolerance)

    def test_distances_stay_as_they_are(self):
        pair = {"a": ball([0, 0, 0]), "b": ball([4, 0, 0]), "id": 7}
        plain, named = self.lines(pair, {"query": "distance", **pair})
        self.assertEqual(plain, named)
        self.assertEqual((plain["distance"], plain["id"]), (2, 7))

    def test_gradients_of_balls(self):
        found = self.answer(query="gradient", a=ball([0, 0, 0]), b=ball([4, 0, 0]))
        self.assertEqual((found["distance"], found["derivatives"]), (2, "twice"))
        self.assert_close(found["gradient"], [-1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0])
        hessian = [[0.0] * 12 for _ in range(12)]
        for k in (1, 2):  # (1 - n n^T) / |r|, |r| = 4
            hessian[k][k] = hessian[6 + k][6 + k] = 0.25
            hessian[k][6 + k] = hessian[6 + k][k] = -0.25
        for row, wanted in zip(found["hessian"], hessian):
            self.assert_close(row, wanted)
        self.assertEqual([len(found[key]) for key in ("normal_gradient", "point_a_gradient", "point_b_gradient")], [3, 3, 3])

    def test_patches_of_boxes(self):
        found = self.answer(query="patch", a=box([0, 0, 0]), b=box([0.5, 0.25, 2]), within=1e-9)
        self.assertEqual(found["distance"], 0)
        patch = found["patch"]
        self.assertEqual((patch["kind"], len(patch["points"]), len({p["id"] for p in patch["points"]})), ("polygon", 4, 4))
        self.assertAlmostEqual(patch["area"], 1.5 * 1.75, delta=1e-12)
        self.assert_close(patch["centre"], [0.25, 0.125, 1])
        for point in patch["points"]:
            self.assert_close(point["a"], point["b"])
            self.assertAlmostEqual(point["depth"], 0, delta=1e-14)
        disc = {"shape": {"kind": "cylinder", "half_length": 1, "radius": 1}, "position": [0, 0, 1]}
        few = self.answer(query="patch", a=FLOOR, b=disc, max_points=5)["patch"]
        many = self.answer(query="patch", a=FLOOR, b=disc, tolerance=1e-4, max_points=200, penetration="local")["patch"]
        self.assertEqual(len(few["points"]), 5)
        self.assertGreater(len(many["points"]), 50)
        self.assertLess(many["error"], few["error"])
        apart = self.answer(query="patch", a=FLOOR, b=ball([0, 0, 3]), within=1)
        self.assertEqual((apart["distance"], apart["patch"]["kind"], apart["patch"]["points"]), (2, "empty", []))
        self.assertIsNone(apart["patch"]["centre"])
        on_floor = self.answer(query="patch", a=FLOOR, b=ball([0, 0, 1]))
        self.assertEqual((on_floor["patch"]["kind"], on_floor["patch"]["area"]), ("point", 0))

    def test_what_has_no_second_derivative_is_null(self):
        found = self.answer(query="gradient", a=box([0, 0, 0]), b=box([4, 0.3, 0]))
        self.assertEqual((found["distance"], found["derivatives"], found["hessian"]), (2, "by_position", None))
        self.assertEqual((found["gradient"][:3], found["gradient"][3:6]), ([-1, 0, 0], [None] * 3))
        over_floor = self.answer(query="gradient", a=FLOOR, b=ball([0, 0, 3]))
        self.assert_close(over_floor["gradient"][6:9], [0, 0, 1])

    def test_overlaps(self):
        near, far = ball([1.5, 0, 0]), ball([3, 0, 0])
        answers = self.lines(*({"query": "overlap", "a": ball([0, 0, 0]), "b": b} for b in (near, far)),
                             {"query": "overlap", "a": FLOOR, "b": ball([0, 0, 0.5])})
        self.assertEqual([answer["overlap"] for answer in answers], ["yes", "no", "yes"])

    def test_points(self):
        outside, inside = self.lines(*({"query": "closest_point", "a": ball([0, 0, 0], 2), "point": p} for p in ([0, 5, 0], [0, 1.5, 0])))
        self.assertAlmostEqual(outside["distance"], 3, delta=1e-12)
        self.assertAlmostEqual(inside["distance"], -0.5, delta=1e-12)
        for found in (outside, inside):
            self.assert_close(found["point"], [0, 2, 0])
            self.assert_close(found["normal"], [0, 1, 0])
        answers = self.lines(*({"query": "contains", "a": body, "point": [0.9, 0.9, -0.1]} for body in (box([0, 0, 0]), ball([0, 0, 0]), FLOOR)))
        self.assertEqual([answer["contains"] for answer in answers], [True, False, True])

    def test_rays(self):
        cast = {"query": "ray", "a": box([0, 0, 0]), "direction": [2, 0, 0]}
        hit, missed, inside, out = self.lines({**cast, "origin": [-3, 0, 0]}, {**cast, "origin": [-3, 5, 0]}, {**cast, "origin": [0, 0, 0]},
                                              {**cast, "origin": [0, 0, 0], "exit": True})
        self.assertEqual((hit["status"], hit["t"], hit["point"], hit["normal"]), ("hit", 1, [-1, 0, 0], [-1, 0, 0]))
        self.assertEqual((missed["status"], missed["t"], missed["point"]), ("missed", None, None))
        self.assertEqual((inside["status"], inside["t"]), ("inside", 0))
        self.assertEqual((out["status"], out["t"], out["point"]), ("hit", 0.5, [1, 0, 0]))

    def test_times_of_contact(self):
        pair = {"query": "time_of_contact", "a": ball([0, 0, 0]), "b": ball([4, 0, 0]), "motion_b": {"velocity": [-1, 0, 0]}}
        hit, before, apart = self.lines({**pair, "t_max": 10}, {**pair, "t_max": 1.5},
                                        {**pair, "t_max": 10, "motion_a": {"velocity": [-1, 0, 0], "angular_velocity": [0, 0, 3]}})
        self.assertEqual(hit["status"], "hit")
        self.assertAlmostEqual(hit["time"], 2, delta=1e-12)
        self.assert_close(hit["point"], [1, 0, 0])
        self.assert_close(hit["normal"], [1, 0, 0])
        self.assertEqual((before["status"], before["time"], before["point"]), ("separated", 1.5, None))
        self.assertEqual(apart["status"], "separated")

    def test_notices_and_ids(self):
        body = {**box([0, 0, 0]), "orientation": [1.0001, 0, 0, 0]}
        found = self.answer(query="contains", a=body, point=[0, 0, 0], id={"n": 1})
        self.assertEqual((found["contains"], found["id"]), (True, {"n": 1}))
        self.assertIn("a.orientation", found["notice"])

    def test_bad_lines(self):
        a, b = ball([0, 0, 0]), ball([4, 0, 0])
        contact = {"query": "time_of_contact", "a": a, "b": b}
        bad = [
            ({"query": "patches", "a": a, "b": b}, '"gradient", "patch", "overlap"'),
            ({"query": "patch", "a": a, "b": b, "within": -1}, "a length, 0 to 1e100"),
            ({"query": "patch", "a": a, "b": b, "within": 1e300}, "a length, 0 to 1e100"),
            ({"query": "patch", "a": a, "b": b, "tolerance": 0.9}, "tolerance is 0.9; accepted: 1e-4 to 0.5"),
            ({"query": "patch", "a": a, "b": b, "max_points": 3.5}, "max_points is 3.5; accepted: a whole number, 3 to 10000"),
            ({"query": "patch", "a": a, "b": b, "penetration": "none"}, 'penetration is "none"'),
            ({"query": "overlap", "a": a, "b": b, "penetration": "local"}, "unknown key penetration"),
            ({"query": 3, "a": a, "b": b}, "query is 3"),
            ({"query": "overlap", "a": a}, "b is missing"),
            ({"query": "overlap", "a": FLOOR, "b": FLOOR}, "half-spaces"),
            ({"query": "overlap", "a": a, "b": b, "seed": "fcl"}, "unknown key seed"),
            ({"query": "contains", "a": a}, "point is missing"),
            ({"query": "contains", "a": a, "point": [1, 2]}, "point is [1,2]"),
            ({"query": "ray", "a": a, "origin": [0, 0, 0], "direction": [0, 0, 0]}, "direction is [0,0,0]"),
            ({"query": "ray", "a": a, "origin": [0, 0, 0], "direction": [1, 0, 0], "exit": 1}, "exit is 1"),
            ({"query": "ray", "a": FLOOR, "origin": [0, 0, 0], "direction": [1, 0, 0], "exit": True}, "half-space"),
            (contact, "t_max is missing"),
            ({**contact, "t_max": -1}, "t_max"),
            ({**contact, "t_max": 1, "motion_a": {"speed": 1}}, "unknown key motion_a.speed"),
            ({**contact, "t_max": 1, "motion_a": {"inertia": [1, 1, 0]}}, "inertia"),
            ({**contact, "t_max": 1, "a": FLOOR}, "a.shape is a half-space"),
        ]
        answers = self.lines(*(query for query, _ in bad), code=2)
        for number, ((query, words), found) in enumerate(zip(bad, answers), 1):
            self.assertEqual(list(found), ["error"], query)
            self.assertIn(f"line {number}: ", found["error"])
            self.assertIn(words, found["error"], query)


if __name__ == "__main__":
    unittest.main()
