"""Trajectories of one and the same walk in the conventions of several programs, and their correlations by numpy.

Positions and velocities are multiples of 1/1024, so that 32-bit numbers hold them exactly, wrapped or not.
"""

import json

import numpy

import gsd.fl
import gsd.hoomd

EDGE = 10.0
BODIES = 8
FRAMES = 40
ROD = {"type": "Ellipsoid", "a": 0.3, "b": 0.3, "c": 0.9}
BALL = {"type": "Sphere", "diameter": 1.0}


def on_grid(values):
    return numpy.round(numpy.asarray(values) * 1024) / 1024


def multiply(p, q):
    """Product of quaternions w, x, y, z."""
    (a, u), (b, v) = (p[:, :1], p[:, 1:]), (q[:, :1], q[:, 1:])
    return numpy.hstack([a * b - (u * v).sum(axis=1, keepdims=True), a * v + b * u + numpy.cross(u, v)])


class Walk:
    """Unwrapped positions, orientations and velocities: arrays of frames x bodies x components."""

    def __init__(self, position, orientation, velocity, steps=None):
        self.position, self.orientation, self.velocity = position, orientation, velocity
        self.steps = numpy.arange(len(position)) if steps is None else numpy.asarray(steps)
        self.image = numpy.floor(position / EDGE + 0.5).astype(int)
        self.wrapped = position - EDGE * self.image

    def __getitem__(self, frames):
        return Walk(self.position[frames], self.orientation[frames], self.velocity[frames], self.steps[frames])

    def axes(self):
        w, x, y, z = numpy.moveaxis(self.orientation, 2, 0)
        return numpy.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=2)

    def correlations(self, lag):
        """MSD, C1, C2, velocity correlation."""
        late, early = slice(lag, None), slice(None, len(self.position) - lag)
        cosine = (self.axes()[late] * self.axes()[early]).sum(axis=2)
        return {
            "msd": ((self.position[late] - self.position[early]) ** 2).sum(axis=2).mean(),
            "c1": cosine.mean(),
            "c2": (1.5 * cosine**2 - 0.5).mean(),
            "vacf": (self.velocity[late] * self.velocity[early]).sum(axis=2).mean(),
        }

    def order(self):
        return [numpy.linalg.eigvalsh(1.5 * u.T @ u / len(u) - 0.5 * numpy.eye(3))[-1] for u in self.axes()]

    def pairs(self, edges):
        """g(r) between the edges of bins."""
        count = numpy.zeros(len(edges) - 1)
        n = self.position.shape[1]
        for x in self.position:
            d = (x[:, None] - x[None])[numpy.triu_indices(n, 1)]
            d -= EDGE * numpy.round(d / EDGE)
            count += numpy.histogram(numpy.sqrt((d**2).sum(axis=1)), edges)[0]
        shells = 4 * numpy.pi / 3 * numpy.diff(edges**3)
        return count / (len(self.position) * n * (n - 1) / 2 / EDGE**3 * shells)


def walk(longest, frames=FRAMES, seed=1):
    """Random steps, each component at most `longest`; orientations and velocities that forget slowly."""
    draws = numpy.random.default_rng(seed)
    corners = numpy.array([[x, y, z] for x in (-2, 3) for y in (-3, 2) for z in (-2, 3)], float)
    steps = on_grid(draws.uniform(-longest, longest, (frames, BODIES, 3)))
    steps[0] = corners + on_grid(draws.uniform(-1, 1, (BODIES, 3)))
    velocity = on_grid(numpy.cumsum(draws.normal(0, 0.3, (frames, BODIES, 3)), axis=0))
    q = draws.normal(size=(BODIES, 4))
    orientation = []
    for _ in range(frames):
        q /= numpy.linalg.norm(q, axis=1, keepdims=True)
        orientation.append(q.copy())
        q = multiply(q, numpy.hstack([numpy.ones((BODIES, 1)), draws.normal(0, 0.1, (BODIES, 3))]))
    return Walk(numpy.cumsum(steps, axis=0), numpy.array(orientation), velocity)


# The columns of LAMMPS dumps: arrays of frames x bodies x components; `low` is the corner of the box.
COLUMNS = {
    "x y z": lambda w, low: w.wrapped + low + EDGE / 2,
    "xu yu zu": lambda w, low: w.position + low + EDGE / 2,
    "xs ys zs": lambda w, low: w.wrapped / EDGE + 0.5,
    "xsu ysu zsu": lambda w, low: w.position / EDGE + 0.5,
    "ix iy iz": lambda w, low: w.image,
    "vx vy vz": lambda w, low: w.velocity,
    "quatw quati quatj quatk": lambda w, low: w.orientation,
    "quati quatj quatk quatw": lambda w, low: numpy.roll(w.orientation, -1, axis=2),
    "shapex shapey shapez": lambda w, low: numpy.broadcast_to([0.6, 0.6, 1.8], w.position.shape),
}
SCALARS = {"id": 1, "type": 1, "mass": 2.5, "radius": 0.5, "diameter": 1, "element": "Ar", "mol": 7, "proc": 0}


