"""Wave vectors of hardbody's S(q): up to 24 vectors of the box in each shell, drawn with a fixed seed
(libed/src/observables/structure.cpp), and its random numbers (libed/include/ed/random.h)."""

from __future__ import annotations

import math

_WORD = (1 << 64) - 1
_MOST = 24
_TRIES = 12


class Random:
    """xoshiro256**, seeded by splitmix64, with normal deviates by Leva's ratio of uniforms."""

    def __init__(self, seed: int) -> None:
        self.state = []
        for _ in range(4):
            seed = (seed + 0x9E3779B97F4A7C15) & _WORD
            z = (seed ^ (seed >> 30)) * 0xBF58476D1CE4E5B9 & _WORD
            z = (z ^ (z >> 27)) * 0x94D049BB133111EB & _WORD
            self.state.append(z ^ (z >> 31))

    def uniform(self) -> float:
        def rotated(x: int, k: int) -> int:
            return (x << k | x >> (64 - k)) & _WORD

        s = self.state
        result = rotated(s[1] * 5 & _WORD, 7) * 9 & _WORD
        t = s[1] << 17 & _WORD
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = rotated(s[3], 45)
        return (result >> 11) * 2.0**-53

    def normal(self) -> float:
        while True:
            u = 1 - self.uniform()
            v = 1.7156 * (self.uniform() - 0.5)
            x, y = u - 0.449871, abs(v) + 0.386595
            q = x * x + y * (0.19600 * y - 0.25472 * x)
            if q < 0.27597 or (q <= 0.27846 and v * v <= -4 * u * u * math.log(u)):
                return v / u

    def direction(self) -> tuple[float, float, float]:
        v = [self.normal() for _ in range(3)]
        norm = math.hypot(*v)
        return v[0] / norm, v[1] / norm, v[2] / norm


def shells(number: int) -> list[list[tuple[int, int, int]]]:
    """Wave vectors of each shell, in units of 2 pi / box, in a box whose shells are one unit wide."""
    random = Random(1)
    found: list[list[tuple[int, int, int]]] = []
    for shell in range(1, number + 1):
        begin, end = shell - 0.5, shell + 0.5
        vectors: list[tuple[int, int, int]] = []
        for _ in range(_TRIES * _MOST):
            if len(vectors) == _MOST:
                break
            direction = random.direction()
            size = begin + (end - begin) * random.uniform()
            n = [math.floor(size * x + 0.5) for x in direction]
            first = next((k for k in n if k), 1)
            one = (n[0], n[1], n[2]) if first > 0 else (-n[0], -n[1], -n[2])
            if begin <= math.hypot(*one) < end and one not in vectors:
                vectors.append(one)
        found.append(vectors)
    return found
