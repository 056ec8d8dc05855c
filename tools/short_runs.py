"""Group `short` of tools/validate: what short runs print of diffusion and decays, against one long run of each state."""

import csv
import json
import math

KINDS = {
    "D_trans": ("msd.csv", 6), "D_rot": ("rotational_msd.csv", None),
    "tau_C2": (None, None), "tau_F": (None, None),
}
PRODUCTIONS = (2, 3, 5, 8, 12, 20, 40, 100, 200)
AUTO = "auto"


def spheroids(X0):
    return f"[shape]\naspect_ratio = {X0}\n"


def ellipsoids(*axes):
    return f'[shape]\nsemi_axes = {list(axes)}\n[dynamics]\ninertia = "uniform"\n'


def superballs(e):
    return f'[shape]\nkind = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [{e}, {e}]\n[dynamics]\ninertia = "uniform"\n'


def mixture(first, second):
    return "".join(f"[[species]]\nsemi_axes = {list(axes)}\nfraction = 0.5\n" for axes in (first, second))


POLYDISPERSE = '[[species]]\nsemi_axes = [1, 1, 1]\nsizes = "gaussian"\nwidth = 0.1\nsize_seed = 1\n'
SPHERES = mixture((1, 1, 1), (1.4, 1.4, 1.4))

# Name: bodies, packing fraction, number, lattice or None, cap of the equilibration, production of the long run.
STATES = {
    "spheres 0.001": (spheroids(1), 0.001, 256, None, 30, 1000),
    "spheres 0.30": (spheroids(1), 0.30, 256, None, 50, 400),
    "spheres 0.45": (spheroids(1), 0.45, 256, None, 50, 400),
    "spheres 0.53": (spheroids(1), 0.53, 256, None, 50, 800),
    "spheres, sizes 10 %, 0.56": (POLYDISPERSE, 0.56, 256, None, 100, 800),
    "spheres, sizes 10 %, 0.58": (POLYDISPERSE, 0.58, 256, None, 100, 800),
    "spheres 1 : 1.4, 0.50": (SPHERES, 0.50, 256, None, 50, 400),
    "spheres 1 : 1.4, 0.58": (SPHERES, 0.58, 256, None, 100, 800),
    "fcc crystal of spheres 0.55": (spheroids(1), 0.55, 256, "fcc", 20, 300),
    "fcc crystal of spheres 0.60": (spheroids(1), 0.60, 256, "fcc", 20, 300),
    "X0 = 0.3, 0.45": (spheroids(0.3), 0.45, 256, None, 100, 400),
    "X0 = 0.5, 0.50": (spheroids(0.5), 0.50, 256, None, 50, 400),
    "X0 = 1.1, 0.50": (spheroids(1.1), 0.50, 256, None, 100, 400),
    "X0 = 1.4, 0.50": (spheroids(1.4), 0.50, 256, None, 50, 400),
    "X0 = 1.4, 0.60": (spheroids(1.4), 0.60, 256, None, 100, 800),
    "X0 = 1.4, 0.64": (spheroids(1.4), 0.64, 256, None, 100, 800),
    "X0 = 2, 0.01": (spheroids(2), 0.01, 256, None, 30, 800),
    "X0 = 2, 0.45": (spheroids(2), 0.45, 256, None, 50, 400),
    "X0 = 2, 0.55": (spheroids(2), 0.55, 256, None, 100, 400),
    "X0 = 2, 0.60": (spheroids(2), 0.60, 256, None, 100, 800),
    "X0 = 3, 0.10": (spheroids(3), 0.10, 256, None, 50, 400),
    "X0 = 3, 0.40": (spheroids(3), 0.40, 256, None, 50, 400),
    "X0 = 3, 0.45": (spheroids(3), 0.45, 256, None, 100, 400),
    "X0 = 3, 0.50": (spheroids(3), 0.50, 256, None, 200, 800),
    "X0 = 5, 0.20": (spheroids(5), 0.20, 512, None, 50, 400),
    "X0 = 5, 0.30": (spheroids(5), 0.30, 512, None, 100, 400),
    "nematic X0 = 4, 0.45": (spheroids(4), 0.45, 504, "fcc", 100, 400),
    "axes 1 : 1.3 : 1.8, 0.50": (ellipsoids(1, 1.3, 1.8), 0.50, 256, None, 50, 300),
    "spheres and X0 = 3, 0.45": (mixture((1, 1, 1), (0.7, 0.7, 2.1)), 0.45, 256, None, 50, 300),
    "superballs e = 0.5, 0.40": (superballs(0.5), 0.40, 216, None, 30, 300),
    "superballs e = 0.5, 0.55": (superballs(0.5), 0.55, 216, None, 50, 300),
    "cubic crystal e = 0.3, 0.60": (superballs(0.3), 0.60, 216, "cubic", 20, 200),
}


def curve(result, file):
    """Lags and means of a correlation."""
    with open(result["directory"] / "observables" / file, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))[1:]
    return [(float(row[0]), float(row[1])) for row in rows if row[1]]


