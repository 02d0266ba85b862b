#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The recipes make pictures of real runs: recipes.py PROGRAM RECIPES FOLDER [blender|paraview]

Runs a small volume and a few flakes and has them shown by recipes/blender.py (or paraview.py) in small pictures. Exit
code 77 where the program that would show them is not installed.
"""
import os
import shutil
import struct
import subprocess
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from make_atlas import make_atlas  # noqa: E402

PUFF = """cattaneo: 1
title: a puff
model: tracer
domain: {size: [1, 1, 1], cells: [24, 24, 24]}
time: {end: 0.1, dt: 0.05, frames: 10}
diffusion: {k: 0.02, tau: 0.2}
fields: {phi: {initial: "exp(-((x-.5)^2+(y-.5)^2+(z-.5)^2)/0.03)"}}
velocity: ["y - 0.5", "0.5 - x", "0"]
output: {formats: [vtkhdf, vdb], fields: [phi, velocity]}
"""
SNOW = """cattaneo: 1
title: flakes
model: snowfall
domain: {size: [0.1, 0.1, 0.1], cells: [8, 8, 8]}
time: {end: 0.01, dt: 0.005, frames: 100}
snowfall: {atlas: ATLAS, flakes: 200}
output: {formats: [npy, ply, vtkhdf], fields: [flakes, ground]}
"""


def grey_levels(path):
    """How many different bytes the picture has, unfiltered rows of a PNG apart: a flat picture has few."""
    data, at, body = open(path, "rb").read(), 8, b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at:at + 4]), data[at + 4:at + 8]
        if kind == b"IDAT":
            body += data[at + 8:at + 8 + length]
        at += 12 + length
    return len(set(zlib.decompress(body)))


def shown(command, picture, expected):
    # The Python in them takes its modules from where the first python3 of PATH has them: be it that of the system.
    paths = {**os.environ, "PATH": "/usr/bin" + os.pathsep + os.environ.get("PATH", "")}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=paths)
    if done.returncode != 0 or not os.path.exists(picture):
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout[-4000:]}")
    for word in expected:
        if word not in done.stdout:
            sys.exit(f"\"{word}\" is not in what the recipe says:\n{done.stdout[-4000:]}")
    levels = grey_levels(picture)
    if levels < 40:
        sys.exit(f"{picture}: shows nothing: {levels} different bytes")


def main():
    program, recipes, folder = (os.path.abspath(p) for p in sys.argv[1:4])
    viewer = sys.argv[4]
    command = shutil.which({"blender": "blender", "paraview": "pvpython"}[viewer])
    if command is None:
        print(f"{viewer} is not installed")
        sys.exit(77)
    command = [command]
    if viewer == "paraview" and "DISPLAY" not in os.environ:
        lent = shutil.which("xvfb-run")
        if lent is None:
            print("there is no display, nor xvfb-run to lend one")
            sys.exit(77)
        # A server begins anew when its last client leaves, and who comes just then is sent away: ParaView looks twice.
        command = [lent, "-a", "-s", "-screen 0 640x480x24 -noreset", *command]
    scratch = os.path.join(folder, "recipes-" + viewer)
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    atlas = make_atlas(os.path.join(scratch, "atlas"))
    for name, scene in (("puff", PUFF), ("snow", SNOW.replace("ATLAS", atlas))):
        path, run, picture = (os.path.join(scratch, name + end) for end in (".yaml", "", ".png"))
        with open(path, "w") as file:
            file.write(scene)
        subprocess.run([program, "run", path, "-o", run, "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
        if viewer == "blender":
            words = ["grids: density, vel"] if name == "puff" else ["shown: surface, particles", "disc.rgba.png"]
            shown([*command, "-b", "--factory-startup", "-P", os.path.join(recipes, "blender.py"), "--", run, "-o", picture,
                   "--size", "160x90", "--samples", "4"], picture, words)
        else:
            shown([*command, os.path.join(recipes, "paraview.py"), run, "-o", picture, "--size", "320x180"], picture,
                  ["shown: "])


main()
