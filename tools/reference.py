#!/usr/bin/env python3
"""Checks that the reference of the Python package names all of its public names, once each, and no others.

usage: reference.py

Public names are those that apps/python/hardbody/__init__.py imports, but for __version__. Pages: docs/reference/*.rst.
"""

import ast
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def public_names():
    tree = ast.parse((ROOT / "apps/python/hardbody/__init__.py").read_text(encoding="utf-8"))
    aliases = [alias for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names]
    return {alias.asname or alias.name for alias in aliases} - {"__version__"}


def documented_names():
    pages = "\n".join(page.read_text(encoding="utf-8") for page in sorted((ROOT / "docs/reference").glob("*.rst")))
    return collections.Counter(re.findall(r"^\.\. (?:auto(?:class|exception|function)|py:data):: (\w+)$", pages, re.MULTILINE))


def main():
    public, documented = public_names(), documented_names()
    messages = [f"docs/reference: {name} has no entry" for name in sorted(public - set(documented))]
    messages += [f"docs/reference: {name} is no public name of the package" for name in sorted(set(documented) - public)]
    messages += [f"docs/reference: {name} has {count} entries" for name, count in sorted(documented.items()) if count > 1]
    for message in messages:
        print(message, file=sys.stderr)
    if messages:
        return 1
    print(f"reference: all {len(public)} public names of the Python package have an entry")
    return 0


if __name__ == "__main__":
    sys.exit(main())
