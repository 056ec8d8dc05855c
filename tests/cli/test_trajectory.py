"""Trajectories as other programs read them, and what the program makes of them again.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_trajectory.py [TestClass[.test]]

Needs Debian's python3-gsd, python3-mdanalysis, python3-scipy and python3-vtk9. HARDBODY_FULL=1: 50 kills, not 20.
"""

import csv
import itertools
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest
import warnings

import numpy
import scipy.interpolate
import scipy.optimize

warnings.simplefilter("ignore")
import gsd.fl
import gsd.hoomd
import gsd.pygsd

from test_cli import FULL, HARDBODY, SMALL, Case

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import order_by_numpy


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
        import MDAnalysis  # takes longer than most tests

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
        import MDAnalysis

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
                             "SuperquadricRoundness.Phi SuperquadricRoundness.Theta ix iy iz".split())
            images = numpy.array([f.particles.image for f in exact.frames])
            for k in range(6):
                rows = numpy.array([[float(x) for x in line.split()] for line in lines[k * (n + 9) + 9:(k + 1) * (n + 9)]])
                numpy.testing.assert_array_equal(rows[:, 0], numpy.arange(n) + 1)
                numpy.testing.assert_array_equal(rows[:, 1], exact.group + 1)
                numpy.testing.assert_array_equal(rows[:, 2:5], exact.position[k])
                self.assertLess(numpy.abs(matrices(rows[:, 5:9]) - exact.rotation[k]).max(), 1e-14)
                species = exact.species[exact.frames[k].particles.typeid]
                numpy.testing.assert_array_equal(rows[:, 9:12], 2 * species[:, 1:4])
                numpy.testing.assert_array_equal(rows[:, 12:14], species[:, [5, 4]])
                numpy.testing.assert_array_equal(rows[:, 14:], images[k])

    def test_vtk(self):
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

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

    def test_at_an_interval(self):
        """Times are decimal multiples of the interval, the last one within production; no frame is added at the end."""
        for every, production, times in [(0.1, 0.3, [0, 0.1, 0.2, 0.3]), (0.4, 1, [0, 0.4, 0.8]), (2, 1, [0])]:
            output = f'[output]\ntrajectory = ["gsd"]\nframes = 9\nframes_every = {every}\n'
            self.run_small("out", "--set", f"production.time={production}", config=SMALL.replace("[output]\n", output))
            self.assertEqual(list(Frames(self.path("out/trajectory.gsd")).time), times)
            shutil.rmtree(self.path("out"))
        # With a target error, too: the run ends before the frames do.
        output = '[output]\ntrajectory = ["gsd"]\nframes = 9\nframes_every = 1\n'
        text = SMALL.replace("[output]\n", output).replace("time = 5\n", 'time = "auto"\ntarget_error = 0.5\n')
        self.run_small("out", config=text)
        self.assertEqual(list(Frames(self.path("out/trajectory.gsd")).time), list(range(9)))

    def test_of_an_earlier_run_are_removed(self):
        """And what hardbody analyze made of them; nothing else."""
        self.run_with("out", SMALL)
        self.assertEqual(self.hardbody("analyze", "out").returncode, 0)
        self.write("out/analysis/notes.txt", "mine")
        self.run_small("out", "--force")
        self.assertEqual([f for f in os.listdir(self.path("out")) if "trajectory" in f], [])
        self.assertEqual(os.listdir(self.path("out/analysis")), ["notes.txt"])

    def test_any_subset(self):
        for formats, file in [("gsd", "gsd"), ("lammps", "lammpstrj"), ("vtk", "vtp")]:
            self.run_with(formats, SMALL, f'[output]\ntrajectory = ["{formats}"]\nframes = 2\n')
            self.assertEqual([f for f in os.listdir(self.path(formats)) if "trajectory" in f], [f"trajectory.{file}"])


