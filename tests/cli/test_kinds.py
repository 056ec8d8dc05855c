"""Runs of every kind of shape: [shape] and [[species]], starts, files, and messages for bad input.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_kinds.py [TestClass[.test]]
"""

import json
import math
import os
import shutil
import time
import unittest
import warnings

import numpy

warnings.simplefilter("ignore")
import gsd.hoomd

from test_cli import Case
from test_restart import OFTEN, Restart

CORNERS = "[[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1], [0, 0, 2]]"  # a pyramid, its centre of mass not in 0

# [shape] of every kind beside ellipsoids and superellipsoids, and what `hardbody distance` calls the same shape.
SHAPES = {
    "sphere": 'kind = "sphere"\ndiameter = 3\n',
    "capsule": 'kind = "capsule"\nlength = 2\ndiameter = 1\n',
    "box": 'kind = "box"\nedges = [1, 2, 3]\n',
    "rounded box": 'kind = "box"\nedges = [1, 1, 1]\nrounding = 0.1\n',
    "dodecahedron": 'kind = "polyhedron"\nsolid = "dodecahedron"\n',
    "pyramid": f'kind = "polyhedron"\nvertices = {CORNERS}\n',
    "rounded octahedron": 'kind = "polyhedron"\nsolid = "octahedron"\nrounding = 0.2\n',
    "cylinder": 'kind = "cylinder"\nlength = 2\ndiameter = 1\n',
    "rounded disc": 'kind = "cylinder"\nlength = 0.5\ndiameter = 1\nrounding = 0.125\n',
    "cone": 'kind = "cone"\nlength = 1\ndiameter = 1\n',
    "rounded cone": 'kind = "cone"\nlength = 1\ndiameter = 1\nrounding = 0.25\n',
}

RUN = """seed = 3
[system]
number = 64
packing_fraction = 0.2
{shape}
[equilibration]
time = 0.5
[production]
time = {time}
[output]
trajectory = {trajectory}
frames = 5
"""

MIXTURE = """
[[species]]
kind = "capsule"
length = 1.5
diameter = 1
fraction = 0.5
[[species]]
kind = "box"
edges = [1, 1, 1]
rounding = 0.05
fraction = 0.25
[[species]]
kind = "polyhedron"
solid = "octahedron"
fraction = 0.125
sizes = "gaussian"
width = 0.1
[[species]]
kind = "sphere"
diameter = 1
fraction = 0.125
"""


def config(shape, time=2, trajectory="[]"):
    if not shape.startswith("\n[[species]]"):
        shape = "[shape]\n" + shape
    return RUN.format(shape=shape, time=time, trajectory=trajectory)


class KindsCase(Case):
    def assert_sound(self, out):
        summary = self.summary(out)
        self.assertTrue(summary["sound"], summary["audit"])
        self.assertEqual(summary["counters"]["overlaps"], 0)
        self.assertEqual(summary["counters"]["declined"], 0)
        self.assertLess(abs(summary["audit"]["energy_relative_drift"]), 1e-11)
        return summary


