"""Tables of tools/validate: printed as Markdown, stored as data/validation/GROUP.csv, summarised in docs/validation.md."""

import csv
import math
import pathlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "data" / "validation"
PAGE = ROOT / "docs" / "validation.md"

COLUMNS = ["table", "state", "quantity", "measured", "error", "reference", "deviation", "sigma", "allowed", "verdict"]
SHORT_COLUMNS = ["state", "quantity", "long_run", "printed_right", "absent_was_wrong", "absent_was_right", "printed_wrong",
                 "lost_with_auto", "auto_alone", "verdict"]
GROUPS = ["dynamics", "pressure", "spheres", "dilute", "rotor", "conservation", "reversal", "superellipsoids", "virial", "mixtures"]


class Table:
    """Rows of one group: state, quantity, measured value, reference, deviation, what is allowed."""

    def __init__(self):
        self.failed = 0
        self.stored = []
        self.title = ""

    @property
    def rows(self):
        return len(self.stored)

    def heading(self, text):
        self.title = text
        print(f"\n### {text}\n")
        print("| state | quantity | measured | reference | deviation | sigma | allowed | |")
        print("|---|---|---|---|---|---|---|---|", flush=True)

    def relative(self, state, quantity, measured, error, reference, allowed, reference_error=0.0, sigmas=math.inf):
        """Requires |measured / reference - 1| <= allowed and at most `sigmas` combined standard errors, which are shown beside."""
        if measured is None:
            self._row(state, quantity, "null", f"{reference:.5g}", "", "", f"{100 * allowed:g} %", False)
            return
        deviation = measured / reference - 1
        combined = math.hypot(error or 0.0, reference_error or 0.0)
        distance = (measured - reference) / combined if combined > 0 else 0.0
        sigma = f"{distance:+.1f}" if combined > 0 else ""
        uncertainty = f" +- {error:.2g}" if error else ""
        both = f"{100 * allowed:g} %" + (f", {sigmas:g} sigma" if sigmas < math.inf else "")
        self._row(state, quantity, f"{measured:.5g}{uncertainty}", f"{reference:.5g}", f"{100 * deviation:+.2f} %", sigma,
                  both, abs(deviation) <= allowed and abs(distance) <= sigmas)

    def sigmas(self, state, quantity, measured, error, reference, allowed):
        """Requires |measured - reference| <= allowed standard errors."""
        deviation = (measured - reference) / error
        self._row(state, quantity, f"{measured:.5g} +- {error:.2g}", f"{reference:.5g}",
                  f"{measured - reference:+.2g}", f"{deviation:+.1f}", f"{allowed:g} sigma", abs(deviation) <= allowed)

    def limit(self, state, quantity, measured, limit, ok):
        self._row(state, quantity, f"{measured:.2e}", "", "", "", limit, ok)

    def plain_heading(self, text, columns):
        print(f"\n### {text}\n\n{columns}\n|{'---|' * (columns.count('|') - 1)}", flush=True)

    def plain_row(self, cells, ok):
        self.failed += 0 if ok else 1
        self.stored.append([*map(str, cells), "ok" if ok else "off"])
        print(f"| {' | '.join(map(str, cells))} | {'ok' if ok else '**off**'} |", flush=True)

    def _row(self, state, quantity, measured, reference, deviation, sigma, allowed, ok):
        self.failed += 0 if ok else 1
        value, _, error = measured.partition(" +- ")
        self.stored.append([self.title, state, quantity, value, error, reference, deviation, sigma, allowed, "ok" if ok else "off"])
        verdict = "ok" if ok else "**off**"
        print(f"| {state} | {quantity} | {measured} | {reference} | {deviation} | {sigma} | {allowed} | {verdict} |",
              flush=True)


def store(group, table):
    """Writes data/validation/GROUP.csv."""
    DATA.mkdir(parents=True, exist_ok=True)
    with open(DATA / f"{group}.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([SHORT_COLUMNS if group == "short" else COLUMNS, *table.stored])


def stored(group):
    with open(DATA / f"{group}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def by(rows, *keys):
    """Rows by the values of these columns, in their order."""
    of = {}
    for row in rows:
        of.setdefault(tuple(row[key] for key in keys), []).append(row)
    return of


def worst(rows):
    """Largest deviation with its state; range of values that have only a limit."""
    if absent := [row["state"] for row in rows if row["measured"] == "null"]:
        return f"no value at {', '.join(absent)}"
    if rows[0]["deviation"]:
        row = max(rows, key=lambda r: abs(float(r["deviation"].split()[0] if r["deviation"].endswith("%") else r["sigma"])))
        sigma = f", {row['sigma']} sigma" if row["sigma"] else ""
        return f"{row['deviation']}{sigma} at {row['state']}"
    values = sorted(float(row["measured"]) for row in rows)
    return f"{values[0]:.1e} to {values[-1]:.1e}" if values[0] != values[-1] else f"{values[0]:g}"


def summary(groups):
    """Lines of the summary: a row for each quantity of each table."""
    yield "| compared with | quantity | comparisons | off | largest deviation, or range | allowed |"
    yield "|---|---|---|---|---|---|"
    for group in groups:
        for (title,), rows in by(stored(group), "table").items():
            first = f"**{title}** [{group}.csv](../data/validation/{group}.csv)"
            for (quantity,), of in by(rows, "quantity").items():
                allowed = ", or ".join(dict.fromkeys(row["allowed"] for row in of))
                off = sum(row["verdict"] != "ok" for row in of)
                yield f"| {first} | {quantity} | {len(of)} | {off} | {worst(of)} | {allowed} |"
                first = ""


def summary_of_short():
    yield '| quantity | printed and right | printed and wrong | absent, was wrong | absent, was right | of these with "auto" | "auto" alone |'
    yield "|---|---|---|---|---|---|---|"
    columns = ("quantity", "printed_right", "printed_wrong", "absent_was_wrong", "absent_was_right", "lost_with_auto", "auto_alone")
    for row in stored("short"):
        if row["state"] == "all":
            yield f"| {' | '.join(row[column] for column in columns)} |"


def write_page():
    """Replaces the text between the markers of docs/validation.md by summaries of data/validation."""
    text = PAGE.read_text(encoding="utf-8")
    for name, lines in (("groups", list(summary(GROUPS))), ("short", list(summary_of_short()))):
        begin, end = f"<!-- {name}: written by tools/validate -->\n", f"<!-- end of {name} -->\n"
        if text.count(begin) != 1 or text.count(end) != 1:
            raise ValueError(f"{PAGE}: markers of {name} are missing")
        text = text[:text.index(begin)] + begin + "\n" + "\n".join(lines) + "\n\n" + text[text.index(end):]
    PAGE.write_text(text, encoding="utf-8")
