"""Trajectories as other programs read them, and what the program makes of them again.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_trajectory.py [TestClass[.test]]

Needs Debian's python3-gsd, python3-mdanalysis and python3-vtk9. HARDBODY_FULL=1: more kills.
"""

import os
import random
import signal
import subprocess
import time
import unittest
import warnings

import numpy

warnings.simplefilter("ignore")
import gsd.fl
import gsd.hoomd
import gsd.pygsd
import MDAnalysis
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from test_cli import HARDBODY, SMALL, Case

FULL = os.environ.get("HARDBODY_FULL") == "1"

ALL = '[output]\ntrajectory = ["gsd", "lammps", "vtk"]\nframes = 6\n'

SUPERBALLS = SMALL.replace("aspect_ratio = 2", 'kind = "superellipsoid"\nsemi_axes = [1, 0.8, 0.6]\nexponents = [0.5, 1.3]')
MIXTURE = """seed = 3
[system]
packing_fraction = 0.2
[[species]]
semi_axes = [0.5, 0.5, 1.5]
number = 30
mass = 2
[[species]]
kind = "superellipsoid"
semi_axes = [0.7, 0.7, 0.7]
exponents = [0.5, 0.5]
number = 30
[[species]]
semi_axes = [0.6, 0.6, 0.6]
number = 20
sizes = "uniform"
width = 0.1
[equilibration]
time = 1
[production]
time = 2
[output]
"""

FAMILIES = {
    "rods": SMALL,
    "discs that spin": SMALL.replace("aspect_ratio = 2", "aspect_ratio = 0.5") + '[dynamics]\ninertia = "uniform"\n',
    "three axes": SMALL.replace("aspect_ratio = 2", "semi_axes = [1, 0.8, 0.6]"),
    "superellipsoids": SUPERBALLS,
    "mixture": MIXTURE,
}


def matrices(q):
    """Of quaternions w, x, y, z."""
    w, x, y, z = numpy.asarray(q, dtype=float).T
    return numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)


def product(p, q):
    """Of quaternions."""
    (a, u), (b, v) = [(x[:, :1], x[:, 1:]) for x in (numpy.asarray(p, float), numpy.asarray(q, float))]
    scalar = a * b - numpy.sum(u * v, axis=1, keepdims=True)
    return numpy.hstack([scalar, a * v + b * u + numpy.cross(u, v)])


class Frames:
    """The doubles of a trajectory of ours, by python3-gsd."""

    def __init__(self, path):
        with gsd.hoomd.open(path, "rb") as file:
            self.frames = list(file)
        first = self.frames[0].log
        self.box = float(first["hardbody/box"][0])
        self.species = first["hardbody/species"]
        self.group = first["particles/hardbody/group"]
        self.time = numpy.array([f.log["hardbody/time"][0] for f in self.frames])
        self.position = numpy.array([self.of(f, "position") for f in self.frames])
        self.rotation = numpy.array([self.of(f, "rotation").reshape(-1, 3, 3) for f in self.frames])
        self.velocity = numpy.array([self.of(f, "velocity") for f in self.frames])
        self.omega = numpy.array([self.of(f, "angular_velocity") for f in self.frames])

    @staticmethod
    def of(frame, name):
        return frame.log[f"particles/hardbody/{name}"]


class Trajectories(Case):
    def run_with(self, out, config, output=ALL):
        return self.run_small(out, config=config.replace("[output]\n", output))


