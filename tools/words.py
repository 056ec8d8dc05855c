#!/usr/bin/env python3
"""Checks the words of comments in C++ files, of the Python package and of the report's scripts, and names file, line and
comment where they break the rule.

usage: words.py [FILE...]

The rule (CONTRIBUTING.md): a doc comment is a sentence whose omitted subject is the declared thing. It begins with a
verb for a function ("Returns ...") and with a noun for data ("Number of ..."), with "True ..." or "Whether ..." for a
truth value. It never begins with a preposition, a pronoun, a conjunction or a stand-in for one ("The same ..."): a
condition follows what it limits. Some phrases are refused anywhere in a comment, because they have to be read twice.

Comments are // and, for doc comments, ///, each with a space; /* */ names an argument (/*signed_distance=*/), no more. Doc
comments of Python are docstrings, and strings below a declaration; those of JavaScript are /** */.

Without FILE all headers and sources (.h, .cpp) of the repository, the modules of the Python package and those of the
report are read. Every fault is printed. Exit code 1: there are more faults, of all comments, than LIMIT times the number of doc comments.
"""

import ast
import io
import pathlib
import re
import subprocess
import sys
import tokenize

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT = 0.01

PREPOSITIONS = """
    about above across after against along among around as at before behind below beneath beside besides between beyond
    by despite down during except for from in inside into like of off on onto out outside over per since
    through throughout till to toward towards under until unto up upon via with within without
"""
PRONOUNS = """
    anything everything he her his how it its itself nobody none nothing others she so something such that
    their theirs them there these they this those we what whatever when whenever where wherever which whichever who
    whom whose why you
"""
CONJUNCTIONS = "although and because but else if nor or otherwise than then though unless whereas while yet"
WRONG_FIRST = frozenset(f"{PREPOSITIONS} {PRONOUNS} {CONJUNCTIONS}".split())

WRONG_BEGINNINGS = re.compile(r"(?:the )?same\b|all (?:that|of|but)\b|one (?:of|that|which)\b|next to\b|not\b", re.IGNORECASE)

PHRASES = [
    r"so many\b(?! \w+ that)",
    r"so much as",
    r"next to nothing",
    r"in good time",
    r"(?:is|are) looked at",
    r"there (?:is|are) not\b",
    r"that there (?:is|are)\b",
    r"that (?:it|they|he) (?:has|have|is|are) not\b",
    r"at the least\b(?! \w)",
    r"what is made of",
    r"what (?:it|they) (?:is|are) worth",
    r"of which it is (?:said|known)",
    r"as good as nothing",
    r"no longer theirs",
    r"all that there",
    r"is for an? \w+ to say",
    r"who(?:ever)? (?:wants|asks)",
    r"be it\b",
    r"for ever\b",
    r"a share of 1e",
]
OTHER_STYLE = re.compile(r"//!.*|///?<?[^\s/<].*|/\*(?![\w:]+=?\*/).*")
WRONG_PHRASES = re.compile("|".join(rf"\b{phrase}" for phrase in PHRASES), re.IGNORECASE)


def comments(text):
    """Yields line number, lines and marker (//, ///, ///<; None: of another style) of each comment of a C++ source."""
    lines = text.split("\n")
    block = None  # marker, number of the first line, texts
    for number, line in enumerate([*lines, ""], 1):
        whole = re.match(r"\s*(///<|///|//)(?:\s(.*)|)$", line)
        trailing = None if whole else re.match(r"[^\"]*?\S\s+(///<|///|//)\s(.*)$", strip_strings(line))
        if whole and block and whole[1] in (block[0], "///<"):
            block[2].append(whole[2] or "")
            continue
        if block:
            yield block[1], block[2], block[0]
        block = None
        if whole:
            block = (whole[1], number, [whole[2] or ""])
        elif trailing:
            block = (trailing[1], number, [line[trailing.start(2):]])
        elif other := OTHER_STYLE.search(strip_strings(line)):
            yield number, [other[0]], None


def python_comments(text):
    """Yields the same of a Python module, with the markers of C++."""
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            continue
        for before, one in zip([None, *node.body], node.body):
            is_text = isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant) and isinstance(one.value.value, str)
            if is_text and (before is None or isinstance(before, (ast.Assign, ast.AnnAssign))):
                yield one.lineno, one.value.value.split("\n"), "///"
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], [token.string.lstrip("# ")], "//"


def script_comments(text):
    """Yields the same of a JavaScript module, whose doc comments are /** */."""
    for match in re.finditer(r"/\*\*(?P<doc>.*?)\*/|(?:^|\s)//\s(?P<line>[^\n]*)", text, re.DOTALL):
        doc = match["doc"]
        lines = [re.sub(r"^\s*\*\s?", "", line) for line in doc.split("\n")] if doc is not None else [match["line"]]
        yield text.count("\n", 0, match.start()) + 1, lines, "//" if doc is None else "///"


def strip_strings(line):
    """A line with strings and characters blotted out."""
    return re.sub(r"""'(?:[^'\\]|\\.)'|"(?:[^"\\]|\\.)*\"""", lambda m: "'" * len(m[0]), line)


def wording(lines):
    """The words of a comment: without doxygen's commands and grouping marks."""
    text = " ".join(line.strip() for line in lines)
    return re.sub(r"\s*@(?:file|brief|\{|\})\s*", " ", text).strip()


def fault(text, marker):
    """What is wrong with a comment, or nothing."""
    if marker is None:
        return "is written in another way than // and ///"
    phrase = WRONG_PHRASES.search(text)
    if phrase:
        return f'says "{phrase[0]}"'
    if marker == "//":
        return None
    beginning = WRONG_BEGINNINGS.match(text)
    if beginning:
        return f'begins with "{beginning[0].strip()}"'
    first = re.match(r"\W*([A-Za-z]+)(?=[\s,;:.)']|$)", text)
    if first and not re.match(r"\W*[=<>^(*/|+-]", text) and first[1].lower() in WRONG_FIRST:
        return f'begins with "{first[1]}"'
    return None


def sources():
    command = ["git", "ls-files", "*.h", "*.cpp", "apps/python/hardbody/*.py", "apps/report/src/*.js"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in listed.split() if (ROOT / name).is_file()]


def main():
    paths = [pathlib.Path(name).resolve() for name in sys.argv[1:]] or sources()
    number, messages = 0, []
    for path in paths:
        read = {".py": python_comments, ".js": script_comments}.get(path.suffix, comments)
        for line, texts, marker in read(path.read_text()):
            text = wording(texts)
            if not text:
                continue
            number += marker in ("///", "///<")
            wrong = fault(text, marker)
            if wrong:
                name = path.relative_to(ROOT) if path.is_relative_to(ROOT) else path
                messages.append(f"{name}:{line}: {wrong}: {text[:100]}")
    share = len(messages) / max(1, number)
    for message in messages:
        print(message, file=sys.stderr)
    print(f"words: {len(messages)} faults in comments, {number} doc comments: {100 * share:.1f} %; accepted: {100 * LIMIT:g} %",
          file=sys.stderr if share > LIMIT else sys.stdout)
    return int(share > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
