# %% [markdown]
# # A first fluid
#
# 128 hard spheroids, three times as long as they are wide, at a packing fraction of 0.3: from a random start to
# pressure, diffusion and orientational order. Run this file as a script, or cell by cell in an editor that knows
# `# %%`.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hardbody as hb

# %% [markdown]
# `Ellipsoid.spheroid(3.0)` has the volume of the unit sphere: the unit of length is the radius of that sphere. Masses
# and kT are 1. By default the moments of inertia of ellipsoids of revolution are those of De Michele (2010), 2/5 of the
# square of the smaller semi-axis, without spin about the axis; `hb.Species(shape, inertia="uniform")` has those of
# uniform density. `random_start` compresses a random gas until the packing fraction is reached, without a single
# overlap. The seed makes the run repeatable to the last bit.

# %%
start = hb.random_start(hb.Ellipsoid.spheroid(3.0), number=128, packing_fraction=0.3, seed=1)
print(start)

# %% [markdown]
# The start still remembers its compression. We let the fluid relax and watch the nematic order S every half time unit:
# it stays near 1 / sqrt(N), so the fluid is isotropic.

# %%
relaxing = hb.Simulation(start)
order: list[float] = []
relaxing.run(time=5, every=0.5, callback=lambda simulation: order.append(simulation.system.nematic_order))
print(f"{relaxing.collisions} collisions, S = {np.mean(order):.2f}")
assert max(order) < 0.3

# %% [markdown]
# Production is a new simulation of the relaxed state. `measure` samples observables on the way; every value comes with
# its standard error, or with the reason for which it is missing.

# %%
fluid = hb.Simulation(relaxing.system)
observables = fluid.measure(duration=60, longest_lag=8)
fluid.run(time=60)
results = observables.results()
for name in ("Z", "S", "D_trans", "D_rot", "t_C2_1overe"):
    print(f"{name:12} {results[name]}")

# %% [markdown]
# Curves are structured arrays with a column of errors beside each value. Short times are ballistic: <dr^2> = 3 t^2 in
# these units, because <v^2> = 3.

# %%
msd = results["msd"]
figure, axes = plt.subplots(layout="constrained")
axes.errorbar(msd["t"], msd["msd"], msd["msd_error"], label="spheroids, a/b = 3, packing fraction 0.3")
axes.plot(msd["t"], 3 * msd["t"] ** 2, "k:", label="ballistic: $3 t^2$")
axes.set(xscale="log", yscale="log", ylim=(1e-5, 100), xlabel="t", ylabel="mean square displacement")
axes.legend()
figure.savefig("first_fluid.png")
assert np.isclose(msd["msd"][0], 3 * msd["t"][0] ** 2, rtol=0.05)

# %% [markdown]
# Is it right? No contact was missed: an audit computes all distances from scratch. Energy is conserved to rounding.
# And spheres have the pressure of Carnahan and Starling's equation of state.

# %%
audit = fluid.system.audit()
change = fluid.kinetic().energy / relaxing.kinetic().energy - 1
print(f"{audit}, energy changed by {change:.0e}")
assert audit.sound and abs(change) < 1e-12

phi = 0.3
spheres = hb.Simulation(hb.random_start(hb.Ellipsoid([1, 1, 1]), number=128, packing_fraction=phi, seed=1))
spheres.run(time=3)
production = hb.Simulation(spheres.system)
measured = production.measure(duration=20)
production.run(time=20)
Z = measured.results()["Z"]
theory = (1 + phi + phi**2 - phi**3) / (1 - phi) ** 3
print(f"Z of spheres: {Z}, Carnahan and Starling: {theory:.4f}")
assert abs(Z.value - theory) < 4 * Z.error + 0.01 * theory  # 0.01: a small system