class OtherPrograms(Trajectories):
    """Each family of bodies, read back by what its users have."""

    def families(self):
        for name, config in FAMILIES.items():
            with self.subTest(name):
                out = name.replace(" ", "_")
                self.run_with(out, config)
                yield out, Frames(self.path(f"{out}/trajectory.gsd"))

    def test_gsd(self):
        for out, exact in self.families():
            self.assertEqual(len(exact.frames), 6)
            end = 2 if "mixture" in out else 5
            numpy.testing.assert_array_equal(exact.time, [end * k / 5 for k in range(6)])
            n = len(exact.group)
            for k, frame in enumerate(exact.frames):
                particles = frame.particles
                self.assertEqual(frame.configuration.step, k)
                self.assertEqual(frame.configuration.dimensions, 3)
                self.assertEqual(particles.N, n)
                L = numpy.float32(exact.box)
                numpy.testing.assert_array_equal(frame.configuration.box, [L, L, L, 0, 0, 0])
                # In the box, to rounding; 6e-8 is half a unit in the last place of a 32-bit 1.
                self.assertTrue(numpy.all(particles.position >= -L / 2) and numpy.all(particles.position < L / 2))
                apart = particles.position - exact.position[k]
                apart -= exact.box * numpy.round(apart / exact.box)
                self.assertLess(numpy.abs(apart).max(), 6e-8 * exact.box)
                self.assertLess(numpy.abs(matrices(particles.orientation) - exact.rotation[k]).max(), 5e-7)
                self.assertLess(numpy.abs(particles.velocity - exact.velocity[k]).max(), 1e-6)
                # HOOMD's angular momentum: q* p / 2 = (0, L), L along the body's axes.
                conjugate = particles.orientation * [1, -1, -1, -1]
                L_body = product(conjugate, particles.angmom) / 2
                omega_body = numpy.einsum("nji,nj->ni", exact.rotation[k], exact.omega[k])
                inertia = exact.species[particles.typeid, 7:10]
                self.assertLess(numpy.abs(L_body[:, 1:] - inertia * omega_body).max(), 5e-6)
                self.assertLess(numpy.abs(L_body[:, 0]).max(), 5e-6)
                numpy.testing.assert_allclose(particles.moment_inertia, inertia, rtol=1e-6)
                numpy.testing.assert_allclose(particles.mass, exact.species[particles.typeid, 6], rtol=1e-6)
                energy = 0.5 * (particles.mass * (exact.velocity[k] ** 2).sum(axis=1)).sum()
                energy += 0.5 * (inertia * omega_body**2).sum()
                self.assertAlmostEqual(frame.log["hardbody/energy"][0] / energy, 1, delta=1e-6)
                self.assertEqual(numpy.isnan(frame.log["hardbody/Z"][0]), k == 0)

    def test_images(self):
        """Unwrapped by images, bodies go on across the box's faces: no jump is longer than they can fly."""
        self.run_with("out", SMALL, ALL.replace("frames = 6", "frames = 101"))
        exact = Frames(self.path("out/trajectory.gsd"))
        unwrapped = numpy.array([f.particles.position + f.particles.image * exact.box for f in exact.frames])
        self.assertGreater(max(numpy.abs(f.particles.image).max() for f in exact.frames), 0)
        jumps = numpy.linalg.norm(numpy.diff(unwrapped, axis=0), axis=2)
        self.assertLess(jumps.max(), 0.05 * 8)  # eight times the thermal velocity

    def test_shapes(self):
        for out, exact in self.families():
            particles = exact.frames[0].particles
            self.assertEqual(len(particles.types), len(exact.species))
            self.assertEqual(len(set(particles.types)), len(particles.types))
            for shape, row in zip(particles.type_shapes, exact.species):
                kind, axes = row[0], row[1:4]
                e1, e2 = row[4:6]
                if kind == 1:
                    self.assertEqual(shape["type"], "ConvexPolyhedron")
                    x, y, z = (numpy.abs(shape["vertices"]) / axes).T
                    level = (x ** (2 / e2) + y ** (2 / e2)) ** (e2 / e1) + z ** (2 / e1)
                    numpy.testing.assert_allclose(level, 1, atol=1e-4)  # written with 7 digits, raised to up to 8
                    self.assertGreater(len(level), 100)
                    numpy.testing.assert_allclose(numpy.abs(shape["vertices"]).max(axis=0), axes, rtol=1e-6)
                elif len(set(axes)) == 1:
                    self.assertEqual(shape, {"type": "Sphere", "diameter": 2 * axes[0]})
                else:
                    self.assertEqual(shape, {"type": "Ellipsoid", "a": axes[0], "b": axes[1], "c": axes[2]})
        self.assertEqual(list(exact.group), [0] * 30 + [1] * 30 + [2] * 20)  # the mixture's, the last
        self.assertEqual(len(exact.species), 2 + 20)

    def test_other_readers_of_gsd(self):
        self.run_with("out", MIXTURE)
        exact = Frames(self.path("out/trajectory.gsd"))
        with open(self.path("out/trajectory.gsd"), "rb") as file:  # without the C library
            read = gsd.hoomd.HOOMDTrajectory(gsd.pygsd.GSDFile(file))
            self.assertEqual(len(read), 6)
            numpy.testing.assert_array_equal(read[5].particles.position, exact.frames[5].particles.position)
        universe = MDAnalysis.Universe(self.path("out/trajectory.gsd"))
        self.assertEqual(universe.trajectory.n_frames, 6)
        self.assertEqual(universe.atoms.n_atoms, 80)
        for k, step in enumerate(universe.trajectory):
            numpy.testing.assert_array_equal(step.positions, exact.frames[k].particles.position)
            numpy.testing.assert_allclose(step.dimensions, [exact.box] * 3 + [90] * 3, rtol=1e-6)

    def test_lammps(self):
        for out, exact in self.families():
            path = self.path(f"{out}/trajectory.lammpstrj")
            universe = MDAnalysis.Universe(path, format="LAMMPSDUMP", topology_format="LAMMPSDUMP")
            self.assertEqual(universe.trajectory.n_frames, 6)
            for k, step in enumerate(universe.trajectory):
                self.assertEqual(step.data["step"], k)
                numpy.testing.assert_allclose(step.dimensions, [exact.box] * 3 + [90] * 3, rtol=1e-6)
                apart = step.positions - exact.position[k]  # MDAnalysis moves the box's corner to the origin
                self.assertLess(numpy.ptp(apart, axis=0).max(), 1e-5)
            # The text itself has every bit of the positions.
            n = len(exact.group)
            lines = self.read(f"{out}/trajectory.lammpstrj").splitlines()
            self.assertEqual(len(lines), 6 * (n + 9))
            names = lines[8].split()[2:]
            self.assertEqual(names, "id type x y z quatw quati quatj quatk shapex shapey shapez "
                             "SuperquadricRoundness.Phi SuperquadricRoundness.Theta".split())
            for k in range(6):
                rows = numpy.array([[float(x) for x in line.split()] for line in lines[k * (n + 9) + 9:(k + 1) * (n + 9)]])
                numpy.testing.assert_array_equal(rows[:, 0], numpy.arange(n) + 1)
                numpy.testing.assert_array_equal(rows[:, 1], exact.group + 1)
                numpy.testing.assert_array_equal(rows[:, 2:5], exact.position[k])
                self.assertLess(numpy.abs(matrices(rows[:, 5:9]) - exact.rotation[k]).max(), 1e-14)
                species = exact.species[exact.frames[k].particles.typeid]
                numpy.testing.assert_array_equal(rows[:, 9:12], 2 * species[:, 1:4])
                numpy.testing.assert_array_equal(rows[:, 12:14], species[:, [5, 4]])

    def test_vtk(self):
        for out, exact in self.families():
            reader = vtkXMLPolyDataReader()
            reader.SetFileName(self.path(f"{out}/trajectory.vtp"))
            reader.UpdateInformation()
            self.assertEqual(reader.GetNumberOfTimeSteps(), 6)
            head = self.bytes_of(f"{out}/trajectory.vtp")
            times = head.split(b'TimeValues="')[1].split(b'"')[0].split()
            numpy.testing.assert_array_equal([float(t) for t in times], exact.time)
            self.assertTrue(head.endswith(b"\n</AppendedData>\n</VTKFile>\n"))
            for k in [0, 5, 2, 3, 0]:  # back and forth
                reader.SetTimeStep(k)
                reader.Update()
                data = reader.GetOutput().GetPointData()
                n = reader.GetOutput().GetNumberOfPoints()
                self.assertEqual(n, len(exact.group))
                array = lambda name: numpy.array([data.GetArray(name).GetTuple(i) for i in range(n)])
                points = numpy.array([reader.GetOutput().GetPoint(i) for i in range(n)])
                axes = exact.species[exact.frames[k].particles.typeid][:, 1:4]
                tensor = numpy.einsum("nij,nj,nkj->nik", exact.rotation[k], axes, exact.rotation[k])
                numpy.testing.assert_allclose(points, exact.position[k], atol=1e-6)
                numpy.testing.assert_allclose(array("shape").reshape(-1, 3, 3), tensor, atol=1e-6)
                numpy.testing.assert_allclose(array("semi_axes"), axes, rtol=1e-6)
                numpy.testing.assert_allclose(matrices(array("orientation")), exact.rotation[k], atol=5e-7)
                numpy.testing.assert_allclose(array("velocity"), exact.velocity[k], atol=1e-6)
                numpy.testing.assert_array_equal(array("species")[:, 0], exact.group)
            self.assertIsNotNone(data.GetTensors())


