"""Measures speeds and memory with the programs of bench/, keeps them in data/performance.csv with the machine named, and writes the
summary of docs/performance.md. See tools/performance."""

import argparse
import csv
import datetime
import json
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "data" / "performance.csv"
PAGE = ROOT / "docs" / "performance.md"
COLUMNS = ["benchmark", "quantity", "unit", "median", "low", "high", "runs", "ratio_to", "ratio", "machine", "date", "program"]


def collisions(entry):
    yield "collisions/s", "1/s", entry["collisions/s"]
    for name, unit in (("kB a body", "kB"), ("start s", "s")):
        if name in entry:
            yield name, unit, entry[name]


def items(entry):
    yield "time", "ns", 1e9 / entry["items_per_second"]


def superellipsoids(entry):
    """cpu_time is that of all pairs, in microseconds: 1000, or those that FCL was asked for."""
    yield "time", "ns", 1000 * entry["cpu_time"] / entry.get("asked", 1000)
    if "longer" in entry:
        yield "longer", "1", entry["longer"]


def same_pairs(entry):
    for name in ("fcl/scalar", "fcl/batch"):
        yield name, "1", entry[name]


def shares(entry):
    yield "share", "%", entry["share %"]


class Suite:
    """Benchmarks of one program: their names, what each measures, and the benchmark that each is compared with."""

    def __init__(self, binary, names, values, reference=None, means=()):
        self.binary = binary
        self.names = names
        self.values = values
        self.reference = reference  # from the name of a benchmark to that of its reference, or None
        self.means = means  # prefixes of names over which a row `PREFIX/mean` averages


SUITES = {
    "engine": Suite("bench_engine", "^engine/", collisions),
    "vectors": Suite("bench_engine", "^vectors/", collisions, lambda name: name.rpartition("/")[0] + "/one by one"),
    "bodies": Suite("bench_bodies", ".", collisions),
    "scale": Suite("bench_engine", "^scale/", collisions, lambda _: "scale/1000"),
    "methods": Suite("bench_engine", "^methods/", collisions),
    "dilute": Suite("bench_engine", "^dilute/", collisions),
    "distance": Suite("bench_distance", "^distance/", items,
                      means=[f"distance/{kind}/{start}" for kind in ("uniaxial", "general") for start in ("cold", "warm")]),
    "same_pairs": Suite("bench_distance", "^same_pairs/", same_pairs),
    "batch": Suite("bench_batch", "^batch/", items,
                   means=[f"batch/{kind}/{s}" for kind in ("uniaxial", "general") for s in ("portable", "avx2", "avx512")]),
    "superellipsoid": Suite("bench_superellipsoid", "^superellipsoid/(cold|warm|fcl_gjk)/", superellipsoids,
                            lambda name: name.replace("/fcl_gjk/", "/cold/") if "/fcl_gjk/" in name else None),
    "overlaps": Suite("bench_superellipsoid", "^superellipsoid/overlap_", superellipsoids),
    "observables": Suite("bench_observables", "^observables/", shares),
}


