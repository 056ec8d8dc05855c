# %% [markdown]
# # Your shape
#
# Any convex body is known by its support function h(n): how far it reaches in the direction n, and the point where. A
# Python object with that method and three radii can be used in all queries, and in simulations. Here: a capsule, all
# points within `radius` of a segment along z.

# %%
import time

import numpy as np

import hardbody as hb


class Capsule:
    """All points within `radius` of a segment along z."""

    def __init__(self, half_length: float, radius: float) -> None:
        self.half_length, self.radius = half_length, radius
        # Spheres around and inside the body, and a ball that rolls inside along the surface. Contacts are certified
        # from these: they have to be right.
        self.bounding_radius = half_length + radius
        self.inscribed_radius = radius
        self.min_curvature_radius = radius
        self.volume = np.pi * radius**2 * (2 * half_length + 4 * radius / 3)
        self.symmetry_axis = 2  # a body of revolution about z

    def support(self, n: np.ndarray) -> tuple[float, np.ndarray]:
        length = np.sqrt(n @ n)
        end = np.array([0, 0, np.copysign(self.half_length, n[2])])
        return self.half_length * abs(n[2]) + self.radius * length, end + self.radius / length * n


# %% [markdown]
# Two parallel capsules side by side, 3 apart between their axes: the gap is 3 - 2 radius = 2.

# %%
capsule = Capsule(half_length=1.0, radius=0.5)
r = hb.distance(capsule, hb.Pose(), capsule, hb.Pose([3, 0, 0]))
print(r.status, r.distance, r.normal)
assert np.isclose(r.distance, 2, rtol=1e-12)

# %% [markdown]
# For two capsules there is a closed form: the distance of their segments less both radii. 50 random pairs show the
# accuracy of the general method. Its answer is certified: the true distance is at most `error_bound` above it. Most
# answers are exact to rounding. Where the normal is across an axis the support function has a kink; there, too,
# `error_bound` is at most 1e-9 of the size, or there is no answer (docs/python-shapes.md).


# %%
def segment_distance(p: np.ndarray, u: np.ndarray, q: np.ndarray, v: np.ndarray, half: float) -> float:
    """Distance of the segments p + s u and q + t v, |s|, |t| <= half, u and v unit vectors."""
    d, b = q - p, u @ v
    s = np.clip(((d @ u) - b * (d @ v)) / max(1 - b * b, 1e-300), -half, half)
    t = np.clip(s * b - d @ v, -half, half)
    s = np.clip(t * b + d @ u, -half, half)
    return float(np.linalg.norm(d + t * v - s * u))


random = np.random.default_rng(1)
errors, bounds = [], []
begin = time.perf_counter()
for _ in range(50):
    A = hb.Pose.normalized([0, 0, 0], random.normal(size=4))
    B = hb.Pose.normalized(random.normal(size=3) * 3, random.normal(size=4))
    exact = segment_distance(A.position, A.rotation[:, 2], B.position, B.rotation[:, 2], 1.0) - 2 * 0.5
    r = hb.distance(capsule, A, capsule, B)
    if exact > 0:  # below 0: the depth, which is another question
        assert r.distance <= exact + 1e-12 and exact <= r.distance + r.error_bound + 1e-12
        errors.append(abs(r.distance - exact))
        bounds.append(r.error_bound)
print(f"errors: median {np.median(errors):.0e}, largest {max(errors):.0e}, largest error_bound {max(bounds):.0e}")
print(f"{(time.perf_counter() - begin) / 50 * 1e3:.1f} ms a pair")
assert np.median(errors) < 1e-12 and max(bounds) < 1e-8

# %% [markdown]
# A simulation also needs the moments of inertia. Those of a capsule are a cylinder's and two hemispheres', whose
# centres are shifted. Every call of `support` is a call into Python, which is for trying a shape out: such bodies make
# some hundred times fewer collisions a second than built-in ones (docs/python-shapes.md has the figures).

# %%
L, R = capsule.half_length, capsule.radius
cylinder, caps = 2 * L / (2 * L + 4 * R / 3), 4 * R / 3 / (2 * L + 4 * R / 3)  # their shares of the mass, 1
about_z = cylinder * R**2 / 2 + caps * 2 * R**2 / 5
about_x = cylinder * (R**2 / 4 + L**2 / 3) + caps * (2 * R**2 / 5 + L**2 + 3 * L * R / 4)
species = hb.Species(capsule, mass=1.0, inertia=[about_x, about_x, about_z])
fluid = hb.Simulation(hb.random_start(species, number=12, packing_fraction=0.02, seed=1))
energy = fluid.kinetic().energy
begin = time.perf_counter()
fluid.run(collisions=10)
print(f"{10 / (time.perf_counter() - begin):.0f} collisions per second; {fluid.audit()}")
assert fluid.audit().sound and np.isclose(fluid.kinetic().energy, energy, rtol=1e-12)
