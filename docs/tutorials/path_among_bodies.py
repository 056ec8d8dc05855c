# %% [markdown]
# # A path among a thousand bodies
#
# An ellipsoid is to pass through a crowd of a thousand bodies of four kinds. The straight way runs through some of
# them. Its configurations are moved and turned along the exact gradients of their distances, until all are free; then
# the way between them is shown to be free, too.

# %%
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import hardbody as hb

Array = NDArray[np.float64]
random = np.random.default_rng(7)
length, number = 20.0, 1000

# %% [markdown]
# The crowd stands in a cube. Bodies that are close to both ends of the way are left out.

# %%
mover = hb.Ellipsoid([0.25, 0.35, 0.8])
kinds: list[hb.Shape] = [
    hb.Ellipsoid([0.4, 0.6, 0.8]),
    hb.Box([0.4, 0.5, 0.6]),
    hb.Capsule(0.6, 0.35),
    hb.Superellipsoid([0.5, 0.5, 0.7], 0.5, 0.5),
]
start, goal = np.array([0.5, 1.0, 1.0]), np.array([19.5, 19.0, 18.0])
places = random.uniform(0, length, (3 * number, 3))
far = np.minimum(np.linalg.norm(places - start, axis=1), np.linalg.norm(places - goal, axis=1)) > 2.2
places = places[far][:number]
turns = random.normal(size=(number, 4))
turns /= np.linalg.norm(turns, axis=1, keepdims=True)
kind_of = np.arange(number) % len(kinds)

# %% [markdown]
# Crowd and configurations are bodies of one scene. Configurations are in a group of their own: they meet the crowd, not
# each other.

# %%
scene = hb.Scene(margin=0.05)
scene.add_many(kinds, places, turns, kind_of, group=1, meets=2)
steps = 400
s = np.linspace(0, 1, steps)
positions = start + s[:, None] * (goal - start)
quaternions = np.tile([1.0, 0, 0, 0], (steps, 1))
path = scene.add_many(mover, positions, quaternions, group=2, meets=1)
print(f"{(scene.pairs_within(0.0).distance < 0).sum()} overlaps on the straight way")

# %% [markdown]
# The distance d of body B from A has the gradient n by the position of B, and s x n by its turning, s the arm from its
# centre to the closest point. Each pair that is closer than `clearance` pushes its configuration, in proportion to what
# is missing; neighbours pull each other along the way like springs.

# %%
clearance, reach = 0.15, 0.8


def turned(q: Array, rotation: Array) -> Array:
    """Quaternions turned by rotation vectors, world frame."""
    angle = np.linalg.norm(rotation, axis=1, keepdims=True)
    w, u = np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) / 2 * rotation
    scalar = w * q[:, :1] - (u * q[:, 1:]).sum(axis=1, keepdims=True)
    vector = w * q[:, 1:] + q[:, :1] * u + np.cross(u, q[:, 1:])
    product: Array = np.concatenate([scalar, vector], axis=1)
    product /= np.linalg.norm(product, axis=1, keepdims=True)
    return product


def turn_between(q: Array, p: Array) -> Array:
    """Rotation vectors of small turns from quaternions q to p, world frame."""
    vector: Array = q[:, :1] * p[:, 1:] - p[:, :1] * q[:, 1:] + np.cross(q[:, 1:], p[:, 1:])
    vector *= 2 * np.sign((q * p).sum(axis=1, keepdims=True))
    return vector


for iteration in range(2000):
    near = scene.pairs_within(clearance)
    row = near.j - path[0]  # handles of the configurations are the larger ones
    if (near.distance > 0.5 * clearance).all() and iteration > 50:
        break
    missing = (clearance - near.distance)[:, None]
    push, torque = np.zeros((steps, 3)), np.zeros((steps, 3))
    np.add.at(push, row, missing * near.normal)
    np.add.at(torque, row, missing * np.cross(near.point_b - positions[row], near.normal))
    spring = np.zeros((steps, 3))
    spring[1:-1] = positions[2:] - 2 * positions[1:-1] + positions[:-2]
    bend = np.zeros((steps, 3))
    bend[1:-1] = turn_between(quaternions[1:-1], quaternions[2:]) + turn_between(quaternions[1:-1], quaternions[:-2])
    move = 0.5 * push + 0.3 * spring
    move[[0, -1]] = 0
    positions += np.clip(move, -0.1, 0.1)
    quaternions = turned(quaternions, np.clip(0.5 * torque / reach**2 + 0.3 * bend, -0.1, 0.1))
    scene.move_many(path, positions, quaternions)
print(f"{iteration} iterations, least distance {near.distance.min(initial=clearance):.3f}")

# %% [markdown]
# Is the gradient that? `distance_derivatives_many` has it beside the Hessian, for the pairs of the last look.

# %%
exact = hb.distance_derivatives_many(
    [*kinds, mover],
    np.concatenate([places, positions]),
    np.concatenate([turns, quaternions]),
    np.stack([near.i, near.j], axis=1),
    shape_of=np.concatenate([kind_of, np.full(steps, len(kinds))]),
)
assert np.allclose(exact.gradient[:, 6:9], near.normal, atol=1e-9)
assert np.allclose(exact.gradient[:, 9:12], np.cross(near.point_b - positions[row], near.normal), atol=1e-8)

# %% [markdown]
# Between two configurations the ellipsoid moves straight and turns about a fixed axis: none of its points moves by more
# than the path of its centre plus `reach` times the angle. Where that is less than both distances together, the way
# between is free.

# %%
distance = np.array([scene.nearest_to(body).result.distance for body in path])
angle = 2 * np.arccos(np.clip(np.abs((quaternions[1:] * quaternions[:-1]).sum(axis=1)), 0, 1))
moved = np.linalg.norm(np.diff(positions, axis=0), axis=1) + reach * angle
crowd = hb.Scene()
crowd.add_many(kinds, places, turns, kind_of)
fine = moved < distance[1:] + distance[:-1]
print(f"{fine.sum()} of {steps - 1} stretches are free at once")
for k in np.flatnonzero(~fine):  # the others: many configurations between
    parts = int(np.ceil(4 * moved[k] / (0.25 * clearance)))
    t = np.linspace(0, 1, parts + 1)[:, None]
    sign = np.sign((quaternions[k] * quaternions[k + 1]).sum())
    axis = sign * quaternions[k + 1] - quaternions[k] * np.cos(angle[k] / 2)
    axis /= np.linalg.norm(axis) or 1.0
    between = np.cos(t * angle[k] / 2) * quaternions[k] + np.sin(t * angle[k] / 2) * axis
    X = [hb.Pose.normalized(p, q) for p, q in zip((1 - t) * positions[k] + t * positions[k + 1], between, strict=True)]
    d = np.array([crowd.nearest(mover, x).result.distance for x in X])
    assert (moved[k] / parts < d[1:] + d[:-1]).all()

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(s, distance)
axes.set(xlabel="configuration", ylabel="distance from the nearest body", ylim=(0, None))
figure.savefig("path_among_bodies.png")
