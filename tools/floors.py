#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Includes point down.

The folders of src/ are floors, and a file may include only from its own floor and those below:

    base 0 < grid 1 < stencil 2 < solve 3 < physics 4 < model 5 < session 6 < app 7

io and render are side towers on top of grid: they see themselves, base and grid, and are seen by session and
app; model sees of them only the readers of what a scene is made of or names (scene, image, mesh, npy), and those
only from .c files: it reads, and writes nothing. Files of physics never include
each other: physics/diffuse.c and physics/diffuse_stage.c may include physics/diffuse.h, no other may.

    tools/floors.py           checks; prints file:line for every wrong arrow and exits with 1 if there is one
    tools/floors.py --draw    draws the stack, with lines of code
    --src FOLDER              another tree than src/ beside this file's folder
"""

import argparse
import pathlib
import re
import sys

STACK = ["base", "grid", "stencil", "solve", "physics", "model", "session", "app"]
TOWERS = ["io", "render"]
TOWER_SEES = {"base", "grid"}
READERS = {"io/scene.h", "io/image.h", "io/mesh.h", "io/npy.h"}
WHAT = {
    "base": "status, memory, parameters, units",
    "grid": "boxes, fields, halos, sweeps, registry",
    "stencil": "pointwise and neighbour laws",
    "solve": "one operator, one multigrid, one PCG",
    "physics": "one equation a file",
    "model": "couplings that the program can run",
    "session": "a run with its folder",
    "app": "the program",
    "io": "files",
    "render": "pictures",
}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def stem(path):
    """The equation a file of physics is about: diffuse for diffuse.h and diffuse_stage.c."""
    return path.stem.split("_")[0]


def wrong(path, floor, target):
    """Why the file `path` (from src) of `floor` may not include `target` (from src); None: it may."""
    to = target.parts[0]
    if to not in STACK + TOWERS:
        return f"{to} is no floor"
    if floor in TOWERS:
        if to != floor and to not in TOWER_SEES:
            return f"{floor} sees only {', '.join(sorted(TOWER_SEES))} and itself"
        return None
    if to in TOWERS:
        if floor in ("session", "app"):
            return None
        if floor == "model" and str(target) in READERS:
            return None if path.suffix == ".c" else "only .c files of model read files"
        return f"{floor} does not see {to}"
    if STACK.index(to) > STACK.index(floor):
        return f"{to} ({STACK.index(to)}) is above {floor} ({STACK.index(floor)})"
    if floor == "physics" and to == "physics" and stem(path) != stem(target):
        return "files of physics meet only in model"
    return None


def sources(src):
    return sorted(p for p in src.glob("*/*") if p.suffix in (".c", ".h", ".cpp", ".hpp", ".inc"))


def faults(src):
    found = []
    for path in sources(src):
        inside = path.relative_to(src)
        floor = inside.parts[0]
        if floor not in STACK + TOWERS:
            found.append(f"{path}:1: {floor} is no floor")
            continue
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            match = INCLUDE.match(line)
            if not match or match.group(1) == "cattaneo.h":
                continue
            target = pathlib.PurePosixPath(match.group(1))
            reason = wrong(inside, floor, target)
            if reason is None and len(target.parts) != 2:
                reason = "includes are written from src, as floor/file.h"
            if reason is None and not (src / target).is_file():
                reason = "there is no such file"
            if reason is not None:
                found.append(f'{path}:{number}: #include "{target}": {reason}')
    return found


def lines_of(src, floor):
    count = 0
    for path in sources(src):
        if path.parent.name == floor:
            count += len(path.read_text(errors="replace").splitlines())
    return count


def row(left, right, width):
    return " " + left + right.rjust(width - len(left) - 2) + " "


def draw(src):
    """The stack: io and render stand on grid, beside stencil to model, under session."""
    wide, narrow, tower = 80, 54, 12
    parts = [narrow, tower, tower]
    lines = {floor: str(lines_of(src, floor)) for floor in STACK + TOWERS}
    whole, split = "+" + "-" * wide + "+", "+" + "+".join("-" * w for w in parts) + "+"
    beside = {"model": TOWERS, "physics": [WHAT[t] for t in TOWERS], "stencil": [lines[t] for t in TOWERS]}
    out = []
    for floor in reversed(STACK):
        left = f"{STACK.index(floor)} {floor:<9}{WHAT[floor]}"
        if floor in ("app", "session", "grid", "base"):
            out += [split if floor == "grid" else whole, "|" + row(left, lines[floor], wide) + "|"]
            continue
        blank = " " * tower
        cells = [word.center(tower) for word in beside.get(floor, ["", ""])]
        over = "+" + "-" * narrow + "+" + "|".join([blank, blank]) + "|"
        out += [split if floor == "model" else over]
        out += ["|" + "|".join([row(left, lines[floor], narrow)] + cells) + "|"]
    out += [whole, f"{sum(map(int, lines.values()))} lines; a floor sees what it stands on"]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description="Checks that includes point down.")
    parser.add_argument("--draw", action="store_true", help="draw the stack instead")
    parser.add_argument("--src", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent / "src")
    options = parser.parse_args()
    if not options.src.is_dir():
        sys.exit(f"floors: there is no folder {options.src}")
    if options.draw:
        print(draw(options.src))
        return 0
    found = faults(options.src)
    for fault in found:
        print(fault)
    if not found:
        print("floors: every include points down")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