class LogTimes(Trajectories):
    def test_resumed(self):
        """Frames at logarithmic times, and all that is measured: after a kill the bytes of the undisturbed run."""
        output = '[output]\ntrajectory = ["gsd"]\nframes = 40\nframes_spacing = "log"\ncheckpoint_every = "0.1s"\n'
        config = MIXTURE.replace("time = 2\n", "time = 300\ncollective = true\n").replace("[output]\n", output)
        self.write("run.toml", config)
        self.assertEqual(self.hardbody("run", "run.toml", "--out", "whole").returncode, 0)
        process = subprocess.Popen([HARDBODY, "run", "run.toml", "--out", "killed"], cwd=self.here,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        path = self.path("killed/trajectory.gsd")
        deadline = time.monotonic() + 60
        while process.poll() is None and (not os.path.exists(path) or os.path.getsize(path) == 0):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        time.sleep(0.3)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.assertFalse(os.path.exists(self.path("killed/summary.json")), "the run is too short to be killed")
        resumed = self.hardbody("resume", "killed")
        self.assertEqual(resumed.returncode, 0, resumed.stderr)
        files = ["trajectory.gsd"] + sorted(
            f"observables/{name}" for name in os.listdir(self.path("whole/observables")))
        self.assertIn("observables/f_collective.csv", files)
        self.assertIn("observables/species.csv", files)
        for name in files:
            with open(self.path(f"whole/{name}"), "rb") as whole, open(self.path(f"killed/{name}"), "rb") as killed:
                self.assertTrue(whole.read() == killed.read(), name)


class Killed(Trajectories):
    def test_at_any_moment(self):
        """kill -9 of a run that writes many frames: every reader opens what is there, and all of it is whole."""
        config = SMALL.replace("time = 5\n", "time = 400\n")
        self.write("run.toml", config.replace("[output]\n", '[output]\ntrajectory = ["gsd"]\nframes = 5001\n'))
        draws = random.Random(1)
        frames = []
        for k in range(50 if FULL else 20):
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
                for index in {0, len(file) // 2, len(file) - 1} if len(file) > 0 else ():
                    self.assertEqual(file[index].log["hardbody/time"][0], 400 * index / 5000)
                    self.assertTrue(numpy.all(numpy.isfinite(file[index].particles.position)))
                    norms = numpy.linalg.norm(file[index].particles.orientation, axis=1)
                    self.assertLess(abs(norms - 1).max(), 1e-6)
                # Ours too, up to the same frame.
                if len(file) > 0:
                    result = self.hardbody("check", f"{out}/trajectory.gsd")
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertRegex(result.stdout, rf"frames +{len(file)}(;.*left out)?\n")
            shutil.rmtree(self.path(out))
        print(f"killed after {sorted(frames)} frames")
        self.assertGreater(max(frames), 10)


AGAIN = """[start]
file = "first/trajectory.gsd"
[equilibration]
time = 0
[production]
time = 0
[output]
trajectory = ["gsd", "lammps"]
"""

EXACT = ["particles/hardbody/" + name for name in ["position", "rotation", "velocity", "angular_velocity", "group"]] + [
    "hardbody/box", "hardbody/species"
]


class StartsFromFiles(Trajectories):
    """[start] file: runs that begin with a frame."""

    def same(self, first, k, second):
        with gsd.hoomd.open(self.path(first), "rb") as a, gsd.hoomd.open(self.path(second), "rb") as b:
            self.assertEqual(len(b), 1)
            for name in EXACT:
                numpy.testing.assert_array_equal(a[k].log[name], b[0].log[name], name)

    def test_the_same_doubles(self):
        for name in ["rods", "discs that spin", "three axes", "superellipsoids"]:
            with self.subTest(name):
                self.run_with("first", FAMILIES[name])
                self.run_small("last", config=AGAIN)
                self.same("first/trajectory.gsd", 5, "last/trajectory.gsd")
                self.run_small("second", "--set", "start.frame=2", config=AGAIN)
                self.same("first/trajectory.gsd", 2, "second/trajectory.gsd")
                # Its own config makes the same again, and so does that of the first run.
                self.run_small("its_own", config=self.read("second/config.toml"))
                self.same("first/trajectory.gsd", 2, "its_own/trajectory.gsd")
                shape = FAMILIES[name].replace("time = 5", "time = 0").replace("time = 1\n", "time = 0\n")
                shape = shape.replace("[output]\n", '[output]\ntrajectory = ["gsd"]\n')
                self.run_small("by_shape", config=shape + '[start]\nfile = "first/trajectory.gsd"\nframe = 0\n')
                self.same("first/trajectory.gsd", 0, "by_shape/trajectory.gsd")
                self.assertEqual(self.hardbody("check", "by_shape").returncode, 0)
                for out in ["first", "last", "second", "its_own", "by_shape"]:
                    shutil.rmtree(self.path(out))

    def test_frames_that_gsd_has_rewritten(self):
        """It leaves out what has its default: that all bodies are of the first type."""
        self.run_with("first", FAMILIES["rods"])
        with gsd.hoomd.open(self.path("first/trajectory.gsd"), "rb") as old:
            with gsd.hoomd.open(self.path("copy.gsd"), "wb") as new:
                for frame in old:
                    new.append(frame)
        self.run_small("again", config='[start]\nfile = "copy.gsd"\n[equilibration]\ntime = 0\n[production]\ntime = 0\n'
                       '[output]\ntrajectory = ["gsd"]\n')
        self.same("first/trajectory.gsd", 5, "again/trajectory.gsd")
        self.assertEqual(self.hardbody("check", "copy.gsd").returncode, 0)

    def test_the_file_is_not_overwritten(self):
        self.run_with("first", FAMILIES["rods"])
        self.write("again.toml", AGAIN)
        result = self.hardbody("run", "again.toml", "--out", "first", "--force")
        self.assert_refused(result, "first: --force would delete ", "first/trajectory.gsd", "accepted: another directory")
        self.assertEqual(self.hardbody("check", "first").returncode, 0)

    def test_names_that_toml_escapes(self):
        self.run_with("first", FAMILIES["rods"])
        shutil.copy(self.path("first/trajectory.gsd"), self.path('a "name"\\.gsd'))
        self.run_small("again", config=AGAIN.replace('"first/trajectory.gsd"', "'a \"name\"\\.gsd'"))
        self.assertEqual(self.hardbody("check", "again").returncode, 0)
        result = self.hardbody("run", "again/config.toml", "--out", "and_again")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_sizes_need_the_config(self):
        self.run_with("first", MIXTURE)
        self.write("again.toml", AGAIN)
        self.assert_refused(self.hardbody("run", "again.toml"), "different sizes", "accepted: [[species]] with sizes")
        again = MIXTURE.replace("time = 1\n", "time = 0\n").replace("time = 2\n", "time = 0\n")
        self.run_small("second", config=again + 'trajectory = ["gsd"]\n[start]\nfile = "first/trajectory.gsd"\n')
        self.same("first/trajectory.gsd", 5, "second/trajectory.gsd")

    def test_goes_on(self):
        """A run from a frame is a run: equilibrates, produces, is sound, can be stopped and resumed."""
        self.run_with("first", SMALL)
        self.run_small("second", config=AGAIN.replace("time = 0\n[out", "time = 3\nX[out").replace("X", ""))
        self.assertEqual(self.hardbody("check", "second").returncode, 0)
        self.assertGreater(self.summary("second")["counters"]["collisions"], 100)
        self.assertIn("start: 64 bodies of frame 5 of ", self.read("second/log.txt"))

    def test_reversed(self):
        """The bodies go back where they came from: rounding errors have grown by far less than 1e9."""
        self.run_with("first", SMALL)
        result = self.run_small("back", "--set", "start.reverse=true", "production.time=1", "output.frames=2", config=AGAIN)
        self.assertIn("velocities unchanged, reversed", result.stderr)
        there = Frames(self.path("first/trajectory.gsd"))
        back = Frames(self.path("back/trajectory.gsd"))
        numpy.testing.assert_array_equal(back.velocity[0], -there.velocity[5])
        numpy.testing.assert_array_equal(back.omega[0], -there.omega[5])
        apart = back.position[1] - there.position[4]
        apart -= there.box * numpy.round(apart / there.box)
        self.assertLess(numpy.abs(apart).max(), 1e-7)
        self.assertGreater(numpy.abs(there.position[5] - there.position[4]).max(), 0.1)
        numpy.testing.assert_allclose(back.rotation[1], there.rotation[4], atol=1e-7)
        numpy.testing.assert_allclose(back.velocity[1], -there.velocity[4], atol=1e-6)

    def test_the_same_body_by_another_formula(self):
        """A superellipsoid with exponents of 1 is the ellipsoid: the same moments but for rounding, so the same speeds."""
        shape = '[shape]\nkind = "ellipsoid"\nsemi_axes = [1.0, 0.8, 0.5]\n'
        self.run_with("first", SMALL.replace("[shape]\naspect_ratio = 2\n", shape))
        shape = shape.replace('"ellipsoid"', '"superellipsoid"\nexponents = [1.0, 1.0]')
        self.assertIn("velocities unchanged", self.run_small("second", config=shape + AGAIN).stderr)
        heavier = shape + "[dynamics]\ninertia = [0.3, 0.3, 0.4]\n" + AGAIN
        self.assertIn("velocities rescaled", self.run_small("third", config=heavier).stderr)

    def test_another_inertia_than_the_file_has(self):
        """That of [dynamics] counts for the species of the file; moments need sections of their own."""
        self.run_with("first", SMALL)
        result = self.run_small("second", config='[dynamics]\ninertia = "uniform"\n' + AGAIN)
        self.assertIn("translation rescaled to kT = 1, rotation rescaled to kT = 1, spin drawn", result.stderr)
        self.assertIn('inertia = "uniform"', self.read("second/config.toml"))
        self.assertEqual(self.run_small("third", config='[dynamics]\ninertia = "paper"\n' + AGAIN).returncode, 0)
        self.same("first/trajectory.gsd", 5, "third/trajectory.gsd")
        self.write("bad.toml", "[dynamics]\ninertia = [0.3, 0.3, 0.4]\n" + AGAIN)
        self.assert_refused(self.hardbody("run", "bad.toml", "--out", "bad"), "bad.toml:2: ", "moments in each [[species]]")
        self.write("bad.toml", '[dynamics]\ninertia = "foo"\n' + AGAIN)
        self.assert_refused(self.hardbody("run", "bad.toml", "--out", "bad"), "bad.toml:2: ", '"paper", "uniform"')

    def test_of_another_program(self):
        """Written by gsd.hoomd, with what HOOMD has: 32-bit numbers, shapes, types in any order, no velocities."""
        self.run_with("first", SMALL)
        exact = Frames(self.path("first/trajectory.gsd"))
        frame = gsd.hoomd.Snapshot()
        frame.configuration.box = [exact.box, exact.box, exact.box, 0, 0, 0]
        frame.particles.N = 64
        frame.particles.types = ["rods", "others"]
        frame.particles.typeid = [1, 0] * 32
        a, b, c = exact.species[0, 1:4]
        # Slightly smaller, so that rounding cannot make them overlap.
        shape = {"type": "Ellipsoid", "a": 0.99 * a, "b": 0.99 * b, "c": 0.99 * c}
        frame.particles.type_shapes = [shape, shape]
        frame.particles.position = exact.position[3]
        frame.particles.orientation = exact.frames[3].particles.orientation
        with gsd.hoomd.open(self.path("other.gsd"), "wb") as file:
            file.append(frame)
        result = self.run_small("out", "--set", "start.file=other.gsd", config=AGAIN)
        self.assertIn("velocities drawn", result.stderr)
        again = Frames(self.path("out/trajectory.gsd"))
        order = list(range(1, 64, 2)) + list(range(0, 64, 2))  # type 0 first
        numpy.testing.assert_allclose(again.position[0], exact.position[3][order], atol=1e-6)
        numpy.testing.assert_allclose(again.rotation[0], exact.rotation[3][order], atol=1e-6)
        self.assertEqual(self.hardbody("check", "out").returncode, 0)
        # The axis of revolution may be any of the file's.
        frame.particles.type_shapes = [{"type": "Ellipsoid", "a": 0.99 * c, "b": 0.99 * a, "c": 0.99 * b}] * 2
        turned = product(exact.frames[3].particles.orientation, numpy.tile([0.5, -0.5, -0.5, -0.5], (64, 1)))
        frame.particles.orientation = turned
        with gsd.hoomd.open(self.path("turned.gsd"), "wb") as file:
            file.append(frame)
        self.run_small("turned", "--set", "start.file=turned.gsd", config=AGAIN)
        axes = Frames(self.path("turned/trajectory.gsd")).rotation[0][:, :, 2]
        numpy.testing.assert_allclose(numpy.abs((axes * again.rotation[0][:, :, 2]).sum(axis=1)), 1, atol=1e-6)

    def test_lammps_dump(self):
        for name in ["three axes", "superellipsoids", "rods"]:
            with self.subTest(name):
                self.run_with("first", FAMILIES[name])
                result = self.run_small("out", "--set", "start.file=first/trajectory.lammpstrj", config=AGAIN)
                self.assertIn("velocities drawn", result.stderr)
                exact = Frames(self.path("first/trajectory.gsd"))
                again = Frames(self.path("out/trajectory.gsd"))
                numpy.testing.assert_allclose(again.position[0], exact.position[5], rtol=0, atol=1e-14)
                numpy.testing.assert_allclose(again.rotation[0], exact.rotation[5], rtol=0, atol=1e-14)
                numpy.testing.assert_array_equal(again.species[:, :7], exact.species[:, :7])
                shutil.rmtree(self.path("first"))
                shutil.rmtree(self.path("out"))

    def test_cut_off_dump(self):
        self.run_with("first", SMALL)
        text = self.read("first/trajectory.lammpstrj")
        whole = text.rindex("ITEM: TIMESTEP")
        for cut, frame in [(len(text), 5), (len(text) - 1, 4), (whole + 30, 4), (whole, 4)]:
            self.write("cut.lammpstrj", text[:cut])
            result = self.run_small("out", "--force", "--set", "start.file=cut.lammpstrj", config=AGAIN)
            self.assertIn(f"of frame {frame} of ", result.stderr)

    def test_dumps_that_say_time_and_units(self):
        """As dump_modify time yes units yes writes them."""
        self.run_with("first", SMALL)
        text = self.read("first/trajectory.lammpstrj")
        parts = text.split("ITEM: TIMESTEP\n")[1:]
        timed = [f"ITEM: TIME\n{0.25 * k}\nITEM: TIMESTEP\n{part}" for k, part in enumerate(parts)]
        units = "ITEM: UNITS\nlj\n" + "".join(timed)
        for name, dump in [("plain", text), ("time", "".join(timed)), ("units", units), ("cut", units + "ITEM: TIME\n")]:
            for frame in [0, 3, 5]:
                self.write("timed.lammpstrj", dump)
                start = ["start.file=timed.lammpstrj", f"start.frame={frame}"]
                self.run_small("out", "--force", "--set", *start, config=AGAIN)
                bodies = self.bytes_of("out/trajectory.lammpstrj").split(b"ITEM: TIMESTEP")[1]
                if name == "plain":
                    self.write(f"plain{frame}", bodies.decode())
                self.assertEqual(bodies.decode(), self.read(f"plain{frame}"))

    def overlapping(self):
        """The first frame with bodies that are 2 % larger."""
        self.run_with("first", SMALL)
        lines = self.read("first/trajectory.lammpstrj").splitlines(keepends=True)[:73]
        for k in range(9, 73):
            words = lines[k].split()
            words[9:12] = [repr(1.02 * float(x)) for x in words[9:12]]
            lines[k] = " ".join(words) + "\n"
        self.write("overlap.lammpstrj", "".join(lines))

    def test_overlaps(self):
        self.overlapping()
        self.write("again.toml", AGAIN.replace("first/trajectory.gsd", "overlap.lammpstrj"))
        refusal = self.hardbody("run", "again.toml", "--out", "out")
        self.assert_refused(refusal, "overlap.lammpstrj: ", "pairs of bodies overlap, the worst by ", "start.mend = true")
        # The pair by the file's own numbers: that which is so close there.
        first, second = map(int, re.search(r"\(bodies (\d+) and (\d+) of the file\)", refusal.stderr).groups())
        lines = self.read("overlap.lammpstrj").splitlines()
        begin = max(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
        columns = lines[begin].split()[2:]
        rows = [dict(zip(columns, line.split())) for line in lines[begin + 1:]]
        where = {int(row["id"]): numpy.array([float(row[c]) for c in "xyz"]) for row in rows}
        edges = [list(map(float, line.split())) for line in lines[5:8]]
        box = edges[0][1] - edges[0][0]
        apart = where[first] - where[second]
        self.assertLess(numpy.linalg.norm(apart - box * numpy.round(apart / box)), 3.2)  # touching discs and rods are this near
        self.assertFalse(os.path.exists(self.path("out")))
        result = self.hardbody("run", "again.toml", "--out", "out", "--set", "start.mend=true")
        self.assertEqual(result.returncode, 0, result.stderr)
        factor = float(result.stderr.split("box and positions scaled by 1 + ")[1].split()[0])
        self.assertGreater(factor, 0)
        box = float(self.read("first/trajectory.lammpstrj").splitlines()[5].split()[1]) * 2
        self.assertAlmostEqual(Frames(self.path("out/trajectory.gsd")).box / box, 1 + factor, delta=1e-5)
        self.assertEqual(self.hardbody("check", "out").returncode, 0)
        self.run_small("again", config=self.read("out/config.toml"))
        self.same("out/trajectory.gsd", 0, "again/trajectory.gsd")

    def test_hostile_dumps(self):
        self.run_with("first", SMALL)
        good = self.read("first/trajectory.lammpstrj")
        begin = good.rindex("ITEM: TIMESTEP")
        head, rest = good[begin:].split("ITEM: ATOMS")
        names, *bodies = ("ITEM: ATOMS" + rest).splitlines()
        lines = head.splitlines()
        column = names.split()[2:].index("x")

        def dump(count=None, bounds=None, x=None, bodies=bodies):
            top = list(lines)
            top[3] = count or top[3]
            top[5] = bounds or top[5]
            first = bodies[0].split()
            first[column] = x or first[column]
            return "\n".join(top + [names, " ".join(first)] + bodies[1:]) + "\n"

        for what, text, *parts in [
            ("infinite box", dump(bounds="-1e308 1e308"), "its box has an edge of inf"),
            ("far away", dump(x="1e17"), "body 1 is at 1e+17", "positions in the box"),
            ("no number", dump(x="nan"), "x of body 1 is \"nan\""),
            ("many bodies", dump(count="2147483648"), "has no complete frame"),
            ("not periodic", dump().replace("BOUNDS pp pp pp", "BOUNDS pp ff pp"), "boundaries ff", "pp pp pp"),
            ("one id twice", dump(bodies=[bodies[1]] + bodies[1:]), "two bodies have the id 2"),
            ("no orientations", dump().replace("quatw", "spare"), "has no orientations", "columns quatw quati quatj quatk"),
            ("a column less", dump(bodies=[bodies[0].rsplit(None, 1)[0]] + bodies[1:]), "a body has"),
        ]:
            with self.subTest(what):
                self.write("bad.lammpstrj", text)
                self.write("again.toml", AGAIN.replace("first/trajectory.gsd", "bad.lammpstrj"))
                self.assert_refused(self.hardbody("run", "again.toml", "--out", "out"), "bad.lammpstrj: ", "accepted: ", *parts)
                self.assertFalse(os.path.exists(self.path("out")))
        # What has no end, or may never have a beginning.
        os.mkfifo(self.path("pipe"))
        for name in ("/dev/zero", "pipe"):
            self.write("again.toml", AGAIN.replace("first/trajectory.gsd", name))
            self.assert_refused(self.hardbody("run", "again.toml", "--out", "out", timeout=60),
                                f"{name}: cannot be read: it is not a file", "accepted: ")

    def test_long_dumps(self):
        """A frame at a time is in memory; a file that is mostly a hole is no text."""
        self.run_with("first", SMALL, ALL)
        content = self.bytes_of("first/trajectory.lammpstrj")
        with open(self.path("hole.lammpstrj"), "wb") as file:
            file.write(content)
            file.truncate(1 << 40)
        self.write("again.toml", AGAIN.replace("first/trajectory.gsd", "hole.lammpstrj"))
        self.assert_refused(self.hardbody("run", "again.toml", "--out", "out", timeout=60),
                            f"hole.lammpstrj: byte {len(content)} is 0", "accepted: ")
        # Longer than a piece that is read at once, the last frame cut off.
        repeats = (1 << 21) // len(content) + 2
        with open(self.path("long.lammpstrj"), "wb") as file:
            file.write(repeats * content + content[:-10])
        frames = repeats * content.count(b"ITEM: TIMESTEP") + content.count(b"ITEM: TIMESTEP") - 1
        self.write("again.toml", AGAIN.replace("first/trajectory.gsd", "long.lammpstrj"))
        result = self.hardbody("run", "again.toml", "--out", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"frame {frames - 1} of ", result.stderr)
        self.assertIn("data after them is incomplete", result.stderr)

    def test_refusals(self):
        self.run_with("first", SMALL)
        self.write("again.toml", AGAIN)
        self.write("text.gsd", "no trajectory")
        self.write("empty.gsd", "")
        good = self.bytes_of("first/trajectory.gsd")
        with open(self.path("cut.gsd"), "wb") as file:
            file.write(good[:1000])
        for change, *parts in [
            (["start.file=none.gsd"], "none.gsd: cannot be read: No such file"),
            (["start.file=text.gsd"], "text.gsd: is neither a GSD file nor a LAMMPS text dump"),
            (["start.file=empty.gsd"], "empty.gsd: is neither"),
            (["start.file=cut.gsd"], "cut.gsd: is cut off after 1000 bytes"),
            (["start.frame=6"], "start.frame is 6", "0 to 5"),
            (["start.frame=-1"], "start.frame", "at least 0"),
            (["start.mend=1"], "start.mend", "true or false"),
            (["start.reverse=1"], "start.reverse", "true or false"),
            (["system.start=fcc"], "system.start", "start.file"),
            (["system.packing_fraction=0.1"], "its packing fraction is 0.2", "in the config 0.1"),
            (["shape.aspect_ratio=3"], "first/trajectory.gsd: body 0 is ellipsoid ", "in the config ellipsoid"),
            (["shape.aspect_ratio=2", "system.number=65"], "has 64 bodies of its types, the config 65"),
        ]:
            with self.subTest(change):
                self.assert_refused(self.hardbody("run", "again.toml", "--out", "out", "--set", *change), "accepted: ", *parts)
                self.assertFalse(os.path.exists(self.path("out")))
        self.write("frame.toml", SMALL + "[start]\nframe = 1\n")
        self.assert_refused(self.hardbody("run", "frame.toml"), "frame.toml:14: start.frame", "start.file beside it")


class CheckOfFiles(Trajectories):
    """hardbody check FILE.gsd."""

    def changed(self, name, array, place, value, dtype, frame=2, of="out/trajectory.gsd"):
        """A copy of a file with a number replaced, through python3-gsd."""
        if of != name:
            shutil.copy(self.path(of), self.path(name))
        with gsd.fl.open(self.path(name), "rb") as file:
            data = file.read_chunk(frame=frame, name=array).astype(dtype)
        content = self.bytes_of(name)
        at = content.index(data.tobytes())
        flat = data.reshape(-1)
        flat[place] = value
        with open(self.path(name), "wb") as file:
            file.write(content[:at] + data.tobytes() + content[at + data.nbytes:])

    def test_sound(self):
        for name, config in FAMILIES.items():
            with self.subTest(name):
                self.run_with("out", config)
                result = self.hardbody("check", "out/trajectory.gsd")
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                for text in ["frames                     6", "overlaps                   0", "bit-exact state            yes"]:
                    self.assertIn(text, result.stdout)
                self.assertTrue(result.stdout.endswith("sound\n"))
                self.assertNotIn("NOT", result.stdout)
                shutil.rmtree(self.path("out"))

    def test_not_sound(self):
        self.run_with("out", SMALL)
        self.changed("energy.gsd", "log/particles/hardbody/velocity", 5, 2.5, "f8")
        self.changed("energy.gsd", "particles/velocity", 5, 2.5, "f4", of="energy.gsd")
        self.changed("nan.gsd", "particles/position", 5, numpy.nan, "f4")
        result = self.hardbody("check", "energy.gsd")
        self.assertEqual(result.returncode, 1)
        self.assertIn("frame 2: the energy is ", result.stdout)
        self.assertTrue(result.stdout.endswith("NOT SOUND\n"))
        self.assert_refused(self.hardbody("check", "nan.gsd"), "nan.gsd: frame 2: particles/position of body 1 is nan")

    def test_overlap(self):
        self.run_with("out", SMALL)
        exact = Frames(self.path("out/trajectory.gsd"))
        target = exact.position[2][1].copy()
        content = self.bytes_of("out/trajectory.gsd")
        at = content.index(exact.position[2].tobytes())
        moved = exact.position[2].copy()
        moved[0] = target + [0, 0, 1e-3]
        with open(self.path("overlap.gsd"), "wb") as file:
            file.write(content[:at] + moved.tobytes() + content[at + moved.nbytes:])
        for k in range(3):
            self.changed("overlap.gsd", "particles/position", k, moved[0][k], "f4", of="overlap.gsd")
        result = self.hardbody("check", "overlap.gsd")
        self.assertEqual(result.returncode, 1)
        self.assertIn("frame 2: ", result.stdout)
        self.assertIn("NOT SOUND", result.stdout)

    def test_edited(self):
        """What another program has changed is not passed over in favour of the doubles beside it."""
        self.run_with("out", FAMILIES["three axes"])
        self.write("again.toml", AGAIN.replace("first/", ""))
        for array, value in [("position", 0.5), ("velocity", 3), ("orientation", 0.5), ("angmom", 1), ("mass", 2), ("moment_inertia", 3)]:
            with self.subTest(array):
                with gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
                    frame = file[2]
                changed = numpy.array(getattr(frame.particles, array))
                changed[7] = value
                setattr(frame.particles, array, changed)
                with gsd.hoomd.open(self.path("trajectory.gsd"), "wb") as file:
                    file.append(frame)
                for command in [("check", "trajectory.gsd"), ("run", "again.toml", "--out", "again")]:
                    what = f"trajectory.gsd: frame 0: particles/{array} of body 7 differs from the double-precision value in log/"
                    self.assert_refused(self.hardbody(*command), what, "accepted: an unedited frame")
        # Without the doubles it is a file as any other.
        frame.log = {}
        with gsd.hoomd.open(self.path("trajectory.gsd"), "wb") as file:
            file.append(frame)
        self.assertIn("no, 32-bit numbers", self.hardbody("check", "trajectory.gsd").stdout)

    def test_thin_bodies_that_spin_are_not_taken_for_edited(self):
        """Rounding of their long axis is much of the angular velocity about it."""
        for shape in ["[shape]\naspect_ratio = 30\n", "[shape]\naspect_ratio = 0.03\n"]:
            config = "[system]\nnumber = 600\npacking_fraction = 0.01\n" + shape + '[dynamics]\ninertia = "uniform"\n'
            self.run_small("out", "--force", config=config + "[equilibration]\ntime = 0\n[production]\ntime = 0.5\n" + ALL)
            result = self.hardbody("check", "out/trajectory.gsd")
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_cut_off_frames_are_said(self):
        self.run_with("out", SMALL)
        content = self.bytes_of("out/trajectory.gsd")
        with open(self.path("cut.gsd"), "wb") as file:
            file.write(content[:-1000])
        said = "5; data after them is incomplete and left out"
        self.assertIn(said, self.hardbody("check", "cut.gsd").stdout)
        self.assertIn("data after them is incomplete", self.hardbody("analyze", "cut.gsd", "--out", "analysis").stdout)
        result = self.run_small("again", config=AGAIN.replace("first/trajectory", "cut"))
        self.assertIn("of frame 4 of ", result.stderr)
        self.assertIn("data after them is incomplete", result.stderr)

    def test_files_with_holes(self):
        """A terabyte of which the disk holds next to nothing: refused, or read, without the memory it claims."""
        self.run_with("out", SMALL)
        content = bytearray(self.bytes_of("out/trajectory.gsd"))

        def sparse(name, **fields):
            head = bytearray(content)
            for place, value in fields.values():
                head[place:place + 8] = value.to_bytes(8, "little")
            with open(self.path(name), "wb") as file:
                file.write(head)
                file.truncate(1 << 40)
            return self.hardbody("check", name, timeout=60)

        index, entries, names = 8, 16, 32
        end = len(content)
        self.assertIn("has no complete frame", sparse("index.gsd", at=(index, end), of=(entries, (1 << 40) // 32 - end)).stderr)
        self.assertIn("more than 16 MiB of names", sparse("names.gsd", of=(names, (1 << 39) // 64)).stderr)
        self.assertIn("sound", sparse("sound.gsd").stdout)

    def test_of_another_program(self):
        """Without the doubles: overlaps beyond the rounding of 32-bit numbers; shapes may be missing."""
        self.run_with("out", SMALL)
        content = self.bytes_of("out/trajectory.gsd").replace(b"log/hardbody/time", b"xog/hardbody/time")
        for name, bytes_ in [("shapes.gsd", content), ("none.gsd", content.replace(b'"Ellipsoid"', b'"Ellipsoix"'))]:
            with open(self.path(name), "wb") as file:
                file.write(bytes_)
            result = self.hardbody("check", name)
            self.assertEqual(result.returncode, 0 if name == "shapes.gsd" else 1, result.stdout + result.stderr)
            self.assertIn("bit-exact state            no", result.stdout)
            last = result.stdout.splitlines()[-1]
            self.assertEqual(last[:26], "sound" if name == "shapes.gsd" else "not tested: overlaps: bodi")


class Analyze(Trajectories):
    """hardbody analyze."""

    def rows(self, name):
        with open(self.path(name)) as file:
            lines = list(csv.reader(file))
        names = [column.split(" [")[0] for column in lines[0]]
        return {n: numpy.array([float(x[k] or "nan") for x in lines[1:]]) for k, n in enumerate(names)}

    def analysis(self, directory):
        return json.loads(self.read(f"{directory}/analysis.json"))

    def test_against_numpy(self):
        for name in ["rods", "three axes", "mixture"]:
            with self.subTest(name):
                self.run_with("out", FAMILIES[name], ALL.replace("6", "31"))
                result = self.hardbody("analyze", "out", "--collective")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.compare(Frames(self.path("out/trajectory.gsd")), 2 if name == "three axes" else None)
                shutil.rmtree(self.path("out"))

    def compare(self, exact, three):
        images = numpy.array([f.particles.image for f in exact.frames])
        schema = numpy.array([f.particles.position for f in exact.frames], dtype=float) + images * exact.box
        unwrapped = exact.position + exact.box * numpy.round((schema - exact.position) / exact.box)
        oriented = exact.group != 2  # the third species of the mixture is of spheres
        u = exact.rotation[:, :, :, 2][:, oriented]
        wave = self.analysis("out/analysis")["wave_numbers"]
        msd, c1, c2, f_self, alpha2, velocity, overlap, directions, bragg = [
            self.rows(f"out/analysis/{n}.csv")
            for n in ["msd", "c1", "c2", "f_self", "alpha2", "velocity", "overlap", "msd_directions", "bragg"]
        ]
        near = 0.6 * self.analysis("out/analysis")["state"]["length"]
        step = exact.time[1]
        self.assertAlmostEqual(msd["t"][-1], 7 * step)  # a quarter of 30, rounded down
        close = lambda a, b: self.assertAlmostEqual(a, b, delta=1e-9 * max(1, abs(b)))
        for k, t in enumerate(msd["t"]):
            lag = round(t / step)
            squares = (unwrapped[lag:] - unwrapped[:-lag]) ** 2
            r2 = squares.sum(axis=2)
            close(msd["msd"][k], r2.mean())
            for axis, edge in enumerate("xyz"):
                close(directions[f"msd_{edge}"][k], squares[:, :, axis].mean())
            close(alpha2["alpha2"][k], 3 * (r2**2).mean() / (5 * r2.mean() ** 2) - 1)
            Q = (r2 < near**2).mean(axis=1)
            close(overlap["overlap"][k], Q.mean())
            close(overlap["chi4"][k], r2.shape[1] * Q.var())
            cosine = (u[lag:] * u[:-lag]).sum(axis=2)
            close(c1["c1"][k], cosine.mean())
            close(c2["c2"][k], (1.5 * cosine**2 - 0.5).mean())
            close(velocity["vacf"][k + 1], (exact.velocity[lag:] * exact.velocity[:-lag]).sum(axis=2).mean())
            for j, q in enumerate(wave):
                close(f_self[f"f_self_q{j + 1}"][k], numpy.sinc(q * numpy.sqrt(r2) / numpy.pi).mean())
            if three:
                for axis, letter in enumerate("xyz"):
                    turned = (exact.rotation[lag:, :, :, axis] * exact.rotation[:-lag, :, :, axis]).sum(axis=2)
                    close(c2[f"c2_{letter}"][k], (1.5 * turned**2 - 0.5).mean())
        self.assertEqual(list(bragg["intensity"]), sorted(bragg["intensity"], reverse=True))
        for n_x, n_y, n_z, intensity in zip(*(bragg[name] for name in ["n_x", "n_y", "n_z", "intensity"])):
            phase = 2j * numpy.pi / exact.box * (exact.position @ numpy.array([n_x, n_y, n_z]))
            close(intensity, (abs(numpy.exp(phase).mean(axis=1)) ** 2).mean())
        G = self.rows("out/analysis/van_hove.csv")
        width = near / 6
        for k, t in enumerate(self.analysis("out/analysis")["van_hove_lags"]):
            lag = round(t / step)
            d = numpy.sqrt(((unwrapped[lag:] - unwrapped[:-lag]) ** 2).sum(axis=2))
            number, edges = numpy.histogram(d, bins=60, range=(0, 60 * width))
            density = number / (d.size * 4 / 3 * numpy.pi * numpy.diff(edges**3))
            numpy.testing.assert_allclose(G[f"G_s_t{k + 1}"], density, atol=1e-9, rtol=1e-9)
        order = self.rows("out/analysis/order.csv")
        self.assertEqual(self.read("out/analysis/order.csv").splitlines()[0], "t [l sqrt(m/kT)],S [1],energy [kT]")
        S = [numpy.linalg.eigvalsh(1.5 * v.T @ v / len(v) - 0.5 * numpy.eye(3))[-1] for v in u]
        numpy.testing.assert_allclose(order["S"], S, atol=1e-12)
        self.assertEqual(list(order["t"]), list(exact.time))
        self.pairs(exact, exact.rotation[:, :, :, 2], oriented)
        self.structure(exact)
        self.collective(exact, msd["t"], step, wave)

    def pairs(self, exact, u, oriented):
        rows = self.rows("out/analysis/g_r.csv")
        n = len(exact.group)
        width = rows["r"][1] - rows["r"][0]
        edges = width * numpy.arange(len(rows["r"]) + 1)
        upper = numpy.triu_indices(n, 1)
        count = numpy.zeros(len(rows["r"]))
        p2 = numpy.zeros(len(rows["r"]))
        turned = numpy.zeros(len(rows["r"]))
        for x, v in zip(exact.position, u):
            d = x[:, None] - x[None]
            d -= exact.box * numpy.round(d / exact.box)
            r = numpy.sqrt((d**2).sum(axis=2))[upper]
            cosine = (v @ v.T)[upper]
            count += numpy.histogram(r, edges)[0]
            counted = (oriented[:, None] & oriented[None])[upper]
            p2 += numpy.histogram(r[counted], edges, weights=(1.5 * cosine**2 - 0.5)[counted])[0]
            turned += numpy.histogram(r[counted], edges)[0]
        volume = 4 * numpy.pi / 3 * (edges[1:] ** 3 - edges[:-1] ** 3)
        ideal = len(u) * n * (n - 1) / 2 / exact.box**3 * volume
        # A pair on the edge of a bin may be counted in the next one.
        self.assertLess(numpy.abs(rows["g"] - count / ideal).max() * ideal.min(), 2)
        self.assertLess(numpy.mean(numpy.abs(rows["g"] - count / ideal) > 1e-9), 0.05)
        some = (turned > 0) & (numpy.abs(rows["g"] - count / ideal) < 1e-9)
        numpy.testing.assert_allclose(rows["g2"][some], (p2 / numpy.maximum(turned, 1))[some], atol=1e-9)
        species = int(exact.group.max()) + 1
        self.assertEqual("g_1_2" in rows, species > 1)
        for a in range(species):
            for b in range(a + 1, species):
                self.assertEqual(f"g2_{a + 1}_{b + 1}" in rows, b < 2)
                count[:] = 0
                for x in exact.position:
                    d = x[exact.group == a][:, None] - x[exact.group == b][None]
                    d -= exact.box * numpy.round(d / exact.box)
                    count += numpy.histogram(numpy.sqrt((d**2).sum(axis=2)), edges)[0]
                pairs = (exact.group == a).sum() * (exact.group == b).sum()
                wrong = rows[f"g_{a + 1}_{b + 1}"] - count / (len(u) * pairs / exact.box**3 * volume)
                self.assertLess(numpy.mean(numpy.abs(wrong) > 1e-9), 0.05)

    def structure(self, exact):
        """The first shell of wave vectors has few enough to have all."""
        rows = self.rows("out/analysis/s_q.csv")
        vectors = [n for n in numpy.ndindex(3, 3, 3) for n in [numpy.array(n) - 1]]
        half = [n for n in vectors if 0.5 <= numpy.linalg.norm(n) < 1.5 and tuple(n) > (0, 0, 0)]
        unit = 2 * numpy.pi / exact.box
        self.assertAlmostEqual(rows["q"][0], unit * numpy.mean([numpy.linalg.norm(n) for n in half]), places=9)
        S = [numpy.abs(numpy.exp(1j * unit * x @ n).sum()) ** 2 / len(x) for x in exact.position for n in half]
        self.assertAlmostEqual(rows["S"][0], numpy.mean(S), places=9)
        of = [exact.group == a for a in range(int(exact.group.max()) + 1)]
        for a, b in itertools.combinations(range(len(of)), 2):
            rho = [[numpy.exp(1j * unit * x[of[s]] @ n).sum() for x in exact.position for n in half] for s in (a, b)]
            S = numpy.mean(numpy.real(rho[0] * numpy.conj(rho[1]))) / numpy.sqrt(of[a].sum() * of[b].sum())
            self.assertAlmostEqual(rows[f"S_{a + 1}_{b + 1}"][0], S, places=9)

    def collective(self, exact, lags, step, wave):
        """F(q, t) / S(q) from all wave vectors of a shell, or every so many of the 48 that are taken."""
        rows = self.rows("out/analysis/f_collective.csv")
        unit = 2 * numpy.pi / exact.box
        for j, q in enumerate(wave):
            low, end = q / unit - 0.5, int(numpy.ceil(q / unit + 0.5))
            grid = itertools.product(range(end + 1), range(-end, end + 1), range(-end, end + 1))
            shell = [n for n in grid if low <= numpy.linalg.norm(n) < low + 1 and n > (0, 0, 0)]
            shell = [shell[k * len(shell) // 48] for k in range(48)] if len(shell) > 48 else shell
            rho = numpy.exp(1j * unit * exact.position @ numpy.array(shell).T).sum(axis=1)
            for k, t in enumerate(lags):
                lag = round(t / step)
                wanted = numpy.real(rho[lag:] * numpy.conj(rho[:-lag])).sum() / (numpy.abs(rho[:-lag]) ** 2).sum()
                self.assertAlmostEqual(rows[f"f_collective_q{j + 1}"][k], wanted, places=9)

    def test_order_against_numpy(self):
        """Bonds of a crystal of discs and of a nematic: tools/order_by_numpy.py on the same frames."""
        asked = '[production]\norder = ["steinhardt", "hexatic"]'
        for kind, state in {
            "discs": ["shape.aspect_ratio=0.4", "system.packing_fraction=0.6"],
            "rods": ["shape.aspect_ratio=3", "system.packing_fraction=0.55"],
        }.items():
            with self.subTest(kind):
                config = SMALL.replace("[production]", asked).replace("[output]\n", ALL)
                start = ["--set", 'system.start="fcc"', "system.number=128", "production.time=1", *state]
                self.run_small("out", *start, config=config)
                self.assertEqual(self.hardbody("analyze", "out").returncode, 0)
                found = self.analysis("out/analysis")["observables"]
                exact = Frames(self.path("out/trajectory.gsd"))
                length = order_by_numpy.axial_length(exact.species[0])
                self.assertEqual(length, 2 * exact.species[0][3])
                Q = numpy.mean([order_by_numpy.tensor(R[:, :, 2]) for R in exact.rotation], axis=0)
                self.assertAlmostEqual(abs(numpy.linalg.eigh(Q)[1][:, 2] @ found["director"]["value"]), 1, places=12)
                bonds, across = [], []
                for x, R in zip(exact.position, exact.rotation):
                    director = numpy.linalg.eigh(order_by_numpy.tensor(R[:, :, 2]))[1][:, 2]
                    bonds.append(order_by_numpy.steinhardt(x, exact.box, 12))
                    across.append(order_by_numpy.hexatic(x, exact.box, director, 2 / 3 * length))
                wanted = [*numpy.mean(bonds, axis=0), *numpy.mean(across, axis=0)]
                for key, value in zip(["q4", "q6", "psi6", "psi6_local"], wanted):
                    self.assertAlmostEqual(found[key]["value"], value, places=9, msg=key)
                    # The run has seen other frames of the same state.
                    self.assertLess(abs(self.summary("out")["observables"][key]["value"] - value), 0.1)
                shutil.rmtree(self.path("out"))

    def test_the_same_frames_as_a_run(self):
        """Structure is measured in this run at times 0, 1, .. 256, where the frames are: the same numbers."""
        self.run_with("out", SMALL.replace("time = 5\n", "time = 256\n"), ALL.replace("6", "257"))
        self.assertEqual(self.hardbody("analyze", "out", "--longest-lag", "16").returncode, 0)
        for file, columns in [("g_r.csv", ["r", "g", "g2"]), ("s_q.csv", ["q", "S"])]:
            own, again = self.rows(f"out/observables/{file}"), self.rows(f"out/analysis/{file}")
            for column in columns:
                numpy.testing.assert_allclose(again[column], own[column], rtol=1e-9, err_msg=f"{file} {column}")
        own, again = self.summary("out")["observables"], self.analysis("out/analysis")["observables"]
        self.assertAlmostEqual(again["q_peak"]["value"], own["q_peak"]["value"], places=9)
        self.assertEqual(self.rows("out/analysis/order.csv")["t"][-1], 256)
        for name in ["D_trans", "S"]:
            a, b = own[name], again[name]
            self.assertLess(abs(a["value"] - b["value"]), 5 * (a["error"] ** 2 + b["error"] ** 2) ** 0.5, name)

    def test_of_another_program(self):
        """No doubles, no times, no images: the same, to the rounding of 32-bit numbers."""
        self.run_with("out", SMALL, ALL.replace("6", "31"))
        content = self.bytes_of("out/trajectory.gsd")
        for name in [b"log/hardbody/time", b"particles/image"]:
            content = content.replace(name, b"X" + name[1:])
        with open(self.path("other.gsd"), "wb") as file:
            file.write(content)
        self.assert_refused(self.hardbody("analyze", "other.gsd"), "other.gsd: frame 0 has no time", "--time-step")
        step = 5 / 30
        result = self.hardbody("analyze", "other.gsd", "--time-step", repr(step), "--out", "other")
        self.assertEqual(result.returncode, 0, result.stderr)
        shutil.copy(self.path("out/trajectory.gsd"), self.path("ours.gsd"))
        self.assertEqual(self.hardbody("analyze", "ours.gsd", "--out", "ours").returncode, 0)
        for file, column in [("msd", "msd"), ("c1", "c1"), ("c2", "c2"), ("f_self", "f_self_q1"), ("velocity", "vacf")]:
            ours, other = self.rows(f"ours/{file}.csv"), self.rows(f"other/{file}.csv")
            numpy.testing.assert_allclose(other["t"], ours["t"], rtol=1e-12)
            numpy.testing.assert_allclose(other[column], ours[column], atol=2e-5, err_msg=column)

    def test_options(self):
        self.run_with("out", SMALL, ALL.replace("6", "41"))
        arguments = ["analyze", "out", "--out", "other", "--every", "2", "--longest-lag", "1"]
        self.assertEqual(self.hardbody(*arguments).returncode, 0)
        self.assertEqual(self.analysis("other")["frames"],
                         {"in_file": 41, "without_positions": 0, "read": 21, "used": 21, "first_used": 0})
        self.assertAlmostEqual(self.rows("other/msd.csv")["t"][-1], 1)
        self.assert_refused(self.hardbody("analyze", "none"), "none: cannot be read: No such file")
        os.makedirs(self.path("empty"))
        self.assert_refused(self.hardbody("analyze", "empty"), "empty: has neither trajectory.gsd nor trajectory.lammpstrj", "trajectory = [\"gsd\"]")
        self.assert_refused(self.hardbody("analyze", "out", "--time-step", "0"), "--time-step")

    def test_lammps(self):
        """A run that has stored nothing else; times by the step, for dumps have none."""
        self.run_with("out", SMALL, ALL)
        self.assertEqual(self.hardbody("analyze", "out", "--out", "gsd").returncode, 0)
        os.remove(self.path("out/trajectory.gsd"))
        self.assert_refused(self.hardbody("analyze", "out"), "frame 0 has no time", "--time-step")
        step = self.rows("gsd/order.csv")["t"][1]
        arguments = ["--time-step", repr(float(step)), "--out", "lammps"]
        self.assertEqual(self.hardbody("analyze", "out", *arguments).returncode, 0)
        for file, column in [("msd", "msd"), ("c2", "c2"), ("f_self", "f_self_q1"), ("g_r", "g")]:
            gsd, lammps = self.rows(f"gsd/{file}.csv"), self.rows(f"lammps/{file}.csv")
            numpy.testing.assert_allclose(lammps[column], gsd[column], rtol=1e-9, atol=1e-12, err_msg=column)

    def test_without_orientations(self):
        """A dump without their columns, a GSD file without orientations: C2 and S have no value. A single frame of
        spheroids is as the schema has it: they are aligned."""
        def nothing(name):
            observables = self.analysis(name)["observables"]
            for key in ["S", "tau_C2", "t_C2_1overe"]:
                self.assertEqual(observables[key], {"value": None, "error": None, "missing": "the file does not tell"}, key)
            self.assertEqual(observables["director"]["value"], [None] * 3)
            for file, column in [("c1", "c1"), ("c2", "c2"), ("order", "S"), ("g_r", "g2")]:
                self.assertTrue(numpy.isnan(self.rows(f"{name}/{file}.csv")[column]).all(), file)
            self.assertTrue(numpy.isfinite(self.rows(f"{name}/msd.csv")["msd"]).all())

        self.run_with("out", SMALL, ALL.replace("6", "31"))
        self.assertEqual(self.hardbody("analyze", "out", "--out", "all").returncode, 0)
        content = self.bytes_of("out/trajectory.lammpstrj").replace(b"quatw quati quatj quatk", b"c_1 c_2 c_3 c_4")
        with open(self.path("other.lammpstrj"), "wb") as file:
            file.write(content)
        step = repr(float(self.rows("all/order.csv")["t"][1]))
        result = self.hardbody("analyze", "other.lammpstrj", "--time-step", step, "--out", "lammps")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"S +- \(the file does not tell\)\n")
        nothing("lammps")
        content = self.bytes_of("out/trajectory.gsd")
        for name in [b"particles/orientation", b"log/hardbody/time"]:
            content = content.replace(name, b"X" + name[1:])
        with open(self.path("aligned.gsd"), "wb") as file:
            file.write(content)
        result = self.hardbody("analyze", "aligned.gsd", "--time-step", step, "--out", "aligned")
        self.assertEqual(result.returncode, 0, result.stderr)
        nothing("aligned")
        self.assertIn("orientations: known in 1 of 31 frames, not used", result.stdout)
        self.assertEqual(self.hardbody("analyze", "aligned.gsd", "--time-step", step, "--out", "aligned", "--every", "31").returncode, 0)
        numpy.testing.assert_allclose(self.rows("aligned/order.csv")["S"], 1)
        with open(self.path("points.gsd"), "wb") as file:
            file.write(content.replace(b"particles/type_shapes", b"Xarticles/type_shapes"))
        result = self.hardbody("analyze", "points.gsd", "--time-step", step, "--out", "points")
        self.assertEqual(result.returncode, 0, result.stderr)
        nothing("points")

    def test_logarithmic_times(self):
        """Frames at 0 and at times that grow by a factor; each is correlated with the first, as numpy does it."""
        text = '[output]\ntrajectory = ["gsd", "vtk"]\nframes_spacing = "log"\nframes = 22\n'
        self.run_with("out", SMALL, text)
        self.assertEqual(self.hardbody("check", "out").returncode, 0)
        result = self.hardbody("analyze", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("frames at logarithmic times", result.stdout)
        times = numpy.concatenate([[0], 0.002 * 2500 ** (numpy.arange(21) / 20)])
        msd = self.rows("out/analysis/msd.csv")
        numpy.testing.assert_allclose(msd["t"], times[1:], rtol=1e-12)
        exact = Frames(self.path("out/trajectory.gsd"))
        numpy.testing.assert_allclose(exact.time, times, rtol=1e-12)
        images = numpy.array([f.particles.image for f in exact.frames])
        schema = numpy.array([f.particles.position for f in exact.frames], dtype=float) + images * exact.box
        unwrapped = exact.position + exact.box * numpy.round((schema - exact.position) / exact.box)
        expected = ((unwrapped[1:] - unwrapped[0]) ** 2).sum(axis=2).mean(axis=1)
        numpy.testing.assert_allclose(msd["msd"], expected, rtol=1e-9)
        self.assertTrue(numpy.isnan(msd["msd_error"]).all())
        self.assertTrue(self.analysis("out/analysis")["log_times"])

    def test_lags_within_the_trajectory(self):
        self.run_with("out", SMALL)
        result = self.hardbody("analyze", "out", "--longest-lag", "5.5")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, "^--longest-lag is 5.5; accepted: at most the time between .* frame, 5\n$")

    def test_fits(self):
        """As the run has done it, from the same lag and at the same q; of a file alone from the lag that is asked for."""
        dense = SMALL.replace("fraction = 0.2", "fraction = 0.4").replace("ratio = 2", "ratio = 3")
        dense = dense.replace("time = 5\n", "time = 60\n")
        self.run_with("out", dense, ALL.replace("6", "1201"))
        self.assertEqual(self.hardbody("analyze", "out").returncode, 0)
        self.numbers_of_curves("out")
        own, again = self.summary("out"), self.analysis("out/analysis")
        self.assertEqual(again["fit_from"], own["fit_windows"]["C2"][0])
        self.assertEqual(again["wave_numbers"], own["wave_numbers"])
        for name in ["tau_C2", "beta_C2", "tau_F", "beta_F"]:
            a, b = own["observables"][name], again["observables"][name]
            self.assertLess(abs(a["value"] - b["value"]), 5 * (a["error"] ** 2 + b["error"] ** 2) ** 0.5, name)
        shutil.copy(self.path("out/trajectory.gsd"), self.path("alone.gsd"))
        result = self.hardbody("analyze", "alone.gsd", "--out", "alone")
        self.assertIn(": the MSD grows as t^1.5 or more slowly there\n", result.stdout)
        chosen = self.analysis("alone")
        # Later than the run, which knows its collisions: so late that this fluid has decayed.
        self.assertTrue(again["fit_from"] < chosen["fit_from"] < 1)
        self.assertRegex(chosen["observables"]["tau_C2"]["missing"], "^decayed before motion is diffusive")
        result = self.hardbody("analyze", "alone.gsd", "--out", "alone", "--fit-from", repr(again["fit_from"]))
        self.assertNotIn("no fits", result.stdout)
        alone = self.analysis("alone")["observables"]
        for name in ["tau_C2", "beta_C2"]:
            self.assertEqual(alone[name], again["observables"][name])
        self.assertGreater(alone["tau_F"]["value"], 0)

    def numbers_of_curves(self, out):
        """Slopes, decay times, fits and peaks of a run from its own curves, by numpy and scipy."""
        values, windows = self.summary(out)["observables"], self.summary(out)["fit_windows"]
        curve = lambda name, column: (lambda rows: (rows["t"], rows[column]))(self.rows(f"{out}/observables/{name}.csv"))
        near = lambda key, value, relative: self.assertAlmostEqual(values[key]["value"], value, delta=relative * abs(value), msg=key)
        for key, file, column, divisor in [
            ("D_trans", "msd", "msd", 6),
            ("D_rot", "rotational_msd", "rot_msd", 4),
            ("D_rot_body", "rotational_msd", "rot_msd_body", 4),
        ]:
            t, y = curve(file, column)
            fitted = t >= 0.4 * t[-1] * (1 - 1e-9)
            near(key, numpy.polyfit(t[fitted], y[fitted], 1)[0] / divisor, 1e-9)
        for k, edge in enumerate("xyz"):
            t, y = curve("msd_directions", f"msd_{edge}")
            fitted = t >= 0.4 * t[-1] * (1 - 1e-9)
            self.assertAlmostEqual(values["D_box"][k]["value"], numpy.polyfit(t[fitted], y[fitted], 1)[0] / 2, places=9)
        for name, file, column in [("C2", "c2", "c2"), ("F", "f_self", "f_self_q1")]:
            t, y = curve(file, column)
            near(f"t_{name}_1overe", scipy.interpolate.PchipInterpolator(t, y - 1 / numpy.e).roots(extrapolate=False)[0], 1e-3)
            fitted = (t >= windows[name][0]) & (t <= windows[name][1])
            decay = lambda t, a, tau, beta: a * numpy.exp(-((t / tau) ** beta))
            _, tau, beta = scipy.optimize.curve_fit(decay, t[fitted], y[fitted], (1, t[fitted][-1] / 3, 1), xtol=1e-12, ftol=1e-12)[0]
            near(f"tau_{name}", tau, 1e-6)
            near(f"beta_{name}", beta, 1e-6)
        # Few bodies may have no clear peak.
        near = lambda key, value, relative: self.assertAlmostEqual(values[key]["value"] or value, value, delta=relative * value, msg=key)
        rows = self.rows(f"{out}/observables/s_q.csv")
        top = numpy.where((rows["q"] >= 1.5) & (rows["q"] <= 7), rows["S"], 0).argmax()
        a, b, c = numpy.polyfit(rows["q"][top - 1 : top + 2], rows["S"][top - 1 : top + 2], 2)
        near("q_peak", -b / (2 * a), 1e-6)
        near("S_peak", c - b * b / (4 * a), 1e-6)
        rows = self.rows(f"{out}/observables/overlap.csv")
        near("chi4_peak", numpy.nanmax(rows["chi4"]), 1e-12)
        near("t_chi4", rows["t"][numpy.nanargmax(rows["chi4"])], 1e-12)

    def test_one_frame(self):
        self.run_with("out", SMALL.replace("time = 5\n", "time = 0\n"))
        result = self.hardbody("analyze", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.analysis("out/analysis")["frames"],
                         {"in_file": 1, "without_positions": 0, "read": 1, "used": 1, "first_used": 0})
        self.assertGreater(self.rows("out/analysis/g_r.csv")["g"].max(), 0)


if __name__ == "__main__":
    unittest.main()
