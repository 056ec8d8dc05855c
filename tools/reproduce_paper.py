"""The paper's study: isodiffusivity lines and correlators of hard ellipsoids of revolution. See tools/reproduce-paper."""

import argparse
import math
import pathlib
import sys

from paper import grid, table
from paper.figures import Lines, write_figures
from paper.report import write_readme
from paper.results import Results, point_of, read_rows
from paper.study import Stop, Study
from paper.verdicts import changed_claims, verdicts

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "data" / "paper"
PAGES = ROOT / "docs" / "paper"


EPILOG = """Finished points are merged into points.csv and curves.csv at once and are not run again. The tool can be stopped at any
time; the same command continues. data/paper holds all points; to begin afresh name another directory, which is created if
necessary: tools/reproduce-paper --results out/my-paper --out out/my-runs. The number of points left and the estimated time
are printed at the beginning and with every point."""


def point(text):
    """Of X0,PHI."""
    try:
        X0, phi = map(float, text.split(","))
    except ValueError:
        X0 = phi = math.nan
    if not (0 < X0 < math.inf and 0 < phi < 1):
        raise argparse.ArgumentTypeError(f"{text!r} is no point; accepted: X0,PHI, both above 0, as 2,0.3")
    return grid.Point(X0, phi)


def count(text):
    if not (text.isdigit() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is no number of processes; accepted: an integer from 1 on")
    return int(text)


def duration(text):
    try:
        minutes = float(text)
    except ValueError:
        minutes = math.nan
    if not 0 <= minutes < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of minutes; accepted: a number from 0 (no end) on")
    return minutes


class Parser(argparse.ArgumentParser):
    """One line for what it refuses."""

    def error(self, message):
        print(f"{self.prog}: {message}", file=sys.stderr)
        sys.exit(2)


def parse(arguments):
    parser = Parser(prog="tools/reproduce-paper", description=__doc__, epilog=EPILOG)
    parser.add_argument("--hardbody", required=True, help="the program (tools/reproduce-paper builds it)")
    parser.add_argument("--out", default="out/paper", help="run directories, one a point that is not finished")
    parser.add_argument("--results", metavar="DIR", help="directory of points.csv, curves.csv and everything derived from them, by default data/paper "
                                                         "with the page and the drawings in docs/paper (with --quick: OUT-quick/results); a new "
                                                         "directory begins afresh")
    parser.add_argument("--jobs", type=count, default=1, help="points that run at the same time")
    parser.add_argument("--minutes", type=duration, default=0, help="stop after so many; call it again to go on")
    parser.add_argument("--quick", action="store_true", help="a coarse grid with short runs, some three minutes")
    parser.add_argument("--figures", action="store_true", help="run nothing: figures and README.md from what is there; values whose "
                                                                 "definitions do not hold are moved to dropped.csv")
    parser.add_argument("--points", nargs="+", type=point, metavar="X0,PHI", help="these points alone")
    return parser.parse_args(arguments)


def chosen(options):
    if options.points:
        return list(dict.fromkeys(options.points))
    return grid.quick_points() if options.quick else grid.ordered_points()


def known_costs(options):
    """Seconds that the points in data/paper took; empty with --quick, whose points are shorter."""
    return {} if options.quick else {point_of(row): float(row["wall_seconds"]) for row in read_rows(DATA / "points.csv")}


def draw(program, directory, pages):
    """Writes figures and README.md, without the values whose definition does not hold."""
    dropped = Results(directory).judge()
    study = table.Study(directory)
    lines = Lines(program, directory)
    pages.mkdir(parents=True, exist_ok=True)
    write_figures(study, lines, directory, pages)
    outcomes = verdicts(study, lines)
    changes = changed_claims(outcomes, verdicts(table.Study(directory, restored=True), lines))
    write_readme(study, outcomes, changes, directory, pages)
    if dropped:
        print(f"{directory}: the definitions of {dropped} values do not hold; they are now in dropped.csv")
    print(f"{pages}: figures and README.md of {len(study.rows)} points")
    for verdict in outcomes:
        print(f"  {verdict.claim}: {verdict.outcome}")


def main(arguments):
    options = parse(arguments)
    out = pathlib.Path(options.out + ("-quick" if options.quick else ""))
    directory = pathlib.Path(options.results or (out / "results" if options.quick else DATA))
    pages = PAGES if directory.resolve() == DATA else directory
    if options.figures:
        if not (directory / "points.csv").exists():
            print(f"{directory}: has no points.csv; accepted: results of tools/reproduce-paper", file=sys.stderr)
            return 2
        draw(options.hardbody, directory, pages)
        return 0
    stop = Stop(options.minutes)
    study = Study(options.hardbody, out, Results(directory), options.jobs, options.quick, known_costs(options))
    done = study.run(chosen(options), stop)
    if stop.signal:
        return 128 + stop.signal
    if study.results.points:
        draw(options.hardbody, directory, pages)
    if study.failed:
        return 1
    if not done:
        print("stopped: the same command continues")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
