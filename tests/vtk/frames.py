#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Frames of real runs as other programs read them: frames.py PROGRAM CHECK FOLDER

Runs a plane and a spatial scene, and some snow, and gives their frames to CHECK (check_vtkhdf.py), first with Debian's h5py, then in an
environment of its own with the current vtk wheel, which is kept in FOLDER. Where no package index is to be had the
second half is left out, with a word; a machine with neither skips the test (exit code 77).
"""
import glob
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from make_atlas import make_atlas  # noqa: E402

PLANE = """cattaneo: 1
title: frames, plane
model: tracer
domain: {size: [1, 0.5], cells: [16, 8], origin: [-1, 2]}
time: {end: 0.2, dt: 0.05, frames: 10}
diffusion: {k: 0.1, tau: 0.5}
fields: {phi: {initial: "x + 2*y", unit: K}, q: {initial: ["0", "0"]}}
output: {formats: [vtkhdf]}
"""
SPACE = PLANE.replace("plane", "space").replace("[1, 0.5]", "[1, 0.5, 0.75]").replace("[16, 8]", "[16, 8, 12]") \
    .replace("[-1, 2]", "[-1, 2, 3]").replace("2*y", "2*y - z").replace('["0", "0"]', '["0", "0", "0"]')
# Particles, and a surface.
SNOW = """cattaneo: 1
title: frames, flakes
model: snowfall
domain: {size: [0.1, 0.1, 0.1], cells: [8, 8, 8]}
time: {end: 0.01, dt: 0.005, frames: 100}
snowfall: {atlas: ATLAS, flakes: 50}
output: {formats: [vtkhdf, ply], fields: [flakes, ground]}
"""


def environment(folder):
    """A Python with the current vtk, made once; None where it cannot be had."""
    python = os.path.join(folder, "bin", "python")
    ready = os.path.join(folder, "ready")
    if not os.path.exists(ready):
        shutil.rmtree(folder, ignore_errors=True)
        made = subprocess.run([sys.executable, "-m", "venv", folder]).returncode == 0 and subprocess.run(
            [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "numpy", "h5py", "vtk"]).returncode == 0
        if not made:
            return None
        open(ready, "w").close()
    return python


def with_h5py():
    """The Python whose h5py is there: this one, or Debian's where another stands before it in PATH."""
    for python in (sys.executable, "/usr/bin/python3"):
        if os.path.exists(python) and subprocess.run([python, "-c", "import h5py"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    return None


def main():
    program, check, folder = (os.path.abspath(p) for p in sys.argv[1:4])
    scratch = os.path.join(folder, "frames")
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    frames = []
    snow = SNOW.replace("ATLAS", make_atlas(os.path.join(scratch, "atlas")))
    for name, scene in (("plane", PLANE), ("space", SPACE), ("snow", snow)):
        path = os.path.join(scratch, name + ".yaml")
        with open(path, "w") as file:
            file.write(scene)
        out = os.path.join(scratch, name)
        subprocess.run([program, "run", path, "-o", out, "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
        frames += sorted(glob.glob(os.path.join(out, "*_*.vtkhdf")))
    assert len(frames) == 3 + 3 + 2 * 3, frames  # of snow: flakes, ground, surface
    debian, python = with_h5py(), environment(os.path.join(folder, "vtk-environment"))
    if debian is not None:
        subprocess.run([debian, check] + frames, check=True)
    if python is None:
        print("no vtk to be had: frames were read with %s" % ("h5py alone" if debian else "nothing"))
        sys.exit(0 if debian else 77)
    subprocess.run([python, "-c", "import vtkmodules.vtkIOHDF"], check=True)
    subprocess.run([python, check] + frames, check=True)


main()