class InARun(Trajectories):
    def test_changes_nothing(self):
        """With frames and without: the same collisions, observables and last state."""
        for name, config in FAMILIES.items():
            with self.subTest(name):
                base = config.replace("[output]\n", "[output]\nevents = 1000\n") if "events" not in config else config
                self.run_small(f"{name}_without", config=base)
                self.run_small(f"{name}_with", config=base.replace("[output]\n", ALL.replace("6", "37")))
                for file in ["events.csv"] + [f"observables/{f}" for f in os.listdir(self.path(f"{name}_with/observables"))]:
                    self.assertEqual(self.bytes_of(f"{name}_with/{file}"), self.bytes_of(f"{name}_without/{file}"), file)
                counters = [self.summary(f"{name}_{way}")["counters"] for way in ["with", "without"]]
                self.assertEqual(*counters)

    def test_target_error(self):
        """Production ends before its longest time: so do the frames, at its end, and nothing else changes."""
        config = SMALL.replace("time = 5\n", 'time = "auto"\ntarget_error = 0.08\n').replace("time = 1\n", 'time = "auto"\n')
        self.run_small("without", config=config)
        self.run_with("with", config, ALL.replace("6", "1001"))
        summary = self.summary("with")
        self.assertTrue(summary["target_error"]["reached"])
        self.assertEqual(summary["observables"], self.summary("without")["observables"])
        times = Frames(self.path("with/trajectory.gsd")).time
        end = summary["time"]["production"]
        self.assertEqual(times[-1], end)
        numpy.testing.assert_array_equal(times[:-1], [5000 * k / 1000 for k in range(len(times) - 1)])
        self.assertLessEqual(end - times[-2], 5)

    def test_of_an_earlier_run_are_removed(self):
        self.run_with("out", SMALL)
        self.run_small("out", "--force")
        self.assertEqual([f for f in os.listdir(self.path("out")) if "trajectory" in f], [])

    def test_any_subset(self):
        for formats, file in [("gsd", "gsd"), ("lammps", "lammpstrj"), ("vtk", "vtp")]:
            self.run_with(formats, SMALL, f'[output]\ntrajectory = ["{formats}"]\nframes = 2\n')
            self.assertEqual([f for f in os.listdir(self.path(formats)) if "trajectory" in f], [f"trajectory.{file}"])


