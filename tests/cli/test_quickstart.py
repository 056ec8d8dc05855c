"""The commands of docs/quickstart.md and of the README do what is said there, in this order, with fewer bodies and
shorter times. (The C++ of both is built and run by tests/package.)

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_quickstart.py
"""

import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import unittest

HARDBODY = os.path.abspath(os.environ.get("HARDBODY", "build/release/apps/hardbody/hardbody"))
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SMALL = {"system.number": 64, "equilibration.time": 0.5, "production.time": 2}
SMALL_TIMES = "[equilibration]\ntime = 0.5\n[production]\ntime = 1\n"
SMALL_GRID = "[system]\nnumber = 64\n[grid]\nshape.aspect_ratio = [2, 3]\nsystem.packing_fraction = [0.2]\n"


def blocks(name):
    """(language, text) of each block of code."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


class Page(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.here = pathlib.Path(directory.name)

    def hardbody(self, line):
        """One line of a page, which succeeds; what it prints. A run is a small one."""
        program, *words = shlex.split(line, comments=True)
        self.assertEqual(program, "hardbody")
        if words[0] == "run":
            settings = [w for w in words if "=" in w and w.split("=")[0] not in SMALL]
            words = [w for w in words if "=" not in w and w != "--set"]
            words += ["--set", *settings, *(f"{key}={value}" for key, value in SMALL.items())]
        result = subprocess.run([HARDBODY, *words], cwd=self.here, capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, f"{line}\n{result.stderr}")
        return result.stdout

    def follow(self, name):
        """All of a page's commands. A toml block that is a whole configuration replaces the file that init wrote; the
        sweep is small from the beginning."""
        configs = [text for language, text in blocks(name) if language == "toml"]
        lines = [line.removeprefix("$ ") for language, text in blocks(name) if not language for line in text.splitlines()]
        ran = [line for line in lines if re.match(r"hardbody [a-z]", line)]
        for line in ran:
            if line.startswith("hardbody run run.toml"):
                (self.here / "run.toml").write_text(next(text for text in configs if "[grid]" not in text))
            if line.startswith("hardbody sweep"):
                grid = next((text for text in configs if "[grid]" in text), SMALL_GRID)
                (self.here / "sweep.toml").write_text(grid.replace("256", "64") + SMALL_TIMES)
            self.hardbody(line)
        return ran

    def test_quickstart(self):
        self.assertEqual(len(self.follow("docs/quickstart.md")), 10)
        for name in ["out/run/trajectory.gsd", "out/run/report.html", "out/both.html", "out/sweep/report.html"]:
            self.assertGreater((self.here / name).stat().st_size, 1000, name)
        # Three shapes at five packing fractions.
        self.assertEqual(len((self.here / "out/sweep/sweep.csv").read_text().splitlines()), 1 + 15)

    def test_readme(self):
        self.assertEqual(len(self.follow("README.md")), 9)
        for name in ["out/run/report.html", "out/superball/summary.json", "out/sweep/sweep.csv"]:
            self.assertGreater((self.here / name).stat().st_size, 100, name)

    def test_what_the_readme_says_that_is_printed(self):
        """The table of superballs: the same rows in the same units, whatever their numbers; of what is missing the name."""
        shown = next(text for _, text in blocks("README.md") if "collision rate" in text)
        self.hardbody("hardbody init superball.toml --template superball")
        printed = self.hardbody("hardbody run superball.toml --set production.time=60")

        def rows(text):
            """Name, unit and meaning, without numbers."""
            table = [line for line in text.splitlines() if re.match(r"  \S.{15}\S.{22}\S", line)]
            return {line[2:18].strip(): "" if line[18:].startswith("- (") else re.sub(r"q = [0-9.]+", "q", line[41:])
                    for line in table}

        self.assertEqual(len(rows(shown)), 7)
        there = rows(printed)
        compared = 0
        for name, meaning in rows(shown).items():
            self.assertIn(name, there)
            # The run of this test is too short for some.
            if meaning and there[name]:
                self.assertEqual(meaning, there[name], name)
                compared += 1
        self.assertGreaterEqual(compared, 2)


if __name__ == "__main__":
    unittest.main()
