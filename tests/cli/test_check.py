"""hardbody check of trajectories of any program, starts from their velocities, names behind links.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_check.py [TestClass[.test]]

Needs Debian's python3-gsd.
"""

import json
import os
import re
import shutil
import unittest
import warnings

import numpy

warnings.simplefilter("ignore")
import gsd.fl
import gsd.hoomd

from test_cli import SMALL, Case

BALL = {"type": "Sphere", "diameter": 1.0}
ROD = {"type": "Ellipsoid", "a": 0.5, "b": 0.5, "c": 1.5}
REST = "[equilibration]\ntime = 0\n[production]\ntime = 0\n[output]\ntrajectory = [\"gsd\"]\n"


def frame_of(positions, shapes=(BALL,), box=(10, 10, 10, 0, 0, 0), **more):
    frame = gsd.hoomd.Snapshot()
    frame.configuration.box = list(box)
    frame.particles.N = len(positions)
    frame.particles.position = positions
    frame.particles.types = [chr(65 + k) for k in range(len(shapes))]
    frame.particles.type_shapes = list(shapes)
    for name, value in more.items():
        setattr(frame.particles, name, value)
    return frame


def dump_of(columns, rows, bounds=("-5 5",) * 3, head="pp pp pp"):
    lines = ["ITEM: TIMESTEP", "0", "ITEM: NUMBER OF ATOMS", str(len(rows)), f"ITEM: BOX BOUNDS {head}", *bounds]
    return "\n".join(lines + [f"ITEM: ATOMS {columns}"] + [" ".join(map(str, row)) for row in rows]) + "\n"


class FilesCase(Case):
    def gsd_file(self, name, *frames):
        with gsd.hoomd.open(self.path(name), "wb") as file:
            file.extend(frames)
        return name

    def verdict(self, name):
        """The last line; exit status 0 means sound, and nothing else does."""
        result = self.hardbody("check", name)
        self.assertEqual(result.stderr, "")
        last = result.stdout.splitlines()[-1]
        self.assertEqual(result.returncode, 0 if last == "sound" else 1, result.stdout)
        self.said = result.stdout
        return last

    def assert_overlap(self, name, bodies):
        self.assertEqual(self.verdict(name), "NOT SOUND")
        self.assertRegex(self.said, rf"1 pairs overlap, the deepest by \S+ \({bodies}\)")


class CheckEveryBox(FilesCase):
    """Pairs are looked at in boxes of every form, or the last line says that they are not."""

    def test_oblong(self):
        box = (10, 10, 20, 0, 0, 0)
        self.assert_overlap(self.gsd_file("a.gsd", frame_of([[0, 0, 0], [0.1, 0, 0]], box=box)), "bodies 0 and 1")
        self.assert_overlap(self.gsd_file("b.gsd", frame_of([[0, 0, -9.8], [0, 0, 9.8], [3, 3, 3]], box=box)), "bodies 0 and 1")
        self.assertEqual(self.verdict(self.gsd_file("c.gsd", frame_of([[0, 0, -4.8], [0, 0, 4.8]], box=box))), "sound")

    def test_tilted(self):
        # The image along y is at (5, 10, 0) from each body.
        box = (10, 10, 10, 0.5, 0, 0)
        self.assert_overlap(self.gsd_file("a.gsd", frame_of([[0, -4.9, 0], [4.9, 4.9, 0]], box=box)), "bodies 0 and 1")
        self.assertEqual(self.verdict(self.gsd_file("b.gsd", frame_of([[0, -4.9, 0], [0, 4.9, 0]], box=box))), "sound")

    def test_images_in_a_small_box(self):
        """A rod of length 3 in a box of 2.9 meets its own image, and in one of 3.1 not."""
        for edge, status in [(2.9, "NOT SOUND"), (3.1, "sound")]:
            name = self.gsd_file("rod.gsd", frame_of([[1, 0, 0]], [ROD], (10, 10, edge, 0, 0, 0), orientation=[[1, 0, 0, 0]]))
            self.assertEqual(self.verdict(name), status)
        self.assertIn("no two bounding spheres meet", self.said)
        # Two rods side by side: each meets the other's images on both sides.
        two = frame_of([[0, 0, 0], [1.1, 0, 0]], [ROD], (2.05, 10, 10, 0, 0, 0), orientation=[[1, 0, 0, 0]] * 2)
        self.assert_overlap(self.gsd_file("two.gsd", two), "bodies 0 and 1")

    def test_all_pairs_of_a_random_box(self):
        random = numpy.random.default_rng(5)
        edges = numpy.array([7, 9, 12])
        positions = (random.random((200, 3)) - 0.5) * edges
        frame = frame_of(positions, [BALL], (*edges, 0, 0, 0))
        apart = positions[:, None] - positions[None]
        apart -= edges * numpy.round(apart / edges)
        distance = numpy.linalg.norm(apart, axis=2)[numpy.triu_indices(200, 1)] - 1
        self.assertEqual(self.verdict(self.gsd_file("random.gsd", frame)), "NOT SOUND")
        self.assertIn(f" {(distance < 0).sum()} pairs overlap", self.said)
        least = float(re.search(r"minimum distance +(\S+)", self.said)[1])
        self.assertAlmostEqual(least, distance.min(), delta=1e-5)


