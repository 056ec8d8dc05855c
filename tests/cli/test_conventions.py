"""One walk in the conventions of HOOMD-blue, LAMMPS and OVITO: `hardbody analyze` gives the same numbers of all files, or
none and the reason.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_conventions.py [TestClass[.test]]
"""

import dataclasses
import functools
import gzip
import shutil
import unittest

import numpy

import walks
from test_cases import Analyses
from test_cli import SMALL
from walks import BALL, EDGE, FRAMES, ROD, Walk, dump, gsd_file, walk

QUAT, VEL, SHAPE = "quatw quati quatj quatk", "vx vy vz", "shapex shapey shapez"
REST = [QUAT, VEL, SHAPE]
MSD, C2, VACF, S, G = "msd", "c2", "vacf", "S", "g"

SHORT = walk(1.4)  # steps of at most 1.4 sqrt(3) = 2.42, less than a quarter of the box
LONG = walk(7.9)


def with_pause():
    """Bodies that are as in frame 0 again in frames 10 to 19: what gsd.hoomd leaves out there."""
    w = walk(1.4, seed=5)
    for array in (w.position, w.orientation, w.velocity):
        array[10:20] = array[0]
    return Walk(w.position, w.orientation, w.velocity)


def from_defaults():
    """At rest and aligned in frame 0, and again in frames 10 to 19: the defaults of GSD files, which are not stored."""
    w = walk(1.4, seed=6)
    for frames in (0, slice(10, 20)):
        w.orientation[frames] = [1, 0, 0, 0]
        w.velocity[frames] = 0
    return w


def unwrapped(w):
    w = Walk(w.position, w.orientation, w.velocity)
    w.wrapped = w.position
    return w


def in_a_box_from(low, w):
    """Wrapped into a box whose faces are elsewhere than those of the file's box."""
    w = Walk(w.position, w.orientation, w.velocity)
    w.wrapped = (w.position - low) % EDGE + low
    return w


def drifting():
    """Wrapped every fifth frame only, as LAMMPS does when it builds lists of neighbours: slightly outside between."""
    w = walk(0.1, frames=200, seed=3)
    w.image = numpy.repeat(w.image[::5], 5, axis=0)
    w.wrapped = w.position - EDGE * w.image
    assert 0 < numpy.abs(w.wrapped).max() - EDGE / 2 < 0.06 * EDGE
    return w


def stepped(w, steps):
    return Walk(w.position, w.orientation, w.velocity, steps)


@dataclasses.dataclass
class Way:
    """How a walk is written, and what is to come out: all right, but for what is `absent`, for a `reason` that is said. `refused`: all
    of it is, with exit status 2."""

    name: str
    walk: Walk
    write: object
    absent: tuple = ()
    reason: str = ""
    refused: bool = False
    file: str = "walk"
    arguments: tuple = ()
    time_step: str = "1"
    step: float = 1
    correlated: tuple = (slice(None),)  # stretches of frames of which correlations may be
    every: int = 1
    more: bytes = b""  # behind the last frame


ALL = (MSD, C2, VACF, S, G)
WAYS = []


def lammps(name, columns, w=SHORT, absent=(), reason="", refused=False, way=None, **how):
    """A dump with these columns; id and type come first unless "id" is among them."""
    columns = list(columns) if "id" in columns or "no id" in name else ["id", "type", *columns]
    write = functools.partial(dump, columns=columns, **how)
    WAYS.append(Way(f"dump: {name}", w, lambda path, x: write(path, x), absent, reason, refused,
                    **{"file": "walk.lammpstrj", **(way or {})}))


def hoomd(name, w=SHORT, absent=(), reason="", refused=False, way=None, **how):
    write = functools.partial(gsd_file, **how)
    WAYS.append(Way(f"gsd: {name}", w, lambda path, x: write(path, x), absent, reason, refused,
                    **{"file": "walk.gsd", **(way or {})}))


X, XU, XS, XSU, I = "x y z", "xu yu zu", "xs ys zs", "xsu ysu zsu", "ix iy iz"
QUARTER = "of the box's edge between frames"

# Where bodies are.
lammps("x", [X, *REST])
lammps("x, long steps", [X, *REST], LONG, (MSD,), reason=QUARTER)
lammps("xs", [XS, *REST])
lammps("xs, long steps", [XS, *REST], LONG, (MSD,), reason=QUARTER)
for w, steps in [(SHORT, "short"), (LONG, "long")]:
    for columns in [[X, I], [XU], [XS, I], [XSU], [XU, I], [XSU, I], [X, XU], [XU, X], [XS, XSU], [I, X]]:
        lammps(f"{' '.join(columns)}, {steps} steps", [*columns, *REST], w)
