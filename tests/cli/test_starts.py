"""Runs that begin with other programs' files: velocities, temperatures of species, paths.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_starts.py [TestClass[.test]]
"""

import os
import unittest

import numpy

import walks
from test_cases import START, Analyses
from walks import EDGE, dump, gsd_file

# Eight rods that do not overlap, at rest on the whole.
RODS = walks.walk(0.5, frames=2)
RODS.velocity -= RODS.velocity.mean(axis=1, keepdims=True)
QUAT, VEL, SHAPE, ANGMOM = "quatw quati quatj quatk", "vx vy vz", "shapex shapey shapez", "angmomx angmomy angmomz"

MIXTURE = """seed = 5
[system]
number = 60
packing_fraction = 0.1
start = "{start}"
[[species]]
semi_axes = [1, 1, 1]
fraction = 0.5
mass = {light}
[[species]]
semi_axes = [0.7, 0.7, 1.4]
fraction = 0.5
mass = {heavy}
[equilibration]
time = 0
[production]
time = 0
[output]
trajectory = ["gsd"]
"""


def factor(found, given):
    """By which `given` is multiplied, and by how much `found` differs from that."""
    s = (found * given).sum() / (given**2).sum()
    return s, numpy.abs(found - s * given).max()


class StartCase(Analyses):
    def of(self, frame, name):
        return frame.log[f"particles/hardbody/{name}"]

    def momenta(self, frame):
        """Angular momenta in the world."""
        R = self.of(frame, "rotation").reshape(-1, 3, 3)
        inertia = frame.log["hardbody/species"][frame.particles.typeid, 7:10]
        return numpy.einsum("nij,nj,nkj,nk->ni", R, inertia, R, self.of(frame, "angular_velocity"))


class Velocities(StartCase):
    """Those of the file are kept, all scaled by one factor; a kind of motion that it does not have is drawn."""

    UNIFORM = '[dynamics]\ninertia = "uniform"\n'

    def kept_momenta(self, frame, L, precision):
        """Tumbling and spin are each scaled by a factor."""
        u = self.of(frame, "rotation").reshape(-1, 3, 3)[:, :, 2]
        for part in (lambda x: (x * u).sum(axis=1), lambda x: x - (x * u).sum(axis=1)[:, None] * u):
            s, wrong = factor(part(self.momenta(frame)), part(L))
            self.assertGreater(s, 0)
            self.assertLess(wrong, precision)

    def kept(self, said, frame, given=RODS.velocity[1]):
        s, wrong = factor(self.of(frame, "velocity"), given)
        self.assertGreater(s, 0)
        self.assertLess(wrong, 1e-6, said)

    def test_dump_without_angular_momenta(self):
        dump(self.path("start"), RODS, ["id", "type", "xu yu zu", QUAT, SHAPE, VEL])
        frame, said = self.started("start")
        self.kept(said, frame)
        self.assertGreater(numpy.abs(self.of(frame, "angular_velocity")).min(axis=1).max(), 0)
        self.assertRegex(said, "rotation|angular|turn")

    def test_dump_with_angular_momenta(self):
        """LAMMPS has them in the world's directions."""
        L = numpy.random.default_rng(4).normal(size=(8, 3))
        names = ANGMOM.split()
        columns = {n: (lambda k, i, c=c: "%.17g" % L[i, c]) for c, n in enumerate(names)}
        for mass in (["mass"], []):
            dump(self.path("start"), RODS, ["id", "type", "xu yu zu", QUAT, SHAPE, VEL, *names, *mass], override=columns)
            frame, said = self.started("start", config=self.UNIFORM)
            self.kept(said, frame)
            self.assertNotIn("drawn", said)
            self.kept_momenta(frame, L, 1e-9)

    def test_gsd(self):
        """HOOMD's angular momenta are quaternions, 2 q (0, L), L along the body's axes."""
        L = numpy.random.default_rng(4).normal(size=(8, 3))
        q = RODS.orientation[1]
        angmom = 2 * walks.multiply(q, numpy.hstack([numpy.zeros((8, 1)), L])).astype(numpy.float32)
        gsd_file(self.path("start.gsd"), RODS, more={"particles/angmom": lambda k: angmom.astype(numpy.float32)})
        frame, said = self.started("start.gsd", config=self.UNIFORM)
        self.kept(said, frame)
        self.assertNotIn("drawn", said)
        R = self.of(frame, "rotation").reshape(-1, 3, 3)
        self.kept_momenta(frame, numpy.einsum("nij,nj->ni", R, L), 5e-6)
        gsd_file(self.path("start.gsd"), RODS)
        frame, said = self.started("start.gsd", config=self.UNIFORM)
        self.kept(said, frame)
        self.assertIn("drawn", said)
        gsd_file(self.path("start.gsd"), RODS, velocity="never",
                 more={"particles/angmom": lambda k: angmom.astype(numpy.float32)})
        frame, said = self.started("start.gsd", config=self.UNIFORM)
        self.assertIn("drawn", said)
        self.kept_momenta(frame, numpy.einsum("nij,nj->ni", R, L), 5e-6)

    def test_of_a_frame_that_has_none(self):
        gsd_file(self.path("start.gsd"), RODS, velocity="first")
        self.assertIn("drawn", self.started("start.gsd")[1])
        self.kept("", self.started("start.gsd", "start.frame=0", config=self.UNIFORM)[0], RODS.velocity[0])

    def test_momentum_is_taken_away(self):
        w = walks.walk(0.5, frames=2)
        w.velocity += [100.0, 0, 0]
        dump(self.path("start"), w, ["id", "type", "xu yu zu", QUAT, SHAPE, VEL])
        frame, said = self.started("start")
        self.kept(said, frame, w.velocity[1] - w.velocity[1].mean(axis=0))

    def test_reversed(self):
        dump(self.path("start"), RODS, ["id", "type", "xu yu zu", QUAT, SHAPE, VEL])
        there, back = [self.of(self.started("start", f"start.reverse={r}")[0], "velocity") for r in ("false", "true")]
        numpy.testing.assert_array_equal(there, -back)

    def test_temperature(self):
        """kT = 1 on 3N - 3 degrees of freedom, and on 2N or 3N."""
        dump(self.path("start"), RODS, ["id", "type", "xu yu zu", QUAT, SHAPE, VEL])
        for config, rotations in [("", 2), (self.UNIFORM, 3)]:
            frame, _ = self.started("start", config=config)
            self.assertAlmostEqual((self.of(frame, "velocity") ** 2).sum() / 21, 1, delta=1e-9)
            turning = (self.momenta(frame) * self.of(frame, "angular_velocity")).sum()
            # The spin of bodies of revolution never changes: it is left as it is, and counted where there is any.
            if rotations == 2:
                self.assertAlmostEqual(turning / 16, 1, delta=1e-9)


