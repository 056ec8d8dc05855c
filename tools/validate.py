"""Runs hardbody at state points with known answers and compares. See tools/validate."""

import argparse
import concurrent.futures
import csv
import hashlib
import json
import math
import pathlib
import subprocess
import sys

import short_runs
from validation_tables import Table, store, write_page

REFERENCE = pathlib.Path(__file__).resolve().parent.parent / "tests" / "reference"


def read_csv(name):
    """Rows of a reference file as dictionaries; comment lines are skipped."""
    with open(REFERENCE / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def number(text):
    return float(text) if text else None


class Runner:
    """Runs the program, at most `jobs` at a time, and keeps what has been run before."""

    def __init__(self, program, out, jobs):
        self.program = str(pathlib.Path(program).resolve())
        self.out = pathlib.Path(out)
        # Results are kept for the very binary that made them.
        self.binary = hashlib.sha256(pathlib.Path(self.program).read_bytes()).hexdigest()
        self.pool = concurrent.futures.ThreadPoolExecutor(jobs)

    def submit(self, name, **settings):
        return self.pool.submit(self.run, name, **settings)

    @staticmethod
    def _bodies(settings):
        """`bodies` as they stand in a config, or ellipsoids of revolution X0."""
        return settings.get("bodies") or Runner.spheroids(settings["X0"], settings.get("inertia", "paper"))

    @staticmethod
    def spheroids(X0, inertia="paper"):
        return f'[shape]\nkind = "ellipsoid"\naspect_ratio = {X0}\n[dynamics]\ninertia = "{inertia}"\n'

    @classmethod
    def _start(cls, settings):
        """The last frame of another run's trajectory, backwards or as it is, or a start at random or on a lattice."""
        if "start" in settings:
            return f'[start]\nfile = "{settings["start"].resolve()}"\n' + settings["bodies"]
        if "reversed" in settings:
            return (f'[start]\nfile = "{settings["reversed"].resolve() / "trajectory.gsd"}"\nreverse = true\n'
                    + settings.get("bodies", ""))
        return (f'[system]\nnumber = {settings.get("number", 512)}\npacking_fraction = {settings["phi"]}\n'
                + (f'start = "{settings["lattice"]}"\n' if settings.get("lattice") else "") + cls._bodies(settings))

    def run(self, name, **settings):
        directory = self.out / name
        config = self.out / f"{name}.toml"
        text = (
            f'# program {self.binary}\n'
            f'seed = {settings.get("seed", 1)}\n'
            + self._start(settings) +
            f'[equilibration]\ntime = {settings["equilibration"]}\n'
            f'[production]\ntime = {settings["production"]}\n'
            + settings.get("output", "")
        )
        summary = directory / "summary.json"
        known = config.exists() and config.read_text() == text and (directory / "checkpoint.bin").exists()
        if not known:
            self.out.mkdir(parents=True, exist_ok=True)
            config.write_text(text)
            self._call("run", str(config), "--out", str(directory), "--force")
        elif not summary.exists() or json.loads(summary.read_text())["interrupted"]:
            self._call("resume", str(directory))
        result = json.loads(summary.read_text())
        result["directory"] = directory
        return result

    def _call(self, *arguments):
        done = subprocess.run([self.program, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or [""])[-1]
            raise SystemExit(f"hardbody {' '.join(arguments)}: exit {done.returncode}: {last}\n"
                             "The same command again keeps what is done and goes on with a run that was interrupted.")


def observable(result, name):
    entry = result["observables"][name]
    return entry["value"], entry["error"]


def mean_over(results, name):
    """Of independent runs that are equally long."""
    values = [observable(result, name) for result in results]
    return (sum(value for value, _ in values) / len(values),
            math.sqrt(sum(error * error for _, error in values)) / len(values))


def production_for(rate, collisions, number_of_bodies=512):
    """Time in which `number_of_bodies` at that collision rate collide `collisions` times."""
    return round(2 * collisions / (rate * number_of_bodies), 1)


def dynamics(runner, table, collisions):
    """The seven state points of dynamics.csv: rate, Z, D and the decay of C2. Long, for diffusion to half a percent."""
    rows = read_csv("dynamics.csv")
    runs = []
    for row in rows:
        production = max(600.0, production_for(float(row["rate"]), 7 * collisions))
        runs.append(runner.submit(f"dynamics-{row['X0']}-{row['phi']}", X0=row["X0"], phi=row["phi"],
                                  equilibration=30, production=production))
    table.heading("Dynamics of ellipsoids of revolution (dynamics.csv: independent simulation, N = 512)")
    for row, run in zip(rows, runs):
        result = run.result()
        state = f"X0 {float(row['X0']):.3g}, phi {row['phi']}"
        for name, column, allowed in (
                ("collision_rate", "rate", 0.002), ("Z", "Z", 0.003), ("D_trans", "D_trans", 0.02),
                ("D_rot", "D_rot", 0.02), ("D_rot_body", "D_rot_body", 0.02), ("t_C2_1overe", "t_C2_1overe", 0.01)):
            value, error = observable(result, name)
            table.relative(state, name, value, error, float(row[column]), allowed, number(row.get(f"{column}_err")))
        for name in ("kT_trans", "kT_rot"):
            value, error = observable(result, name)
            table.sigmas(state, name, value, error, 1.0, 3)


def pressure(runner, table, collisions):
    """Z of spheroids against independent Monte Carlo (simulations.csv)."""
    rows = [row for row in read_csv("simulations.csv") if row["system"].startswith("spheroids")]
    runs = [runner.submit(f"pressure-{row['X0']}-{row['phi']}", X0=row["X0"], phi=row["phi"], equilibration=30,
                          production=production_for(4 * float(row["Z"]), collisions)) for row in rows]
    table.heading("Pressure of spheroids (simulations.csv: independent Monte Carlo)")
    for row, run in zip(rows, runs):
        value, error = observable(run.result(), "Z")
        table.relative(f"X0 {row['X0']}, phi {row['phi']}", "Z", value, error, float(row["Z"]), 0.01,
                       float(row["Z_err"]), sigmas=3)


def spheres(runner, table, collisions):
    """Hard spheres: Z and the collision rate 3/sqrt(pi) (Z - 1) in units of the radius; and of 500, D."""
    wanted = (0.10, 0.20, 0.30, 0.40, 0.45)
    rows = [row for row in read_csv("hard_sphere_eos.csv") if any(abs(float(row["phi"]) - phi) < 1e-9 for phi in wanted)]
    runs = []
    # A rate at phi = 0.45 has an error of 0.09 % after 3 million collisions: too near to the 0.2 % that are allowed.
    for row in rows:
        rate = 3 / math.sqrt(math.pi) * (float(row["Z_BannermanLueWoodcock2010"]) - 1)
        runs.append(runner.submit(f"spheres-{row['phi']}", X0=1, phi=row["phi"], equilibration=30,
                                  production=production_for(rate, 5 * collisions)))
    simulated = [row for row in read_csv("simulations.csv") if row["system"] == "hard spheres ED"]
    # D of 500 spheres at phi = 0.47 changes by 1 % from one such run to the next.
    longer = [[runner.submit(f"spheres-500-{row['phi']}-{seed}", X0=1, phi=row["phi"], number=row["N"], equilibration=30,
                             production=production_for(float(row["rate"]) / 2, 5 * collisions, int(row["N"])), seed=seed)
               for seed in (1, 2, 3)] for row in simulated]
    table.heading("Hard spheres (hard_sphere_eos.csv: Bannerman, Lue and Woodcock 2010)")
    for row, run in zip(rows, runs):
        result = run.result()
        Z = float(row["Z_BannermanLueWoodcock2010"])
        table.relative(f"phi {row['phi']}", "Z", *observable(result, "Z"), Z, 0.01)
        table.relative(f"phi {row['phi']}", "collision_rate", *observable(result, "collision_rate"),
                       3 / math.sqrt(math.pi) * (Z - 1), 0.002)
    table.heading("500 hard spheres, three runs each (simulations.csv: independent simulation, in units of the radius)")
    for row, runs in zip(simulated, longer):
        results = [run.result() for run in runs]
        for name, column, scale, allowed, sigmas in (("Z", "Z", 1, 0.01, 3),
                                                     ("collision_rate", "rate", 0.5, 0.002, math.inf),
                                                     ("D_trans", "D", 2, 0.02, math.inf)):
            table.relative(f"phi {row['phi']}, N {row['N']}", name, *mean_over(results, name), scale * float(row[column]),
                           allowed, scale * float(row[f"{column}_err"]), sigmas)


def dilute(runner, table, collisions):
    """Against the exact kinetic theory of an infinitely dilute gas, at phi = 0.05 times Enskog's contact value, chi = (Z -
    1)/(B2 phi) with the measured Z and with Vega's. One chi for all orientations is wrong by a share that grows with
    phi, so that the collision rate is also taken to phi = 0, from 0.025 and 0.05; and the rates at which velocities are
    forgotten are also compared per collision, where chi drops out."""
    wanted = (1 / 3, 0.5, 2.0, 3.0)
    chosen = lambda name: [row for row in read_csv(name) if row.get("phi", "0.05") == "0.05"
                           and row.get("I_convention", "seed") == "seed" and any(abs(float(row["X0"]) - x) < 1e-4 for x in wanted)]
    exact = chosen("dilute_spheroid_rates.csv")
    nu0 = [float(row["nu0/phi (collisions per particle per time)"]) for row in exact]
    runs = [runner.submit(f"dilute-{row['X0']}", X0=row["X0"], phi=0.05, equilibration=30,
                          production=production_for(0.06 * rate, 2 * collisions)) for row, rate in zip(exact, nu0)]
    thinner = [runner.submit(f"dilute-{row['X0']}-0.025", X0=row["X0"], phi=0.025, equilibration=30,
                             production=production_for(0.03 * rate, 2 * collisions)) for row, rate in zip(exact, nu0)]

    def over_enskog(result, row, rate):
        value, error = observable(result, "collision_rate")
        expected = (observable(result, "Z")[0] - 1) / float(row["B2/V"]) * rate
        return value / expected, error / expected

    table.heading("Dilute spheroids (dilute_spheroid_rates.csv: exact kinetic theory)")
    for row, rate, run, other in zip(exact, nu0, runs, thinner):
        result = run.result()
        state = f"X0 {float(row['X0']):.3g}"
        measured, error = observable(result, "collision_rate")
        chi_phi = (observable(result, "Z")[0] - 1) / float(row["B2/V"])
        for name, column in (("vacf", "zeta_v/phi"), ("wacf", "zeta_w/phi")):
            slope = initial_slope(result, name, float(row["I_perp/(m l^2)"]))
            exact_slope = float(row[column])
            table.relative(f"{state}, phi 0.05", f"initial slope of {name}", slope, None, chi_phi * exact_slope, 0.04)
            table.relative(f"{state}, phi 0.05", f"initial slope of {name} / collision_rate", slope / measured, None,
                           exact_slope / rate, 0.02)
        table.relative(f"{state}, phi 0.05", "collision_rate", measured, error, chi_phi * rate, 0.005)
        (dense, dense_error), (thin, thin_error) = (over_enskog(r, row, rate) for r in (result, other.result()))
        table.relative(f"{state}, phi to 0", "collision_rate / Enskog's", 2 * thin - dense,
                       math.hypot(2 * thin_error, dense_error), 1.0, 0.005)
    table.heading("Dilute spheroids, phi = 0.05 (enskog_spheroids.csv: the same with Vega's Z)")
    for row, run in zip(chosen("enskog_spheroids.csv"), runs):
        table.relative(f"X0 {float(row['X0']):.3g}", "collision_rate", *observable(run.result(), "collision_rate"),
                       float(row["coll_rate=nu0*chi"]), 0.005)


def initial_slope(result, name, moment):
    """-d ln C/dt at lags in which bodies turn by 0.15 radian, before a pair that has collided can meet again; by least
    squares with an intercept, for C(0) is over other time origins."""
    with open(result["directory"] / "observables" / "velocity.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    columns = [text.split(" [")[0] for text in rows[0]]
    value = columns.index(name)
    longest = 0.15 * math.sqrt(moment)
    lags = [(float(row[0]), -math.log(float(row[value]))) for row in rows[1:] if 0 < float(row[0]) <= longest]
    mean_t = sum(t for t, _ in lags) / len(lags)
    mean_y = sum(y for _, y in lags) / len(lags)
    return sum((t - mean_t) * (y - mean_y) for t, y in lags) / sum((t - mean_t) ** 2 for t, _ in lags)


def rotor(runner, table, _):
    """C2 of bodies that hardly ever collide against the exact free rotor, over independent seeds."""
    X0 = 3.0
    moment = 0.4 * X0 ** (-2.0 / 3.0)
    seeds = range(1, 17)
    runs = [runner.submit(f"rotor-{seed}", X0=X0, phi=1e-5, number=4096, equilibration=0, production=32, seed=seed)
            for seed in seeds]
    exact = [(float(r["tau=t*sqrt(kT/I)"]), float(r["C2_linear_rotor"])) for r in read_csv("free_rotor_c2.csv")]
    curves = []
    for run in runs:
        with open(run.result()["directory"] / "observables" / "c2.csv", newline="", encoding="utf-8") as file:
            curves.append([(float(row[0]), float(row[1])) for row in list(csv.reader(file))[1:]])
    table.heading("Free rotor: C2 at X0 = 3, phi = 1e-5, 16 x 4096 bodies (free_rotor_c2.csv: exact)")
    chosen = [k for k, (t, _) in enumerate(curves[0]) if 0.1 < t / math.sqrt(moment) < 4.5][::3]
    for k in chosen:
        tau = curves[0][k][0] / math.sqrt(moment)
        values = [curve[k][1] for curve in curves]
        mean = sum(values) / len(values)
        error = math.sqrt(sum((v - mean) ** 2 for v in values) / (len(values) * (len(values) - 1)))
        table.sigmas(f"tau {tau:.3f}", "C2", mean, error, interpolate(exact, tau), 3)


def interpolate(points, x):
    """Cubic (Lagrange) interpolation in a table with equal steps."""
    k = min(max(next(i for i, p in enumerate(points) if p[0] >= x) - 2, 0), len(points) - 4)
    near = points[k:k + 4]
    return sum(y * math.prod((x - b) / (a - b) for b, _ in near if b != a) for a, y in near)


def conservation(runner, table, _):
    """Energy, momentum and the smallest distance after more than a million collisions: ellipsoids of revolution over
    shapes and both kinds of inertia, and one fluid of every other family. Distances all along a run are looked at by
    HARDBODY_FULL=1 build/release/tests/physics_general_bodies_test, a thousand times in a million collisions."""
    times = {(0.1, 0.25): (60, 170), (0.333333, 0.4): (100, 160), (1, 0.45): (250, 250), (2, 0.45): (150, 170),
             (3, 0.4): (120, 170), (5, 0.3): (80, 210), (10, 0.2): (60, 220)}
    spheroids = [(X0, phi, inertia, time[k]) for k, inertia in enumerate(("paper", "uniform"))
                 for (X0, phi), time in times.items()]
    runs = []
    for X0, phi, inertia, time in spheroids:
        runs.append((f"X0 {X0:.3g}, phi {phi}, {inertia}", 1e-11, -1e-12, 0, runner.submit(
            f"conservation-{X0}-{inertia}", X0=X0, phi=phi, inertia=inertia, number=600, equilibration=5,
            production=time)))
    for name, (state, bodies, time) in general_families().items():
        runs.append((f"{state}, phi 0.4", 1e-10, -1e-11, 1e-4 if name == "sharp-cubes" else 0, runner.submit(
            f"conservation-{name}", phi=0.4, equilibration=5, bodies=bodies, production=time)))
    table.heading("Conservation and overlaps at the end of a run")
    for state, most_drift, least_distance, most_rescues, run in runs:
        result = run.result()
        state = f"{state}, {result['counters']['collisions']:.1e} collisions"
        audit = result["audit"]
        drift = abs(audit["energy_relative_drift"])
        distance = audit["minimum_distance"]
        momentum = audit["momentum_drift"]
        table.limit(state, "energy drift", drift, f"{most_drift:g}", drift <= most_drift)
        table.limit(state, "momentum drift", momentum, f"{most_drift:g}", momentum <= most_drift)
        table.limit(state, "minimum distance", distance, f">= {least_distance:g}", distance >= least_distance)
        overlaps = result["counters"]["overlaps"] + result["counters"]["declined"]
        table.limit(state, "overlaps, and pairs without an answer", overlaps, "0", overlaps == 0 and result["sound"])
        # Searches that only the fallback over all normals answered, as certain as the others: the sharpest cubes have some.
        rescues = result["counters"]["rescues"] / result["counters"]["collisions"]
        table.limit(state, "rescues / collisions", rescues, f"{most_rescues:g}", rescues <= most_rescues)


def reversal(runner, table, _):
    """All velocities are negated at the end of a run: every body goes back where it began. Rounding errors grow by 1e6
    to 1e9 in that time, so that later than that nothing could be told."""
    time = 0.3
    output = '[output]\ntrajectory = ["gsd"]\nframes = 2\n'
    families = {f"rods-{X0:.3g}": (f"X0 {X0:.3g}", Runner.spheroids(X0)) for X0 in (1 / 3, 1, 3)}
    families |= {name: (state, bodies) for name, (state, bodies, _) in general_families().items()}
    there = {name: runner.submit(f"reversal-{name}", phi=0.4, number=256, equilibration=5, bodies=bodies,
                                 production=time, output=output) for name, (_, bodies) in families.items()}
    # The file says what bodies these are, but for distributed sizes.
    of = lambda name: {"bodies": families[name][1]} if "sizes" in families[name][1] else {}
    back = {name: runner.submit(f"reversal-{name}-back", reversed=run.result()["directory"], equilibration=0,
                                production=time, output=output, **of(name)) for name, run in there.items()}
    table.heading("Time reversal: 256 bodies at phi = 0.4 go forward by t = 0.3, and back")
    for name, (state, _) in families.items():
        out, home = there[name].result(), back[name].result()
        collisions = [run["counters"]["collisions"] for run in (out, home)]
        state = f"{state}, {collisions[0]} collisions"
        begin, turn, box = ends(out["directory"])
        _, end, _ = ends(home["directory"])
        went = farthest(begin, turn, box)
        table.limit(state, "the farthest way that a body went", went, ">= 0.1", went >= 0.1)
        off = farthest(begin, end, box)
        table.limit(state, "distance from where it began", off, "1e-6", off <= 1e-6)
        more = abs(collisions[1] - collisions[0])
        table.limit(state, "collisions more or fewer", more, "0", more == 0)


def ends(directory):
    """The positions of the bodies in the first and in the last frame, in doubles, and the edge of the box."""
    import gsd.hoomd  # Debian's python3-gsd, which no other group needs
    with gsd.hoomd.open(str(directory / "trajectory.gsd"), "rb") as file:
        first, last = (file[i].log["particles/hardbody/position"] for i in (0, len(file) - 1))
        return first, last, float(file[0].log["hardbody/box"][0])


def farthest(first, second, box):
    """The largest distance of a body from itself, by the nearest image."""
    return max(math.hypot(*(q - p - box * round((q - p) / box) for p, q in zip(x, y))) for x, y in zip(first, second))


def general_families():
    """Of each: what it is, `bodies` as they stand in a config, and the time in which 512 of them collide more than a
    million times at phi = 0.4."""
    return {
        "cubes": ("superballs, p 4", superellipsoid(0.5, 0.5, [1, 1, 1]), 380),
        "sharp-cubes": ("superballs, p 8", superellipsoid(0.25, 0.25, [1, 1, 1]), 380),
        "octahedra": ("superballs, p 1.25", superellipsoid(1.6, 1.6, [1, 1, 1]), 300),
        "long-cubes": ("superellipsoids 1:1:2, e 0.5", superellipsoid(0.5, 0.5, [1, 1, 2]), 300),
        "rounded": ("superellipsoids 1:1:0.5, e 1.6, 0.7", superellipsoid(1.6, 0.7, [1, 1, 0.5]), 300),
        "biaxial": ("ellipsoids 1:0.8:0.5", "[shape]\nsemi_axes = [1, 0.8, 0.5]\n", 300),
        "round": ("superellipsoids 1:1:0.5, e 0.4, 1, that spin", superellipsoid(0.4, 1, [1, 1, 0.5]), 300),
        "sizes": ("ellipsoids 1:1:2 of sizes 0.5 to 1.5", (
            '[[species]]\nsemi_axes = [0.7, 0.7, 1.4]\nfraction = 1\ninertia = "uniform"\nsizes = "uniform"\n'
            "width = 0.29\n"), 300),
        "unlike": ("ellipsoids and superellipsoids", (
            "[[species]]\nsemi_axes = [0.6, 1, 1.5]\nfraction = 0.5\nmass = 3\n"
            '[[species]]\nkind = "superellipsoid"\nsemi_axes = [0.5, 0.6, 0.4]\nexponents = [0.5, 1.3]\nfraction = 0.5\n'),
            370),
    }


def superellipsoid(e1, e2, axes):
    return f'[shape]\nkind = "superellipsoid"\nsemi_axes = {axes}\nexponents = [{e1}, {e2}]\n'


def temperatures(table, state, observables):
    """kT = 1 of translation, of rotation, and about each body axis where there is no axis of revolution."""
    for name in ("kT_trans", "kT_rot"):
        entry = observables[name]
        table.sigmas(state, name, entry["value"], entry["error"], 1.0, 3)
    for axis, entry in zip("xyz", observables.get("kT_axes", [])):
        table.sigmas(state, f"kT about {axis}", entry["value"], entry["error"], 1.0, 3)


def superellipsoids(runner, table, collisions):
    """Collision rate and Z of two fluids of superellipsoids; the same bodies with moments that are all different."""
    rows = read_csv("superellipsoid_dynamics.csv")
    runs = [runner.submit(f"superellipsoids-{row['az_over_ax']}", phi=row["phi"], number=row["N"], equilibration=20,
                          bodies=superellipsoid(row["e1"], row["e2"], [1, 1, float(row["az_over_ax"])]),
                          production=production_for(float(row["rate"]), collisions / 3, int(row["N"]))) for row in rows]
    table.heading("Superellipsoids (superellipsoid_dynamics.csv: independent simulation)")
    for row, run in zip(rows, runs):
        state = f"e {row['e1']}, {row['e2']}, 1:1:{row['az_over_ax']}, phi {row['phi']}"
        result = run.result()
        table.relative(state, "collision_rate", *observable(result, "collision_rate"), float(row["rate"]), 0.005)
        table.relative(state, "Z", *observable(result, "Z"), float(row["Z"]), 0.007, float(row["Z_err"]))
        temperatures(table, state, result["observables"])
    biaxial = runner.submit("biaxial", phi=0.4, number=256, equilibration=20, production=1000,
                            bodies="[shape]\nsemi_axes = [1, 1.5, 2.25]\n")
    temperatures(table, "ellipsoids 1:1.5:2.25, phi 0.4", biaxial.result()["observables"])


def straight_line(xs, ys, errors):
    """The intercept of a weighted least-squares line, and its standard error."""
    weights = [1 / e ** 2 for e in errors]
    moment = lambda f: sum(w * f(x, y) for w, x, y in zip(weights, xs, ys))
    s0, s1, s2 = moment(lambda x, y: 1), moment(lambda x, y: x), moment(lambda x, y: x * x)
    determinant = s0 * s2 - s1 * s1
    intercept = (s2 * moment(lambda x, y: y) - s1 * moment(lambda x, y: x * y)) / determinant
    return intercept, (s2 / determinant) ** 0.5


def spheroid_virial(runner, table, collisions):
    wanted = (1 / 3, 0.5, 2.0, 3.0)
    rows = [row for row in read_csv("spheroid_virials.csv") if any(abs(float(row["X0"]) - x) < 1e-4 for x in wanted)]
    shares = (0.04, 0.08, 0.12)  # of pairs: phi B2, as of spheres at phi = 0.01 to 0.03
    exact = lambda row: float(row["B2_over_V"])
    runs = [[(s / exact(row), runner.submit(f"virial-spheroids-{row['X0']}-{s}", X0=row["X0"], phi=s / exact(row),
                                            equilibration=10, production=production_for(1.7 * s, collisions / 7)))
             for s in shares] for row in rows]
    table.heading("Spheroids at phi B2 = 0.04, 0.08, 0.12: (Z - 1) / phi extrapolated to 0 (spheroid_virials.csv: exact B2)")
    for row, points in zip(rows, runs):
        table.relative(f"X0 {float(row['X0']):.3g}", "B2 / V", *extrapolated_b2(points), exact(row), 0.01)


def extrapolated_b2(points):
    """Of packing fractions and runs: the intercept of (Z - 1) / phi, and its error."""
    measured = [(phi, *observable(run.result(), "Z")) for phi, run in points]
    return straight_line([phi for phi, _, _ in measured], [(Z - 1) / phi for phi, Z, _ in measured],
                         [error / phi for phi, _, error in measured])


def virial(runner, table, collisions):
    """The second virial coefficients of spheroids and of superballs: (Z - 1) / phi at three low packing fractions,
    extrapolated to 0."""
    spheroid_virial(runner, table, collisions)
    phis = (0.01, 0.02, 0.03)
    wanted = (("1", "2.5"), ("1", "3"), ("1", "4"), ("1", "6"))
    rows = [row for row in read_csv("superball_b2.csv") if (row["c"], row["n"]) in wanted]
    runs = {}
    for row in rows:
        e = 2 / float(row["n"])
        for phi in phis:
            # Rate about 3 / sqrt(pi) (Z - 1), as for spheres.
            rate = 1.7 * float(row["B2/V=1+3alpha"]) * phi
            runs[row["n"], phi] = runner.submit(f"virial-{row['n']}-{phi}", phi=phi, equilibration=10,
                                                bodies=superellipsoid(e, e, [float(row[k]) for k in "abc"]),
                                                production=production_for(rate, collisions / 7))
    table.heading("Superballs at phi = 0.01, 0.02, 0.03: (Z - 1) / phi extrapolated to 0 (superball_b2.csv: exact B2)")
    for row in rows:
        points = [(phi, runs[row["n"], phi]) for phi in phis]
        table.relative(f"p {row['n']}", "B2 / V", *extrapolated_b2(points), float(row["B2/V=1+3alpha"]), 0.01)


def z_of_spheres(diameters, phi):
    """Boublik, and Mansoori, Carnahan, Starling and Leland: Z of as many spheres of each diameter. Where they are all
    equal it is Carnahan and Starling's, 0.3 % below the simulations at phi = 0.4."""
    mean = lambda k: sum(d ** k for d in diameters) / len(diameters)
    z0, z1, z2, z3 = (phi * mean(k) / mean(3) for k in range(4))
    return (1 / (1 - z3) + 3 * z1 * z2 / (z0 * (1 - z3) ** 2) + z2 ** 3 * (3 - z3) / (z0 * (1 - z3) ** 3))


def rate_of_spheres(radii, masses, species, phi):
    """Enskog's collisions of a sphere of this species with any, as many of each, with the contact values that belong to
    z_of_spheres."""
    mean = lambda k: sum((2 * r) ** k for r in radii) / len(radii)
    number = phi / (math.pi / 6 * mean(3)) / len(radii)  # of each species in a volume of 1
    z2, free = phi * mean(2) / mean(3), 1 - phi
    rate = 0
    for r, m in zip(radii, masses):
        d = 2 * r * radii[species] / (r + radii[species])
        contact = 1 / free + 3 * z2 * d / free ** 2 + 2 * (z2 * d) ** 2 / free ** 3
        speed = math.sqrt(8 / math.pi * (1 / m + 1 / masses[species]))
        rate += number * math.pi * (r + radii[species]) ** 2 * speed * contact
    return rate


def mixtures(runner, table, collisions):
    """Spheres of two sizes and masses against the equation of state and Enskog's rates with its contact values (which
    are 1 to 2 % off for such sizes); equipartition in a mixture of unlike shapes."""
    spheres_of = lambda a, b: (f"[[species]]\nsemi_axes = [{a}, {a}, {a}]\nfraction = 0.5\nmass = 8\n"
                               f"[[species]]\nsemi_axes = [{b}, {b}, {b}]\nfraction = 0.5\n")
    pairs = ((1, 1), (1, 0.5), (1, 0.3))
    runs = [runner.submit(f"mixtures-{a}-{b}", phi=0.4, number=1000, equilibration=30, bodies=spheres_of(a, b),
                          production=production_for(7, collisions, 1000)) for a, b in pairs]
    unlike = runner.submit("mixtures-unlike", phi=0.35, number=256, equilibration=20, production=4000, bodies=(
        "[[species]]\nsemi_axes = [0.6, 1, 1.5]\nfraction = 0.5\nmass = 3\n"
        '[[species]]\nkind = "superellipsoid"\nsemi_axes = [0.5, 0.6, 0.4]\nexponents = [0.5, 1.3]\nfraction = 0.5\n'))
    table.heading("Mixtures of spheres, phi = 0.4, masses 8 and 1 (Boublik-Mansoori-Carnahan-Starling-Leland), and of "
                  "unlike shapes")
    for (a, b), run in zip(pairs, runs):
        result = run.result()
        table.relative(f"radii {a}, {b}", "Z", *observable(result, "Z"), z_of_spheres((a, b), 0.4), 0.01)
        for k, species in enumerate(result["species"], 1):
            entry = species["observables"]["kT_trans"]
            table.sigmas(f"radii {a}, {b}", f"kT_trans of species {k}", entry["value"], entry["error"], 1.0, 3)
            rate = species["observables"]["collision_rate"]
            table.relative(f"radii {a}, {b}", f"collision_rate of species {k}", rate["value"], rate["error"],
                           rate_of_spheres((a, b), (8, 1), k - 1, 0.4), 0.02)
    for k, species in enumerate(unlike.result()["species"], 1):
        temperatures(table, f"ellipsoids and superellipsoids, species {k}", species["observables"])


GROUPS = {"dynamics": dynamics, "pressure": pressure, "spheres": spheres, "dilute": dilute, "rotor": rotor,
          "conservation": conservation, "reversal": reversal, "superellipsoids": superellipsoids, "virial": virial,
          "mixtures": mixtures, "short": short_runs.short}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("groups", nargs="*", choices=[[], *GROUPS], help="default: all")
    parser.add_argument("--hardbody", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--collisions", type=float, default=3e6, help="of each run, at least")
    parser.add_argument("--record", action="store_true", help="store the tables in data/validation and summarise them in docs/validation.md")
    arguments = parser.parse_args()
    runner = Runner(arguments.hardbody, arguments.out, arguments.jobs)
    rows = failed = 0
    for name in arguments.groups or GROUPS:
        table = Table()
        GROUPS[name](runner, table, arguments.collisions)
        rows, failed = rows + table.rows, failed + table.failed
        if arguments.record:
            store(name, table)
    if arguments.record:
        write_page()
    print(f"\n{rows} comparisons, {failed} off")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
