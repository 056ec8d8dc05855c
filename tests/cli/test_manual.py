"""The manual page says what the program's own help says: every command, option and argument, and no others.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_manual.py
"""

import os
import re
import shutil
import subprocess
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
HARDBODY = os.path.abspath(os.environ.get("HARDBODY", "build/release/apps/hardbody/hardbody"))
MANUAL = os.path.join(HERE, "..", "..", "docs", "man", "hardbody.1")


def help_of(*command):
    result = subprocess.run([HARDBODY, *command, "--help"], capture_output=True, text=True, check=True)
    return result.stdout


def block(text, title):
    """The indented lines below `title:`, one entry each."""
    match = re.search(rf"^{title}:\n((?:  .*\n)+)", text, re.MULTILINE)
    return re.findall(r"^  (\S+)", match.group(1), re.MULTILINE) if match else []


def options(text):
    return {name for entry in block(text, "Options") for name in entry.split(",")}


class Manual(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(MANUAL, encoding="utf-8") as file:
            cls.source = file.read()
        cls.commands = block(help_of(), "Subcommands")

    def section(self, kind, title):
        """The source from one heading to the next."""
        match = re.search(rf"^\.{kind} {title}\b.*?(?=^\.S[sh] |\Z)", self.source, re.MULTILINE | re.DOTALL)
        self.assertIsNotNone(match, f".{kind} {title} is missing")
        return match.group(0)

    def options_in(self, section):
        text = re.sub(r"^\.(It|Op) ", "", section, flags=re.MULTILINE)
        long = {f"--{name}" for name in re.findall(r"\bFl Fl ([\w-]+)", text)}
        return long | {f"-{name}" for name in re.findall(r"(?<!Fl )\bFl (\w)\b", text)}

    def test_commands(self):
        self.assertIn("run", self.commands)
        described = re.findall(r"^\.Ss (\w+)", self.section_of_commands(), re.MULTILINE)
        self.assertEqual(sorted(described), sorted(self.commands))
        synopsis = self.section("Sh", "SYNOPSIS")
        for command in self.commands:
            self.assertIn(f".Cm {command}\n", synopsis)

    def section_of_commands(self):
        return re.search(r"^\.Sh COMMANDS.*?(?=^\.Sh )", self.source, re.MULTILINE | re.DOTALL).group(0)

    def test_global_options(self):
        self.assertEqual(self.options_in(self.section("Sh", "OPTIONS")), options(help_of()))

    def test_options_and_arguments_of_each_command(self):
        for command in self.commands:
            with self.subTest(command=command):
                text = help_of(command)
                section = self.section("Ss", command)
                # Every command has these two; the page says so once.
                self.assertEqual(self.options_in(section), options(text) - {"-h", "--help"})
                for argument in block(text, "Positionals"):
                    self.assertRegex(section, rf"\bAr {argument}\b")

    def test_words_of_distance(self):
        """The members and values that `hardbody distance --help` names."""
        section = self.section("Ss", "distance")
        footer = help_of("distance").split("A line in:")[1]
        for word in set(re.findall(r'"(\w+)"', footer)):
            with self.subTest(word=word):
                self.assertRegex(section, rf"\b{word}\b")

    def test_exit_statuses(self):
        section = self.section("Sh", "EXIT STATUS")
        for status in re.findall(r"\b\d+\b", help_of().split("Exit status:")[1]):
            self.assertRegex(section, rf"\b{status}\b")

    @unittest.skipUnless(shutil.which("mandoc"), "mandoc is not installed")
    def test_markup(self):
        result = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", MANUAL], capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stdout), (0, ""))


if __name__ == "__main__":
    unittest.main()
