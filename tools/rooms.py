#!/usr/bin/env python3
"""Checks that sources include from their own room or from rooms below, and names file and include where they do not.

usage: rooms.py

A room is a folder of a library or of the program. Its public headers count as part of the room that implements them.
docs/architecture.md says what lives in each room. Rooms between the same two "<" do not see each other.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_SOURCES = 25  # in one folder

LIBRARIES = {
    "libgeom/src": {
        "order": "shapes < dual < norm < paper, batch",
        "public": ("geom", {}),
    },
    "libed/src": {
        "order": "base < cells < motion < contact < vectors < system < bodies < neighbours < loop < start, observables",
        "public": ("ed", {
            "base": "archive arithmetic export random tolerances",
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


def check_library(folder, order, public):
    """Messages about the includes of a library."""
    rank = ranks(order)
    prefix, headers = public
    room_of_header = {name: room for room, names in headers.items() for name in names.split()}
    for path in sources(ROOT / folder):
        inside = path.relative_to(ROOT / folder)
        name = path.relative_to(ROOT)
        text = path.read_text()
        if len(inside.parts) == 1:
            if inside.name != "main.cpp":
                yield f"{name}: is in no room; accepted: {', '.join(rank)}"
            continue
        room = inside.parts[0]
        if room not in rank:
            yield f"{name}: unknown room {room}; accepted: {', '.join(rank)}"
            continue
        targets = []
        for include in re.findall(r'#\s*include "([^"]+)"', text):
            if not (ROOT / folder / include).is_file():
                yield f'{name}: #include "{include}" is no file of {folder}; accepted: names from there'
                continue
            targets.append((f'"{include}"', include.split("/")[0]))
        if room_of_header:
            for include in re.findall(rf"#\s*include <{prefix}/(\w+)\.h>", text):
                if include not in room_of_header:
                    yield f"{name}: <{prefix}/{include}.h> belongs to no room; add it to tools/rooms.py"
                    continue
                targets.append((f"<{prefix}/{include}.h>", room_of_header[include]))
        for include, target in targets:
            if target != room and rank[target] >= rank[room]:
                yield f"{name}: #include {include} is of {target}, which is not below {room}; order: {order}"


def check_audience():
    """Messages about includes of another library's private headers."""
    for folder in ("libgeom", "libed", "apps"):
        for path in sources(ROOT / folder):
            for include in re.findall(r"#\s*include <((?:geom|ed)/internal/[^>]+)>", path.read_text()):
                yield f"{path.relative_to(ROOT)}: #include <{include}>; accepted: geom/kernel/ and public headers"


def check_sizes():
    """Messages about folders of too many sources."""
    for folder in (*LIBRARIES, "libgeom/include", "libed/include", "tests/unit"):
        number = {}
        for path in sources(ROOT / folder):
            number[path.parent] = number.get(path.parent, 0) + 1
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
