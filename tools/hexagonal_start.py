#!/usr/bin/env python3
"""Writes a LAMMPS dump of 896 superellipsoids 1 : 1 : 0.4 in hexagonal columns, a start for `[start] file`.

usage: hexagonal_start.py FILE

56 columns of 16 bodies, each column at a height of its own, in a cubic box at packing fraction 0.62; the triangular
lattice is stretched by 1 % to fit. docs/ordered-phases.md has the hexatic order of a run from it.
"""

import random
import sys

SPACING, COLUMNS, ROWS, IN_COLUMN = 2.15, 7, 8, 16
NAMES = "id type x y z quatw quati quatj quatk shapex shapey shapez SuperquadricRoundness.Phi SuperquadricRoundness.Theta"


def main(file):
    draws = random.Random(1)
    edge = COLUMNS * SPACING
    lines = []
    for row in range(ROWS):
        for column in range(COLUMNS):
            offset = draws.random()
            for k in range(IN_COLUMN):
                x, y, z = (column + 0.5 * (row % 2)) * SPACING, row * edge / ROWS, (k + offset) * edge / IN_COLUMN
                lines.append(f"{len(lines) + 1} 1 {x % edge!r} {y!r} {z % edge!r} 1 0 0 0 2 2 0.8 1 0.3\n")
    with open(file, "w") as out:
        out.write(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{len(lines)}\nITEM: BOX BOUNDS pp pp pp\n")
        out.write(f"0 {edge!r}\n" * 3 + f"ITEM: ATOMS {NAMES}\n" + "".join(lines))


if __name__ == "__main__":
    main(sys.argv[1])