lammps("outside the box", [X, *REST], unwrapped(LONG), reason="by positions outside the box")
lammps("outside the box, short steps", [X, *REST], unwrapped(SHORT))
lammps("slightly outside the box", [X, *REST], drifting(), reason="by nearest images")
lammps("slightly outside the box, images", [X, I, *REST], drifting())
lammps("two images of three", [X, "ix", "iy", *REST], LONG, (MSD,), reason=QUARTER,
       override={"ix": lambda k, i: LONG.image[k, i, 0], "iy": lambda k, i: LONG.image[k, i, 1]})
lammps("one axis unwrapped", ["xu", "y", "z", *REST], LONG, (MSD,), reason=QUARTER,
       override={n: (lambda k, i, c=c: "%.17g" % (LONG.position if c == 0 else LONG.wrapped)[k, i, c])
                 for c, n in enumerate(["xu", "y", "z"])})
lammps("no positions", [*REST], absent=ALL, reason="x y z|xu|position|column", refused=True)

# The box.
for low in (0.0, -3.7, 1e5, numpy.array([0.0, -7.25, 100.0])):
    for columns in [[X], [XU, I], [XS, I], [X, I]]:
        w = SHORT if columns == [X] else LONG
        lammps(f"from {low}: {' '.join(columns)}", [*columns, *REST], w, low=low)
for tilt in (" 0", " 0.0000000000000000e+00", " -0.0"):
    lammps(f"tilts of{tilt}", [X, *REST], bounds="xy xz yz pp pp pp", tilt=tilt)
lammps("tilted", [X, *REST], bounds="xy xz yz pp pp pp", tilt=" 0.5", absent=ALL, reason="tilt", refused=True)
lammps("three vectors and an origin", [X, *REST], bounds="abc origin pp pp pp", box=lambda k: ["10 0 0 -5", "0 10 0 -5", "0 0 10 -5"])
lammps("no flags of boundaries", [X, *REST], bounds="")
lammps("walls", [X, *REST], bounds="pp ff pp", absent=ALL, reason="ff", refused=True)
lammps("oblong", [X, *REST], absent=ALL, reason="cube|oblong|edges", refused=True,
       box=lambda k: ["-5 5", "-5 5", "-10 10"])
lammps("a box that grows in frame 7", [X, *REST], absent=ALL, reason="frame 7", refused=True,
       box=lambda k: 3 * ["-5 5" if k < 7 else "-5.5 5.5"])
lammps("bounds that shift", [X, *REST], absent=ALL, reason="frame 1: .*constant bounds", refused=True,
       box=lambda k: 3 * [f"{-5 + k / 16!r} {5 + k / 16!r}"])

# Who is who, and when.
rows = numpy.random.default_rng(2)
lammps("lines in any order", [X, *REST], order=lambda k: rows.permutation(walks.BODIES))
lammps("ids with gaps, in any order", ["id", "type", XU, *REST], LONG, order=lambda k: rows.permutation(walks.BODIES),
       override={"id": lambda k, i: 5 * i + 17})
lammps("large ids", ["id", "type", XU, *REST], LONG, override={"id": lambda k, i: 3_000_000_000 - 7 * i})
lammps("lines that are empty", [XU, *REST], LONG, end="\n", way={"more": b"\n\n"})
lammps("two components of velocities", [X, QUAT, "vx", "vy", SHAPE], absent=(VACF,), override={
    "vx": lambda k, i: SHORT.velocity[k, i, 0], "vy": lambda k, i: SHORT.velocity[k, i, 1]})
lammps("times of some frames", [X, *REST], head=lambda k: ["ITEM: TIME", f"{k}.5"] if k < 12 else [], absent=ALL, reason="frame 12 has no time",
       refused=True, way={"time_step": None})
lammps("no id", ["type", X, *REST], absent=(MSD, C2, VACF), reason="no column id")
lammps("an id that changes in frame 7", ["id", "type", X, *REST], absent=ALL, reason="frame 7", refused=True,
       override={"id": lambda k, i: 99 if k >= 7 and i == 2 else i + 1})
lammps("a body that is lost in frame 7", [X, *REST], absent=ALL, reason="frame 7", refused=True,
       order=lambda k: range(walks.BODIES - (k >= 7)))
