#!/usr/bin/env python3
"""clang-tidy on the files named, with the compile commands of a build tree; exit 1 if it has something to say.

usage: tidy.py BUILD_TREE FILE..

What it found nothing in is remembered, by a hash of all that it saw: the file with its headers and comments, as the
preprocessor puts them together, the options, .clang-tidy and clang-tidy's own version. Only what is the same to the
last character is not looked at again. The memory is in ~/.cache/hardbody-tidy (XDG_CACHE_HOME); remove it at will.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys

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


def look_at(file, tree, commands, common):
    """What clang-tidy says, and whether it looked: an empty text if nothing."""
    path = (ROOT / file).resolve()
    if path not in commands:
        return f"{file}: no compile command in {tree}\n", True
    mark = MEMORY / seen(*commands[path], common)
    if mark.exists():
        return "", False
    run = subprocess.run(["clang-tidy", "--quiet", "-p", str(tree), str(path)], cwd=ROOT, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True)
    if run.returncode == 0 and not run.stdout.strip():
        mark.touch()
        return "", True
    return f"{file}: clang-tidy says\n{run.stdout}{run.stderr}", True


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    tree = pathlib.Path(sys.argv[1]).resolve()
    files = sys.argv[2:]
    commands = compile_commands(tree)
    version = subprocess.run(["clang-tidy", "--version"], check=True, stdout=subprocess.PIPE).stdout
    common = version + (ROOT / ".clang-tidy").read_bytes()
    MEMORY.mkdir(parents=True, exist_ok=True)
    looked = 0
    good = True
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for text, fresh in pool.map(lambda f: look_at(f, tree, commands, common), files):
            looked += fresh
            if text:
                good = False
                print(text, end="", flush=True)
    print(f"lint: clang-tidy looked at {looked} files, {len(files) - looked} are as they were when it had nothing to say")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