class CheckWhatIsNotSaid(FilesCase):
    def test_missing_shapes(self):
        name = self.gsd_file("none.gsd", frame_of([[0, 0, 0], [0.1, 0, 0]], [{}], diameter=[1, 1]))
        self.assertRegex(self.verdict(name), "^not tested: overlaps: bodies of type A have no shape")
        self.assertRegex(self.said, "minimum distance +not known")
        # Overlaps of the others are found all the same.
        some = frame_of([[0, 0, 0], [3, 0, 0], [3.1, 0, 0]], [{}, BALL], typeid=[0, 1, 1])
        self.assert_overlap(self.gsd_file("some.gsd", some), "bodies 1 and 2")
        apart = frame_of([[0, 0, 0], [3, 0, 0]], [{}, BALL], typeid=[0, 1])
        self.assertRegex(self.verdict(self.gsd_file("apart.gsd", apart)), "^not tested: .*type A")
        # A type without bodies needs none.
        self.assertEqual(self.verdict(self.gsd_file("unused.gsd", frame_of([[1, 0, 0]], [BALL, {}]))), "sound")

    def test_orientations_of_frame_0(self):
        """No later frame stores them, so that nothing is known of how bodies lie."""
        frames = [frame_of([[0, 0, 0], [1.1, 0, 0]], [ROD], orientation=[[1, 0, 0, 0]] * 2) for _ in range(2)]
        frames[1].particles.orientation = None
        frames[1].particles.position = [[0, 0, 0], [1.2, 0, 0]]
        self.assertRegex(self.verdict(self.gsd_file("near.gsd", *frames)), "^not tested: .*orientations")
        frames[1].particles.position = [[0, 0, 0], [3.2, 0, 0]]
        self.assertEqual(self.verdict(self.gsd_file("far.gsd", *frames)), "sound")

    def test_frames_without_positions(self):
        name = self.gsd_file("log.gsd", frame_of([[0, 0, 0], [3, 0, 0]]))
        with gsd.fl.open(self.path(name), "rb+") as file:
            for k in range(1, 4):
                file.write_chunk("log/energy", numpy.array([k], numpy.float64))
                if k == 2:
                    file.write_chunk("particles/position", numpy.array([[0, 0, 0], [0.5, 0, 0]], numpy.float32))
                file.end_frame()
        self.assertEqual(self.verdict(name), "NOT SOUND")
        self.assertIn("frame 2: 1 pairs overlap", self.said)
        self.assertRegex(self.said, "frames left out +2, which have no positions")