lammps("types that swap in frame 7", ["id", "type", X, *REST], absent=ALL, reason="frame 7: body 1 is of type 2", refused=True,
       override={"type": lambda k, i: 1 + (i + (k >= 7)) % 2})
lammps("a size that changes in frame 7", [X, QUAT, VEL, "shapex", "shapey", "shapez"], absent=ALL, reason="frame 7: body 1",
       refused=True, override={n: (lambda k, i, x=x: x * (1 + (k >= 7))) for n, x in
                                   [("shapex", 0.6), ("shapey", 0.6), ("shapez", 1.8)]})
lammps("no type", ["id", X, *REST])
TIME = "ITEM: UNITS\nlj\nITEM: TIME\n{k}.5"
lammps("times", [X, *REST], head="ITEM: TIME\n{k}.5", way={"time_step": None})
lammps("units and times", [XU, *REST], LONG, head=TIME, way={"time_step": None})
lammps("times and --time-step", [XU, *REST], LONG, head=TIME)
lammps("steps of ten thousand from three thousand million on", [XU, *REST],
       stepped(LONG, 3_000_000_000 + 10_000 * numpy.arange(FRAMES)), way={"time_step": "1e-4"})
lammps("an uneven first interval", [XU, *REST], stepped(LONG, [0, *range(7, 7 + 39)]), reason="evenly spaced",
       way={"correlated": (slice(1, None),)})
gap = [k for k in range(FRAMES) if k != 14]
lammps("a missing frame", [XU, *REST], LONG[gap], reason="evenly spaced", way={"correlated": (slice(14, None),)})
again = [*range(26), *range(25, FRAMES)]
lammps("a frame that stands there twice", [XU, *REST], LONG[again], absent=ALL,
       reason="lammpstrj: time of frame 26 is 25, that of frame 25 is 25; accepted: finite times that rise", refused=True)
lammps("steps that start again", [XU, *REST], stepped(LONG, [*range(25), *range(15)]), absent=ALL, reason="time of frame 25",
       refused=True)

# What else columns hold.
lammps("other columns", ["id", "type", "mol", "element", "mass", "proc", XU, *REST], LONG)
lammps("radius", [X, QUAT, VEL, "radius"], reason="column radius: not used")
lammps("diameter", [X, QUAT, VEL, "diameter"], reason="column diameter: not used")
lammps("no shape", [X, QUAT, VEL])
lammps("no velocities", [X, QUAT, SHAPE], absent=(VACF,))
lammps("no orientations", [X, VEL, SHAPE], absent=(C2, S))
lammps("quaternions with w last", [X, "quati quatj quatk quatw", VEL, SHAPE])
for order in ([0, 1, 2, 3], [1, 2, 3, 0]):
    lammps(f"c_orient as {order}", [X, *(f"c_orient[{n + 1}]" for n in range(4)), VEL, SHAPE], absent=(C2, S),
           reason=r"c_orient", override={f"c_orient[{n + 1}]": (lambda k, i, c=c: "%.17g" % SHORT.orientation[k, i, c])
                                         for n, c in enumerate(order)})


def longer(factor):
    w = walk(1.4)
    exact = w.orientation
    w.orientation = exact * factor
    return Walk(w.position, exact, w.velocity), {QUAT.split()[c]: (lambda k, i, c=c: "%.17g" % (factor * exact[k, i, c]))
                                                  for c in range(4)}


for factor in (1.0008, 0.9992):
    w, columns = longer(factor)
    lammps(f"quaternions longer by {factor}", [X, *QUAT.split(), VEL, SHAPE], w, override=columns)
w, columns = longer(1.004)
lammps("quaternions that are none", [X, *QUAT.split(), VEL, SHAPE], w, ALL, reason=r"1\.004", refused=True,
       override=columns)
lammps("lines that end with CR LF", [X, *REST], end="\r\n")
lammps("no space at the ends of lines", [X, *REST], tail="")

# GSD.
for when in ("each", "changed"):
    for w, steps in [(SHORT, "short"), (LONG, "long")]:
        hoomd(f"images {when}, {steps} steps", w, image=when)
for when in ("first", "never"):
    hoomd(f"images {when}", image=when)
    hoomd(f"images {when}, long steps", LONG, (MSD,), reason=QUARTER, image=when)
hoomd("outside the box", LONG, image="never", position="unwrapped")
hoomd("outside the box, short steps", SHORT, image="never", position="unwrapped")
hoomd("from 0 to the edge", in_a_box_from(0, SHORT), image="never")
hoomd("from 0 to the edge, long steps", in_a_box_from(0, LONG), (MSD,), reason=QUARTER, image="never")
hoomd("wrapped at other faces", in_a_box_from(-1.5, SHORT), (MSD,), reason="outside the box", image="never")
for when in ("each", "changed"):
    hoomd(f"all {when}, as in frame 0 again", with_pause(), image=when, orientation=when, velocity=when)
