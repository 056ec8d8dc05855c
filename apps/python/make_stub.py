"""Writes _core.pyi, the stub of the extension, beside it.

usage: make_stub.py STUBGEN DIRECTORY

STUBGEN: nanobind's stubgen.py. DIRECTORY: that of the extension, which is imported by itself: the build environment
need not have NumPy, which the package asks for. Nor is a package hardbody looked for, which might be an older one.
"""

import pathlib
import runpy
import sys

stubgen, directory = sys.argv[1:]
sys.modules["hardbody"] = None  # type: ignore[assignment]
stub = pathlib.Path(directory, "_core.pyi")
sys.argv = [stubgen, "-q", "-i", directory, "-m", "_core", "-o", str(stub)]
runpy.run_path(stubgen, run_name="__main__")

# What mypy --strict asks for beyond what stubgen writes.
text = stub.read_text(encoding="utf-8")
text = text.replace("__hash__: None = None", "__hash__: None  # type: ignore[assignment]")
stub.write_text(text + "\n__version__: str\n", encoding="utf-8")