class CheckDumps(FilesCase):
    COLUMNS = "id type x y z shapex shapey shapez"

    def test_told_by_content(self):
        self.write("dump.gsd", dump_of(self.COLUMNS, [[7, 1, 0, 0, 0, 1, 1, 1], [3, 1, 2, 0, 0, 1, 1, 1]]))
        self.assertEqual(self.verdict("dump.gsd"), "sound")
        self.assertIn("LAMMPS", self.said)
        self.gsd_file("gsd.dat", frame_of([[0, 0, 0], [2, 0, 0]]))
        self.assertEqual(self.verdict("gsd.dat"), "sound")
        self.write("text.gsd", "no trajectory")
        self.assert_refused(self.hardbody("check", "text.gsd"), "text.gsd: is neither a GSD file nor a LAMMPS text dump")
        self.assert_refused(self.hardbody("check", "none"), "none: cannot be read: No such file", "accepted: a run directory")

    def test_names_bodies_by_their_ids(self):
        rows = [[70, 1, 0, 0, 0, 1, 1, 1], [30, 1, 4.8, 0, 0, 1, 1, 1], [20, 1, -4.8, 0, 0, 1, 1, 1]]
        self.write("dump", dump_of(self.COLUMNS, rows))
        self.assert_overlap("dump", "bodies 20 and 30|bodies 30 and 20")

    def test_six_digits_are_no_overlap(self):
        """Spheres in contact, rounded as LAMMPS does."""
        rows = [[1, 1, 0, 0, 0, 1, 1, 1], [2, 1, 0.999999, 0, 0, 1, 1, 1]]
        self.write("touch", dump_of(self.COLUMNS, rows))
        self.assertEqual(self.verdict("touch"), "sound")
        self.assertIn("minimum distance           -1e-06", self.said)
        rows[1][2] = 0.999
        self.write("deep", dump_of(self.COLUMNS, rows))
        self.assertEqual(self.verdict("deep"), "NOT SOUND")

    def test_without_shapes(self):
        self.write("dump", dump_of("id type x y z", [[1, 1, 0, 0, 0], [2, 1, 0.1, 0, 0]]))
        self.assertRegex(self.verdict("dump"), "^not tested: overlaps: bodies of type 1 have no shape")

    def test_ours(self):
        self.run_small("out", config=SMALL + 'trajectory = ["gsd", "lammps"]\nframes = 3\n')
        self.assertEqual(self.verdict("out/trajectory.lammpstrj"), "sound")
        self.assertEqual(self.verdict("out/trajectory.gsd"), "sound")
        self.assertEqual(self.verdict("out"), "sound")