hoomd("all changed, from their defaults", from_defaults(), image="changed", orientation="changed", velocity="changed")
lammps("at rest and aligned in some frames", [X, *REST], from_defaults())
hoomd("orientations of frame 0", orientation="first", absent=(C2, S), reason="orientation")
hoomd("velocities of frame 0", velocity="first", absent=(VACF,), reason="velocit")
hoomd("velocities never", velocity="never", absent=(VACF,))
hoomd("as HOOMD-blue's default", image="first", velocity="first", absent=(VACF,), reason="velocit")
hoomd("logged values between all frames", log_only=lambda k: True, reason="frames without positions")
hoomd("logged values between some frames", LONG, log_only=lambda k: k % 3 == 1, reason="frames without positions")
hoomd("a box in each frame", LONG, box=lambda k: [EDGE, EDGE, EDGE, 0, 0, 0])
hoomd("a box that grows in frame 7", box=lambda k: 3 * [EDGE + (k >= 7)] + [0, 0, 0], absent=ALL, reason="frame 7",
      refused=True)
hoomd("an oblong box", box=lambda k: [EDGE, EDGE, 2 * EDGE, 0, 0, 0], absent=ALL, reason="cube|oblong|edges", refused=True)
hoomd("a tilted box", box=lambda k: [EDGE, EDGE, EDGE, 0.1, 0, 0], absent=ALL, reason="tilt", refused=True)
hoomd("no shapes", shapes=None)
hoomd("two types", shapes=(ROD, ROD), more={
    "particles/typeid": lambda k: numpy.arange(walks.BODIES, dtype=numpy.uint32) % 2 if k == 0 else None})
hoomd("types that swap in frame 7", shapes=(ROD, BALL), absent=ALL, reason="frame 7: body 0 is of type B", refused=True, more={
    "particles/typeid": lambda k: (numpy.arange(walks.BODIES, dtype=numpy.uint32) + (k >= 7)) % 2})
hoomd("masses, diameters, charges, bodies", LONG, more={
    "particles/mass": lambda k: numpy.full(8, 2.5, numpy.float32), "particles/charge": lambda k: numpy.ones(8, numpy.float32),
    "particles/diameter": lambda k: numpy.ones(8, numpy.float32), "particles/body": lambda k: numpy.full(8, -1, numpy.int32)})
hoomd("a body less in frame 7", absent=ALL, reason="frame 7", refused=True, more={
    "particles/N": lambda k: numpy.array([7], numpy.uint32) if k == 7 else None})
hoomd("steps of ten thousand", stepped(LONG, 10_000 * numpy.arange(FRAMES)), way={"time_step": "1e-4"})
hoomd("an uneven first interval", stepped(LONG, [0, *range(7, 7 + 39)]), reason="evenly spaced",
      way={"correlated": (slice(1, None),)})

# Not all frames, other names.
for every in (2, 3):
    way = {"arguments": ("--every", str(every)), "every": every, "step": every}
    lammps(f"every {every}", [X, *REST], way=way)
    hoomd(f"every {every}, images never", image="never", way=way)
    hoomd(f"every {every}, logged values between", image="never", way=way, log_only=lambda k: k % 3 == 1)
for name in ("walk.gsd", "walk.txt", "walk"):
    lammps(f"named {name}", [XU, *REST], LONG, way={"file": name})
for name in ("walk.lammpstrj", "walk.txt", "walk"):
    hoomd(f"named {name}", LONG, way={"file": name})


