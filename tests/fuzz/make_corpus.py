"""Writes the inputs that the fuzzers start from: `make_corpus.py DIR` fills DIR/line, DIR/geom, DIR/scene,
DIR/checkpoint, DIR/gsd and DIR/lammps.

The same files every time: the draws are seeded.
"""

import json
import os
import random
import struct
import sys


def lines():
    ellipsoid = {"kind": "ellipsoid", "semi_axes": [1, 1, 3]}
    brick = {"kind": "superellipsoid", "semi_axes": [1, 2, 0.5], "exponents": [0.5, 1.3]}
    for a in [ellipsoid, brick]:
        for b in [ellipsoid, brick]:
            body_a = {"shape": a, "position": [0, 0, 0], "orientation": [1, 0, 0, 0]}
            body_b = {"shape": b, "position": [4, 0.25, -2.5e-1], "orientation": [0.5, -0.5, 0.5, 0.5]}
            pair = {"a": body_a, "b": body_b}
            for more in [
                {},
                {"id": 7},
                {"id": {"k": [None, "\u00e9\n"]}, "method": "dual"},
                {"method": "newton8"},
                {"method": "newton5", "seed": "centres"},
                {"penetration": "local", "b": {**body_b, "position": [0.5, 0, 0]}},
                {"b": {"shape": b, "position": [1e300, -1e-300, 0]}},
                {"method": "newton6"},
                {"a": {**body_a, "orientation": [1, 1, 0, 0]}},
                {"velocity": 1},
            ]:
                yield json.dumps({**pair, **more})
    yield from ["", "{", "null", "[" * 200, '{"a":1,"a":2}', '{"id":1e999}', '{"id":"\\ud800"}']


def gsd_files():
    """A byte 0 and a file, or another byte and changes of a file that the target makes, most of them of its head."""
    draws = random.Random(2)
    magic = 0x65DF65DF65DF65DF

    def file(index=256, entries=1, names=288, blocks=1, version=0x20000, entry=(0, 1, 352, 1, 0, 3, 0)):
        head = struct.pack("<QQQQQII", magic, index, entries, names, blocks, 0x10004, version)
        head += b"fuzz".ljust(64, b"\0") + b"hoomd".ljust(64, b"\0") + bytes(80)
        return head + struct.pack("<QQqIHBB", *entry) + b"particles/N".ljust(64, b"\0") + struct.pack("<I", 1)

    yield b"\0" + file()
    yield b"\0" + file()[:100]
    for change in [
        {"index": 2**63},
        {"entries": 2**59},
        {"names": 2**64 - 1},
        {"blocks": 2**58},
        {"version": 0x30000},
        {"entry": (0, 2**63, 352, 2**31, 0, 10, 0)},
        {"entry": (2**63, 1, 352, 1, 0, 3, 0)},
        {"entry": (0, 1, -1, 1, 0, 3, 0)},
        {"entry": (0, 1, 352, 1, 9, 3, 0)},
        {"entry": (0, 1, 352, 1, 0, 99, 0)},
        {"entry": (0, 1, 352, 0, 0, 3, 0)},
        {"entry": (0, 1, 352, 1, 0, 3, 1)},
    ]:
        yield b"\0" + file(**change)
    for k in range(120):
        limit = 2000 if k % 2 else 2**16
        places = [draws.randrange(limit) for _ in range(k % 8 + 1)]
        changes = b"".join(struct.pack(">HB", place, draws.choice([0, 1, 127, 128, 255])) for place in places)
        yield b"\1" + changes
        yield b"\2" + changes


