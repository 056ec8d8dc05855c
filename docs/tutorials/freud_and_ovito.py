# %% [markdown]
# # From hardbody to freud and OVITO, and back
#
# A run writes its frames to a GSD file, which freud and OVITO read: both analyse it here. OVITO then makes a larger
# system of the last frame, which goes on in hardbody. Needs the packages gsd, freud-analysis, ovito and matplotlib.

# %%
import freud
import matplotlib.pyplot as plt
import numpy as np
from ovito.io import export_file, import_file
from ovito.modifiers import ReplicateModifier

import hardbody as hb

# %% [markdown]
# Sixty-four spheroids, three times as long as wide, and 33 frames of 16 time units.

# %%
run = hb.run(
    {
        "seed": 1,
        "system": {"number": 64, "packing_fraction": 0.35},
        "shape": {"aspect_ratio": 3.0},
        "equilibration": {"time": 2.0},
        "production": {"time": 16.0},
        "output": {"trajectory": ["gsd"], "frames": 33},
    },
    out="out/fluid",
    force=True,
)
frames = run.trajectory()
print(len(frames), "frames,", frames[0].particles.type_shapes)

# %% [markdown]
# **freud**: g(r) over all frames. `analyze` computes the same from the same file; with its bins, and freud's
# normalization for a finite number of bodies, both agree to the single precision that freud computes in.

# %%
ours = hb.analyze(run, longest_lag=4.0).observables["g_r"]
bins, width = len(ours) - 1, ours["r"][1] - ours["r"][0]  # the last bin ends at half the box, which freud refuses
rdf = freud.density.RDF(bins=bins, r_max=bins * width, normalization_mode="finite_size")
for frame in frames:
    rdf.compute((frame.configuration.box, frame.particles.position), reset=False)
difference = np.abs(rdf.rdf - ours["g"][:bins]).max()
print(f"g(r): largest difference {difference:.0e}")
assert difference < 1e-3

# %% [markdown]
# The nematic order of the last frame, of the axes of revolution: body z, turned by the quaternions (w, x, y, z).

# %%
w, x, y, z = frames[-1].particles.orientation.T
axes_of_bodies = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
nematic = freud.order.Nematic()
nematic.compute(axes_of_bodies)
S = frames[-1].log["hardbody/S"][0]
print(f"S: freud {nematic.order:.6f}, hardbody {S:.6f}")
assert abs(nematic.order - S) < 1e-5

# %%
figure, axes = plt.subplots(layout="constrained")
axes.errorbar(ours["r"], ours["g"], ours["g_error"], label="hardbody", lw=1)
axes.plot(rdf.bin_centers, rdf.rdf, "k:", label="freud")
axes.set(xlabel="r", ylabel="g(r)")
axes.legend()
figure.savefig("freud_and_ovito.png")

# %% [markdown]
# **OVITO** shows the bodies as the ellipsoids they are: their semi-axes and orientations are in the file.

# %%
pipeline = import_file(str(run.path / "trajectory.gsd"))
data = pipeline.compute(pipeline.source.num_frames - 1)
print("semi-axes", data.particles["Aspherical Shape"][0])
assert np.allclose(
    data.particles["Aspherical Shape"][0], frames[0].particles.type_shapes[0]["c"] * np.array([1, 1, 3]) / 3
)

# %% [markdown]
# It also edits: eight copies of the last frame make a box of 512 bodies.

# %%
pipeline.modifiers.append(ReplicateModifier(num_x=2, num_y=2, num_z=2))
export_file(pipeline, "replicated.gsd", "gsd/hoomd", frame=pipeline.source.num_frames - 1)

# %% [markdown]
# **And back.** Files of hardbody are read bit for bit. OVITO's has positions, orientations and velocities in single
# precision and no shapes: `components` gives the shapes, and `mend` removes overlaps due to rounding.

# %%
same = hb.from_gsd(run.path / "trajectory.gsd")
print(same, f"Z so far {run.summary['observables']['Z']['value']:.2f}")

spheroid = hb.Species(hb.Ellipsoid.spheroid(3.0), inertia="paper")
large = hb.from_gsd("replicated.gsd", components=[(spheroid, 512)], mend=True)
print(large)
assert len(large) == 512 and abs(large.box / same.box - 2) < 1e-5
assert abs(large.packing_fraction - 0.35) < 1e-4 and abs(large.nematic_order - same.nematic_order) < 1e-4

# %% [markdown]
# Copies start with equal velocities: new ones are drawn.

# %%
simulation = hb.Simulation(large.thermalized(seed=2))
simulation.run(time=1)
print(simulation, simulation.audit())
assert simulation.audit().sound