class Conventions(Analyses):
    def compare(self, way):
        way.write(self.path(way.file), way.walk)
        with open(self.path(way.file), "ab") as file:
            file.write(way.more)
        result = self.analyze(way.file, *way.arguments, time_step=way.time_step)
        said = self.said(result)
        self.assertEqual(result.returncode, 2 if way.refused else 0, said)
        if way.refused:
            self.assert_refused(result, "accepted: ")
            self.assertRegex(result.stderr, way.reason)
            return
        used = way.walk[:: way.every]
        lags = [(k * way.step, k) for k in range(1, 4)]
        precision = 2e-6 if "gsd" in way.name else 1e-9

        def judge(what, found, right):
            """`right`: the numbers of each of the stretches that may be meant."""
            if all(x is None for x in found):
                self.assertIn(what, way.absent, "has no value\n" + result.stdout)
                return
            self.assertNotIn(what, way.absent, f"{found} {right}\n{result.stdout}")
            self.assertNotIn(None, found)
            wrong = [numpy.abs(numpy.array(found) - x).max() for x in right]
            self.assertLess(min(wrong), precision * max(1, numpy.abs(right).max()), f"{what}: {found} {right}\n{result.stdout}")

        for what, file, column in [(MSD, "msd", "msd"), (C2, "c2", "c2"), (C2, "c1", "c1"), (VACF, "velocity", "vacf")]:
            right = [[used[part].correlations(k)[column] for _, k in lags] for part in way.correlated]
            judge(what, [self.at(file, column, t) for t, _ in lags], numpy.array(right))
        order = list(self.column("order", "S").values())
        if any(x is not None for x in order) or S not in way.absent:
            judge(S, order or [None], [numpy.array(used.order())])
        self.pairs(way, used, said)
        if way.reason:
            self.assertRegex(said, way.reason)

    def pairs(self, way, used, said):
        rows = self.column("g_r", "g")
        r, g = numpy.array(list(rows)), list(rows.values())
        if not len(g) or None in g:
            self.assertIn(G, way.absent, said)
            return
        edges = (r[1] - r[0]) * numpy.arange(len(r) + 1)
        one = 1 / (len(used.position) * walks.BODIES * (walks.BODIES - 1) / 2 / EDGE**3 * 4 * numpy.pi / 3
                   * numpy.diff(edges**3))  # what a pair adds
        wrong = numpy.abs(g - used.pairs(edges)) / one
        self.assertLess(wrong.max(), 2.5)
        self.assertLess((wrong > 1e-6).mean(), 0.05)  # pairs on the edge of a bin may be counted in the next one

    def test_all(self):
        self.assertEqual(len({w.name for w in WAYS}), len(WAYS))
        for way in WAYS:
            with self.subTest(way.name):
                self.compare(way)

    def test_gzip(self):
        dump(self.path("walk"), SHORT, ["id", "type", X, *REST])
        gsd_file(self.path("walk.gsd"), SHORT)
        for name, packed in [("walk", "walk.lammpstrj.gz"), ("walk", "walk.gsd"), ("walk.gsd", "walk.gsd.gz")]:
            with gzip.open(self.path("packed"), "wb") as file:
                file.write(self.bytes_of(name))
            shutil.copy(self.path("packed"), self.path(packed))
            for command in [("analyze", packed, "--time-step", "1"), ("check", packed)]:
                self.assert_refused(self.hardbody(*command), packed, "gzip", "gunzip")

    def test_what_is_no_trajectory(self):
        for name, content in [("data", b"LAMMPS data file\n\n8 atoms\n1 atom types\n"), ("xyz", b"2\n\nA 0 0 0\nA 1 0 0\n"),
                              ("binary", numpy.array([-10, 1, 1, 2], "<i8").tobytes()), ("empty", b"")]:
            with open(self.path(name), "wb") as file:
                file.write(content)
            for command in [("analyze", name, "--time-step", "1"), ("check", name)]:
                self.assert_refused(self.hardbody(*command), name, "accepted")


class OwnTrajectories(Analyses):
    def test_frames_far_apart(self):
        """Bodies move across the box between frames: GSD files and dumps of a run say where they went."""
        config = SMALL.replace("time = 5\n", "time = 100\n").replace("aspect_ratio = 2", "aspect_ratio = 1.5")
        config = config.replace("events = 500", 'trajectory = ["gsd", "lammps"]\nframes = 9')
        self.run_small("out", config=config)
        with walks.gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
            frames = list(file)
        edge = frames[0].log["hardbody/box"][0]
        x = numpy.array([f.particles.position + edge * f.particles.image for f in frames], float)
        right = ((x[1:] - x[:-1]) ** 2).sum(axis=2).mean()
        self.assertGreater(right, (edge / 4) ** 2)
        rows = []
        for name, step in [("gsd", None), ("lammpstrj", "12.5")]:
            result = self.analyze(f"out/trajectory.{name}", time_step=step)
            self.assertEqual(result.returncode, 0, result.stderr)
            rows.append(list(self.column("msd", "msd").values()))
            self.assertAlmostEqual(rows[-1][0], right, delta=1e-5 * right)
        numpy.testing.assert_allclose(*rows, rtol=1e-9)


if __name__ == "__main__":
    unittest.main()