def line(points):
    """Least-squares slope."""
    x0 = sum(x for x, _ in points) / len(points)
    y0 = sum(y for _, y in points) / len(points)
    return sum((x - x0) * (y - y0) for x, y in points) / sum((x - x0) ** 2 for x, _ in points)


def slope_alone(result, name, components):
    """The diffusion coefficient by the logarithmic slope alone, 1 +- 0.2 in the window; None elsewhere."""
    file, divisor = KINDS[name]
    if file is None:
        return None
    points = curve(result, file)
    window = [(t, y) for t, y in points if t >= 0.4 * points[-1][0] * (1 - 1e-9) and y > 0]
    if len(window) < 2 or abs(line([(math.log(t), math.log(y)) for t, y in window]) - 1) > 0.2:
        return None
    return line(window) / (divisor or 2 * components)


def agrees(value, error, reference, reference_error):
    return abs(value - reference) <= 0.05 * reference + 4 * math.hypot(error or 0, reference_error or 0)


# What may become of a value: in this order the columns of the table, the first three of which show numbers, the others values.
KEPT = ("right", "dropped", "lost", "wrong", "lost with auto", "auto alone")


def judge(kept, production, entry, reference, alone, is_longer):
    """Adds a value of a short run to the list where it belongs; `is_longer`: than the long run."""
    value, error = entry["value"], entry["error"]
    if value is not None:
        if reference["value"] is None and is_longer:
            kept["auto alone"].append(f"{value:.4g}")
        elif reference["value"] is not None and agrees(value, error, reference["value"], reference["error"]):
            kept["right"].append(f"{value:.4g}")
        else:
            kept["wrong"].append(f"{value:.4g} at {production}")
    elif alone is not None:
        # Without an error of its own a value counts as right within the tenth that its scatter may take.
        right = reference["value"] is not None and abs(alone - reference["value"]) <= 0.1 * reference["value"]
        kept["lost" if right else "dropped"].append(f"{alone:.4g}")
        if right and production == AUTO:
            kept["lost with auto"].append(f"{alone:.4g}")


def row(table, state, name, long_run, kept):
    """Writes a row of one state, or of all, which has numbers alone: ok without wrong values and right ones lost with "auto"."""
    cells = {}
    for column, values in kept.items():
        is_number = column in KEPT[:3] or state == "all"
        cells[column] = len(values) if is_number else ", ".join(values) or "0"
    if KINDS[name][0] is None:  # fits have no rule to compare with
        cells |= dict.fromkeys(("dropped", "lost", "lost with auto"), "-")
    table.plain_row([state, name, long_run, *cells.values()], not kept["wrong"] and not kept["lost with auto"])


def submit(runner, name, state):
    """The long run, then the short ones from its last frame."""
    bodies, phi, number, lattice, cap, production = state
    base = "short-" + "".join(c if c.isalnum() or c in ".-" else "_" for c in name)

    def runs():
        long = runner.run(f"{base}-long", bodies=bodies, phi=phi, number=number, lattice=lattice,
                          equilibration=f'"auto"\ncap = {cap}', production=production,
                          output='[output]\ntrajectory = ["gsd"]\nframes = 2\n')
        q = f"wave_numbers = [{long['wave_numbers'][0]}]"
        short = {p: runner.run(f"{base}-{p}", start=long["directory"] / "trajectory.gsd", bodies=bodies, equilibration=0,
                               production=f"{p}\n{q}") for p in PRODUCTIONS}
        short[AUTO] = runner.run(f"{base}-auto", start=long["directory"] / "trajectory.gsd", bodies=bodies,
                                 equilibration=f'"auto"\ncap = {cap}', production=f'"auto"\n{q}')
        return long, short
    return runner.pool.submit(runs)


def short(runner, table, _):
    """Each printed value within 5 % plus 4 combined standard errors of the long run's, or absent."""
    runs = {name: submit(runner, name, state) for name, state in STATES.items()}
    table.plain_heading(
        f"Short runs against long ones: productions of {', '.join(map(str, PRODUCTIONS))} and \"auto\" from the end of a long one",
        "| state | quantity | long run | printed and right | absent, was wrong | absent, was right | printed and wrong "
        "| lost with \"auto\" | \"auto\" alone | |")
    totals = {name: {column: [] for column in KEPT} for name in KINDS}
    for state, run in runs.items():
        long, shorts = run.result()
        components = 3 if "uniform" in STATES[state][0] else 2
        for name in KINDS:
            reference = long["observables"][name]
            kept = {column: [] for column in KEPT}
            for production, result in shorts.items():
                judge(kept, production, result["observables"][name], reference, slope_alone(result, name, components),
                      result["time"]["production"] > long["time"]["production"])
            shown = "absent" if reference["value"] is None else f"{reference['value']:.4g} +- {reference['error'] or 0:.2g}"
            row(table, state, name, shown, kept)
            for column, values in kept.items():
                totals[name][column] += values
    for name, kept in totals.items():
        row(table, "all", name, "", kept)
