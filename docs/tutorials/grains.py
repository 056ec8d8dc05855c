# %% [markdown]
# # Grains that press on each other
#
# Grains of any shape touch in faces. A step of the discrete element method needs the area over which two grains overlap
# and how deep: `contact_patch_many` has both. Here they make forces of an elastic foundation, first for a small pile
# that comes to rest, then for a step of ten thousand grains.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import hardbody as hb

Array = NDArray[np.float64]
grain = hb.Superellipsoid([0.5, 0.5, 0.5], 0.5, 0.5)
floor = hb.Box([50, 50, 1])
kinds: list[hb.Shape] = [grain, floor]
mass, moment = 1.0, float(grain.inertia(1.0)[0])

# %% [markdown]
# Overlapping pairs come from a scene. The patch with `within=0` is the area over which two grains overlap; a foundation
# of stiffness k presses with k times the mean depth on each part of it, along the normal and at its centre. The mean
# depth of a cap is half of the deepest one, which is the distance. A damper acts against the rate at the centre.

# %%
stiffness, damping, friction = 2e4, 30.0, 0.4


class Grains:
    """Grains in a scene, the last body of which is the floor."""

    def __init__(self, positions: Array, with_floor: bool) -> None:
        n = len(positions)
        self.number = n
        self.positions = np.concatenate([positions, [[0, 0, -1]]]) if with_floor else positions.copy()
        self.quaternions = np.tile([1.0, 0, 0, 0], (len(self.positions), 1))
        self.shape_of = np.array([0] * n + [1] * (len(self.positions) - n))
        self.velocities, self.spins = np.zeros_like(self.positions), np.zeros_like(self.positions)
        self.scene = hb.Scene(margin=0.05)
        self.bodies = self.scene.add_many(kinds, self.positions, self.quaternions, self.shape_of)
        self.contacts = 0

    def forces(self, threads: int = 2) -> tuple[Array, Array]:
        """Forces and torques on all bodies, shape (N, 3) each."""
        near = self.scene.overlapping_pairs(threads)
        pairs = np.stack([near.i, near.j], axis=1)
        places, turns = self.positions, self.quaternions
        at = hb.distance_many(kinds, places, turns, pairs, self.shape_of, threads, penetration="local")
        patch = hb.contact_patch_many(kinds, places, turns, pairs, 0.0, self.shape_of, threads, tolerance=0.05)
        self.contacts = len(pairs)
        a, b = pairs[:, 0], pairs[:, 1]
        arm_a, arm_b = patch.centre - self.positions[a], patch.centre - self.positions[b]
        rate = self.velocities[b] + np.cross(self.spins[b], arm_b) - self.velocities[a] - np.cross(self.spins[a], arm_a)
        normal_rate = (rate * at.normal).sum(axis=1)
        depth = np.maximum(-at.distance, 0)
        # Distances of bodies that only touch may have an empty patch, and no force.
        push = np.where(patch.area > 0, np.maximum(stiffness * patch.area * depth / 2 - damping * normal_rate, 0), 0.0)
        slip = rate - normal_rate[:, None] * at.normal
        speed = np.linalg.norm(slip, axis=1)
        drag = np.minimum(friction * push, damping * speed) / np.maximum(speed, 1e-300)
        force_b = push[:, None] * at.normal - drag[:, None] * slip
        force, torque = np.zeros_like(self.positions), np.zeros_like(self.positions)
        np.add.at(force, b, force_b)
        np.add.at(force, a, -force_b)
        np.add.at(torque, b, np.cross(arm_b, force_b))
        np.add.at(torque, a, -np.cross(arm_a, force_b))
        return force, torque

    def step(self, dt: float, gravity: float) -> None:
        force, torque = self.forces()
        n = self.number
        self.velocities[:n] += dt * (force[:n] / mass + [0, 0, -gravity])
        self.spins[:n] += dt * torque[:n] / moment  # three equal moments: no gyroscopic term
        self.positions[:n] += dt * self.velocities[:n]
        w, u = self.quaternions[:n, :1], self.quaternions[:n, 1:]
        half = 0.5 * dt * self.spins[:n]
        turned = np.concatenate([w - (half * u).sum(axis=1, keepdims=True), u + w * half + np.cross(half, u)], axis=1)
        self.quaternions[:n] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
        self.scene.move_many(self.bodies[:n], self.positions[:n], self.quaternions[:n])

    def kinetic_energy(self) -> float:
        return 0.5 * mass * float((self.velocities**2).sum()) + 0.5 * moment * float((self.spins**2).sum())


# %% [markdown]
# A pile of 27 grains falls by a little and comes to rest: the kinetic energy decays, and no grain rocks.

# %%
grid = np.stack(np.meshgrid([0, 1.05, 2.1], [0, 1.05, 2.1], [0, 1.02, 2.04], indexing="ij"), axis=-1).reshape(-1, 3)
pile = Grains(grid + [0, 0, 0.51], with_floor=True)
dt, energies = 2e-3, []
for _ in range(900):
    pile.step(dt, gravity=9.81)
    energies.append(pile.kinetic_energy())
print(f"kinetic energy: at most {max(energies):.2g}, at the end {energies[-1]:.2g}; {pile.contacts} contacts")
assert energies[-1] < 1e-3 * max(energies)
height = pile.positions[:27, 2].max()
assert 2.4 < height < 2.56

# %%
figure, axis = plt.subplots(figsize=(6, 3.5), layout="constrained")
axis.semilogy(dt * np.arange(1, len(energies) + 1), energies)
axis.set(xlabel="time", ylabel="kinetic energy", title="27 grains come to rest")
figure.savefig("grains.png")

# %% [markdown]
# Ten thousand grains that overlap a little, each with its neighbours: one step, and what its parts take. Forces are
# equal and opposite, so that the momentum stays.

# %%
edge = 22
random = np.random.default_rng(3)
cube = np.stack(np.meshgrid(*[0.999 * np.arange(edge)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)[:10_000]
many = Grains(cube + random.uniform(-2e-4, 2e-4, cube.shape), with_floor=False)
many.velocities[:] = 0.1 * random.normal(size=many.velocities.shape)
momentum = many.velocities.sum(axis=0)
begin = time.perf_counter()
many.step(1e-3, gravity=0.0)
print(f"{many.number} grains, {many.contacts} contacts: a step takes {time.perf_counter() - begin:.1f} s")
assert many.contacts > 20_000
assert np.abs(many.velocities.sum(axis=0) - momentum).max() < 1e-9
