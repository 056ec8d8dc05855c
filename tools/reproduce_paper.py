"""The paper's study: isodiffusivity lines and correlators of hard ellipsoids of revolution. See tools/reproduce-paper."""

import argparse
import pathlib
import sys

from paper import grid, table
from paper.figures import Lines, write_figures
from paper.report import write_readme
from paper.results import Results
from paper.study import Stop, Study
from paper.verdicts import verdicts

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs" / "paper"


def parse(arguments):
    parser = argparse.ArgumentParser(prog="tools/reproduce-paper", description=__doc__)
    parser.add_argument("--hardbody", required=True, help="the program (tools/reproduce-paper builds it)")
    parser.add_argument("--out", default="out/paper", help="run directories, one a point that is not finished")
    parser.add_argument("--results", help="directory of points.csv and curves.csv; without it docs/paper, of --quick OUT/results")
    parser.add_argument("--jobs", type=int, default=1, help="points that run at the same time")
    parser.add_argument("--minutes", type=float, default=0, help="stop after so many; call it again to go on")
    parser.add_argument("--quick", action="store_true", help="a coarse grid with short runs, about ten minutes")
    parser.add_argument("--figures", action="store_true", help="run nothing: figures and README.md from what is there")
    parser.add_argument("--points", nargs="+", metavar="X0,PHI", help="these points alone")
    return parser.parse_args(arguments)


def chosen(options):
    if options.points:
        return [grid.Point(*map(float, text.split(","))) for text in options.points]
    return grid.quick_points() if options.quick else grid.ordered_points()


def draw(program, directory):
    """Figures and README.md."""
    study = table.Study(directory)
    lines = Lines(program, directory)
    write_figures(study, lines, directory)
    outcomes = verdicts(study, lines)
    write_readme(study, outcomes, directory)
    print(f"{directory}: figures and README.md of {len(study.rows)} points")
    for verdict in outcomes:
        print(f"  {verdict.claim}: {verdict.outcome}")


def main(arguments):
    options = parse(arguments)
    out = pathlib.Path(options.out + ("-quick" if options.quick else ""))
    directory = pathlib.Path(options.results or (out / "results" if options.quick else DOCS))
    if options.figures:
        if not (directory / "points.csv").exists():
            print(f"{directory}: has no points.csv; accepted: results of tools/reproduce-paper", file=sys.stderr)
            return 2
        draw(options.hardbody, directory)
        return 0
    stop = Stop(options.minutes)
    study = Study(options.hardbody, out, Results(directory), options.jobs, options.quick)
    done = study.run(chosen(options), stop)
    if stop.signal:
        return 128 + stop.signal
    if study.results.points:
        draw(options.hardbody, directory)
    if study.failed:
        return 1
    if not done:
        print("stopped: the same command goes on")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
