"""Sphinx' settings of the reference of the Python package: pages of docs/reference, and the tutorials (tools/docs).

Docstrings are plain text: paragraphs, and paragraphs that describe arguments, "name: ...".
"""

import os
import re
from collections.abc import Callable

from sphinx.application import Sphinx
from sphinx.parsers import RSTParser

import hardbody

project = "hardbody"
release = version = os.environ["HARDBODY_VERSION"]
root_doc = "reference/index"
include_patterns = ["reference/*.rst", "tutorials/*.py"]
extensions = ["sphinx.ext.autodoc"]
html_theme = "alabaster"
html_theme_options = {
    "description": "Python package",
    "fixed_sidebar": True,
    "page_width": "1100px",
    "sidebar_width": "260px",
}
html_show_sourcelink = html_show_copyright = False
html_sidebars = {"**": ["about.html", "searchbox.html", "navigation.html"]}
python_maximum_signature_line_length = 100
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
autoclass_content = "both"
smartquotes = False
autodoc_type_aliases = {name: name for name in ("ArrayLike", "Curves", "Progress", "Shape", "Shapes", "Table")}

ARGUMENTS = re.compile(r"(?:[a-z]\w*(?:, | and )?)+(?: \([^)]*\))?: ")


def escaped(text: str) -> str:
    """Plain text as reStructuredText; backticks, single or double, are about literals."""
    parts = re.split(r"(``.+?``|`[^`]+`)", text)
    return "".join(
        f"``{part.strip('`')}``" if part.startswith("`") else re.sub(r"([\\*`|_])", r"\\\1", part) for part in parts
    )


def formatted(paragraph: list[str]) -> list[str]:
    """A paragraph, a list of definitions, or the items of a paragraph that describes arguments."""
    if any(line.startswith(" ") for line in paragraph) and not ARGUMENTS.match(paragraph[0]):
        return [*map(escaped, paragraph), ""]
    if not ARGUMENTS.match(paragraph[0]):
        return [escaped(" ".join(line.strip() for line in paragraph)), ""]
    items = re.split(rf"(?:(?<=\. )|(?<=\n))(?={ARGUMENTS.pattern})", "\n".join(line.strip() for line in paragraph))
    lines = []
    for item in items:
        name, _, text = item.replace("\n", " ").partition(": ")
        lines += [f"- **{escaped(name)}**: {escaped(text.strip())}"]
    return [*lines, ""]


def format_docstring(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    paragraphs = re.split(r"\n\s*\n", "\n".join(lines).strip("\n"))
    lines[:] = [line for text in paragraphs if text.strip() for line in formatted(text.split("\n"))]
    signature = getattr(getattr(obj, "fget", None), "__nb_signature__", None)
    if signature and " -> " in signature[0][0]:
        lines += [f"Type: ``{signature[0][0].partition(' -> ')[2]}``", ""]


def shorten_signature(
    app: Sphinx, what: str, name: str, obj: object, options: object, signature: str | None, returned: str | None
):
    def short(text: str | None) -> str | None:
        if text is None:
            return None
        text = re.sub(r"TypeAliasForwardRef\('(\w+)'\)", r"\1", text).replace("(self, ", "(").replace("(self)", "()")
        return re.sub(r"\b(?:numpy\.typing|hardbody(?:\._\w+)?|os|collections\.abc|typing)\.", "", text)

    return short(signature), short(returned)


def as_python(function: object, name: str) -> Callable[..., None]:
    """A function of the extension's as one of Python's own, which autodoc takes for a static method."""

    def stand_in() -> None: ...

    stand_in.__name__ = stand_in.__qualname__ = name
    stand_in.__doc__ = function.__doc__
    return stand_in


def show_static_methods() -> None:
    for kind in vars(hardbody).values():
        if isinstance(kind, type) and kind.__module__ == "hardbody._core":
            for name, member in list(vars(kind).items()):
                if type(member).__name__ == "nb_func":
                    setattr(kind, name, staticmethod(as_python(member, name)))


def to_rst(script: str) -> str:
    """A tutorial as reStructuredText: its cells are text, or code."""
    pages = []
    for cell in re.split(r"^# %%", script, flags=re.MULTILINE)[1:]:
        kind, _, body = cell.partition("\n")
        if "[markdown]" in kind:
            comment, _, code = re.match(r"((?:#.*\n|\s*\n)*)()((?:.|\n)*)", body).groups()
            text = re.sub(r"^# ?", "", comment.strip(), flags=re.MULTILINE)
            text = re.sub(r"`([^`]+)`", r"``\1``", text)
            pages.append(re.sub(r"^# (.*)$", lambda m: f"{m[1]}\n{'=' * len(m[1])}", text, flags=re.MULTILINE))
        else:
            code = body
        if code.strip():
            pages.append(
                "\n".join([".. code-block:: python", "", *(f"   {line}" for line in code.strip("\n").split("\n"))])
            )
    return "\n\n".join(pages) + "\n"


class ScriptParser(RSTParser):
    supported = ("script",)

    def parse(self, inputstring: str, document: object) -> None:
        super().parse(to_rst(str(inputstring)), document)


def setup(app: Sphinx) -> None:
    show_static_methods()
    app.connect("autodoc-process-docstring", format_docstring)
    app.connect("autodoc-process-signature", shorten_signature)
    app.add_source_suffix(".py", "script")
    app.add_source_parser(ScriptParser)
