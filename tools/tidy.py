#!/usr/bin/env python3
"""clang-tidy on the files named, with the compile commands of a build tree; exit 1 if it has something to say.

usage: tidy.py [--minutes M] BUILD_TREE FILE..

The file that was changed last comes first. After so many minutes no further file is begun; how many are left out is said.

What it found nothing in is remembered, by a hash of all that it saw: the file with its headers and comments, as the
preprocessor puts them together, the options, .clang-tidy and clang-tidy's own version. Only what is the same to the
last character is not looked at again. The memory is in ~/.cache/hardbody-tidy (XDG_CACHE_HOME); remove it at will.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
MEMORY = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "hardbody-tidy"


def compile_commands(tree):
    """Arguments and directory of each unit."""
    commands = {}
    for entry in json.loads((tree / "compile_commands.json").read_text()):
        commands[pathlib.Path(entry["file"]).resolve()] = (shlex.split(entry["command"]), entry["directory"])
    return commands


def preprocessor(arguments):
    """The command that puts the unit together instead of compiling it."""
    output = arguments.index("-o")
    kept = [a for a in arguments[:output] + arguments[output + 2:] if a != "-c"]
    if pathlib.Path(kept[0]).name == "ccache":
        kept = kept[1:]
    return kept + ["-E", "-C", "-P", "-o", "-"]


def seen(arguments, directory, common):
    """The hash of all that clang-tidy looks at."""
    text = subprocess.run(preprocessor(arguments), cwd=directory, check=True, stdout=subprocess.PIPE).stdout
    everything = common + " ".join(arguments).encode() + b"\0" + text
    return hashlib.sha256(everything.replace(str(ROOT).encode(), b".")).hexdigest()


def last_changed(file):
    """Seconds since the epoch, of the last commit that touched it."""
    run = subprocess.run(["git", "log", "-1", "--format=%ct", "--", file], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    return int(run.stdout or 0)


def look_at(file, tree, commands, common, deadline):
    """What clang-tidy says (an empty text if nothing), and whether it looked; None if there was no time."""
    path = (ROOT / file).resolve()
    if path not in commands:
        return f"{file}: no compile command in {tree}\n", True
    mark = MEMORY / seen(*commands[path], common)
    if mark.exists():
        return "", False
    if time.monotonic() > deadline:
        return "", None
    run = subprocess.run(["clang-tidy", "--quiet", "-p", str(tree), str(path)], cwd=ROOT, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True)
    if run.returncode == 0 and not run.stdout.strip():
        mark.touch()
        return "", True
    return f"{file}: clang-tidy says\n{run.stdout}{run.stderr}", True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("tree", type=pathlib.Path)
    parser.add_argument("files", nargs="+")
    options = parser.parse_args()
    deadline = time.monotonic() + 60 * options.minutes
    tree = options.tree.resolve()
    files = sorted(options.files, key=last_changed, reverse=True)
    commands = compile_commands(tree)
    version = subprocess.run(["clang-tidy", "--version"], check=True, stdout=subprocess.PIPE).stdout
    common = version + (ROOT / ".clang-tidy").read_bytes()
    MEMORY.mkdir(parents=True, exist_ok=True)
    counts = {True: 0, False: 0, None: 0}
    good = True
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for text, looked in pool.map(lambda f: look_at(f, tree, commands, common, deadline), files):
            counts[looked] += 1
            if text:
                good = False
                print(text, end="", flush=True)
    left_out = f", {counts[None]} are LEFT OUT for want of time" if counts[None] else ""
    print(f"lint: clang-tidy looked at {counts[True]} files, {counts[False]} are as they were when it had nothing to say{left_out}")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