class KindsRun(KindsCase):
    def test_every_kind(self):
        for name, shape in SHAPES.items():
            with self.subTest(name):
                out = name.replace(" ", "_")
                self.write(f"{out}.toml", config(shape))
                result = self.run_config(f"{out}.toml", out)
                summary = self.assert_sound(out)
                self.assertGreater(summary["counters"]["collisions"], 100)
                self.assertGreater(summary["observables"]["Z"]["value"], 1.5)
                self.assertEqual(summary["state"]["kind"], shape.split('"')[1])
                body = summary["state"]["shape"]
                self.assertEqual(body["kind"], summary["state"]["kind"])
                self.assertEqual(summary["units"]["length"], "l = radius of the sphere of the body's volume = 1")
                oriented = name != "sphere"
                self.assertEqual("D_rot" in result.stdout, oriented, result.stdout)
                self.assertEqual("D_rot_body" in result.stdout, oriented)
                # The resolved config is the same run.
                again = self.hardbody("run", f"{out}/config.toml", "--out", "again", "--force")
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertEqual(self.state_of("again"), self.state_of(out))

    def test_unit_is_the_sphere_of_the_same_volume(self):
        volume = {
            "sphere": lambda s: 4 / 3 * math.pi * s["radius"] ** 3,
            "capsule": lambda s: math.pi * s["radius"] ** 2 * (2 * s["half_length"] + 4 / 3 * s["radius"]),
            "box": lambda s: 8 * math.prod(s["half_extents"]),
            "cylinder": lambda s: 2 * math.pi * s["radius"] ** 2 * s["half_length"],
            "cone": lambda s: math.pi / 3 * s["radius"] ** 2 * s["height"],
        }
        for name in ["sphere", "capsule", "box", "cylinder", "cone"]:
            self.write("run.toml", config(SHAPES[name], time=0))
            self.run_config("run.toml", name)
            shape = self.summary(name)["state"]["shape"]
            self.assertAlmostEqual(volume[name](shape), 4 / 3 * math.pi, 12)
            self.assertAlmostEqual({"sphere": 1, "capsule": 2 * 0.5, "box": 3, "cylinder": 2, "cone": 2}[name], {
                "sphere": lambda s: s["radius"],
                "capsule": lambda s: s["half_length"] / 2 / s["radius"],
                "box": lambda s: s["half_extents"][2] / s["half_extents"][0],
                "cylinder": lambda s: s["half_length"] / s["radius"],
                "cone": lambda s: s["height"] / s["radius"],
            }[name](shape), 12)

    def test_only_ratios_count(self):
        """Powers of two, so that not even the last bits differ."""
        for a, b in [
            ('kind = "capsule"\nlength = 2\ndiameter = 1\n', 'kind = "capsule"\nlength = 2048.0\ndiameter = 1024\n'),
            ('kind = "box"\nedges = [1, 2, 3]\nrounding = 0.5\n', 'kind = "box"\nedges = [0.25, 0.5, 0.75]\nrounding = 0.125\n'),
            ('kind = "sphere"\ndiameter = 1\n', 'kind = "sphere"\ndiameter = 7e20\n'),
        ]:
            states = []
            for k, shape in enumerate([a, b]):
                self.write("run.toml", config(shape, time=0.5, trajectory='["gsd"]'))
                self.run_config("run.toml", str(k), "--force")
                states.append(self.bytes_of(f"{k}/trajectory.gsd"))
                shutil.rmtree(self.path(str(k)))
            self.assertEqual(*states)

    def test_inertia(self):
        """Uniform density by default; of a pyramid about its centre of mass, along its principal axes."""
        self.write("run.toml", config("\n[[species]]\n" + SHAPES["pyramid"], time=0, trajectory='["gsd"]'))
        self.run_config("run.toml", "out")
        species = self.summary("out")["species"][0]
        # Edge 2, height 3: I_z = m a^2 / 10, I_x = m (a^2 / 20 + 3 h^2 / 80).
        numpy.testing.assert_allclose(sorted(species["inertia"]), [0.4, 4 / 20 + 27 / 80, 4 / 20 + 27 / 80], rtol=1e-12)
        corners = numpy.array(species["shape"]["vertices"])
        self.assertAlmostEqual(corners[:, 2].max() - corners[:, 2].min(), 3, 12)
        self.assertAlmostEqual(max(abs(corners[:, 2])), 9 / 4, 12)

    def test_mixture_and_sizes(self):
        self.write("run.toml", config(MIXTURE))
        self.run_config("run.toml", "out")
        species = self.assert_sound("out")["species"]
        self.assertEqual([s["kind"] for s in species], ["capsule", "box", "polyhedron", "sphere"])
        self.assertEqual([s["number"] for s in species], [32, 16, 8, 8])
        self.assertEqual(species[0]["shape"], {"kind": "capsule", "half_length": 0.75, "radius": 0.5})
        self.assertEqual(species[1]["shape"], {"kind": "box", "half_extents": [0.5, 0.5, 0.5], "rounding": 0.05})
        self.assertEqual(species[3]["semi_axes"], [0.5, 0.5, 0.5])
        self.assertGreater(species[2]["sizes"]["largest"], species[2]["sizes"]["smallest"])

    def test_lattices(self):
        """Aligned cubes fill space, and capsules stand on fcc."""
        for name, shape, lattice, number, phi in [
            ("cylinders", SHAPES["cylinder"], "fcc", 108, 0.3),
            ("cubes", 'kind = "box"\nedges = [1, 1, 1]\n', "cubic", 64, 0.9),
            ("capsules", SHAPES["capsule"], "fcc", 108, 0.3),
        ]:
            self.write("run.toml", config(shape, time=0.2))
            self.run_config("run.toml", name, "--set", f"system.start={lattice}", f"system.number={number}",
                            f"system.packing_fraction={phi}", "equilibration.time=0.1")
            self.assert_sound(name)

    def test_nematic_order_of_capsules(self):
        self.write("run.toml", config(SHAPES["capsule"], time=0))
        self.run_config("run.toml", "out", "--set", "system.start=fcc", "system.number=288", "equilibration.time=0",
                        "system.nematic_order=0.8", "--set", "output.trajectory=[\"gsd\"]")
        with gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
            q = file[0].particles.orientation.astype(float)
        u_z = 1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2)
        self.assertAlmostEqual(1.5 * (u_z**2).mean() - 0.5, 0.8, delta=0.01)

    def test_pressure_of_capsules(self):
        """Nezbeda's equation of state of hard convex bodies, Chem. Phys. Lett. 41 (1976) 55, within 1 % and 4 errors."""
        for length, phi in [(1, 0.2), (2, 0.3)]:
            shape = f'kind = "capsule"\nlength = {length}\ndiameter = 1\n'
            self.write("run.toml", config(shape, time=12))
            self.run_config("run.toml", "out", "--force", "--set", f"system.packing_fraction={phi}", "system.number=216",
                            "equilibration.time=4")
            g = length + 1
            a = g * (g + 1) / (3 * g - 1)  # non-sphericity R S / (3 V)
            wanted = (1 + (3 * a - 2) * phi + (a * a + a - 1) * phi**2 - a * (5 * a - 4) * phi**3) / (1 - phi) ** 3
            z = self.summary("out")["observables"]["Z"]
            self.assertAlmostEqual(z["value"], wanted, delta=0.01 * wanted + 4 * z["error"])
            shutil.rmtree(self.path("out"))

    def test_sweep(self):
        text = config(SHAPES["capsule"], time=0.5) + "[grid]\nshape.length = [0, 1, 2]\n"
        self.write("sweep.toml", text)
        result = self.hardbody("sweep", "sweep.toml", "--out", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("shape.length", self.read("out/sweep.csv").splitlines()[0].split(","))
        self.assertEqual(len(self.read("out/sweep.csv").splitlines()), 4)
        self.write("sweep.toml", config(SHAPES["dodecahedron"], time=0.2) + '[grid]\nshape.solid = ["cube", "octahedron"]\n')
        result = self.hardbody("sweep", "sweep.toml", "--out", "solids")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_templates(self):
        for name in ["capsule", "polyhedron"]:
            text = self.hardbody("init", "--template", name).stdout
            self.write("run.toml", text)
            self.run_config("run.toml", name, "--set", "system.number=64", "equilibration.time=0.1", "production.time=0.1")


class KindsContinue(KindsCase, Restart):
    def test_killed_and_resumed(self):
        """The bytes of an undisturbed run, files of frames too."""
        shapes = [(SHAPES["capsule"], 20), (SHAPES["pyramid"], 4), (SHAPES["cone"], 1), (MIXTURE, 4)]
        for shape, time_of_production in shapes:
            text = config(shape, time_of_production, '["gsd", "lammps", "vtk"]').replace("[output]\n", f"[output]\n{OFTEN}\n")
            seconds = self.undisturbed("reference", text)
            expected = self.results("reference")
            shutil.rmtree(self.path("reference"))
            self.write("run.toml", text)
            with self.subTest(shape):
                for share in [0.3, 0.6]:
                    process = self.start("run", "run.toml", "--out", "out", "--force")
                    time.sleep(share * seconds)
                    self.stop(process)
                    if not os.path.exists(self.path("out/checkpoint.bin")):
                        continue
                    self.resume("out")
                    self.assert_same_run("out", expected)
                shutil.rmtree(self.path("out"))

    def test_extended(self):
        self.write("run.toml", config(SHAPES["pyramid"], time=1).replace("time = 1\n", "time = 1\nlongest_lag = 0.1\n"))
        self.run_config("run.toml", "short")
        result = self.hardbody("extend", "short", "--time", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.write("long.toml", self.read("run.toml").replace("time = 1\n", "time = 2\n"))
        self.run_config("long.toml", "long")
        self.assertEqual(self.summary("short")["counters"], self.summary("long")["counters"])

    def test_replay(self):
        """A pair of a capsule and a cube that meet face on; the paper has no equations for them."""
        turn = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        capsule = {"kind": "capsule", "half_length": 1, "radius": 0.5}
        cube = {"kind": "box", "half_extents": [0.5, 0.5, 0.5]}
        pair = {"format": "hardbody pair", "a": {"shape": capsule, "position": [0, 0, 0], "rotation": turn},
                "b": {"shape": cube, "position": [3, 0.2, 0], "rotation": turn, "velocity": [-1, 0, 0]}}
        result = self.hardbody("replay", self.write("pair.json", json.dumps(pair)))
        self.assertEqual(result.returncode, 0, result.stderr)
        for text in ["a: capsule of half-length 1 and radius 0.5", "they touch after 2\n", "no equations of a capsule"]:
            self.assertIn(text, result.stdout)

    def test_start_from_a_run(self):
        self.write("run.toml", config(SHAPES["capsule"], time=0.5))
        self.run_config("run.toml", "first")
        self.run_config("run.toml", "second", "--set", "system.start_from=first", "system.packing_fraction=0.25")
        self.assert_sound("second")


ROTATE = [[math.cos(0.5), 0, 0, math.sin(0.5)], [0.5, 0.5, -0.5, 0.5], [1, 0, 0, 0]]


def rotated(q, v):
    """v turned by the quaternion q (w, x, y, z)."""
    w, u = q[0], numpy.array(q[1:])
    return v + 2 * numpy.cross(u, numpy.cross(u, v) + w * numpy.array(v))


class KindsFiles(KindsCase):
    def make(self, shape, name="out", time=0.5, **more):
        self.write("run.toml", config(shape, time=time, trajectory='["gsd", "lammps", "vtk"]'))
        self.run_config("run.toml", name)
        with gsd.hoomd.open(self.path(f"{name}/trajectory.gsd"), "rb") as file:
            return file[-1]

    def test_shapes_in_gsd_files(self):
        def shape(name):
            return self.make(SHAPES[name], name.replace(" ", "_")).particles.type_shapes[0]

        self.assertEqual(shape("sphere"), {"type": "Sphere", "diameter": 2})
        capsule = shape("capsule")
        self.assertEqual(sorted(capsule), ["rounding_radius", "type", "vertices"])
        self.assertEqual(capsule["type"], "ConvexPolyhedron")
        self.assertEqual(capsule["vertices"], [[0, 0, -2 * capsule["rounding_radius"]], [0, 0, 2 * capsule["rounding_radius"]]])
        box = shape("rounded box")
        self.assertEqual((box["type"], len(box["vertices"])), ("ConvexPolyhedron", 8))
        self.assertAlmostEqual(box["rounding_radius"] / box["vertices"][-1][0], 0.2, 12)
        pyramid = shape("pyramid")
        self.assertEqual((len(pyramid["vertices"]), pyramid["rounding_radius"]), (5, 0))
        # Cylinders and cones nearly: with vertices on their rims.
        disc = shape("rounded disc")
        self.assertEqual((disc["type"], len(disc["vertices"])), ("ConvexPolyhedron", 96))
        radii = numpy.linalg.norm(numpy.array(disc["vertices"])[:, :2], axis=1)
        numpy.testing.assert_allclose(disc["rounding_radius"] / radii, 0.25, rtol=1e-12)
        cone = numpy.array(shape("cone")["vertices"])
        self.assertEqual(len(cone), 49)
        self.assertAlmostEqual(cone[-1, 2] / cone[0, 2], -3, 12)

    def test_own_files_are_read_to_the_bit(self):
        for k, (name, shape) in enumerate(list(SHAPES.items()) + [("mixture", MIXTURE)]):
            with self.subTest(name):
                self.make(shape, f"out{k}")
                # Nothing but the file is needed; but of bodies of several sizes.
                text = f'[start]\nfile = "out{k}/trajectory.gsd"\n[equilibration]\ntime = 0\n[production]\ntime = 0\n'
                if name == "mixture":
                    text = config(shape, time=0).replace("time = 0.5", "time = 0").replace("packing_fraction = 0.2\n", "")
                    text += f'[start]\nfile = "out{k}/trajectory.gsd"\n'
                    text = text.replace("[]", '["gsd"]')
                else:
                    text += '[output]\ntrajectory = ["gsd"]\n'
                self.write("again.toml", text)
                self.run_config("again.toml", f"again{k}")
                with gsd.hoomd.open(self.path(f"out{k}/trajectory.gsd"), "rb") as a, gsd.hoomd.open(
                    self.path(f"again{k}/trajectory.gsd"), "rb"
                ) as b:
                    for key in ["position", "rotation", "velocity", "angular_velocity"]:
                        numpy.testing.assert_array_equal(a[-1].log[f"particles/hardbody/{key}"], b[0].log[f"particles/hardbody/{key}"])
                    numpy.testing.assert_array_equal(a[-1].log["hardbody/species"], b[0].log["hardbody/species"])

    def test_check_and_analyze(self):
        for k, (name, shape) in enumerate([
            ("capsule", SHAPES["capsule"]), ("pyramid", SHAPES["pyramid"]), ("cone", SHAPES["rounded cone"]), ("mixture", MIXTURE)
        ]):
            with self.subTest(name):
                self.make(shape, f"out{k}")
                result = self.hardbody("check", f"out{k}/trajectory.gsd")
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                self.assertNotIn("not tested", result.stdout)
                result = self.hardbody("analyze", f"out{k}/trajectory.gsd", "--out", f"analysis{k}")
                self.assertEqual(result.returncode, 0, result.stderr)
                report = self.hardbody("report", f"out{k}", "-o", "report.html")
                self.assertEqual(report.returncode, 0, report.stderr)
                # Dumps tell no such shapes.
                result = self.hardbody("check", f"out{k}/trajectory.lammpstrj")
                self.assertEqual(result.returncode, 1, result.stdout)
                self.assertIn("not tested: overlaps: ", result.stdout)

    def test_edited_shapes_are_refused(self):
        self.make(SHAPES["capsule"])
        data = self.bytes_of("out/trajectory.gsd")
        self.assertEqual(data.count(b'"rounding_radius": 0.6'), 1)
        with open(self.path("edited.gsd"), "wb") as file:
            file.write(data.replace(b'"rounding_radius": 0.6', b'"rounding_radius": 0.5'))
        self.assert_refused(self.hardbody("check", "edited.gsd"), "the shape of type 0", "edited")

    def write_frame(self, name, shapes, positions, orientations=None, typeid=None, box=12):
        frame = gsd.hoomd.Snapshot()
        frame.configuration.box = [box, box, box, 0, 0, 0]
        frame.particles.N = len(positions)
        frame.particles.position = positions
        frame.particles.types = [chr(65 + k) for k in range(len(shapes))]
        frame.particles.typeid = typeid or [0] * len(positions)
        frame.particles.type_shapes = shapes
        if orientations:
            frame.particles.orientation = orientations
        with gsd.hoomd.open(self.path(name), "wb") as file:
            file.append(frame)

    def started(self, name, more=""):
        """The species and the first frame of a run from a file."""
        self.write("start.toml", f'{more}[start]\nfile = "{name}"\n[equilibration]\ntime = 0\n[production]\ntime = 0.2\n'
                                 '[output]\ntrajectory = ["gsd"]\nframes = 2\n')
        result = self.hardbody("run", "start.toml", "--out", "out", "--force")
        self.assertEqual(result.returncode, 0, result.stderr)
        with gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
            return self.summary("out")["species"], file[0], result.stderr

    def test_files_of_other_programs(self):
        places = [[0, 0, 0], [4, 1, 0], [-3, 4, 2]]
        capsule = {"type": "ConvexPolyhedron", "rounding_radius": 0.5, "vertices": [[0, 0, 1], [0, 0, -1]]}
        cube = {"type": "ConvexPolyhedron", "rounding_radius": 0.1,
                "vertices": [[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]}
        ball = {"type": "Sphere", "diameter": 1}
        self.write_frame("file.gsd", [capsule, cube, ball], places, ROTATE, [0, 1, 2])
        species, frame, said = self.started("file.gsd")
        self.assertEqual([s["kind"] for s in species], ["capsule", "polyhedron", "ellipsoid"])
        self.assertEqual(species[0]["shape"], {"kind": "capsule", "half_length": 1, "radius": 0.5})
        self.assertEqual((len(species[1]["shape"]["vertices"]), species[1]["shape"]["rounding"]), (8, 0.1))
        numpy.testing.assert_allclose(frame.particles.position, places, atol=1e-6)
        numpy.testing.assert_allclose(frame.particles.orientation, ROTATE, atol=1e-6)
        self.assertEqual(self.hardbody("check", "file.gsd").returncode, 0)
        # A box is the polyhedron of its corners; another one is refused.
        more = """[system]
[[species]]
kind = "capsule"
length = 2
diameter = 1
number = 1
[[species]]
kind = "box"
edges = [1, 1, 1]
rounding = 0.1
number = 1
[[species]]
kind = "sphere"
diameter = 1
number = 1
"""
        species, frame, said = self.started("file.gsd", more)
        self.assertEqual([s["kind"] for s in species], ["capsule", "box", "sphere"])
        self.write("bad.toml", more.replace("length = 2", "length = 2.1") + '[start]\nfile = "file.gsd"\n')
        self.assert_refused(self.hardbody("run", "bad.toml", "--out", "bad"), "is capsule of half-length 1", "in the config capsule")

    def test_polyhedra_in_any_frame(self):
        """Bodies are moved to the centre of mass and principal axes: their corners stay where they are."""
        corners = numpy.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0], [1, 0.5, 3.0], [1, 0.7, 3]])
        shape = {"type": "ConvexPolyhedron", "rounding_radius": 0, "vertices": corners.tolist()}
        places = [[0, 0, 0], [4, 1, 0], [-3, 4, 5.9]]
        self.write_frame("file.gsd", [shape], places, ROTATE)
        species, frame, said = self.started("file.gsd")
        self.assertIn("moved to the centres of mass and principal axes", said)
        moved = numpy.array(species[0]["shape"]["vertices"])
        for i, place in enumerate(places):
            before = sorted(tuple(numpy.round(place + rotated(ROTATE[i], c), 4)) for c in corners)
            after = []
            for c in moved:
                x = frame.particles.position[i].astype(float) + rotated(frame.particles.orientation[i].astype(float), c)
                x += 12 * numpy.round((numpy.array(place) - x) / 12)
                after.append(tuple(numpy.round(x, 4)))
            numpy.testing.assert_allclose(before, sorted(after), atol=3e-4)

    def test_unknown_shapes_stay_unknown(self):
        tilted = {"type": "ConvexPolyhedron", "rounding_radius": 0.5, "vertices": [[0, 0, 1], [0, 1, -1]]}
        for shape in [tilted, {"type": "Mesh", "vertices": []}, {"type": "ConvexPolyhedron", "vertices": [[0, 0, 0]]}]:
            self.write_frame("file.gsd", [shape], [[0, 0, 0], [4, 1, 0]], ROTATE[:2])
            self.write("start.toml", '[start]\nfile = "file.gsd"\n')
            self.assert_refused(self.hardbody("run", "start.toml", "--out", "out"), "no shape of type A")
        flat = {"type": "ConvexPolyhedron", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}
        self.write_frame("file.gsd", [flat], [[0, 0, 0], [4, 1, 0]], ROTATE[:2])
        self.assert_refused(self.hardbody("check", "file.gsd"), "the shape of type 0", "in a plane")

    def test_superellipsoids_as_other_programs_have_them(self):
        """Without the doubles of this program a superellipsoid is a polyhedron; the config may say what it is."""
        superball = 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1.5]\nexponents = [0.5, 0.5]\n'
        frame = self.make(superball)
        for key in list(frame.log):
            del frame.log[key]
        with gsd.hoomd.open(self.path("file.gsd"), "wb") as file:
            file.append(frame)
        shape = superball.replace("[1, 1, 1.5]", str([(1 / 1.5) ** (1 / 3)] * 2 + [1.5 * (1 / 1.5) ** (1 / 3)]))
        species, first, said = self.started("file.gsd", f"[system]\npacking_fraction = 0.2\n[[species]]\n{shape}number = 64\n")
        numpy.testing.assert_allclose(first.particles.orientation, frame.particles.orientation, atol=1e-5)
        self.write("start.toml", f'[[species]]\n{shape}number = 64\n[start]\nfile = "file.gsd"\n')
        self.assert_refused(self.hardbody("run", "start.toml", "--out", "bad"), "system.packing_fraction is missing")

    def test_dumps(self):
        """Orientations and no shapes, which the config has to say."""
        self.make(SHAPES["capsule"])
        rows = self.read("out/trajectory.lammpstrj").splitlines()
        self.assertEqual(rows[9].split()[9:14], ["0", "0", "0", "1", "1"])
        result = self.hardbody("analyze", "out/trajectory.lammpstrj", "--out", "analysis", "--time-step", "0.1")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.write("start.toml", '[start]\nfile = "out/trajectory.lammpstrj"\n')
        self.assert_refused(self.hardbody("run", "start.toml", "--out", "bad"), "no shape of type 1")
        shape = self.summary("out")["state"]["shape"]
        text = f'[[species]]\nkind = "capsule"\nlength = {2 * shape["half_length"]}\ndiameter = {2 * shape["radius"]}\nnumber = 64\n'
        self.write("start.toml", text + '[start]\nfile = "out/trajectory.lammpstrj"\n[equilibration]\ntime = 0\n[production]\ntime = 0.1\n'
                                        '[system]\npacking_fraction = 0.2\n')
        self.run_config("start.toml", "again")
        self.assert_sound("again")