def machine_name():
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def program_name():
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def once(bench, suite, names):
    """One run of a program: {(benchmark, quantity, unit): value}."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        subprocess.run([bench / suite.binary, f"--benchmark_filter={names}", f"--benchmark_out={out.name}", "--benchmark_out_format=json"],
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        text = pathlib.Path(out.name).read_text(encoding="utf-8")
    entries = json.loads(text)["benchmarks"] if text else []
    values = {(re.sub(r"/iterations:\d+$", "", e["name"]), quantity, unit): value
              for e in entries if not e.get("error_occurred") for quantity, unit, value in suite.values(e)}
    for prefix in suite.means:
        times = [value for (name, _, _), value in values.items() if name.startswith(prefix + "/")]
        if times:
            values[f"{prefix}/mean", "time", "ns"] = statistics.mean(times)
    return values


def reference_of(suite, key, old):
    """The key that a value is compared with: that of the other build if there is one, else another benchmark of the same run."""
    if old:
        return key
    name = suite.reference(key[0]) if suite.reference else None
    return (name, *key[1:]) if name and name != key[0] else None


def measure(bench, against, suite, names, runs, labels):
    """Rows of a suite: medians of the runs, and medians of the ratios within each run (or to the other build, run in turn)."""
    new, old = [], []
    for _ in range(runs):
        if against:
            old.append(once(against, suite, names))
        new.append(once(bench, suite, names))
    for key in new[0]:
        values = [run[key] for run in new]
        to = reference_of(suite, key, bool(old))
        ratios = [run[key] / other[to] for run, other in zip(new, old or new) if to in other and other[to]] if to else []
        yield {"benchmark": key[0], "quantity": key[1], "unit": key[2], "median": f"{statistics.median(values):.4g}",
               "low": f"{min(values):.4g}", "high": f"{max(values):.4g}", "runs": runs,
               "ratio_to": (str(against) if old else to[0]) if ratios else "",
               "ratio": f"{statistics.median(ratios):.3f}" if ratios else "", **labels}


def read():
    if not DATA.exists():
        return []
    with open(DATA, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def merge(rows):
    """Rows of the same benchmark, quantity and machine are replaced, all others stay."""
    key = lambda row: (row["benchmark"], row["quantity"], row["machine"])
    fresh = {key(row) for row in rows}
    all_rows = [row for row in read() if key(row) not in fresh] + rows
    with open(DATA, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(all_rows)


# What the page shows: text, benchmark, quantity, what is wanted (NaN: nothing), whether more is better.
NONE = float("nan")
SHOWN = [
    ("Collisions per second, N = 512, one core", None, None, NONE, True),
    ("X0 = 3, 0.40, in vectors (AVX-512)", "vectors/X0:3/phi:0.4/avx512", "collisions/s", 200000, True),
    ("X0 = 3, 0.40, in vectors (AVX2)", "vectors/X0:3/phi:0.4/avx2", "collisions/s", 200000, True),
    ("X0 = 3, 0.40, one pair at a time", "vectors/X0:3/phi:0.4/one by one", "collisions/s", NONE, True),
    ("X0 = 10, 0.25", "engine/X0:10/phi:0.25", "collisions/s", 60000, True),
    ("X0 = 1/10, 0.25", "engine/X0:0.1/phi:0.25", "collisions/s", 60000, True),
    ("X0 = 1/3, 0.40", "engine/X0:0.333/phi:0.4", "collisions/s", NONE, True),
    ("X0 = 2, 0.45", "engine/X0:2/phi:0.45", "collisions/s", NONE, True),
    ("X0 = 5, 0.30", "engine/X0:5/phi:0.3", "collisions/s", NONE, True),
    ("superballs p = 2.5, 0.40", "superballs p=2.5", "collisions/s", 60000, True),
    ("superballs p = 4", "superballs p=4", "collisions/s", 35000, True),
    ("superellipsoids 1 : 1 : 2, e = 0.5", "superellipsoids 1:1:2 e=0.5", "collisions/s", 25000, True),
    ("ellipsoids 1 : 0.8 : 0.5, uniform density", "ellipsoids 1:0.8:0.5", "collisions/s", 25000, True),
    ("spheres, 0.40", "spheres", "collisions/s", NONE, True),
    ("capsules, L/D = 2", "capsules L/D=2", "collisions/s", NONE, True),
    ("capsules, L/D = 5", "capsules L/D=5", "collisions/s", NONE, True),
    ("cubes, rounded by 0.05", "rounded boxes 0.05", "collisions/s", 20000, True),
    ("cubes", "cubes", "collisions/s", 15000, True),
    ("dodecahedra", "dodecahedra", "collisions/s", 10000, True),
    ("a user's spherocylinders", "a user's spherocylinders", "collisions/s", 30000, True),
    ("Percent of a run of 60 time units that observables take, N = 512", None, None, NONE, True),
    ("ellipsoids X0 = 3, 0.40", "observables/prolate X0=3 0.40", "share", 10, False),
    ("ellipsoids X0 = 1/2, 0.45", "observables/oblate X0=1/2 0.45", "share", 10, False),
    ("ellipsoids 0.7 : 1 : 1.6, 0.40", "observables/biaxial 0.7:1:1.6 0.40", "share", 10, False),
    ("superballs p = 4, 0.40", "observables/superballs p=4 0.40", "share", 10, False),
    ("mixture of X0 = 3 and 1/2, 0.40", "observables/prolate and oblate 0.40", "share", 10, False),
    ("spheres, 0.40", "observables/spheres 0.40", "share", 10, False),
    ("Collisions per second, X0 = 2, 0.40, many bodies", None, None, NONE, True),
    ("1,000 bodies", "scale/1000", "collisions/s", NONE, True),
    ("10,000 bodies", "scale/10000", "collisions/s", NONE, True),
    ("100,000 bodies", "scale/100000", "collisions/s", NONE, True),
    ("1,000,000 bodies", "scale/1000000", "collisions/s", NONE, True),
    ("Nanoseconds per distance, means over X0 = 0.1 to 10 and four gaps", None, None, NONE, False),
    ("two bodies of revolution, cold", "distance/uniaxial/cold/mean", "time", 230, False),
    ("two bodies of revolution, warm", "distance/uniaxial/warm/mean", "time", NONE, False),
    ("two ellipsoids with three axes, cold", "distance/general/cold/mean", "time", 230, False),
    ("two ellipsoids with three axes, warm", "distance/general/warm/mean", "time", NONE, False),
    ("batches, of revolution, AVX-512", "batch/uniaxial/avx512/mean", "time", 50, False),
    ("batches, of revolution, AVX2", "batch/uniaxial/avx2/mean", "time", 50, False),
    ("batches, three axes, AVX-512", "batch/general/avx512/mean", "time", 50, False),
    ("batches, three axes, AVX2", "batch/general/avx2/mean", "time", 50, False),
    ("Times as fast as FCL on the same pairs (libccd, 1e-6)", None, None, NONE, True),
    ("one by one, gap 1", "same_pairs/gap:1", "fcl/scalar", 8, True),
    ("one by one, gap 0.1", "same_pairs/gap:0.1", "fcl/scalar", 8, True),
    ("one by one, gap 1e-6", "same_pairs/gap:1e-06", "fcl/scalar", 8, True),
    ("one by one, 1e-3 deep", "same_pairs/gap:-0.001", "fcl/scalar", 8, True),
    ("in batches (AVX-512), gap 1", "same_pairs/gap:1", "fcl/batch", 40, True),
    ("in batches (AVX-512), gap 0.1", "same_pairs/gap:0.1", "fcl/batch", 40, True),
    ("in batches (AVX-512), gap 1e-6", "same_pairs/gap:1e-06", "fcl/batch", 40, True),
    ("in batches (AVX-512), 1e-3 deep", "same_pairs/gap:-0.001", "fcl/batch", 40, True),
]


def shown(number):
    value = float(number)
    return f"{value:,.0f}" if value >= 100 else f"{value:g}"


def cell(row):
    low, high = shown(row["low"] or row["median"]), shown(row["high"] or row["median"])
    text = low if low == high else f"{low} to {high}"
    return text + (f" ({row['ratio']} of {row['ratio_to'].rpartition('/')[2]})" if row["ratio"] else "")


def verdict(row, wanted, more):
    """Whether the median reaches what is wanted."""
    if wanted != wanted:
        return ""
    value = float(row["median"])
    return "met" if (value >= wanted if more else value <= wanted) else "missed"


def summary():
    rows = read()
    machines = list(dict.fromkeys(row["machine"] for row in rows))
    yield "| | wanted | " + " | ".join(f"{machine} | " for machine in machines)
    yield "|---|---|" + "---|---|" * len(machines)
    section = ""
    for text, benchmark, quantity, wanted, more in SHOWN:
        if benchmark is None:
            section = f"| **{text}** | |" + " | |" * len(machines)
            continue
        cells = []
        for machine in machines:
            row = next((r for r in rows if (r["benchmark"], r["quantity"], r["machine"]) == (benchmark, quantity, machine)), None)
            cells += [cell(row), verdict(row, wanted, more)] if row else ["", ""]
        if any(cells):
            if section:
                yield section
                section = ""
            yield f"| {text} | {'' if wanted != wanted else shown(wanted)} | {' | '.join(cells)} |"


def write_page():
    text = PAGE.read_text(encoding="utf-8")
    begin, end = "<!-- summary: written by tools/performance -->\n", "<!-- end of summary -->\n"
    if text.count(begin) != 1 or text.count(end) != 1:
        raise ValueError(f"{PAGE}: markers of the summary are missing")
    PAGE.write_text(text[:text.index(begin)] + begin + "\n" + "\n".join(summary()) + "\n\n" + text[text.index(end):], encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(prog="tools/performance", description=__doc__)
    parser.add_argument("suites", nargs="*", metavar="SUITE", help=f"what to measure: {' '.join(SUITES)}; default: all")
    parser.add_argument("--filter", help="only benchmarks whose names match this regular expression")
    parser.add_argument("--runs", type=int, default=3, help="runs of each program, whose medians count (default: 3)")
    parser.add_argument("--bench", default="build/release/bench", help="directory of the benchmark programs")
    parser.add_argument("--against", metavar="DIR", help="directory of another build's benchmark programs: both run in turn, and ratios are "
                                                         "new over old; printed, not stored")
    parser.add_argument("--machine", default=machine_name(), help="name of the machine in the table")
    parser.add_argument("--page", action="store_true", help="measure nothing: only write docs/performance.md")
    options = parser.parse_args()
    unknown = [name for name in options.suites if name not in SUITES]
    if unknown:
        parser.error(f"unknown suite {', '.join(unknown)}; accepted: {' '.join(SUITES)}")
    labels = {"machine": options.machine, "date": datetime.date.today().isoformat(), "program": program_name()}
    for name in [] if options.page else options.suites or SUITES:
        suite = SUITES[name]
        rows = list(measure(pathlib.Path(options.bench).resolve(), options.against and pathlib.Path(options.against).resolve(), suite,
                            options.filter or suite.names, options.runs, labels))
        for row in rows:
            ratio = f"  {row['ratio']} of {row['ratio_to']}" if row["ratio"] else ""
            print(f"{row['benchmark']}: {row['quantity']} {row['median']} {row['unit']} ({row['low']} to {row['high']}){ratio}", flush=True)
        if not options.against:
            merge(rows)
    if not options.against:
        write_page()
    return 0


if __name__ == "__main__":
    sys.exit(main())
