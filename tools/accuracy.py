"""Writes the accuracy tables: data/accuracy/*.csv from what the tests print in their long form, and the summaries of
docs/accuracy.md from these files. See tools/accuracy."""

import argparse
import csv
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "data" / "accuracy"
PAGE = ROOT / "docs" / "accuracy.md"

NUMBER = r"([-+\d.e]+)"
ROW_OF_CLASS = re.compile(rf"^(\S.{{15}}) +{' +'.join([NUMBER] * 9)}$")
ROW_OF_SEARCH = re.compile(rf"^(\S.*?) +{NUMBER} pairs, {NUMBER} declined, {NUMBER} wrong, {NUMBER} evaluations each, widest bound {NUMBER} of the size$")


def markdown_rows(text):
    """Cells of the rows of all tables, without heads and rules."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return [row for row in rows if not re.fullmatch(r"-+", row[0]) and row[0] != "pair" and not row[0].startswith("set")]


def matching_rows(pattern):
    return lambda text: [[cell.strip() for cell in match.groups()] for line in text.splitlines() if (match := pattern.match(line))]


class Table:
    """One file of data/accuracy: columns, and the tests that print its rows, each with the value of a first column `bodies`."""

    def __init__(self, binary, tests, columns, rows=markdown_rows):
        self.binary = binary
        self.tests = tests if isinstance(tests, dict) else {"": tests}
        self.columns = (["bodies"] if isinstance(tests, dict) else []) + columns.split()
        self.rows = rows

    def measure(self, tests_directory):
        """Rows of all tests; raises CalledProcessError if one fails."""
        rows = []
        for bodies, test in self.tests.items():
            done = subprocess.run([tests_directory / self.binary, f"--gtest_filter={test}"], env=os.environ | {"HARDBODY_FULL": "1"},
                                  capture_output=True, text=True, check=True)
            for row in self.rows(done.stdout):
                rows.append(([bodies] if bodies else []) + row)
                if len(rows[-1]) != len(self.columns):
                    raise ValueError(f"{self.binary} {test}: {len(rows[-1])} cells, {len(self.columns)} wanted: {row}")
        if not rows:
            raise ValueError(f"{self.binary} {self.tests}: printed no rows")
        return rows


COPIES = {"copies": "SuperellipsoidDistance.{}", "unlike": "SuperellipsoidDistance.{}OfUnlikeBodies"}

TABLES = {
    "ellipsoids": Table("geom_accuracy_test", "Accuracy.OfRandomPairsIsThatOfTheContract",
                        "class pairs failures largest_error mean_error normal_error_50 normal_error_99 largest_normal_error evaluations "
                        "most_evaluations", matching_rows(ROW_OF_CLASS)),
    "superellipsoids": Table("geom_property_test", {k: v.format("OfKnownAnswers") for k, v in COPIES.items()},
                             "set pairs wrong declined largest_error largest_error_bound points_off_the_surfaces"),
    "overlaps": Table("geom_property_test", {k: v.format("OfOverlaps") for k, v in COPIES.items()},
                      "set depth pairs misses declined largest_error widest_bound shorter_ways"),
    "brute_force": Table("geom_property_test", "Penetration.Of*IsTheLeast*", "bodies pairs declined wrong evaluations widest_bound",
                         matching_rows(ROW_OF_SEARCH)),
    "extreme": Table("geom_accuracy_test", "ExtremeShapes.AreWithinTheContractCertifiedOrDeclined",
                     "pair aspect_ratio pairs wrong declined certified largest_error"),
    "deep": Table("geom_accuracy_test", "ExtremeShapes.DeepInEachOther",
                  "pair aspect_ratio pairs declined largest_error bound_over_depth_median bound_over_depth_largest ms_median ms_largest"),
    "pairs": Table("geom_accuracy_test", "AccuracyTable.*",
                   "pair gap pairs failures median_error largest_error largest_error_bound evaluations"),
    "cores": Table("geom_accuracy_test", "CoresTable.*",
                   "pair pairs failures median_error largest_error largest_error_bound evaluations"),
    "libraries": Table("oracle_table_test", "AccuracyTable.*",
                       "pair gap ours_largest fcl_median fcl_largest fcl_declined libccd_median libccd_largest libccd_declined "
                       "cgal_median cgal_largest cgal_declined"),
}


def write(name, rows):
    DATA.mkdir(parents=True, exist_ok=True)
    with open(DATA / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([TABLES[name].columns, *rows])


def read(name):
    with open(DATA / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def groups(rows, *keys):
    """Rows by the values of these columns, in their order."""
    of = {}
    for row in rows:
        of.setdefault(tuple(row[key] for key in keys), []).append(row)
    return of


def total(rows, column):
    return f"{sum(int(row[column]) for row in rows):,}"


def largest(rows, column):
    values = [float(row[column]) for row in rows if row[column] not in ("", "-")]
    return f"{max(values):.1e}" if values else "-"


def mean(rows, column):
    return f"{sum(float(row[column]) for row in rows) / len(rows):.1f}"


def summary_of_overlaps():
    yield "| set | bodies | pairs | misses | declined | largest error | widest bound | shorter ways |"
    yield "|---|---|---|---|---|---|---|---|"
    for (name, bodies), rows in groups(read("overlaps"), "set", "bodies").items():
        yield (f"| {name} | {bodies} | {total(rows, 'pairs')} | {total(rows, 'misses')} | {total(rows, 'declined')} | "
               f"{largest(rows, 'largest_error')} | {largest(rows, 'widest_bound')} | {total(rows, 'shorter_ways')} |")


def summary_of_extreme():
    yield "| pair | pairs | wrong | declined | certified | largest error, aspect ratio to 100 | beyond |"
    yield "|---|---|---|---|---|---|---|"
    for (name,), rows in groups(read("extreme"), "pair").items():
        near, far = ([row for row in rows if (float(row["aspect_ratio"]) <= 100) == near] for near in (True, False))
        yield (f"| {name} | {total(rows, 'pairs')} | {total(rows, 'wrong')} | {total(rows, 'declined')} | {total(rows, 'certified')} | "
               f"{largest(near, 'largest_error')} | {largest(far, 'largest_error')} |")


def summary_of_deep():
    yield "| pair | pairs | declined | largest error | bound / depth, largest, aspect ratio to 100 | beyond | ms, largest |"
    yield "|---|---|---|---|---|---|---|"
    before = ""
    for row in (rows := read("deep")):
        # Rows "the same, nearly parallel" belong to the pair named before.
        if row["pair"] == "the same, nearly parallel":
            row["pair"] = f"{before}, nearly parallel"
        else:
            before = row["pair"]
    for (name,), of_pair in groups(rows, "pair").items():
        near, far = ([row for row in of_pair if (float(row["aspect_ratio"]) <= 100) == near] for near in (True, False))
        yield (f"| {name} | {total(of_pair, 'pairs')} | {total(of_pair, 'declined')} | {largest(of_pair, 'largest_error')} | "
               f"{largest(near, 'bound_over_depth_largest')} | {largest(far, 'bound_over_depth_largest')} | "
               f"{max(float(row['ms_largest']) for row in of_pair):.2f} |")


def summary_of_pairs():
    yield "| pair | pairs | failures | apart: largest error | error bound | evaluations | overlapping: largest error | error bound | evaluations |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for (name,), rows in groups(read("pairs"), "pair").items():
        cells = [name, total(rows, "pairs"), total(rows, "failures")]
        for side in ([row for row in rows if float(row["gap"]) > 0], [row for row in rows if float(row["gap"]) < 0]):
            cells += [largest(side, "largest_error"), largest(side, "largest_error_bound"), mean(side, "evaluations")]
        yield f"| {' | '.join(cells)} |"


def summary_of_libraries():
    yield "| pair | ours, largest | FCL, median | largest | libccd, median | largest | CGAL, median | largest | declined |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for (name,), rows in groups(read("libraries"), "pair").items():
        cells = [name, largest(rows, "ours_largest")]
        for library in ("fcl", "libccd", "cgal"):
            cells += [largest(rows, f"{library}_median"), largest(rows, f"{library}_largest")]
        declined = sum(int(row[f"{library}_declined"]) for row in rows for library in ("fcl", "libccd", "cgal")
                       if row[f"{library}_declined"].isdigit())
        yield f"| {' | '.join([*cells, str(declined)])} |"


SUMMARIES = {"overlaps": summary_of_overlaps, "extreme": summary_of_extreme, "deep": summary_of_deep, "pairs": summary_of_pairs,
             "libraries": summary_of_libraries}


def with_summaries(text):
    """The page with each summary, between its marker and the next empty line, made anew."""
    for name, summary in SUMMARIES.items():
        marker = f"<!-- {name}: written by tools/accuracy -->\n"
        if text.count(marker) != 1:
            raise ValueError(f"{PAGE}: has {text.count(marker)} markers of {name}; accepted: one")
        before, _, rest = text.partition(marker)
        after = rest.partition("\n\n")[2]
        text = before + marker + "\n".join(summary()) + "\n\n" + after
    return text


def main():
    parser = argparse.ArgumentParser(prog="tools/accuracy", description=__doc__)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"tables to measure: {' '.join(TABLES)}; default: all")
    parser.add_argument("--page", action="store_true", help="measure nothing: only write the summaries of docs/accuracy.md")
    parser.add_argument("--tests", default="build/release/tests", help="directory of the tests' binaries")
    options = parser.parse_args()
    unknown = set(options.tables) - set(TABLES)
    if unknown:
        parser.error(f"unknown table {', '.join(sorted(unknown))}; accepted: {' '.join(TABLES)}")
    for name in [] if options.page else options.tables or TABLES:
        write(name, TABLES[name].measure(pathlib.Path(options.tests).resolve()))
        print(f"accuracy: data/accuracy/{name}.csv is written", flush=True)
    PAGE.write_text(with_summaries(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    print("accuracy: docs/accuracy.md is written")
    return 0


if __name__ == "__main__":
    sys.exit(main())