class Killed(Trajectories):
    def test_at_any_moment(self):
        """kill -9 of a run that writes many frames: every reader opens what is there, and all of it is whole."""
        config = SMALL.replace("time = 5\n", "time = 400\n")
        self.write("run.toml", config.replace("[output]\n", '[output]\ntrajectory = ["gsd"]\nframes = 5001\n'))
        draws = random.Random(1)
        frames = []
        for k in range(50 if FULL else 12):
            out = f"out{k}"
            process = subprocess.Popen([HARDBODY, "run", "run.toml", "--out", out], cwd=self.here,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            path = self.path(f"{out}/trajectory.gsd")
            deadline = time.monotonic() + 60
            while not os.path.exists(path) and process.poll() is None:
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.001)
            time.sleep(draws.uniform(0, 0.5))
            process.send_signal(signal.SIGKILL)
            process.wait()
            if os.path.getsize(path) == 0:
                continue
            with gsd.hoomd.open(path, "rb") as file:
                frames.append(len(file))
                for index in {0, len(file) // 2, len(file) - 1} - {-1}:
                    self.assertEqual(file[index].log["hardbody/time"][0], 400 * index / 5000)
                    self.assertTrue(numpy.all(numpy.isfinite(file[index].particles.position)))
                    norms = numpy.linalg.norm(file[index].particles.orientation, axis=1)
                    self.assertLess(abs(norms - 1).max(), 1e-6)
        print(f"killed after {sorted(frames)} frames")
        self.assertGreater(max(frames), 10)


if __name__ == "__main__":
    unittest.main()
