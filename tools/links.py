#!/usr/bin/env python3
"""Checks that the files named in documentation and comments exist.

usage: links.py

Documentation: relative links of every page lead to a file, and to a heading of it; a path between backticks that begins with a
folder of this repository is a file, a folder or a pattern that matches one; a name of a source (`shapes/pose.cpp`, `pose.h`) is
the end of the path of one; tools, tests, and programs of tests and benchmarks exist, also those in blocks of code. Comments of
sources: names of headers and sources likewise, and docs/*.md.
"""

import fnmatch
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("apps", "bench", "cmake", "data", "docs", "libed", "libgeom", "tests", "tools")
WRITTEN_LATER = ("docs/api/",)  # by tools/docs
SOURCE = r"[\w./*-]+\.(?:h|cpp|py|cmake|js)"
# Names of sources of other projects, and of readers' own files.
ELSEWHERE = {"mine.cpp", "uPlot.js", "three.js"}
# Names of other programs that look like those of tests.
OF_OTHERS = {"SuperquadricRoundness.Phi", "SuperquadricRoundness.Theta"}


def tracked():
    listing = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    return [name for name in listing if (ROOT / name).exists()]


class Files:
    def __init__(self, names):
        self.names = set(names)
        self.folders = {str(parent) for name in names for parent in pathlib.PurePath(name).parents}
        self.ends = {"/".join(parts[k:]) for name in names for parts in [name.split("/")] for k in range(len(parts))}

    def has_path(self, path):
        """Whether a path from the root, with * for any characters, names a file or a folder."""
        path = path.rstrip("/")
        if "*" in path:
            return any(fnmatch.fnmatch(name, path) for name in self.names)
        return path in self.names or path in self.folders

    def has_source(self, name):
        """Whether a name is the end of the path of a file, with * for any characters."""
        if "*" in name:
            return any(fnmatch.fnmatch(end, name) for end in self.ends)
        return name in self.ends


def anchor(heading):
    """Name of a heading in links, as GitHub makes it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
    return re.sub(r"[^\w\- ]", "", text).strip().replace(" ", "-")


def prose(text):
    """A page without its blocks of code."""
    return re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)


def anchors(path):
    text = prose(path.read_text(encoding="utf-8"))
    return {anchor(heading) for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE)}


def check_links(name, text):
    """Messages about relative links of a page."""
    text = prose(text)
    for other in re.findall(r"^\[[^\]]+\]:|\]\[|<(?:a|img)\s[^>]*", re.sub(r"`[^`]*`", "", text), re.MULTILINE):
        yield f"{name}: {other} is another kind of link; accepted: [text](target)"
    for target in re.findall(r"\]\(<?([^)>\s]+)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, fragment = target.partition("#")
        file = (ROOT / name).parent / path if path else ROOT / name
        if not file.exists():
            yield f"{name}: link to {target}, which is no file"
        elif fragment and file.suffix == ".md" and fragment not in anchors(file):
            yield f"{name}: link to {target}, which is no heading there"


def check_names(name, text, files):
    """Messages about paths and sources between backticks of a page."""
    for token in re.findall(r"`([^`\n]+)`", text):
        for word in token.split():
            word = word.removeprefix("./").rstrip(",;:").strip("<>")
            if word.startswith(tuple(f"{folder}/" for folder in FOLDERS)) and re.fullmatch(r"[\w./*-]+", word):
                if not word.startswith(WRITTEN_LATER) and not files.has_path(word):
                    yield f"{name}: `{word}` is no file"
            elif re.fullmatch(SOURCE, word) and word not in ELSEWHERE and not word.startswith(("build/", "out/")):
                if not files.has_source(word):
                    yield f"{name}: `{word}` is the name of no file"


def programs(names):
    """Patterns of the programs of tests and benchmarks, and Suite.Test of all tests."""
    places = re.compile(r"(tests|bench)/.*(\.cpp|\.cmake|\.txt)$")
    text = "\n".join((ROOT / name).read_text(encoding="utf-8") for name in names if places.match(name))
    called = re.findall(r"(?:hardbody_test|hardbody_bench|add_executable)\(([\w${}]+)", text)
    patterns = [re.sub(r"\$\{\w+\}", "*", name) for name in called]
    tests = re.findall(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", text, re.MULTILINE)
    return [p for p in patterns if p.strip("*")], [".".join(test) for test in tests]


def check_commands(name, text, files, patterns, tests):
    """Messages about tools, programs and tests that a page names, also in blocks of code."""
    for tool in set(re.findall(r"(?<![\w/.-])tools/[\w.-]*\w", text)):
        if not files.has_path(tool):
            yield f"{name}: {tool} is no file"
    for program in set(re.findall(r"build/\w+/(?:tests|bench)/(\w+)|(?<![\w/.])(\w+_test|bench_\w+)\b(?!\.)", text)):
        program = "".join(program)
        if not any(fnmatch.fnmatch(program, pattern) for pattern in patterns):
            yield f"{name}: {program} is no program of tests or benchmarks"
    filters = re.findall(r"gtest_filter='?([\w*.]+)", text) + re.findall(r"`([A-Z]\w+\.[A-Z][\w*]+)`", text)
    for wanted in set(filters) - OF_OTHERS:
        if not any(fnmatch.fnmatch(test, wanted) for test in tests):
            yield f"{name}: {wanted} is no test"


def comments(text):
    return "\n".join(re.findall(r"//.*$", text, re.MULTILINE))


def check_comments(name, text, files):
    """Messages about names of sources and pages in the comments of a source."""
    for word in re.findall(rf"(?<![\w./<-]){SOURCE}\b", comments(text)):
        if word not in ELSEWHERE and not files.has_source(word):
            yield f"{name}: a comment names {word}, which is no file"


def check_pages(name, text, files):
    """Messages about docs/*.md, and docs/decisions/NNN, named in any file."""
    for word in re.findall(r"(?<![\w/])docs/[\w/.-]+\.md|(?<![\w/])docs/decisions/\d+", text):
        if not files.has_path(word if word.endswith(".md") else word + "-*"):
            yield f"{name}: {word} is no file"


def released(text):
    """The part of a changelog that is about released versions, whose files may be gone."""
    match = re.search(r"^## \[[\d.]+\] - \d", text, re.MULTILINE)
    return text[match.start():] if match else ""


def main():
    names = tracked()
    files = Files(names)
    known = programs(names)
    messages = []
    pages = 0
    for name in names:
        if not name.endswith((".md", ".h", ".cpp", ".py", ".cmake", "CMakeLists.txt")):
            continue
        text = (ROOT / name).read_text(encoding="utf-8")
        if name == "CHANGELOG.md":
            text = text.removesuffix(released(text))
        if name.endswith(".md"):
            pages += 1
            messages += [*check_links(name, text), *check_names(name, text, files), *check_commands(name, text, files, *known)]
        if name.endswith((".h", ".cpp")):
            messages += check_comments(name, text, files)
        if name != "tools/links.py":
            messages += check_pages(name, text, files)
    for message in dict.fromkeys(messages):
        print(message, file=sys.stderr)
    if messages:
        return 1
    print(f"links: the files that {pages} pages and all comments name exist")
    return 0


if __name__ == "__main__":
    sys.exit(main())
