# %% [markdown]
# # A sweep and its map
#
# How does the pressure depend on the shape of the bodies and on their density? A grid of nine state points, run two at
# a time, read as a table of pandas, and drawn as a map of contour lines.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hardbody as hb

# %% [markdown]
# A config has the sections and keys of the program's TOML files (docs/configuration.md); keys that are left out have
# their defaults. Real runs are larger, and without times they last until they are equilibrated and precise enough.

# %%
config = {
    "seed": 1,
    "system": {"number": 64},
    "equilibration": {"time": 3.0},
    "production": {"time": 10.0},
    "grid": {
        "shape.aspect_ratio": [1.0, 2.0, 3.0],
        "system.packing_fraction": {"from": 0.2, "to": 0.4, "count": 3},
    },
}
sweep = hb.sweep(config, out="out/sweep", jobs=2)

# %% [markdown]
# The table has one row a point: keys, observables with their errors, and the status. The same call again finds all
# points done and runs nothing; after an interruption it continues.

# %%
table = sweep.to_pandas()
table = table.rename(columns={"shape.aspect_ratio": "a/b", "system.packing_fraction": "phi"})
print(table[["a/b", "phi", "Z", "Z_error", "t_C2_1overe", "status"]].to_string(index=False))
assert (table["status"] == "done").all()

# %% [markdown]
# Pressure against density, a row a density and a column a shape: it grows with both.

# %%
Z = table.pivot(index="phi", columns="a/b", values="Z")
print(Z.round(2))
assert (Z.diff().dropna() > 0).all(axis=None) and (Z.diff(axis=1).iloc[:, 1:] > 0).all(axis=None)

# %% [markdown]
# Spheres have a known equation of state, that of Carnahan and Starling: a check of the whole chain. Sixty-four of them
# are a small system, good to a few per cent.

# %%
phi = np.array(Z.index)
theory = (1 + phi + phi**2 - phi**3) / (1 - phi) ** 3
deviation = Z[1] / theory - 1
print(f"spheres against Carnahan and Starling: {', '.join(f'{100 * d:+.1f} %' for d in deviation)}")
assert abs(deviation).max() < 0.08

# %% [markdown]
# The map: lines of equal pressure over shape and density, as an SVG drawing, which a notebook shows, and as points.
# Over them, by matplotlib, the table itself:

# %%
contours = sweep.map("aspect_ratio", "packing_fraction", "Z", levels=[3, 5])
print(contours.path, len(contours.lines), "points")

figure, axes = plt.subplots(layout="constrained")
filled = axes.contourf(Z.columns, Z.index, Z, levels=12)
for level in np.unique(contours.lines["level"]):
    line = contours.lines[contours.lines["level"] == level]
    axes.plot(line["shape.aspect_ratio"], line["system.packing_fraction"], "k-o", label=f"Z = {level:g}")
figure.colorbar(filled, label="Z = P V / (N kT)")
axes.set(xlabel="aspect ratio a/b", ylabel="packing fraction")
axes.legend()
figure.savefig("sweep_and_map.png")

# %% [markdown]
# Each point is a run of its own, with curves and a report; one that has not begun is None.

# %%
run = sweep.runs[-1]
assert run is not None
print(run.path, run.summary["counters"]["collisions"], "collisions")
print(run.observables["c2"].to_pandas().head(3))