class FilesOfStarts(StartCase):
    """What a file says of bodies, and what it does not."""

    def refused(self, *parts, config=""):
        self.write("start.toml", config + START.format("start"))
        self.assert_refused(self.hardbody("run", "start.toml", "--out", "out", "--force"), "accepted: ", *parts)

    def same_places(self, frame, w=RODS):
        wrong = self.of(frame, "position") - w.position[1]
        self.assertLess(numpy.abs(wrong - EDGE * numpy.round(wrong / EDGE)).max(), 1e-6)

    def test_last_frame_with_positions(self):
        gsd_file(self.path("start"), RODS, log_only=lambda k: True)
        frame, _ = self.started("start")
        self.same_places(frame)

    def test_orientations_of_frame_0(self):
        """Those of a later frame are not known: bodies that are no spheres are not taken for aligned."""
        gsd_file(self.path("start"), RODS, orientation="first")
        self.refused("orientation")
        self.assertIn("frame 0 of", self.started("start", "start.frame=0")[1])
        gsd_file(self.path("start"), RODS, orientation="first", shapes=(walks.BALL,))
        self.same_places(self.started("start")[0])

    def test_columns(self):
        balls = "[system]\npacking_fraction = 0.0041887902\n[[species]]\nsemi_axes = [0.5, 0.5, 0.5]\nnumber = 8\n"
        for columns, config in [(["radius"], ""), (["diameter"], ""), ([], balls), (["radius"], balls)]:
            for where in ["x y z", "xu yu zu", "xs ys zs", "xsu ysu zsu", "x y z ix iy iz"]:
                with self.subTest(where, columns=columns, config=config):
                    places = ["x y z", "ix iy iz"] if "ix" in where else [where]
                    dump(self.path("start"), RODS, ["id", "type", *places, VEL, *columns], low=3.0)
                    self.write("start.toml", config + START.format("start"))
                    result = self.hardbody("run", "start.toml", "--out", "out", "--force")
                    if result.returncode == 2 and columns and not config:
                        self.assert_refused(result, columns[0])
                        continue
                    self.assertEqual(result.returncode, 0, result.stderr)
                    with walks.gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
                        frame = file[0]
                    wrong = self.of(frame, "position") - RODS.position[1]
                    wrong -= wrong[0]  # the box may have another origin
                    self.assertLess(numpy.abs(wrong - EDGE * numpy.round(wrong / EDGE)).max(), 1e-6)
                    numpy.testing.assert_allclose(frame.log["hardbody/species"][0, 1:4], 0.5)

    def test_boxes_and_orientations(self):
        columns = ["id", "type", "x y z", QUAT, SHAPE]
        dump(self.path("start"), RODS, columns, box=lambda k: ["-5 5", "-5 5", "-10 10"])
        self.refused("its box has edges 10, 10, 20")
        dump(self.path("start"), RODS, columns, bounds="xy xz yz pp pp pp", tilt=" 0.5")
        self.refused("tilt")
        dump(self.path("start"), RODS, columns, bounds="xy xz yz pp pp pp", tilt=" 0")
        self.same_places(self.started("start")[0])
        names = [f"c_orient[{n}]" for n in range(1, 5)]
        dump(self.path("start"), RODS, ["id", "type", "x y z", *names, SHAPE], override={n: lambda k, i: 0.5 for n in names})
        self.refused("c_orient")
        gsd_file(self.path("start"), RODS, box=lambda k: [EDGE, EDGE, 2 * EDGE, 0, 0, 0])
        self.refused("its box has edges 10, 10, 20")


