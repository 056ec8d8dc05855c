#!/usr/bin/env python3
"""Checks that sources include from their own room or from rooms below, and names file and include where they do not.

usage: rooms.py

A room is a folder of a library or of the program. Its public headers count as part of the room that implements them.
docs/architecture.md says what lives in each room. Rooms between the same two "<" do not see each other. Also checked: that
no library includes from one above it, functions of public headers are exported, constants of headers have names of their
own, and the sizes of files and folders.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_SOURCES = 25  # in one folder
MOST_LINES = 400  # of one file of the libraries, the program and the unit tests

LIBRARIES = {
    "libgeom/src": {
        "order": "shapes < dual < norm, cores < paper, batch < any < derivatives, patch, scene",
        "public": ("geom", {
            "shapes": "check_support ellipsoid export mass obb polyhedron pose round_shapes shape superellipsoid tolerances "
                      "kernel/core kernel/eigen_layout kernel/lane_norms kernel/lanes kernel/mass_impl kernel/nested_norm kernel/norm_bodies kernel/refuse "
                      "kernel/small_solve",
            "dual": "distance kernel/distance_impl kernel/dual_newton kernel/meridian_search kernel/perram_wertheim kernel/simplex_descent "
                    "kernel/sphere_search kernel/swept_impl kernel/uniaxial kernel/uniaxial_pair",
            "norm": "kernel/norm_body_pair",
            "cores": "rounded shape_variant kernel/core_simplex",
            "paper": "newton kernel/newton_equations kernel/newton_impl",
            "batch": "batch kernel/records-inl",
            "any": "any_convex any_shape half_space kernel/any_body queries kernel/queries_impl",
            "scene": "scene",
            "patch": "contact_patch",
            "derivatives": "derivatives",
        }),
    },
    "libed/src": {
        "order": "base < cells < motion < contact < vectors < system < bodies < neighbours < loop < start, observables",
        "public": ("ed", {
            "base": "archive arithmetic export random sink tolerances",
            "motion": "given/motion impulse motion",
            "contact": "contact_options given/contact given/scene shape time_of_contact",
            "system": "archive_system polydispersity system",
            "bodies": "snapshot",
            "loop": "archive_simulation simulation",
            "start": "start",
            "observables": "analysis archive_observables equilibration observables replicas stored_frames",
        }),
    },
    "apps/hardbody": {
        "order": "base < registry < io < trajectory < config < start < run < sweep, plot, audit < report, distance < commands",
        "public": ("hardbody", {}),
    },
    "apps/python/src": {
        "order": "base < geometry < scene, simulation, runs",
        "public": ("hardbody", {}),
    },
}
ABOVE_ALL_ROOMS = ("main.cpp", "command_line.cpp", "command_line.h", "module.cpp")


def ranks(order):
    """Rank of each room of an order as above."""
    return {room.strip(): rank for rank, group in enumerate(order.split("<")) for room in group.split(",")}


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".h", ".cpp"))


def includes(path):
    """Names of the files that a source includes, each with whether it stands in quotes."""
    return [(name, opening == '"') for opening, name in re.findall(r'^\s*#\s*include\s*(["<])([^">]+)', path.read_text(), re.MULTILINE)]


class Library:
    """A folder of LIBRARIES, with the rooms of its public headers."""

    def __init__(self, folder, order, public):
        self.folder = ROOT / folder
        self.order = order
        self.rank = ranks(order)
        self.prefix, headers = public
        self.room_of_header = {name: room for room, names in headers.items() for name in names.split()}

    def check(self):
        """Messages about sources in no room, and about what the others include."""
        for path in sources(self.folder):
            room = path.relative_to(self.folder).parts[0]
            if room in self.rank:
                yield from self.check_includes(path, room)
            elif room not in ABOVE_ALL_ROOMS:
                yield f"{path.relative_to(ROOT)}: is in no room; accepted: {', '.join(self.rank)}"
        public = self.folder.parent / "include" / self.prefix
        for path in sources(public):
            name = str(path.relative_to(public).with_suffix(""))
            if name in self.room_of_header:
                yield from self.check_includes(path, self.room_of_header[name])
            elif name != self.prefix:  # which includes all others
                yield f"{path.relative_to(ROOT)}: belongs to no room; accepted: headers that tools/rooms.py lists"

    def check_includes(self, path, room):
        """Messages about what a file of a room includes from the library."""
        name = path.relative_to(ROOT)
        for include, quoted in includes(path):
            shown = f'"{include}"' if quoted else f"<{include}>"
            target = room
            if quoted or (self.folder / include).is_file():
                if not (quoted and self.is_plain_path(include)):
                    yield f"{name}: #include {shown}; accepted: the path of a file from {self.folder.relative_to(ROOT)}, in quotes"
                    continue
                target = pathlib.PurePath(include).parts[0]
            elif self.room_of_header and include.startswith(f"{self.prefix}/"):
                target = self.room_of_header.get(include.removeprefix(f"{self.prefix}/").removesuffix(".h"))
                if target is None:
                    yield f"{name}: {shown} belongs to no room; accepted: headers that tools/rooms.py lists"
                    continue
            if target != room and self.rank[target] >= self.rank[room]:
                yield f"{name}: #include {shown} is of {target}, which is not below {room}; order: {self.order}"

    def is_plain_path(self, include):
        """Whether a name is the shortest path of a file from the folder."""
        parts = pathlib.PurePath(include).parts
        return "/".join(parts) == include and ".." not in parts and (self.folder / include).is_file()


def check_audience():
    """Messages about includes of libraries above."""
    for folder, higher in {"libgeom": ("ed/", "hardbody/"), "libed": ("hardbody/",)}.items():
        for path in sources(ROOT / folder):
            for include, _ in includes(path):
                if include.startswith(higher):
                    yield f"{path.relative_to(ROOT)}: #include <{include}>; accepted: headers of libraries below"


def declared_functions(text):
    """Names of functions that a header declares and does not define, each with its line's first words."""
    for match in re.finditer(r"^(?!using |friend |static_assert|return )(\w[\w:<>,*& ]*?)\b(\w+)\([^;{}]*\)[^;{}()]*;", text, re.MULTILINE):
        words, name = match.groups()
        template = text[: match.start()].rstrip().rsplit("\n", 1)[-1].startswith(("template", "  requires"))
        defined_below = re.search(rf"^inline [^;]*?\b{name}\(", text, re.MULTILINE)
        if not template and not defined_below:
            yield name, words


