"""Writes the inputs that the fuzzers start from: `make_corpus.py DIR` fills DIR/line, DIR/geom and DIR/checkpoint.

The same files every time: the draws are seeded.
"""

import json
import os
import random
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


def main(directory):
    draws = random.Random(1)
    geom = [bytes(draws.randrange(256) for _ in range(160)) for _ in range(64)]
    # A byte that says of what, then changes of three bytes each, or a payload.
    checkpoint = [bytes([k % 3]) + bytes(draws.randrange(256) for _ in range(3 * (k % 40))) for k in range(120)]
    line = [line.encode() for line in lines()]
    for name, inputs in [("line", line), ("geom", geom), ("checkpoint", checkpoint)]:
        os.makedirs(os.path.join(directory, name), exist_ok=True)
        for k, data in enumerate(inputs):
            with open(os.path.join(directory, name, f"seed{k:03}"), "wb") as file:
                file.write(data)


if __name__ == "__main__":
    main(sys.argv[1])
