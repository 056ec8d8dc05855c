"""What files of frames say, and no more: walks written in every way, quantities that only some frames have, formats.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_reading.py [TestClass[.test]]

Needs Debian's python3-gsd.
"""

import csv
import gzip
import json
import struct
import unittest
import warnings

import numpy

warnings.simplefilter("ignore")
import gsd.fl
import gsd.hoomd

from test_cli import Case

L = 10.0
BALL = [{"type": "Sphere", "diameter": 1.0}]
ROD = [{"type": "Ellipsoid", "a": 0.3, "b": 0.3, "c": 0.9}]
GsdFrame = getattr(gsd.hoomd, "Frame", None) or gsd.hoomd.Snapshot
WRITE = "w" if hasattr(gsd.hoomd, "Frame") else "wb"
AGAIN = "w+" if WRITE == "w" else "rb+"

WRAPPED = ("positions are wrapped, or may be, and bodies move far between frames; unwrapped columns, image flags or frames closer "
           "together help")


def wrapped(x):
    return (numpy.asarray(x) + L / 2) % L - L / 2


class FilesCase(Case):
    def gsd(self, name, positions, shapes=BALL, **more):
        """A file with the positions of each frame; of more quantities one a frame, None where it is left out."""
        with gsd.hoomd.open(self.path(name), WRITE) as file:
            for k, x in enumerate(positions):
                frame = GsdFrame()
                frame.configuration.step = k
                frame.configuration.box = [L, L, L, 0, 0, 0]
                frame.particles.N = len(x)
                frame.particles.position = numpy.asarray(x, numpy.float32)
                frame.particles.types = ["A"]
                frame.particles.type_shapes = shapes
                for key, values in more.items():
                    if values[k] is not None:
                        setattr(frame.particles, key, numpy.asarray(values[k], numpy.int32 if key == "image" else numpy.float32))
                file.append(frame)

    def dump(self, name, columns, frames, head="pp pp pp", bounds=("-5 5",) * 3, steps=None):
        """A LAMMPS dump; a frame is a list of rows."""
        text = ""
        for k, rows in enumerate(frames):
            step = steps[k] if steps else k
            text += f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX BOUNDS {head}\n"
            text += "".join(f"{b}\n" for b in bounds) + f"ITEM: ATOMS {columns}\n"
            text += "".join(" ".join(x if isinstance(x, str) else f"{x:.9g}" for x in row) + "\n" for row in rows)
        self.write(name, text)

    def analyze(self, name, *arguments):
        result = self.hardbody("analyze", name, "--time-step", "1", "--out", "analysis", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def refused(self, name, *parts):
        self.assert_refused(self.hardbody("analyze", name, "--time-step", "1", "--out", "analysis"), name, "accepted: ", *parts)

    def rows(self, name):
        with open(self.path(f"analysis/{name}.csv")) as file:
            lines = list(csv.reader(file))
        names = [column.split(" [")[0] for column in lines[0]]
        return {n: numpy.array([float(x[k] or "nan") for x in lines[1:]]) for k, n in enumerate(names)}

    def heads(self, name):
        with open(self.path(f"analysis/{name}.csv")) as file:
            return next(csv.reader(file))

    def msd(self):
        """Lags and values that there are."""
        rows = self.rows("msd")
        return {t: x for t, x in zip(rows["t"], rows["msd"]) if numpy.isfinite(x)}

    def analysis(self):
        return json.loads(self.read("analysis/analysis.json"))


class Walks(FilesCase):
    """One and the same walk in all ways to write it: the same displacements, or the reason why there are none."""

    def setUp(self):
        super().setUp()
        steps = numpy.random.default_rng(5).uniform(-4.5, 4.5, (12, 6, 3))
        self.walk = numpy.cumsum(steps, axis=0)
        self.slow = numpy.cumsum(0.2 * steps, axis=0)
        self.edges = lambda x: numpy.rint((x - wrapped(x)) / L).astype(int)

    def wanted(self, x):
        return {t: ((x[t:] - x[:-t]) ** 2).sum(axis=2).mean() for t in (1, 2)}

    def same(self, x, by):
        found = self.msd()
        for t, value in self.wanted(x).items():
            self.assertAlmostEqual(found[t], value, delta=1e-5 * value)
        self.assertEqual(self.analysis()["unwrapped"], {"by": by, "reason": None})

    def table(self, x, columns):
        """Rows of a dump with these columns, the bodies in an order that changes."""
        frames = []
        for k, frame in enumerate(x):
            w, n = wrapped(frame), self.edges(frame)
            row = lambda i: {"id": i + 1, "type": 1, **{f"{a}": w[i, j] for j, a in enumerate("xyz")},
                             **{f"{a}s": w[i, j] / L + 0.5 for j, a in enumerate("xyz")},
                             **{f"{a}u": frame[i, j] for j, a in enumerate("xyz")},
                             **{f"{a}su": frame[i, j] / L + 0.5 for j, a in enumerate("xyz")},
                             **{f"i{a}": n[i, j] for j, a in enumerate("xyz")}}
            frames.append([[row(i)[c] for c in columns.split()] for i in numpy.roll(numpy.arange(len(frame)), k)])
        return frames

    def test_dumps(self):
        for columns, by in [("xu yu zu", "unwrapped columns"), ("xsu ysu zsu", "unwrapped columns"),
                            ("x y z ix iy iz", "image flags"), ("xs ys zs ix iy iz", "image flags"),
                            ("x y z xu yu zu", "unwrapped columns"), ("xs ys zs xsu ysu zsu", "unwrapped columns"),
                            ("xu y z iy iz", "image flags")]:
            with self.subTest(columns):
                self.dump("walk.lammpstrj", "id type " + columns, self.table(self.walk, "id type " + columns))
                out = self.analyze("walk.lammpstrj", "--longest-lag", "2")
                self.same(self.walk, by)
                self.assertIn(f"positions unwrapped by {by}", out)

    def test_dumps_with_positions_outside_the_box(self):
        rows = [[[i + 1, 1, *x] for i, x in enumerate(frame)] for frame in self.walk]
        self.dump("walk.lammpstrj", "id type x y z", rows)
        self.analyze("walk.lammpstrj", "--longest-lag", "2")
        self.same(self.walk, "positions outside the box")

    def test_gsd(self):
        self.gsd("images.gsd", wrapped(self.walk), image=self.edges(self.walk))
        self.analyze("images.gsd", "--longest-lag", "2")
        self.same(self.walk, "image flags")
        self.gsd("outside.gsd", self.walk)
        self.analyze("outside.gsd", "--longest-lag", "2")
        self.same(self.walk, "positions outside the box")

    def test_nearest_images(self):
        """Believed as long as bodies move little; through all frames, whichever are taken."""
        self.dump("slow.lammpstrj", "id type x y z", self.table(self.slow, "id type x y z"))
        self.analyze("slow.lammpstrj", "--longest-lag", "2")
        self.same(self.slow, "nearest images")
        self.gsd("slow.gsd", wrapped(self.slow))
        self.analyze("slow.gsd", "--longest-lag", "6", "--every", "3")
        x = self.slow[::3]
        self.assertAlmostEqual(self.msd()[6], ((x[2:] - x[:-2]) ** 2).sum(axis=2).mean(), delta=1e-4)
        self.assertEqual(self.analysis()["frames"]["read"], 4)
        for name, write in [("fast.gsd", lambda n: self.gsd(n, wrapped(self.walk))),
                            ("fast.lammpstrj", lambda n: self.dump(n, "id type x y z", self.table(self.walk, "id type x y z")))]:
            write(name)
            out = self.analyze(name)
            self.assertIn("no displacements, MSD and F_self: without images, and bodies move by up to 0.4", out)
            self.assertEqual(self.msd(), {})
            for key in ["D_trans", "t_F_1overe", "tau_F", "beta_F"]:
                self.assertEqual(self.analysis()["observables"][key], {"value": None, "error": None, "missing": WRAPPED}, key)
            self.assertIn(f"D_trans      - ({WRAPPED})", out)
            self.assertTrue(numpy.isnan(self.rows("f_self")["f_self_q1"]).all())
            self.assertIsNone(self.analysis()["unwrapped"]["by"])
            self.assertIn("nearest images", self.analysis()["unwrapped"]["reason"])
            self.assertTrue(numpy.isfinite(self.rows("s_q")["S"]).any())

    def test_images_that_nobody_keeps(self):
        """0 in all frames while bodies jump across the box: nearest images, if they tell. Where they do not jump, they are 0."""
        def dump(name, x, columns):
            rows = [[[i + 1, 1, *body, 0, 0, 0] for i, body in enumerate(frame)] for frame in x]
            self.dump(name, f"id type {columns} ix iy iz", rows)

        def gsd_zeros(name, x):
            """Images as they are, which the module for GSD files leaves out where they are 0."""
            with gsd.fl.open(self.path(name), WRITE, application="test", schema="hoomd", schema_version=[1, 4]) as file:
                for k, frame in enumerate(x):
                    for chunk, data in [("configuration/step", numpy.array([k], numpy.uint64)),
                                        ("configuration/box", numpy.array([L, L, L, 0, 0, 0], numpy.float32)),
                                        ("particles/N", numpy.array([len(frame)], numpy.uint32)),
                                        ("particles/position", frame.astype(numpy.float32)),
                                        ("particles/image", numpy.zeros(frame.shape, numpy.int32))]:
                        file.write_chunk(chunk, data)
                    file.end_frame()

        across = self.slow + 4.7  # they begin at a face of the box
        within = numpy.clip(0.1 * self.slow, -4.9, 4.9)
        for name, write in [("slow.lammpstrj", lambda n, x: dump(n, wrapped(x), "x y z")),
                            ("scaled.lammpstrj", lambda n, x: dump(n, wrapped(x) / L + 0.5, "xs ys zs")),
                            ("slow.gsd", lambda n, x: gsd_zeros(n, wrapped(x)))]:
            with self.subTest(name):
                write(name, across)
                out = self.analyze(name, "--longest-lag", "2")
                self.same(across, "nearest images")
                self.assertIn("note: images: 0 in all frames, while bodies jump by up to 0.9", out)
                write(name, self.walk)
                out = self.analyze(name)
                self.assertIn("not used", out)
                self.assertEqual(self.msd(), {})
                D_trans = self.analysis()["observables"]["D_trans"]
                self.assertEqual(D_trans, {"value": None, "error": None, "missing": WRAPPED})
                self.assertIn(f"D_trans      - ({WRAPPED})", out)
                write(name, within)
                out = self.analyze(name, "--longest-lag", "2")
                self.same(within, "image flags")
                self.assertNotIn("not used", out)
        # Within the box by half of it and more, a few times: that may be. A jump by all but 0.4 % of it hardly can.
        for x, by in [([-4, 4], "image flags"), ([-3, 2.5, -2.7], "image flags"), ([-4.98, 4.98], "nearest images"),
                      ([-4.6, 4.6, -4.6], "nearest images")]:
            with self.subTest(x):
                dump("few.lammpstrj", [[[a, 0, 0], [0, 3, 0]] for a in x], "x y z")
                self.analyze("few.lammpstrj", "--longest-lag", "1")
                self.assertEqual(self.analysis()["unwrapped"]["by"], by)
        # Another body that has crossed a face: images are kept, and these bodies have jumped.
        x = wrapped(across)
        rows = [[[i + 1, 1, *b, int(k == 11 and i == 0), 0, 0] for i, b in enumerate(f)] for k, f in enumerate(x)]
        self.dump("kept.lammpstrj", "id type x y z ix iy iz", rows)
        self.analyze("kept.lammpstrj", "--longest-lag", "2")
        self.assertEqual(self.analysis()["unwrapped"]["by"], "image flags")
        # Not wrapped at all: what is stored goes on outside the box, and images add nothing.
        dump("outside.lammpstrj", self.walk, "x y z")
        self.assertNotIn("not used", self.analyze("outside.lammpstrj", "--longest-lag", "2"))
        self.same(self.walk, "image flags")
        # From 0 to the edge, in a box about the origin.
        dump("corner.lammpstrj", (across + L / 2) % L, "x y z")
        self.assertIn("note: images: 0 in all frames", self.analyze("corner.lammpstrj", "--longest-lag", "2"))
        self.same(across, "nearest images")

    def test_images_without_ids(self):
        """Bodies in another order in every frame: a jump is another body, and says nothing about images."""
        def dump(columns):
            x = wrapped(self.slow + 4.7)
            rows = [numpy.roll([[1, *b, 0, 0, 0] for b in f], k, axis=0) for k, f in enumerate(x)]
            numbered = [[[i + 1, *row] for i, row in enumerate(f)] for f in rows] if "id" in columns else rows
            self.dump("jumps.lammpstrj", f"{columns} x y z ix iy iz", numbered)

        dump("type")
        out = self.analyze("jumps.lammpstrj")
        self.assertIn("the file does not number its bodies (no column id)", out)
        self.assertNotIn("images:", out)
        self.assertEqual(self.analysis()["notices"], [])
        dump("id type")
        self.assertIn("note: images: 0 in all frames, while bodies jump", self.analyze("jumps.lammpstrj"))

    def test_a_little_outside_the_box(self):
        """LAMMPS wraps only now and then; another program's file may mean either."""
        near = [[[4.9, 0, 0], [0, 3, 0]], [[5.3, 0, 0], [0, 3, 0]], [[-4.2, 0, 0], [0, 3, 0]]]
        self.dump("late.lammpstrj", "id type x y z", [[[i + 1, 1, *x] for i, x in enumerate(f)] for f in near])
        self.analyze("late.lammpstrj", "--longest-lag", "2")
        self.assertAlmostEqual(self.msd()[2], 0.9**2 / 2, places=6)
        self.gsd("late.gsd", near)
        self.assertIn("whether positions are wrapped is not clear", self.analyze("late.gsd"))
        self.assertEqual(self.msd(), {})

    def test_images_of_the_first_frame(self):
        two = lambda x: [[x, 0, 0], [0, 3, 0]]
        self.gsd("first.gsd", [two(4.9), two(-4.9)], image=[[[1, 0, 0], [0, 0, 0]], None])
        self.analyze("first.gsd")
        self.assertAlmostEqual(self.msd()[1], 0.02, places=6)

    def test_columns_that_disagree(self):
        self.dump("bad.lammpstrj", "id type x y z xu yu zu", [[[7, 1, 1, 0, 0, 14, 0, 0]]])
        self.refused("bad.lammpstrj", "frame 0: wrapped and unwrapped x of body 7 are 1.3 edges of the box apart")
        self.dump("bad.lammpstrj", "id type x y z ix iy iz", [[[7, 1, 1, 0, 0, 0.5, 0, 0]]])
        self.refused("bad.lammpstrj", "ix of body 7 is 0.5", "an integer")

    def test_bodies_are_followed_by_their_ids(self):
        rows = self.table(self.slow, "type x y z")
        self.dump("no.lammpstrj", "type x y z", rows)
        out = self.analyze("no.lammpstrj")
        self.assertIn("no correlations in time: the file does not number its bodies (no column id)", out)
        self.assertEqual(self.msd(), {})
        self.assertTrue(numpy.isfinite(self.rows("s_q")["S"]).any())
        self.assertIsNone(self.analysis()["followed"]["by"])
        self.dump("other.lammpstrj", "id type x y z", [[[1, 1, 0, 0, 0], [2, 1, 0, 3, 0]], [[1, 1, 0, 0, 0], [3, 1, 0, 3, 0]]])
        self.refused("other.lammpstrj", "frame 1: has body 3 where the first frame has 2")


class PartsOfFrames(FilesCase):
    """Quantities that only some frames have, and bodies that change."""

    def two(self, x):
        return [[x, 0, 0], [0, 3, 0]]

    def test_velocities(self):
        v = [[1, 0, 0], [-1, 0, 0]]
        x = [self.two(0.5 * k) for k in range(3)]
        self.gsd("first.gsd", x, velocity=[v, None, None])
        self.assertIn("velocities: known in 1 of 3 frames, not used", self.analyze("first.gsd"))
        self.assertTrue(numpy.isnan(self.rows("velocity")["vacf"]).all())
        # Written when they change: a frame without them has those of the first.
        self.gsd("all.gsd", x, velocity=[v, v, [[2, 0, 0], [-1, 0, 0]]])
        self.analyze("all.gsd")
        self.assertAlmostEqual(self.rows("velocity")["vacf"][1], (1 + 1 + 2 + 1) / 4, places=6)
        # The first body at rest is no body without a velocity.
        self.gsd("rest.gsd", x, velocity=[[[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]], [[0, 0, 0], [1, 0, 0]]])
        self.analyze("rest.gsd")
        self.assertAlmostEqual(self.rows("velocity")["vacf"][1], 1, places=6)

    def test_orientations(self):
        q = [[0.5, 0.5, 0.5, 0.5], [1, 0, 0, 0]]
        x = [self.two(0.1 * k) for k in range(3)]
        for name, values in [("first.gsd", [q, None, None]), ("none.gsd", [None] * 3)]:
            self.gsd(name, x, ROD, orientation=values)
            self.assertIn("orientations: known in 1 of 3 frames, not used", self.analyze(name))
            self.assertIsNone(self.analysis()["observables"]["S"]["value"])
            self.assertTrue(numpy.isnan(self.rows("c2")["c2"]).all())
        self.gsd("all.gsd", x, ROD, orientation=[q, None, [[0.8, 0.6, 0, 0], [1, 0, 0, 0]]])
        self.analyze("all.gsd")
        self.assertTrue(numpy.isfinite(self.rows("c2")["c2"]).all())
        # One frame is as the schema has it: aligned.
        self.gsd("one.gsd", x[:1], ROD)
        self.analyze("one.gsd")
        self.assertAlmostEqual(self.analysis()["observables"]["S"]["value"], 1)

    def test_frames_without_positions(self):
        self.gsd("log.gsd", [self.two(0)])
        file = gsd.fl.open(self.path("log.gsd"), AGAIN)
        for k in range(1, 5):
            file.write_chunk("configuration/step", numpy.array([k], numpy.uint64))
            file.write_chunk("log/energy", numpy.array([k], numpy.float64))
            if k % 2 == 0:
                file.write_chunk("particles/position", numpy.array(self.two(0.1 * k), numpy.float32))
            file.end_frame()
        file.close()
        self.assertIn("frames without positions are left out: 2 of 5 in the file", self.analyze("log.gsd"))
        self.assertAlmostEqual(self.msd()[2], 0.02, places=6)
        self.assertNotIn(1, self.msd())
        frames = self.analysis()["frames"]
        self.assertEqual((frames["in_file"], frames["without_positions"], frames["read"]), (5, 2, 3))

    def test_uneven_times(self):
        """A first interval of another length: structure from all, correlations from the rest."""
        steps = [0, 1, 100, 200, 300, 400]
        self.dump("uneven.lammpstrj", "id type xu yu zu", [[[1, 1, 0.005 * s, 0, 0], [2, 1, 0, 3, 0]] for s in steps], steps=steps)
        out = self.analyze("uneven.lammpstrj")
        self.assertIn("S, g(r) and S(q) are from all frames, correlations from the longest evenly spaced sequence, 4 frames", out)
        self.assertIn("of times 100 to 400", out)
        self.assertEqual(list(self.msd()), [100])
        self.assertAlmostEqual(self.msd()[100], 0.125, places=6)
        frames = self.analysis()["frames"]
        self.assertEqual((frames["read"], frames["used"], frames["first_used"]), (6, 4, 2))
        # g(r) of all six: the one pair of bodies in each frame.
        rows = self.rows("g_r")
        pairs = lambda d: [(x * x + 9) ** 0.5 for x in d]
        seen = rows["r"][rows["g"] > 0]
        for r in pairs([0.005 * s for s in steps]):
            self.assertLess(numpy.abs(seen - r).min(), rows["r"][1] - rows["r"][0])

    def test_times_that_do_not_rise(self):
        """Frames are named by their numbers in the file, whichever are used."""
        steps = [0, 1, 2, 3, 2, 5]
        self.dump("back.lammpstrj", "id type xu yu zu", [[[1, 1, 0, 0, 0], [2, 1, 0, 3, 0]] for _ in steps], steps=steps)
        self.refused("back.lammpstrj", "back.lammpstrj: time of frame 4 is 2, that of frame 3 is 3; accepted: finite times")
        result = self.hardbody("analyze", "back.lammpstrj", "--time-step", "1", "--every", "2", "--out", "analysis")
        self.assert_refused(result, "back.lammpstrj: time of frame 4 is 2, that of frame 2 is 2; accepted: finite times")

    def test_boxes_that_are_far_too_large(self):
        row = [[[1, 1, 0, 0, 0, 1e-6], [2, 1, 0, 3, 0, 1e-6]]]
        self.dump("far.lammpstrj", "id type x y z radius", row)
        self.refused("far.lammpstrj", "frame 0: its box has an edge of 10, its bodies have a mean radius of 1e-06",
                     "an edge below 1e+06 times this length")

    def test_units_without_sizes(self):
        """A file without sizes may have any unit of length: all results scale with it, and lose no peak."""
        self.write("fluid.toml", """seed = 1
[system]
number = 256
packing_fraction = 0.45
start = "fcc"
[shape]
aspect_ratio = 1
[equilibration]
time = 10
[production]
time = 80
[output]
trajectory = ["lammps"]
frames = 41
""")
        result = self.hardbody("run", "fluid.toml", "--out", "fluid")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.analyze("fluid/trajectory.lammpstrj")
        known = self.analysis()["observables"]["q_peak"]["value"]
        text = self.read("fluid/trajectory.lammpstrj").split("ITEM: TIMESTEP\n")[1:]
        edge = 2 * float(text[0].split("pp pp pp\n")[1].split()[1])
        frames = [numpy.array([line.split() for line in frame.split("\n")[8:] if line], float) for frame in text]
        frames = [rows[:, 2:5] + edge * rows[:, -3:] for rows in frames]
        found = {}
        for scale in (0.1, 1, 30):
            rows = [[[i + 1, 1, *(scale * x)] for i, x in enumerate(frame)] for frame in frames]
            self.dump("scaled.lammpstrj", "id type xu yu zu", rows, bounds=(f"{-scale * edge / 2:.9g} {scale * edge / 2:.9g}",) * 3)
            self.analyze("scaled.lammpstrj")
            analysis = self.analysis()
            self.assertEqual(analysis["units"], "those of the file")
            self.assertEqual(self.heads("msd") + self.heads("g_r")[:1], ["t [time]", "msd [length^2]", "msd_error [length^2]", "r [length]"])
            self.assertEqual(self.heads("order"), ["t [time]", "S [1]", "energy [energy]"])
            peak = analysis["observables"]["q_peak"]["value"] * scale
            self.assertAlmostEqual(peak, known, delta=0.05)
            self.assertAlmostEqual(analysis["wave_numbers"][0] * scale, 2 * numpy.pi * 256 ** (1 / 3) / edge, places=6)
            pairs = self.rows("g_r")
            found[scale] = peak, pairs["r"] / scale, pairs["g"], self.rows("s_q")["S"]
        for scale in (0.1, 30):
            for here, there in zip(found[scale], found[1]):
                numpy.testing.assert_allclose(here, there, rtol=1e-4, atol=1e-4)

    def test_bodies_that_change(self):
        first = [[1, 1, 0, 0, 0, 1, 1], [5, 2, 0, 3, 0, 1, 1]]
        for what, row, text in [("type", [5, 1, 0, 3, 0, 1, 1], "body 5 is of type 1, in the first frame of 2"),
                                ("mass", [5, 2, 0, 3, 0, 1, 3], "body 5 has a mass of 3, in the first frame of 1"),
                                ("size", [5, 2, 0, 3, 0, 0.5, 1], "body 5 has another shape or size than in the first frame")]:
            with self.subTest(what):
                self.dump("change.lammpstrj", "id type x y z radius mass", [first, first, [first[0], row]])
                self.refused("change.lammpstrj", "frame 2: " + text)

    def test_radius_and_diameter(self):
        self.dump("r.lammpstrj", "id type x y z radius", [[[1, 1, 0, 0, 0, 0.5], [2, 1, 0, 3, 0, 1]]])
        self.assertIn("column radius: bodies are treated as spheres of these sizes", self.analyze("r.lammpstrj"))
        self.assertAlmostEqual(self.analysis()["state"]["length"], ((0.125 + 1) / 2) ** (1 / 3), places=9)
        q = "quatw quati quatj quatk"
        self.dump("q.lammpstrj", f"id type x y z radius {q}", [[[1, 1, 0, 0, 0, 0.5, 1, 0, 0, 0]]])
        self.assertIn("column radius: not used, because bodies with orientations are not spheres", self.analyze("q.lammpstrj"))
        self.gsd("d.gsd", [self.two(0)], shapes=[{}], diameter=[[2, 3]])
        self.assertIn("particles/diameter: bodies are treated as spheres of these diameters", self.analyze("d.gsd"))
        self.assertAlmostEqual(self.analysis()["state"]["length"], ((1 + 1.5**3) / 2) ** (1 / 3), places=6)

    def test_columns_of_other_names(self):
        names = " ".join(f"c_orient[{k}]" for k in range(1, 5))
        self.dump("c.lammpstrj", f"id type x y z {names}", [[[1, 1, 0, 0, 0, 1, 0, 0, 0]]])
        self.assertIn(f"columns {names}: not used; orientations are read from quatw quati quatj quatk", self.analyze("c.lammpstrj"))
        self.dump("l.lammpstrj", "id type x y z shapex shapey shapez blockiness1 blockiness2", [[[1, 1, 0, 0, 0, 1, 1, 2, 2, 2]]])
        self.assertIn("shapex shapey shapez: not used together with columns blockiness1 blockiness2", self.analyze("l.lammpstrj"))

    def test_quaternions(self):
        columns = "id type x y z quatw quati quatj quatk shapex shapey shapez"
        row = lambda w: [[4, 1, 0, 0, 0, w, 0, 0, 0, 1, 1, 2], [9, 1, 0, 3, 0, 1, 0, 0, 0, 1, 1, 2]]
        self.dump("q.lammpstrj", columns, [row(1.0005)])
        self.assertIn("orientations: quaternions of 1 bodies normalized, their lengths off 1 by up to 5.0e-04", self.analyze("q.lammpstrj"))
        self.dump("q.lammpstrj", columns, [row(1.002)])
        self.refused("q.lammpstrj", "the orientation of body 4 is a quaternion of length 1.002", "1 within 0.001")
        for length, said in [(1.000005, False), (1 + 9e-6, False), (1 + 1.1e-5, True)]:
            self.dump("q.lammpstrj", columns, [row(f"{length:.9f}")])
            self.assertEqual("normalized" in self.analyze("q.lammpstrj"), said)
        for length, known in [(1.0005, True), (1.002, False)]:
            self.gsd("q.gsd", [self.two(0)], ROD, orientation=[[[1, 0, 0, 0], [length, 0, 0, 0]]])
            if known:
                self.assertIn("orientations: quaternions of 1 bodies normalized", self.analyze("q.gsd"))
            else:
                self.refused("q.gsd", "the orientation of body 1 is a quaternion of length 1.002")
        self.gsd("q.gsd", [self.two(0)], ROD, orientation=[[[1, 0, 0, 0], [1.000005, 0, 0, 0]]])
        self.assertNotIn("normalized", self.analyze("q.gsd"))

    def test_messages_give_ids(self):
        for column, value, text in [("x", "nan", 'x of body 17 is "nan"'), ("x", 1e17, "body 17 is at 1e+17"),
                                    ("vx", "inf", 'vx of body 17 is "inf"'), ("shapex", -1, "shape of body 17"),
                                    ("type", 0, "the type of body 17 is 0")]:
            columns = "id type x y z vx vy vz shapex shapey shapez".split()
            row = dict(zip(columns, [17, 1, 0, 0, 0, 1, 1, 1, 1, 1, 1]))
            row[column] = value
            self.dump("bad.lammpstrj", " ".join(columns), [[list(row.values())]])
            self.refused("bad.lammpstrj", "frame 0: " + text)


    def test_time_steps_are_integers(self):
        for step in ["3.5", "-3", "1e300"]:
            self.dump("steps.lammpstrj", "id type x y z", [[[1, 1, 0, 0, 0]]])
            text = self.bytes_of("steps.lammpstrj").decode().replace("TIMESTEP\n0\n", f"TIMESTEP\n{step}\n")
            self.assertIn(step, text)
            with open(self.path("steps.lammpstrj"), "w", encoding="utf-8") as file:
                file.write(text)
            self.refused("steps.lammpstrj", "frame 0: its time step is ", "an integer from 0 to 2^53")


class Boxes(FilesCase):
    def row(self, x=0):
        return [[1, 1, x, 0, 0], [2, 1, 0, 3, 0]]

    def test_zero_tilts(self):
        for head, bounds in [("xy xz yz pp pp pp", ["-5 5 0"] * 3), ("abc origin pp pp pp", ["10 0 0 -5", "0 10 0 -5", "0 0 10 -5"])]:
            self.dump("cube.lammpstrj", "id type x y z", [self.row(0), self.row(0.2)], head, bounds)
            self.analyze("cube.lammpstrj")
            self.assertAlmostEqual(self.msd()[1], 0.02, places=6)

    def test_tilted(self):
        self.dump("tilt.lammpstrj", "id type x y z", [self.row()], "xy xz yz pp pp pp", ["-5 7 2", "-5 5 0", "-5 5 0"])
        self.refused("tilt.lammpstrj", "its box is tilted: edges 10, 10, 10, xy xz yz = 2, 0, 0")
        self.dump("abc.lammpstrj", "id type x y z", [self.row()], "abc origin pp pp pp", ["10 0 0 -5", "2 10 0 -5", "0 0 10 -5"])
        self.refused("abc.lammpstrj", "general triclinic one (abc origin)")
        self.gsd("tilt.gsd", [[[1, 0, 0]]])
        content = bytearray(self.bytes_of("tilt.gsd"))
        box = struct.pack("<6f", L, L, L, 0, 0, 0)
        at = content.index(box)
        content[at:at + 24] = struct.pack("<6f", L, L, L, 0.25, 0, 0)
        with open(self.path("tilt.gsd"), "wb") as file:
            file.write(content)
        self.refused("tilt.gsd", "its box is tilted: edges 10, 10, 10, xy xz yz = 2.5, 0, 0")

    def test_scaled_positions_in_tilted_boxes(self):
        """They are along the edges: the image along the second one, (5, 10, 0), is near."""
        shapes = "shapex shapey shapez"
        for columns, rows in [("x y z", [[1, 1, 0, -4.9, 0], [2, 1, 4.9, 4.9, 0]]),
                              ("xs ys zs", [[1, 1, 0.745, 0.01, 0.5], [2, 1, 0.745, 0.99, 0.5]])]:
            self.dump("tilt.lammpstrj", f"id type {columns} {shapes}", [[[*row, 1, 1, 1] for row in rows]],
                      "xy xz yz pp pp pp", ["-5 10 5", "-5 5 0", "-5 5 0"])
            result = self.hardbody("check", "tilt.lammpstrj")
            self.assertIn("1 pairs overlap, the deepest by 0.77", result.stdout + result.stderr)
        self.dump("mixed.lammpstrj", "id type x ys z", [[[1, 1, 0, 0.5, 0]]], "xy xz yz pp pp pp", ["-5 10 5", "-5 5 0", "-5 5 0"])
        self.refused("mixed.lammpstrj", "has scaled and other positions in a tilted box")

    def test_oblong(self):
        self.dump("oblong.lammpstrj", "id type x y z", [self.row()], bounds=["-5 5", "-5 5", "-10 10"])
        self.refused("oblong.lammpstrj", "its box has edges 10, 10, 20", "a cubic box")

    def test_formats_are_named(self):
        self.dump("plain", "id type x y z", [self.row()])
        text = self.bytes_of("plain")
        for content, *parts in [
            (gzip.compress(text), "is compressed by gzip", "gunzip"),
            (b"\x28\xb5\x2f\xfd" + bytes(40), "is compressed by zstd"),
            (struct.pack("<qq", -8, 0)[:8] + b"DUMPATOM" + bytes(40), "is a binary LAMMPS dump", "binary2txt"),
            (b"2\ncomment\nA 0 0 0\nA 0 3 0\n", "is an xyz file"),
            (b'<?xml version="1.0"?>\n<VTKFile type="PolyData">\n', "is an XML file, as VTK files are"),
            (b'<VTKFile type="PolyData">\n', "is a VTK file"),
            (b"CRYST1   10.000   10.000   10.000\n", "is a PDB file"),
            (b"\x00\x00\x07\xcb" + bytes(100), "is an XTC file"),
            (b'2\nLattice="10 0 0 0 10 0 0 0 10"\nA 0 0 0\nA 0 3 0\n', "is an extended xyz file"),
            (b"LAMMPS data\n\n2 atoms\n1 atom types\n\n-5 5 xlo xhi\n", "is a LAMMPS data file"),
            (b"no trajectory", "is neither a GSD file nor a LAMMPS text dump"),
        ]:
            with open(self.path("file.gsd"), "wb") as file:
                file.write(content)
            self.refused("file.gsd", *parts)
        # Content counts, not the name.
        with open(self.path("file.gsd"), "wb") as file:
            file.write(text)
        self.analyze("file.gsd")


if __name__ == "__main__":
    unittest.main()
