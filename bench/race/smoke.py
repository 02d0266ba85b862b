#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The same plume of smoke by this program and by Blender's gas solver (Mantaflow), volumes written by both.

    smoke.py PROGRAM [--cells N] [--frames F] [--blender PATH]

A ball lets smoke into a box of N^3 cells; one step a frame, F frames, one thread, VDB. Compared is the processor time of
a frame: that of a run of 2 F frames less that of one of F, so that starting, compiling and importing do not count. The
two take turns. Blender solves for the pressure to its own default accuracy, this program to 1e-3 and to 1e-5; only this
one has C-F diffusion in it. Nothing passes or fails here.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile

SCENE = """cattaneo: 1
title: Smoke of a ball
model: flow
domain: {{size: [2, 2, 2], cells: [{n}, {n}, {n}], walls: {{z+: open}}}}
time: {{end: {end}, dt: {dt}, frames: {rate}}}
diffusion: {{k: 1e-4, tau: 1}}
flow: {{gravity: [0, 0, -9.81], buoyancy: {{phi: 0.05}}}}
sources: [{{field: phi, shape: sphere, center: [1, 1, 0.4], radius: 0.2, rate: 24}}]
solver: {{tolerance: {tolerance}}}
sparse: {{follow: on}}
output: {{fields: [phi, velocity], formats: [vdb], checkpoint: {{every: never}}}}
"""

BAKE = """
import bpy, sys
folder, n, frames = sys.argv[-3], int(sys.argv[-2]), int(sys.argv[-1])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.2, location=(0, 0, -0.6))
source = bpy.context.object.modifiers.new('Fluid', 'FLUID')
source.fluid_type = 'FLOW'
source.flow_settings.flow_type = 'SMOKE'
source.flow_settings.flow_behavior = 'INFLOW'
bpy.ops.mesh.primitive_cube_add(size=2)
box = bpy.context.object.modifiers.new('Fluid', 'FLUID')
box.fluid_type = 'DOMAIN'
d = box.domain_settings
d.domain_type = 'GAS'
d.resolution_max = n
d.use_adaptive_domain = False
d.use_adaptive_timesteps = False
d.timesteps_min = d.timesteps_max = 1
d.use_noise = False
d.cache_directory = folder
d.cache_type = 'ALL'
d.cache_data_format = 'OPENVDB'
d.cache_frame_start, d.cache_frame_end = 1, frames
bpy.context.scene.frame_end = frames
bpy.ops.fluid.bake_all()
"""


def processor_seconds(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "TBB_NUM_THREADS": "1"}
    done = subprocess.run(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{words[0]}: {done.stdout[-800:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ours(program, folder, n, frames, tolerance):
    scene = os.path.join(folder, "plume.yaml")
    with open(scene, "w", encoding="ascii") as file:
        file.write(SCENE.format(n=n, end=frames / 24, dt=1 / 24, rate=24, tolerance=tolerance))
    return processor_seconds([program, "run", scene, "-o", os.path.join(folder, "ours"), "--force", "--threads", "1",
                              "--progress", "none"])


def theirs(blender, folder, n, frames):
    script, cache = os.path.join(folder, "bake.py"), os.path.join(folder, f"cache{frames}")
    with open(script, "w", encoding="ascii") as file:
        file.write(BAKE)
    seconds = processor_seconds([blender, "-b", "-t", "1", "--python-exit-code", "1", "-P", script, "--", cache, str(n),
                                 str(frames)])
    written = sum(name.endswith(".vdb") for _, _, names in os.walk(cache) for name in names)
    if written < frames:
        sys.exit(f"{blender}: wrote {written} volumes of {frames}")
    return seconds


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program")
    p.add_argument("--cells", type=int, default=128)
    p.add_argument("--frames", type=int, default=8)
    p.add_argument("--blender", default="blender")
    a = p.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        frame = {}
        for name, run in (("Blender", lambda f: theirs(a.blender, folder, a.cells, f)),
                          ("ours, 1e-3", lambda f: ours(a.program, folder, a.cells, f, 1e-3)),
                          ("ours, 1e-5", lambda f: ours(a.program, folder, a.cells, f, 1e-5))):
            frame[name] = (run(2 * a.frames) - run(a.frames)) / a.frames
    print(f"{a.cells}^3 cells, frames {a.frames} to {2 * a.frames}, seconds of one processor a frame")
    for name, seconds in frame.items():
        print(f"  {name:12s} {seconds:8.3f}   {frame['Blender'] / seconds:6.2f} times as fast as Blender")


if __name__ == "__main__":
    main()