class Temperatures(StartCase):
    """kT = 1 of each species, whatever its masses: on 3 (N_k - M_k / M) degrees of freedom, and 2 N_k of rotation."""

    def check(self, frame, masses):
        group = self.of(frame, "group")
        v = self.of(frame, "velocity")
        m = frame.log["hardbody/species"][frame.particles.typeid, 6]
        share = numpy.array([m[group == k].sum() for k in (0, 1)]) / m.sum()
        for k in (0, 1):
            numpy.testing.assert_allclose(m[group == k], masses[k], rtol=1e-6)
            freedoms = 3 * ((group == k).sum() - share[k])
            kT = (m * (v**2).sum(axis=1))[group == k].sum() / freedoms
            self.assertAlmostEqual(kT, 1, delta=1e-6, msg=f"of species {k}, masses {masses}")
        self.assertLess(numpy.abs((m[:, None] * v).sum(axis=0)).max(), 1e-9 * (m * numpy.abs(v).max(axis=1)).sum())
        turning = (self.momenta(frame) * self.of(frame, "angular_velocity")).sum(axis=1)[group == 1].sum()
        self.assertAlmostEqual(turning / (2 * (group == 1).sum()), 1, delta=1e-6)

    def test_starts(self):
        for start in ("random", "cubic"):
            for masses in [(1e-6, 1e6), (1e6, 1e-6), (1e-3, 1e3), (1, 1)]:
                with self.subTest(start=start, masses=masses):
                    config = MIXTURE.format(start=start, light=masses[0], heavy=masses[1])
                    self.run_small("out", "--force", config=config)
                    with walks.gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
                        self.check(file[0], masses)

    def test_summary(self):
        """Temperature of all bodies in the summary, after some time."""
        config = MIXTURE.format(start="cubic", light=1e-3, heavy=1e3).replace("[production]\ntime = 0", "[production]\ntime = 1")
        self.run_small("out", config=config)
        self.assertAlmostEqual(self.summary("out")["observables"]["kT_trans"]["value"], 1, delta=0.2)

    def test_file_without_velocities(self):
        types = lambda k: numpy.arange(8, dtype=numpy.uint32) % 2
        for masses in [(1e-6, 1e6), (1e-3, 1e3)]:
            with self.subTest(masses=masses):
                gsd_file(self.path("start.gsd"), RODS, velocity="never", shapes=(walks.BALL, walks.ROD),
                         more={"particles/typeid": types})
                config = "".join(f"[[species]]\nsemi_axes = {a}\nnumber = 4\nmass = {m}\n"
                                 for a, m in zip([[0.5, 0.5, 0.5], [0.3, 0.3, 0.9]], masses))
                self.check(self.started("start.gsd", config=config)[0], masses)


class Paths(StartCase):
    """`..` behind a symbolic link is the system's: the parent of the link's target."""

    def test_file(self):
        os.makedirs(self.path("far/away"))
        os.symlink("far/away", self.path("link"))
        columns = ["id", "type", "xu yu zu", QUAT, SHAPE, VEL]
        dump(self.path("far/walk"), RODS, columns)
        other = walks.walk(0.5, frames=3, seed=9)
        for where in ["here", "nothing"]:
            with self.subTest(where):
                if where == "here":
                    dump(self.path("walk"), other, columns)
                else:
                    os.remove(self.path("walk"))
                frame, said = self.started("link/../walk")
                self.assertIn("frame 1 of", said)
                wrong = self.of(frame, "position") - RODS.position[1]
                self.assertLess(numpy.abs(wrong - EDGE * numpy.round(wrong / EDGE)).max(), 1e-9)
                # The resolved configuration names the same file.
                again = self.hardbody("run", "out/config.toml", "--out", "again", "--force")
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertIn("frame 1 of", again.stderr)

    def test_run(self):
        os.makedirs(self.path("far/away"))
        os.symlink("far/away", self.path("link"))
        small = MIXTURE.format(start="cubic", light=1, heavy=1)
        self.run_small("far/first", config=small)
        again = small.replace('start = "cubic"', 'start_from = "link/../first"')
        self.run_small("second", config=again)
        for name in ("velocity", "position"):
            a, b = [self.of(self.frame(f"{d}/trajectory.gsd"), name) for d in ("far/first", "second")]
            numpy.testing.assert_allclose(a, b, rtol=0, atol=1e-14)

    def frame(self, name):
        with walks.gsd.hoomd.open(self.path(name), "rb") as file:
            return file[0]


if __name__ == "__main__":
    unittest.main()
