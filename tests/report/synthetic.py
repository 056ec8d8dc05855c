"""A sweep that never ran, in the form of one that did: every point has the files of one small run, and numbers of its own.

    /usr/bin/python3 tests/report/synthetic.py RUN_DIRECTORY SWEEP_DIRECTORY [--ratios 25] [--densities 20]
"""

import argparse
import csv
import json
import math
import os
import pathlib
import re

NAMES = ["collision_rate", "Z", "D_trans", "D_rot", "S", "t_C2_1overe"]


def numbers_of(ratio, density):
    """Smooth in both, of the shape that the real ones have."""
    elongation = abs(math.log(ratio))
    pressure = (1 + density + density**2 - density**3) / (1 - density) ** 3 + 2 * density * elongation**2
    return {
        "collision_rate": 1.7 * (pressure - 1) * (1 + elongation),
        "Z": pressure,
        "D_trans": 0.6 * (1 - density) ** 4 / (density + 0.05) * (1 + 0.2 * elongation),
        "D_rot": 0.9 * (1 - density) ** 3 / (density + 0.05) / (0.15 + elongation),
        "S": min(0.95, 0.05 + 0.9 / (1 + math.exp(-18 * (density * elongation - 0.55)))),
        "t_C2_1overe": 0.3 * (0.3 + elongation**2) * math.exp(6 * density),
    }


def estimate(value):
    return {"value": value, "error": abs(value) * 0.01}


def config_of(text, ratio, density):
    text = re.sub(r"packing_fraction = [^\n]*", f"packing_fraction = {density}", text)
    return re.sub(r"aspect_ratio = [^\n]*", f"aspect_ratio = {float(ratio)}", text)


def write_point(run, directory, ratio, density, seed):
    directory.mkdir(parents=True)
    (directory / "observables").mkdir()
    for file in (run / "observables").iterdir():
        os.link(file, directory / "observables" / file.name)
    os.link(run / "checkpoint.bin", directory / "checkpoint.bin")
    (directory / "config.toml").write_text(config_of((run / "config.toml").read_text(), ratio, density))
    summary = json.loads((run / "summary.json").read_text())
    summary["observables"].update({name: estimate(value) for name, value in numbers_of(ratio, density).items()})
    (directory / "summary.json").write_text(json.dumps(summary))
    state = {
        "name": directory.name,
        "keys": {"shape.aspect_ratio": ratio, "system.packing_fraction": density},
        "seed": seed,
        "status": "done",
        "message": "",
    }
    (directory / "state.json").write_text(json.dumps(state))


def row_of(ratio, density, seed, failed):
    row = [ratio, density, seed, 10, 60]
    for value in numbers_of(ratio, density).values():
        row += ["", ""] if failed else [value, abs(value) * 0.01]
    if failed:
        return row + ["", "failed", "no start found, of <b>no</b> kind", "", ""]
    return row + ["true", "done", "", 12.5, 100000]


def write_sweep(run, sweep, ratios=25, densities=20, failed=((3, 4),)):
    """`failed`: indices of points that have no run."""
    run, sweep = pathlib.Path(run), pathlib.Path(sweep)
    sweep.mkdir(parents=True)
    (sweep / "sweep.toml").write_text("# synthetic\n")
    header = ["shape.aspect_ratio", "system.packing_fraction", "seed", "equilibration_time", "production_time"]
    header += [column for name in NAMES for column in (name, f"{name}_error")]
    header += ["equilibrated", "status", "message", "wall_seconds", "collisions_per_second"]
    with open(sweep / "sweep.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        for i in range(ratios):
            ratio = round(3 ** (2 * i / max(1, ratios - 1) - 1), 6)
            for j in range(densities):
                density = round(0.05 + 0.45 * j / max(1, densities - 1), 6)
                table.writerow(row_of(ratio, density, 1, (i, j) in failed))
                if (i, j) not in failed:
                    write_point(run, sweep / f"aspect_ratio={ratio},packing_fraction={density}", ratio, density, 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run")
    parser.add_argument("sweep")
    parser.add_argument("--ratios", type=int, default=25)
    parser.add_argument("--densities", type=int, default=20)
    arguments = parser.parse_args()
    write_sweep(arguments.run, arguments.sweep, arguments.ratios, arguments.densities)


if __name__ == "__main__":
    main()