def dumps():
    """LAMMPS dumps, most of them with something that is not as it should be."""
    columns = "id type x y z quatw quati quatj quatk shapex shapey shapez SuperquadricRoundness.Phi SuperquadricRoundness.Theta vx vy vz"
    body = "{id} {type} {x} 0 0 {q} 0 0 0 1 1 2 0.5 0.5 1 0 0"

    def dump(count=2, bounds=("-5 5",) * 3, names=columns, frames=1, flags="pp pp pp", head=(), body=body, **other):
        values = {"type": 1, "x": 1, "q": 1, **other}
        bodies = [body.format(**{"id": k + 1, **values}) for k in range(2)]
        frame = [*head, "ITEM: TIMESTEP", "0", "ITEM: NUMBER OF ATOMS", str(count), f"ITEM: BOX BOUNDS {flags}", *bounds,
                 "ITEM: ATOMS " + names, *bodies]
        return ("\n".join(frame) + "\n") * frames

    yield dump()
    yield dump(frames=3)
    yield dump(names=columns.replace(" x y z ", " xs ys zs "))
    yield dump(names=columns.replace(" x y z ", " xu yu zu "))
    yield dump(names=columns.replace(" x y z ", " xsu ysu zsu "), frames=2)
    for names in ["id type x y z ix iy iz", "id type xu yu zu ix iy iz", "id xs ys zs ix iy iz mass", "id type x y z radius ix iy",
                  "id type x y z diameter vx vy", "id type x y z c_orient[1] c_orient[2] c_orient[3]",
                  "type id xu yu zu angmomx angmomy angmomz", "x y z id type omegax omegay omegaz"]:
        numbers = " ".join(["{id}", "1"] + (len(names.split()) - 2) * ["{x}"])
        yield dump(names=names, frames=3, body=numbers)
    for tilt in ["0", "-0.0", "1", "nan"]:
        yield dump(bounds=(f"-5 5 {tilt}",) * 3, flags="xy xz yz pp pp pp")
    yield dump(bounds=("10 0 0 -5", "0 10 0 -5", "0 0 10 -5"), flags="abc origin pp pp pp")
    yield dump(frames=2, head=["ITEM: UNITS", "lj", "ITEM: TIME", "0.5"])
    yield dump(frames=2, flags="")
    for names in ["id type x y z ix iy iz", "id type xsu ysu zsu radius", "type x y z xu yu zu", "id x ys zu iy diameter mass",
                  "id type x y z omegax omegay omegaz", "id x y z c_orient[1] c_orient[2] block1 block2",
                  columns.replace("vx vy vz", "angmomx angmomy angmomz") + " mass", "id x y z shapex shapey shapez"]:
        rows = [" ".join([str(k + 1), "1"] + ["1"] * (len(names.split()) - 2)) for k in range(2)]
        if "quatw" in names:
            rows = [f"{k + 1} 1 1 0 0 1.0005 0 0 0 1 1 2 0.5 0.5 1 0 0 2" for k in range(2)]
        for head, tilt in [("", ""), (" xy xz yz", " 0"), (" xy xz yz", " 1"), (" abc origin", None)]:
            text = dump(names=names).replace("BOUNDS", "BOUNDS" + head)
            bounds = ["-5 5" + (tilt or "")] * 3 if tilt is not None else ["9 0 0 -5", "0 9 0 -5", "0 0 9 -5"]
            begin, rest = text.split("-5 5\n" * 3)
            yield begin + "\n".join(bounds) + "\n" + rest.split("\n")[0] + "\n" + "\n".join(rows) + "\n"
    yield dump()[:200]
    for count in ["2147483648", "-1", "0", "nan", "1e300", "2.5", ""]:
        yield dump(count=count)
    for bound in ["-1e308 1e308", "5 -5", "0 0", "nan 1", "-5 5 1", "0 1e-320"]:
        yield dump(bounds=(bound, "-5 5", "-5 5"))
    for change in [{"x": "1e17"}, {"x": "-1e308"}, {"x": "nan"}, {"q": 0}, {"q": 2}, {"type": 0}, {"type": 10**9}, {"id": "x"}]:
        yield dump(**change)
    yield dump(names="id type")
    yield dump(names=columns + " more")


def main(directory):
    draws = random.Random(1)
    geom = [bytes(draws.randrange(256) for _ in range(160)) for _ in range(64)]
    # A byte that says of what, then changes of three bytes each, or a payload.
    checkpoint = [bytes([k % 5]) + bytes(draws.randrange(256) for _ in range(3 * (k % 40))) for k in range(120)]
    scene = [bytes(draws.randrange(256) for _ in range(256)) for _ in range(64)]
    line = [line.encode() for line in lines()]
    for name, inputs in [("line", line), ("geom", geom), ("scene", scene), ("checkpoint", checkpoint), ("gsd", list(gsd_files())),
                         ("lammps", [text.encode() for text in dumps()])]:
        os.makedirs(os.path.join(directory, name), exist_ok=True)
        for k, data in enumerate(inputs):
            with open(os.path.join(directory, name, f"seed{k:03}"), "wb") as file:
                file.write(data)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit("usage: make_corpus.py DIRECTORY")
    main(sys.argv[1])
