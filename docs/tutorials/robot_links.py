# %% [markdown]
# # Distances of a robot's links
#
# An arm of three links reaches past two obstacles. How close does it come to them, and to itself? Links are rounded
# boxes and ellipsoids; a motion of 2000 configurations is answered by one call.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hardbody as hb

# %% [markdown]
# The links, lengths in metres, each in its own frame: a superellipsoid with small exponents is a box with rounded
# edges, and an ellipsoid fits a forearm. Two obstacles stand in the world: a pillar and a ball.

# %%
upper_arm = hb.Superellipsoid([0.35, 0.06, 0.06], 0.3, 0.3)
forearm = hb.Ellipsoid([0.30, 0.05, 0.05])
hand = hb.Superellipsoid([0.10, 0.04, 0.02], 0.5, 0.5)
pillar = hb.Superellipsoid([0.08, 0.08, 0.60], 0.2, 1.0)
ball = hb.Ellipsoid([0.15, 0.15, 0.15])
shapes: list[hb.Ellipsoid | hb.Superellipsoid] = [upper_arm, forearm, hand, pillar, ball]
names = ["upper arm", "forearm", "hand", "pillar", "ball"]

# %% [markdown]
# Forward kinematics: `X_AB @ X_BC` is X_AC. Joints turn about z, in the shoulder also about y; the centre of a link is
# half of its length from its joint.


# %%
def turn(angle: float, axis: int) -> hb.Pose:
    quaternion = np.zeros(4)
    quaternion[0], quaternion[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return hb.Pose([0, 0, 0], quaternion)


def along(x: float) -> hb.Pose:
    return hb.Pose([x, 0, 0])


def poses(shoulder: float, lift: float, elbow: float, wrist: float) -> list[hb.Pose]:
    """Poses of the three links in the world."""
    X_shoulder = turn(shoulder, 2) @ turn(lift, 1)
    X_elbow = X_shoulder @ along(0.75) @ turn(elbow, 2)
    X_wrist = X_elbow @ along(0.65) @ turn(wrist, 2)
    return [X_shoulder @ along(0.36), X_elbow @ along(0.31), X_wrist @ along(0.11)]


steps = 2000
s = np.linspace(0, 1, steps)
joints = np.stack([-0.9 + 2.3 * s, 0.3 * np.sin(np.pi * s), 2.0 * np.sin(np.pi * s), -0.8 * s], axis=1)
obstacles = [hb.Pose([1.2, 0.75, 0.0]), hb.Pose([0.25, -0.75, 0.05])]

# %% [markdown]
# Bodies: five a step. Pairs: each link with each obstacle, and the upper arm with the hand. Neighbouring links share a
# joint: they are left out, as in any robot.

# %%
X = [X for q in joints for X in [*poses(*q), *obstacles]]
positions = np.array([x.position for x in X])
quaternions = np.array([x.quaternion for x in X])
kinds = np.tile(np.arange(5), steps)
watched = np.array([(0, 3), (0, 4), (1, 3), (1, 4), (2, 3), (2, 4), (0, 2)])
pairs = (watched + 5 * np.arange(steps)[:, None, None]).reshape(-1, 2)
R = hb.distance_many(shapes, positions, quaternions, pairs, shape_of=kinds, threads=2)
print(R)
distance = R.distance.reshape(steps, len(watched))

# %% [markdown]
# The clearance of the motion, where it is least, and the points that are closest there.

# %%
step, which = np.unravel_index(distance.argmin(), distance.shape)
row = step * len(watched) + which
a, b = (names[k] for k in watched[which])
print(f"least clearance {distance.min():.4f} m at s = {s[step]:.3f}: {a} and {b}")
print(f"from {R.point_a[row].round(3)} to {R.point_b[row].round(3)}")
assert np.allclose(R.point_a[row] + R.distance[row] * R.normal[row], R.point_b[row], atol=1e-9)

# The same by the function for one pair, and the certificate: the true distance is never less.
i, j = pairs[row]
one = hb.distance(shapes[kinds[i]], X[i], shapes[kinds[j]], X[j])
assert abs(one.distance - distance.min()) < 1e-12 and one.error_bound < 1e-9

# %% [markdown]
# And between the steps? No point of the arm moves further in a step than the arm's reach times the sum of the joints'
# paths, which are at most their largest rates `|dq/ds|` times the step. That is less than the least clearance: the
# whole motion is free, not only the configurations that were computed. (Half of it would do for an obstacle that
# stands still; the upper arm and the hand both move.)

# %%
reach = 0.75 + 0.65 + np.hypot(0.21, 0.05)  # from shoulder to elbow to wrist to the corners of the hand's far end
rates = np.array([2.3, 0.3 * np.pi, 2.0 * np.pi, 0.8])
assert (np.abs(np.diff(joints, axis=0)) <= rates * s[1] * (1 + 1e-9)).all()
largest_move = reach * rates.sum() * s[1]
print(f"no point moves more than {largest_move:.4f} m a step")
assert distance.min() > largest_move

# %%
figure, axes = plt.subplots(layout="constrained")
for k, (i, j) in enumerate(watched):
    axes.plot(s, distance[:, k], label=f"{names[i]}, {names[j]}")
axes.set(xlabel="s", ylabel="distance / m", ylim=(0, None))
axes.legend(fontsize="small")
figure.savefig("robot_links.png")
