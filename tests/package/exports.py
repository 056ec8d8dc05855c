"""The shared libraries export every function that the installed headers declare, and nothing else of their own.

    python3 exports.py PREFIX NM

A function counts as declared if a header outside internal/ leaves its body to the library: the headers are read, not
compiled, which needs no more than their own regular style. Overloads are counted by name.
"""

import collections
import pathlib
import re
import subprocess
import sys

# Header -> library, by default that of its directory.
LIBRARIES = {"geom": "geom", "ed": "ed", "geom/seeds.h": "geom_seeds", "geom/cgal.h": "geom_cgal"}


def without_comments(text):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.DOTALL)
    return re.sub(r"^\s*#(\\\n|[^\n])*", " ", text, flags=re.MULTILINE)


def without_nested(text, pair):
    """The text without what stands between these two."""
    kept, depth = [], 0
    for character in text:
        if character == pair[0]:
            depth += 1
        elif character == pair[1]:
            depth -= 1
        elif depth == 0:
            kept.append(character)
    return "".join(kept)


def statements(text):
    """(scope, statement) of what ends in `;` outside function bodies; scopes are namespaces and classes."""
    scopes, begin, parentheses = [], 0, 0
    for k, character in enumerate(text):
        if character in "()":
            parentheses += 1 if character == "(" else -1
        elif parentheses > 0:
            continue
        elif character == "{":
            head = text[begin:k]
            # "class GEOM_EXPORT Name", "namespace geom::kernel"; not a function that returns a struct, nor the
            # template <class T> of one.
            scope = re.search(r"\b(namespace|class|struct|enum)\b(?:\s*\[\[\w+\]\])?(?:\s+\w+)*?\s+([\w:]+)\s*$", head)
            if scope and "(" not in head:
                scopes.append(scope.groups())
            else:
                scopes.append(("body", ""))
            begin = k + 1
        elif character == "}":
            scopes.pop()
            begin = k + 1
        elif character == ";":
            if not any(kind in ("body", "enum") for kind, _ in scopes):
                yield [name for _, name in scopes], " ".join(text[begin : k + 1].split())
            begin = k + 1


def declared(header):
    """Qualified names of the functions that the header declares and leaves to the library."""
    text = without_comments(header.read_text(encoding="utf-8"))
    # Declared, for a friend, and defined further down.
    inline = set(re.findall(r"^inline [^;{(]*?(\w+)\(", text, re.MULTILINE))
    for scope, statement in statements(text):
        statement = re.sub(r"^((public|private|protected)\s*:\s*)+", "", statement)
        if re.match(r"(template|using|friend|typedef|static_assert|inline constexpr)\b", statement):
            continue
        # A pointer to a function is no function.
        if re.search(r"=\s*(default|delete|0)\s*;$", statement) or re.match(r"[^(]*\(\*\w+\)\(", statement):
            continue
        statement = without_nested(statement, "<>")
        head = statement.split("(")[0]
        match = re.search(r"(~?\w+|operator\S+)\s*$", head)
        # A member with an initialiser or a brace is no function; without a parenthesis nothing is.
        if "(" not in statement or not match or "=" in head.replace("operator=", ""):
            continue
        if statement.startswith(("inline ", "constexpr ")):
            continue
        if match.group(1) not in inline:
            yield "::".join([*scope, match.group(1)])


def exported(library, nm):
    """Qualified names that the library offers, weak ones apart, with the number of different signatures of each."""
    output = subprocess.run(
        [nm, "--dynamic", "--defined-only", "--demangle", library], capture_output=True, text=True, check=True
    ).stdout
    signatures = collections.defaultdict(set)
    for line in output.splitlines():
        _, kind, signature = line.split(maxsplit=2)
        name = re.sub(r"\[abi:\w+\]", "", without_nested(signature.split("(")[0], "<>"))
        # Weak: type information of the standard library's classes, which everybody may have.
        if kind in "TDBR":
            signatures[name].add(signature)
    return {name: len(different) for name, different in signatures.items()}


def main():
    prefix, nm = pathlib.Path(sys.argv[1]), sys.argv[2]
    include = prefix / "include" / "hardbody"
    wanted = collections.defaultdict(collections.Counter)
    for header in sorted(include.glob("*/*.h")):
        name = str(header.relative_to(include))
        library = LIBRARIES.get(name, LIBRARIES[header.parent.name])
        wanted[library].update(declared(header))

    failures = []
    for library, names in sorted(wanted.items()):
        (path,) = prefix.glob(f"lib*/**/libhardbody_{library}.so")
        soname = path.resolve().name
        if not re.fullmatch(rf"libhardbody_{library}\.so\.\d+\.\d+\.\d+", soname):
            failures.append(f"{path.name} is {soname}: not the library's full version")
        there = exported(path, nm)
        for name, count in sorted(names.items()):
            if there.get(name, 0) < count:
                failures.append(f"{path.name}: {there.get(name, 0)} of {count} declared functions {name} exported")
        for name in there:
            if not name.startswith(("geom::", "ed::")):
                failures.append(f"{path.name}: {name} is exported")
        print(f"{path.name}: {sum(names.values())} declared functions, {sum(there.values())} exported")
        if sum(names.values()) == 0:
            failures.append(f"{path.name}: no declared function found")
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