class KindsRefused(KindsCase):
    def refusal(self, shape, *words, settings=()):
        self.write("run.toml", config(shape))
        result = self.hardbody("run", "run.toml", "--out", "out", *(["--set", *settings] if settings else []))
        with self.subTest(shape):
            self.assert_refused(result, *words)
            self.assertFalse(os.path.exists(self.path("out")))

    def test_bad_values(self):
        capsule = 'kind = "capsule"\n'
        box = 'kind = "box"\n'
        hull = 'kind = "polyhedron"\n'
        cylinder = 'kind = "cylinder"\n'
        cone = 'kind = "cone"\n'
        square = "[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]"
        tetrahedron = "[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]"
        for shape, *words in [
            ('kind = "ball"\n', "shape.kind is \"ball\"", '"capsule", "box", "polyhedron", "cylinder", "cone"'),
            ('kind = "sphere"\n', "shape.diameter of a sphere is missing", "a number"),
            ('kind = "sphere"\ndiameter = 0\n', "shape.diameter is 0"),
            ('kind = "sphere"\ndiameter = nan\n', "shape.diameter is nan"),
            ('kind = "sphere"\ndiameter = 1\nrounding = 0.1\n', "shape.rounding is 0.1; accepted: no rounding of a sphere, "
             'or kind = "box" or "polyhedron" or "cylinder" or "cone"'),
            ("aspect_ratio = 2\nrounding = 0.1\n", "accepted: no rounding of an ellipsoid"),
            ("length = 2\ndiameter = 1\n", 'shape.length is 2; accepted: no length of an ellipsoid, or kind = "capsule" or "cylinder" or "cone"'),
            (capsule + "length = 2\n", "shape.diameter of a capsule is missing"),
            (capsule + "diameter = 2\n", "shape.length of a capsule is missing", "between the centres of the caps"),
            (capsule + "diameter = 1\nlength = -1\n", "shape.length is -1"),
            (capsule + "diameter = 1\nlength = 200\n", "shape.length is 200", "99 times the diameter"),
            (capsule + "diameter = 1\nlength = inf\n", "shape.length is inf"),
            (capsule + 'diameter = 1\nlength = "2"\n', 'shape.length is "2"'),
            (capsule + "aspect_ratio = 3\n", "shape.aspect_ratio is 3; accepted: no aspect_ratio of a capsule, or kind = "
             '"ellipsoid" or "superellipsoid"'),
            (capsule + "diameter = 1\nlenght = 1\n", "unknown key shape.lenght, did you mean shape.length?"),
            (cylinder + "length = 2\n", "shape.diameter of a cylinder is missing"),
            (cylinder + "diameter = 2\n", "shape.length of a cylinder is missing", "a number"),
            (cylinder + "diameter = 2\nlength = 0\n", "shape.length is 0", "0.02 to 200, 1/100 to 100 diameters"),
            (cylinder + "diameter = 1\nlength = 101\n", "shape.length is 101", "0.01 to 100"),
            (cylinder + "diameter = 1\nlength = 1\nrounding = -1\n", "shape.rounding is -1"),
            (cylinder + "diameter = 1\nlength = 1\nrounding = 101\n", "shape.rounding is 101", "100 times the size"),
            (cylinder + 'solid = "cube"\n', 'shape.solid is "cube"; accepted: no solid of a cylinder'),
            (cone + "length = 1\n", "shape.diameter of a cone is missing"),
            (cone + "length = 0.02\ndiameter = 1\nrounding = 10\n", "shape.rounding is 10", "centre of mass is well inside"),
            (cone + "diameter = 1\nlength = nan\n", "shape.length is nan"),
            (cone + "diameter = 1\nlength = 60\n", "shape.length is 60", "1/50 to 50 diameters"),
            (box, "shape.edges of a box is missing", "three positive finite numbers"),
            (box + "edges = [1, 1]\n", "shape.edges is"),
            (box + "edges = [1, 1, 0]\n", "shape.edges is", "three positive finite numbers"),
            (box + "edges = [1, 1, 101]\n", "edges of which none is more than 100 times another"),
            (box + "edges = [1, 1, nan]\n", "shape.edges is"),
            (box + "edges = [1, 1, 1]\nrounding = -0.1\n", "shape.rounding is -0.1"),
            (box + "edges = [1, 1, 1]\nrounding = nan\n", "shape.rounding is nan"),
            (box + "edges = [1, 1, 1]\nrounding = 1000\n", "shape.rounding is 1000", "100 times the size"),
            (hull, "the section [shape] needs shape.vertices or shape.solid and has none"),
            (hull + f'solid = "cube"\nvertices = [{tetrahedron}]\n', "accepted: only one of them"),
            (hull + 'solid = "cubes"\n', 'shape.solid is "cubes", did you mean "cube"?', "tetrahedron, cube"),
            (hull + "solid = 3\n", "shape.solid is 3"),
            (hull + "vertices = 3\n", "shape.vertices is 3", "4 to 1000 points"),
            (hull + "vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n", "shape.vertices is", "4 to 1000 points"),
            (hull + f"vertices = [{tetrahedron}, [1, 2]]\n", "whose point 5 is [1, 2]"),
            (hull + f"vertices = [{tetrahedron}, [1, 2, nan]]\n", "whose point 5 is"),
            (hull + f"vertices = [{square}]\n", "shape.vertices is", "which all lie in a plane"),
            (hull + "vertices = [[1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, 1]]\n", "shape.vertices is"),
            (hull + "vertices = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n", "all of them in one point"),
            (hull + f"vertices = [{tetrahedron}, [0, 0, 0.25]]\n", "point 5, (0, 0, 0.25), is no corner"),
            (hull + f"vertices = [{tetrahedron}, [1, 1, 1]]\n", "point 5, (1, 1, 1), is no corner", "given twice"),
            (hull + f"vertices = [{tetrahedron}, [1, 0, 0]]\n", "point 5, (1, 0, 0), is no corner"),
            (hull + "vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.001]]\n", "shape.vertices is", "at most 100"),
        ]:
            self.refusal(shape, *words)

    def test_the_papers_finder(self):
        for name in ["capsule", "box", "pyramid", "cylinder"]:
            self.refusal(SHAPES[name], 'dynamics.finder is "bracketing"', 'accepted: "certified"',
                         settings=["dynamics.finder=bracketing"])
        self.refusal(SHAPES["capsule"], 'dynamics.inertia is "paper"', settings=["dynamics.inertia=paper"])
        self.write("run.toml", config(SHAPES["sphere"], time=0.2))
        self.run_config("run.toml", "out", "--set", "dynamics.finder=bracketing")

    def test_mixtures(self):
        self.refusal(MIXTURE.replace("length = 1.5", "length = 1e4"), "species[1].length is 1")
        self.refusal(MIXTURE.replace("length = 1.5\n", ""), "species[1].length of a capsule is missing")
        self.refusal(MIXTURE.replace("edges = [1, 1, 1]", "edges = [1e-4, 1e-4, 1e-4]"), "species[2].edges")


if __name__ == "__main__":
    unittest.main()
