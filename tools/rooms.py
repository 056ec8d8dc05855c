#!/usr/bin/env python3
"""Checks that sources include from their own room or from rooms below, and names file and include where they do not.

usage: rooms.py

A room is a folder of a library or of the program. Its public headers count as part of the room that implements them.
docs/architecture.md says what lives in each room. Rooms between the same two "<" do not see each other. Libraries stand in
an order, too, and files and folders have a largest size.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_SOURCES = 25  # in one folder
MOST_LINES = 400  # of one file of the libraries and the program

LIBRARIES = {
    "libgeom/src": {
        "order": "shapes < dual < norm < paper, batch < any",
        "public": ("geom", {
            "shapes": "ellipsoid export mass obb pose shape shape_variant superellipsoid tolerances kernel/eigen_layout kernel/hessian_sum "
                      "kernel/lane_norms kernel/lanes kernel/mass_impl kernel/nested_norm kernel/norm_bodies kernel/refuse "
                      "kernel/small_solve",
            "dual": "distance kernel/distance_impl kernel/dual_newton kernel/perram_wertheim kernel/simplex_descent "
                    "kernel/sphere_search kernel/uniaxial kernel/uniaxial_pair",
            "norm": "kernel/norm_body_pair",
            "paper": "newton kernel/newton_equations kernel/newton_impl",
            "batch": "batch kernel/records-inl",
            "any": "any_shape queries kernel/queries_impl",
        }),
    },
    "libed/src": {
        "order": "base < cells < motion < contact < vectors < system < bodies < neighbours < loop < start, observables",
        "public": ("ed", {
            "base": "archive arithmetic export random sink tolerances",
            "motion": "impulse motion",
            "contact": "contact_options shape time_of_contact",
            "system": "archive_system polydispersity system",
            "bodies": "snapshot",
            "loop": "archive_simulation simulation",
            "start": "start",
            "observables": "analysis archive_observables equilibration observables stored_frames",
        }),
    },
    "apps/hardbody": {
        "order": "base < registry < io < trajectory < config < start < run < sweep, plot, audit < report, distance < commands",
        "public": ("hardbody", {}),
    },
}


def ranks(order):
    """Rank of each room of an order as above."""
    return {room.strip(): rank for rank, group in enumerate(order.split("<")) for room in group.split(",")}


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".h", ".cpp"))


def includes(path):
    """Names of the files that a source includes, each with whether it stands in quotes."""
    return [(name, opening == '"') for opening, name in re.findall(r'^\s*#\s*include\s*(["<])([^">]+)', path.read_text(), re.MULTILINE)]


def check_library(folder, order, public):
    """Messages about the includes of a library."""
    rank = ranks(order)
    prefix, headers = public
    room_of_header = {name: room for room, names in headers.items() for name in names.split()}
    for path in sources(ROOT / folder):
        inside = path.relative_to(ROOT / folder)
        if len(inside.parts) == 1:
            if inside.name != "main.cpp":
                yield f"{path.relative_to(ROOT)}: is in no room; accepted: {', '.join(rank)}"
        elif inside.parts[0] not in rank:
            yield f"{path.relative_to(ROOT)}: unknown room {inside.parts[0]}; accepted: {', '.join(rank)}"
        else:
            yield from check_includes(path, inside.parts[0], folder, order, prefix, room_of_header)
    for path in sources(ROOT / pathlib.Path(folder).parent / "include" / prefix) if room_of_header else []:
        name = str(path.relative_to(ROOT / pathlib.Path(folder).parent / "include" / prefix).with_suffix(""))
        if name in room_of_header:
            yield from check_includes(path, room_of_header[name], folder, order, prefix, room_of_header)
        elif name != prefix:  # which includes all others
            yield f"{path.relative_to(ROOT)}: belongs to no room; accepted: headers that tools/rooms.py lists"


def check_includes(path, room, folder, order, prefix, room_of_header):
    """Messages about what a file of a room includes: only files of the library itself."""
    name = path.relative_to(ROOT)
    rank = ranks(order)
    for include, quoted in includes(path):
        shown = f'"{include}"' if quoted else f"<{include}>"
        target = room
        if quoted or (ROOT / folder / include).is_file():
            parts = pathlib.PurePath(include).parts
            if not quoted or "/".join(parts) != include or ".." in parts or not (ROOT / folder / include).is_file():
                yield f'{name}: #include {shown}; accepted: the path of a file from {folder}, in quotes'
                continue
            target = parts[0]
        elif room_of_header and include.startswith(f"{prefix}/"):
            target = room_of_header.get(include.removeprefix(f"{prefix}/").removesuffix(".h"))
            if target is None:
                yield f"{name}: {shown} belongs to no room; accepted: headers that tools/rooms.py lists"
                continue
        if target != room and rank[target] >= rank[room]:
            yield f"{name}: #include {shown} is of {target}, which is not below {room}; order: {order}"


def check_audience():
    """Messages about includes of libraries above, and of another library's private headers."""
    above = {"libgeom": "ed|hardbody", "libed": "hardbody", "apps": "-"}
    for folder, higher in above.items():
        for path in sources(ROOT / folder):
            for include, _ in includes(path):
                if re.match(rf"(?:geom|ed)/internal/|(?:{higher})/", include):
                    yield f"{path.relative_to(ROOT)}: #include <{include}>; accepted: geom/kernel/ and public headers of libraries below"


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
    messages = [m for folder, library in LIBRARIES.items() for m in check_library(folder, **library)]
    messages += [*check_audience(), *check_sizes()]
    for message in messages:
        print(message, file=sys.stderr)
    if messages:
        return 1
    print("rooms: includes point down, no folder has more than", MOST_SOURCES, "sources")
    return 0


if __name__ == "__main__":
    sys.exit(main())