class StartVelocities(FilesCase):
    """Kept by kind of motion where the file has them, drawn where not."""

    def start(self, file, *more, config=""):
        text = config + f'[start]\nfile = "{file}"\n' + REST
        result = self.run_small("out", "--force", *more, config=text)
        self.report = result.stderr
        with gsd.fl.open(self.path("out/trajectory.gsd"), "rb") as file:
            chunk = lambda name: file.read_chunk(frame=0, name="log/particles/hardbody/" + name)
            return chunk("velocity").reshape(-1, 3), chunk("angular_velocity").reshape(-1, 3)

    def assert_same_direction(self, a, b):
        a, b = numpy.ravel(a), numpy.ravel(b)
        self.assertAlmostEqual(a @ b / numpy.linalg.norm(a) / numpy.linalg.norm(b), 1, delta=1e-6)

    SPHERES = "id type x y z vx vy vz shapex shapey shapez"

    def test_dump_with_velocities_alone(self):
        self.write("dump", dump_of(self.SPHERES, [[1, 1, 0, 0, 0, 1, 0, 0, 1, 1, 1], [2, 1, 0, 3, 0, -1, 0, 0, 1, 1, 1]]))
        velocity, omega = self.start("dump")
        self.assertIn("translation rescaled to kT = 1, rotation drawn", self.report)
        # 3 degrees of freedom: m v^2 of both is 3.
        numpy.testing.assert_allclose(velocity, [[1.5**0.5, 0, 0], [-(1.5**0.5), 0, 0]], atol=1e-14)
        self.assertGreater(numpy.linalg.norm(omega, axis=1).min(), 0)

    def test_gsd_by_kinds(self):
        random = numpy.random.default_rng(8)
        positions = [[x, y, z] for x in (-3, 0, 3) for y in (-3, 3) for z in (-2.5, 2.5)]
        moving = random.normal(size=(12, 3))
        quaternions = random.normal(size=(12, 4))
        quaternions /= numpy.linalg.norm(quaternions, axis=1)[:, None]
        angmom = numpy.zeros((12, 4))
        angmom[:, 1:] = random.normal(size=(12, 3))

        def product(a, b):
            w = a[:, 0] * b[:, 0] - (a[:, 1:] * b[:, 1:]).sum(axis=1)
            v = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + numpy.cross(a[:, 1:], b[:, 1:])
            return numpy.column_stack([w, v])

        body = {"orientation": quaternions, "mass": [2] * 12, "moment_inertia": [[0.5, 0.4, 0.3]] * 12}
        box = (10, 10, 10, 0, 0, 0)
        shape = {"type": "Ellipsoid", "a": 0.7, "b": 0.8, "c": 1.0}
        momenta = 2 * product(quaternions, angmom)
        both = frame_of(positions, [shape], box, velocity=moving, angmom=momenta, **body)
        velocity, omega = self.start(self.gsd_file("both.gsd", both))
        self.assertIn("velocities rescaled to kT = 1", self.report)
        self.assert_same_direction(velocity, moving - moving.mean(axis=0))
        turned = product(product(quaternions, angmom / [1, 0.5, 0.4, 0.3]), quaternions * [1, -1, -1, -1])[:, 1:]
        self.assert_same_direction(omega, turned)
        turning, all_drawn = frame_of(positions, [shape], box, angmom=momenta, **body), frame_of(positions, [shape], box, **body)
        drawn, drawn_omega = self.start(self.gsd_file("drawn.gsd", all_drawn))
        self.assertIn("velocities drawn", self.report)
        velocity, omega = self.start(self.gsd_file("turning.gsd", turning))
        self.assertIn("translation drawn, rotation rescaled to kT = 1", self.report)
        self.assert_same_direction(omega, turned)
        self.assert_same_direction(velocity, drawn)
        # Moments that only the config has.
        del body["moment_inertia"]
        name = self.gsd_file("momenta.gsd", frame_of(positions, [shape], box, velocity=moving, angmom=momenta, **body))
        config = "[[species]]\nnumber = 12\nmass = 2\nsemi_axes = [0.7, 0.8, 1.0]\ninertia = [0.5, 0.4, 0.3]\n"
        velocity, omega = self.start(name, config=config)
        self.assertIn("velocities rescaled to kT = 1", self.report)
        self.assert_same_direction(omega, turned)

    def test_rounding_is_no_spin(self):
        """Of bodies that turn across their axes only, in 64 bits and in 32, the spin that rounding leaves is not kept."""
        positions = [[x, y, z] for x in (-3, 0, 3) for y in (-3, 3) for z in (-2.5, 2.5)] * 3
        positions = [[x, y, z + k // 12 * 1.2] for k, (x, y, z) in enumerate(positions)]
        random = numpy.random.default_rng(10)
        quaternions = random.normal(size=(36, 4))
        quaternions /= numpy.linalg.norm(quaternions, axis=1)[:, None]
        w, x, y, z = quaternions.T
        across = random.normal(size=(36, 2, 1))
        v = numpy.concatenate([across[:, 0], across[:, 1], numpy.zeros((36, 1))], axis=1)
        # Twice the product of the quaternion and (0, L).
        momenta = 2 * numpy.column_stack([-(x * v[:, 0] + y * v[:, 1]), w * v[:, 0] - z * v[:, 1], w * v[:, 1] + z * v[:, 0],
                                          x * v[:, 1] - y * v[:, 0]])
        shape = {"type": "Ellipsoid", "a": 0.4, "b": 0.4, "c": 0.5}
        frame = frame_of(positions, [shape], orientation=quaternions, moment_inertia=[[0.1, 0.1, 0.05]] * 36,
                         velocity=random.normal(size=(36, 3)), angmom=momenta)
        self.start(self.gsd_file("across.gsd", frame))
        self.assertIn("rotation rescaled to kT = 1, spin drawn", self.report)
        self.run_small("paper", "--force", config="[system]\nnumber = 36\npacking_fraction = 0.2\n[shape]\naspect_ratio = 2\n" + REST)
        self.start("paper/trajectory.gsd", config="[shape]\naspect_ratio = 2\n[dynamics]\ninertia = \"uniform\"\n")
        self.assertIn("rotation rescaled to kT = 1, spin drawn", self.report)

    def test_velocities_of_frame_0_are_not_those_of_a_later_one(self):
        frames = [frame_of([[0, 0.1 * k, 0], [0, 3, 0]]) for k in range(2)]
        frames[0].particles.velocity = [[1, 0, 0], [-1, 0, 0]]
        name = self.gsd_file("first.gsd", *frames)
        velocity, _ = self.start(name, "--set", "start.frame=0")
        self.assertIn("translation rescaled", self.report)
        velocity, _ = self.start(name, "--set", "start.frame=1")
        self.assertIn("velocities drawn", self.report)
        self.assertGreater(numpy.abs(velocity).min(), 0)

    def test_a_species_at_rest_is_drawn_by_itself(self):
        random = numpy.random.default_rng(9)
        positions = [[x, y, z] for x in (-3, 0, 3) for y in (-3, 3) for z in (-2.5, 2.5)]
        velocity = random.normal(size=(12, 3))
        velocity[6:] = 0
        frame = frame_of(positions, [BALL, BALL], velocity=velocity, typeid=[0] * 6 + [1] * 6, mass=[1] * 6 + [1e6] * 6)
        new, _ = self.start(self.gsd_file("some.gsd", frame))
        self.assertIn("translation drawn for species 2, otherwise rescaled to kT = 1, rotation drawn", self.report)
        old = velocity[:6] - velocity[:6].mean(axis=0)
        self.assert_same_direction(new[:6] - new[:6].mean(axis=0), old)
        total = 6 + 6e6
        self.assertAlmostEqual((new[:6] ** 2).sum() / (3 * (6 - 6 / total)), 1, delta=1e-12)
        self.assertAlmostEqual(1e6 * (new[6:] ** 2).sum() / (3 * (6 - 6e6 / total)), 1, delta=1e-12)

    def test_overlaps_are_named_by_index(self):
        self.gsd_file("overlap.gsd", frame_of([[3, 0, 0], [0, 0, 0], [0.5, 0, 0]], [BALL, BALL], typeid=[1, 0, 0]))
        self.write("a.toml", '[start]\nfile = "overlap.gsd"\n' + REST)
        self.assert_refused(self.hardbody("run", "a.toml"), "(bodies 1 and 2 of the file)")


class MassRatios(Case):
    def test_every_species_is_at_kT_1(self):
        """Seen before: 0.925 and 1.077 with 1e-6 and 1e6."""
        for start in ["random", "fcc"]:
            for mass in ["1e-6", "1e6"]:
                config = f'[system]\npacking_fraction = 0.2\nstart = "{start}"\n' + "".join(
                    f"[[species]]\nnumber = 54\nsemi_axes = [0.5, 0.5, {c}]\nmass = {m}\n" for c, m in [(0.7, "1"), (0.8, mass)])
                self.run_small("out", "--force", config=config + "[equilibration]\ntime = 0\n[production]\ntime = 1e-9\n")
                kT = [species["observables"]["kT_trans"]["value"] for species in self.summary("out")["species"]]
                numpy.testing.assert_allclose(kT, [1, 1], atol=1e-9)


class Links(FilesCase):
    """".." behind a symbolic link is the system's: the parent of the directory that the link points to."""

    def setUp(self):
        super().setUp()
        os.makedirs(self.path("real/deep/runs"))
        os.symlink(self.path("real/deep/runs"), self.path("link"))

    def test_start_file(self):
        shutil.move(self.path(self.gsd_file("a.gsd", frame_of([[0, 0, 0], [3, 0, 0]]))), self.path("real/deep/a.gsd"))
        self.write("a.toml", '[start]\nfile = "link/../a.gsd"\n' + REST)
        result = self.hardbody("run", "a.toml", "--out", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f'file = "{self.path("real/deep/a.gsd")}"', self.read("out/config.toml"))
        self.assertEqual(self.hardbody("run", "out/config.toml", "--out", "again").returncode, 0)
        # Links that no ".." follows stay as they are named, and so do files that ".." names without one.
        os.symlink(self.path("real/deep/a.gsd"), self.path("newest.gsd"))
        self.write("b.toml", '[start]\nfile = "real/../newest.gsd"\n' + REST)
        self.assertEqual(self.hardbody("run", "b.toml", "--out", "newest").returncode, 0)
        self.assertIn(f'file = "{self.path("newest.gsd")}"', self.read("newest/config.toml"))

    def test_start_from(self):
        self.run_small("real/deep/first")
        self.write("a.toml", SMALL.replace("packing_fraction = 0.2", 'packing_fraction = 0.2\nstart_from = "link/../first"'))
        result = self.hardbody("run", "a.toml", "--out", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f'start_from = "{self.path("real/deep/first")}"', self.read("out/config.toml"))
        self.assertEqual(self.hardbody("run", "out/config.toml", "--out", "again").returncode, 0)

    def test_sweep(self):
        shutil.move(self.path(self.gsd_file("a.gsd", frame_of([[0, 0, 0], [3, 0, 0]]))), self.path("real/a.gsd"))
        self.write("real/sweep.toml", '[start]\nfile = "a.gsd"\n' + REST + "[grid]\nseed = [1, 2]\n")
        # The sweep's own directory lies behind the link, and holds the name of the file relative to itself.
        result = self.hardbody("sweep", "real/sweep.toml", "--out", "link/out")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        named = re.search(r'file = "([^"]+)"', self.read("link/out/sweep.toml"))[1]
        self.assertTrue(os.path.samefile(os.path.join(self.path("link/out"), named), self.path("real/a.gsd")))
        again = self.hardbody("sweep", "link/out/sweep.toml", "--out", "again")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)


class Quaternions(Case):
    BODY = '"shape":{"kind":"ellipsoid","semi_axes":[1,2,3]},"position":[%s,0,0],"orientation":[%.17g,%.17g,0,0]'

    def query(self, length, spare=""):
        a = self.BODY % ("0", 0.8 * length, 0.6 * length)
        b = self.BODY % ("9", 0.8, 0.6)
        self.write("lines", '{"a":{%s},"b":{%s}%s}\n' % (a, b, spare))
        result = self.hardbody("distance", "lines")
        return result.returncode, json.loads(result.stdout)

    def test_distance(self):
        # Both readers of lines: the second is for members in which a string has an escape.
        for spare in ["", ',"id":"\\u0041"']:
            _, exact = self.query(1, spare)
            self.assertNotIn("notice", exact)
            for length, said in [(1 - 9.9e-4, "0.99901"), (1 + 9.9e-4, "1.00099"), (1 + 1.1e-5, "1.00001"),
                                 (1.000005, "1.000005"), (1 + 2e-6, "1.000002"), (1 - 2e-6, "0.999998")]:
                status, answer = self.query(length, spare)
                self.assertEqual(status, 0)
                self.assertEqual(answer.pop("notice"), f"a.orientation is a quaternion of length {said}: normalized")
                self.assertEqual(list(answer), list(exact))
                self.assertAlmostEqual(answer["distance"], exact["distance"], delta=1e-14)
            # A pose takes these as they are.
            for length in [1 + 9e-7, 1 - 9e-7]:
                status, answer = self.query(length, spare)
                self.assertEqual(status, 0)
                self.assertNotIn("notice", answer)
                self.assertAlmostEqual(answer["distance"], exact["distance"], delta=1e-14)
            status, answer = self.query(1.0011, spare)
            self.assertEqual(status, 2)
            self.assertIn("its length is 1.0011", answer["error"])
            self.assertIn("accepted: 1 within 0.001", answer["error"])

    def test_replay(self):
        pair = {"format": "hardbody pair"}
        for name, length in [("a", 1.0005), ("b", 1)]:
            pair[name] = json.loads("{%s}" % (self.BODY % ("0" if name == "a" else "9", 0.8 * length, 0.6 * length)))
        self.write("pair.json", json.dumps(pair))
        result = self.hardbody("replay", "pair.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("notice: a.orientation is a quaternion of length 1.0005: normalized", result.stdout)
        pair["a"]["orientation"][0] = 0.9
        self.write("pair.json", json.dumps(pair))
        self.assert_refused(self.hardbody("replay", "pair.json"), "pair.json: a.orientation", "its length is 1.08183", "1 within 0.001")


if __name__ == "__main__":
    unittest.main()