def check_exports():
    """Messages about functions of public headers that shared libraries would hide."""
    for folder in ("libgeom/include", "libed/include"):
        for path in sources(ROOT / folder):
            for name, words in declared_functions(path.read_text()):
                if not re.search(r"_EXPORT\b|\binline\b|\bconstexpr\b", words):
                    yield f"{path.relative_to(ROOT)}: {name} is not exported; accepted: GEOM_EXPORT or ED_EXPORT before it"


def check_constants():
    """Messages about constants of headers that another source of the library declares again.

    In another namespace, that one would silently stand for the header's wherever sources are compiled in groups.
    """
    for folders in (("libgeom",), ("libed",), ("apps/hardbody",), ("apps/python/src", "apps/hardbody")):
        places = {}
        for path in (p for folder in folders for p in sources(ROOT / folder)):
            for name in re.findall(r"^(?:inline |static )?(?:constexpr|const) [^=({;\n]*?\b(k[A-Z]\w*)(?=[\s\[{=])", path.read_text(), re.MULTILINE):
                places.setdefault(name, set()).add(path)
        for name, paths in places.items():
            if len(paths) > 1 and any(p.suffix == ".h" for p in paths):
                yield f"{', '.join(str(p.relative_to(ROOT)) for p in sorted(paths))}: all declare {name}; accepted: one name, one constant"


def check_sizes():
    """Messages about folders of too many sources and files of too many lines."""
    for folder in (*LIBRARIES, "libgeom/include", "libed/include", "tests/unit", "tests/common"):
        number = {}
        for path in sources(ROOT / folder):
            number[path.parent] = number.get(path.parent, 0) + 1
            name, lines = str(path.relative_to(ROOT)), path.read_text().count("\n")
            if lines > MOST_LINES:
                yield f"{name}: {lines} lines; accepted: at most {MOST_LINES}"
        for parent, count in number.items():
            if count > MOST_SOURCES:
                yield f"{parent.relative_to(ROOT)}: {count} sources in one folder; accepted: at most {MOST_SOURCES}"


def main():
    messages = [m for folder, library in LIBRARIES.items() for m in Library(folder, **library).check()]
    messages += [*check_audience(), *check_exports(), *check_constants(), *check_sizes()]
    for message in messages:
        print(message, file=sys.stderr)
    if messages:
        return 1
    print(f"rooms: includes point down, no folder has more than {MOST_SOURCES} sources, no file more than {MOST_LINES} lines")
    return 0


if __name__ == "__main__":
    sys.exit(main())