def dump(path, w, columns, low=-EDGE / 2, bounds="pp pp pp", tilt="", head="", tail=" ", end="\n", order=None,
         override=None, box=None):
    """`columns`: a list of keys of COLUMNS and SCALARS, or other names, whose values `override` has: name ->
    f(frame, body). `head`: text before each frame, with {k}, or f(frame); `order`: f(frame) gives the order of lines; `tail`: behind
    each line of ATOMS, as LAMMPS has it; `box`: f(frame) gives the lines of bounds."""
    override = override or {}
    arrays = {c: COLUMNS[c](w, low) for c in columns if c in COLUMNS and c not in override}
    lines = []
    for k, step in enumerate(w.steps):
        if head:
            lines += head(k) if callable(head) else [head.format(k=k)]
        lines += ["ITEM: TIMESTEP", str(step), "ITEM: NUMBER OF ATOMS", str(w.position.shape[1])]
        lines.append(f"ITEM: BOX BOUNDS {bounds}".rstrip())
        lines += box(k) if box else [f"{float(x)!r} {float(x + EDGE)!r}{tilt}" for x in numpy.broadcast_to(low, 3)]
        lines.append("ITEM: ATOMS " + " ".join(columns) + tail)
        for i in order(k) if order else range(w.position.shape[1]):
            words = []
            for c in columns:
                if c in override:
                    words.append(str(override[c](k, i)))
                elif c in arrays:
                    words += ["%.17g" % x for x in arrays[c][k, i]]
                else:
                    words.append(str(i + 1 if c == "id" else SCALARS[c]))
            lines.append(" ".join(words) + tail)
    with open(path, "w", newline="") as file:
        file.write(end.join(lines) + end)


def gsd_file(path, w, image="each", orientation="each", velocity="each", position="wrapped", shapes=(ROD,),
             log_only=lambda k: False, box=None, more=None, where=None):
    """Chunks as the schema has them. "each" frame; "first" frame only; "changed": where they differ from the first
    frame's, and in that from their default, as gsd.hoomd writes them; "never". `more`: name -> f(frame), an array or None; `log_only`: frames that another one without positions
    follows."""
    box = box or (lambda k: [EDGE, EDGE, EDGE, 0, 0, 0] if k == 0 else None)
    chunks = {
        "image": (image, w.image.astype(numpy.int32)),
        "orientation": (orientation, w.orientation.astype(numpy.float32)),
        "velocity": (velocity, w.velocity.astype(numpy.float32)),
    }
    names = [chr(ord("A") + k).encode() + b"\0" for k in range(max(1, len(shapes or ())))]
    with gsd.fl.open(path, "wb", application="test", schema="hoomd", schema_version=(1, 4)) as file:
        for k, step in enumerate(w.steps):
            file.write_chunk("configuration/step", numpy.array([step], numpy.uint64))
            if box(k) is not None:
                file.write_chunk("configuration/box", numpy.array(box(k), numpy.float32))
            if k == 0:
                file.write_chunk("particles/N", numpy.array([w.position.shape[1]], numpy.uint32))
                file.write_chunk("particles/types", numpy.array([list(n) for n in names], numpy.int8))
                if shapes:
                    texts = [json.dumps(s).encode() + b"\0" for s in shapes]
                    width = max(map(len, texts))
                    table = numpy.array([list(t.ljust(width, b"\0")) for t in texts], numpy.int8)
                    file.write_chunk("particles/type_shapes", table)
            array = w.wrapped[k] if position == "wrapped" else w.position[k]
            file.write_chunk("particles/position", array.astype(numpy.float32))
            for name, (when, array) in chunks.items():
                default = [1, 0, 0, 0] if name == "orientation" else [0, 0, 0]
                changed = numpy.any(array[k] != (array[0] if k > 0 else default))
                if when == "each" or (when == "first" and k == 0) or (when == "changed" and changed):
                    file.write_chunk(f"particles/{name}", array[k])
            for name, make in (more or {}).items():
                if make(k) is not None:
                    file.write_chunk(name, make(k))
            file.end_frame()
            if log_only(k):
                file.write_chunk("configuration/step", numpy.array([step], numpy.uint64))
                file.write_chunk("log/energy", numpy.array([1.5], numpy.float64))
                file.end_frame()
