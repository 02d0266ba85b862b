# SPDX-License-Identifier: MIT
"""A frame of a run in Blender 3.4 or later, without a display.

    blender -b --factory-startup -P recipes/blender.py -- RUN [--frame N] [-o PICTURE.png] [--size 1280x720]
            [--samples 64] [--up x|y|z] [--save SCENE.blend] [--radius R]

RUN is a run's folder. Shown is what it holds of the frame (the last one if none is named):

    fields_000012.vdb             a volume: smoke, ink, whatever is called `density` (formats: [vdb])
    mesh_000012.ply               a surface, coloured by its first attribute (formats: [ply])
    particles_000012_*.npy        balls, where there is no surface; with `orientation`, `radius` and `kind`, and an
    particles_SET_000012_*.npy    atlas in the scene: flakes (formats: [npy])

Material, light and camera suit the model, and are ordinary Blender objects: --save keeps the scene for going on by hand.
Lengths are metres, as everywhere. Velocities (`vel` in the volume) are m/s: for motion blur set the volume's velocity
grid to `vel`, which this does, and its unit to seconds.
"""
import argparse
import glob
import json
import math
import os
import re
import sys

import bpy
import numpy as np
from mathutils import Matrix, Vector

INK = (0.02, 0.05, 0.30)
COLD, WARM = (0.05, 0.22, 0.45, 1), (1.0, 0.72, 0.38, 1)


# --- the run -----------------------------------------------------------------------------------------------------


class Run:
    """What run.yaml and the names of the files say."""

    def __init__(self, folder, frame):
        self.folder = folder
        with open(os.path.join(folder, "run.yaml"), encoding="utf-8") as file:
            self.yaml = file.read()
        self.model = self.word("model", "tracer")
        self.size = self.numbers("size") or [1, 1, 1]
        self.origin = self.numbers("origin") or [0] * len(self.size)
        frames = {int(m.group(1)) for name in os.listdir(folder)
                  for m in [re.match(r"(?:fields|mesh|particles(?:_\w+?)?)_(\d{6,})[._]", name)]
                  if m and re.search(r"\.(vdb|ply|npy)$", name)}
        if not frames:
            sys.exit(f"{folder}: nothing to show: run the scene with output.formats: [vdb], [ply] or [npy]")
        self.frame = max(frames) if frame is None else frame
        if self.frame not in frames:
            sys.exit(f"{folder}: frame {self.frame} is not there; there are {min(frames)} to {max(frames)}")

    def word(self, key, default):
        found = re.search(rf"^ *{key}: *\"?([^\n\"]+)", self.yaml, re.M)
        return found.group(1).strip() if found else default

    def numbers(self, key):
        found = re.search(rf"^ *{key}: *\[([^\]]*)\]", self.yaml, re.M)
        return [float(n) for n in found.group(1).split(",")] if found and found.group(1).strip() else None

    def file(self, pattern):
        path = os.path.join(self.folder, pattern.format(self.frame))
        return path if os.path.exists(path) else None

    def largest(self):
        """The largest value of the first scalar, of which metrics.csv has a column."""
        try:
            table = np.genfromtxt(os.path.join(self.folder, "metrics.csv"), delimiter=",", names=True)
            column = next(name for name in table.dtype.names if name.startswith("max_"))
            return max(float(np.nanmax(table[column])), 1e-30)
        except (OSError, StopIteration, ValueError):
            return 1.0

    def up(self, wanted):
        """The axis that points up, and its sign: against gravity if the run has some."""
        if wanted:
            return "xyz".index(wanted), 1
        gravity = self.numbers("gravity")
        if gravity and any(gravity):
            axis = int(np.argmax(np.abs(gravity)))
            return axis, -1 if gravity[axis] > 0 else 1
        return (1 if self.model in ("tracer", "flow") else 2), 1


# --- things ------------------------------------------------------------------------------------------------------


def material(name, build):
    """A material whose nodes `build(nodes, links, output)` makes."""
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    m.node_tree.nodes.clear()
    output = m.node_tree.nodes.new("ShaderNodeOutputMaterial")
    build(m.node_tree.nodes, m.node_tree.links, output)
    return m


def attribute_colour(nodes, links, name, low, high):
    """A socket with a colour from cold to warm by the attribute, low to high."""
    value, ramp = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeValToRGB")
    scale = nodes.new("ShaderNodeMapRange")
    value.attribute_name = name
    scale.inputs["From Min"].default_value, scale.inputs["From Max"].default_value = low, max(high, low + 1e-30)
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = COLD, WARM
    links.new(value.outputs["Fac"], scale.inputs["Value"])
    links.new(scale.outputs["Result"], ramp.inputs["Fac"])
    return ramp.outputs["Color"]


def volume_material(run, length):
    """Ink absorbs before a white wall; smoke scatters before a dark one. Thick over a tenth of the box."""
    thick = 25 / (run.largest() * length)

    def build(nodes, links, output):
        shader = nodes.new("ShaderNodeVolumePrincipled")
        shader.inputs["Density"].default_value = thick
        shader.inputs["Anisotropy"].default_value = 0.3
        if is_ink(run):
            shader.inputs["Color"].default_value = (*INK, 1)
            shader.inputs["Absorption Color"].default_value = (*INK, 1)
        else:
            shader.inputs["Color"].default_value = (0.85, 0.88, 0.92, 1)
        links.new(shader.outputs["Volume"], output.inputs["Volume"])

    return material("volume", build)


def add_volume(run, path, length):
    data = bpy.data.volumes.new("fields")
    data.filepath = path
    data.velocity_grid, data.velocity_unit = "vel", "SECOND"
    data.materials.append(volume_material(run, length))
    data.grids.load()
    print("grids:", ", ".join(grid.name for grid in data.grids))
    return link(bpy.data.objects.new("fields", data))


def read_ply(path):
    """A PLY file as `cattaneo` writes it: places, attributes by name, triangles."""
    with open(path, "rb") as file:
        names, counts = [], {}
        for line in iter(lambda: file.readline().decode("ascii").split(), ["end_header"]):
            if line[0] == "element":
                counts[line[1]] = int(line[2])
            if line[:2] == ["property", "float"]:
                names.append(line[2])
        vertices = np.fromfile(file, [(name, "<f4") for name in names], counts["vertex"])
        faces = np.fromfile(file, [("n", "u1"), ("corner", "<i4", 3)], counts["face"])
    places = np.stack([vertices[a] for a in "xyz"], axis=1)
    extra = {name: vertices[name] for name in names if name not in ("x", "y", "z", "nx", "ny", "nz")}
    return places, extra, faces["corner"]


def make_mesh(name, places, extra, corners=()):
    """Vertices, triangles and numbers at the vertices, all at once."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(places))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(places, np.float32).ravel())
    if len(corners):
        mesh.loops.add(3 * len(corners))
        mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(corners, np.int32).ravel())
        mesh.polygons.add(len(corners))
        mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(corners), 3, dtype=np.int32))
        mesh.polygons.foreach_set("loop_total", np.full(len(corners), 3, np.int32))
        mesh.polygons.foreach_set("use_smooth", np.ones(len(corners), bool))
    for key, values in extra.items():
        kind, field = ("FLOAT", "value") if values.ndim == 1 else ("FLOAT_VECTOR", "vector")
        attribute = mesh.attributes.new(key, kind, "POINT")
        attribute.data.foreach_set(field, np.ascontiguousarray(values, np.float32).ravel())
    mesh.update()
    mesh.validate()
    return mesh


def add_surface(run, path):
    places, extra, corners = read_ply(path)
    if not len(corners):
        return None
    mesh = make_mesh("surface", places, extra, corners)
    key = next(iter(extra), None)

    def build(nodes, links, output):
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.inputs["Roughness"].default_value = 0.35
        shader.inputs["Clearcoat"].default_value = 0.3
        if key and run.model != "snowfall":
            colour = attribute_colour(nodes, links, key, float(extra[key].min()), float(extra[key].max()))
            links.new(colour, shader.inputs["Base Color"])
        else:
            shader.inputs["Base Color"].default_value = (0.85, 0.9, 0.95, 1)
        links.new(shader.outputs["BSDF"], output.inputs["Surface"])

    mesh.materials.append(material("surface", build))
    return link(bpy.data.objects.new("surface", mesh))


def modifier(thing, build):
    """Geometry nodes on an object: build(nodes, links, input socket, output socket)."""
    group = bpy.data.node_groups.new(thing.name, "GeometryNodeTree")
    group.inputs.new("NodeSocketGeometry", "Geometry")
    group.outputs.new("NodeSocketGeometry", "Geometry")
    into, out = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    build(group.nodes, group.links, into.outputs[0], out.inputs[0])
    thing.modifiers.new(thing.name, "NODES").node_group = group


def particle_files(run):
    """{set's word: {attribute: array}} of the frame."""
    sets = {}
    for path in sorted(glob.glob(os.path.join(run.folder, "particles*.npy"))):
        found = re.match(r"(particles(?:_\w+?)?)_(\d{6,})_(\w+)\.npy$", os.path.basename(path))
        if found and int(found.group(2)) == run.frame:
            sets.setdefault(found.group(1), {})[found.group(3)] = np.load(path)
    return {word: s for word, s in sets.items() if "position" in s and len(s["position"])}


def in_space(places):
    return places if places.shape[1] == 3 else np.pad(places, ((0, 0), (0, 1)))


def add_balls(run, word, s, radius):
    extra = {k: v.astype(np.float32) for k, v in s.items()
             if k not in ("position", "id") and v.ndim == 1 and np.isfinite(v).all()}
    key = next((k for k in ("saturation", "S", "age", "depth") if k in extra), next(iter(extra), None))
    mesh = make_mesh(word, in_space(s["position"]), extra)

    def shade(nodes, links, output):
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.inputs["Roughness"].default_value = 0.4
        if key:
            colour = attribute_colour(nodes, links, key, float(extra[key].min()), float(extra[key].max()))
            links.new(colour, shader.inputs["Base Color"])
        else:
            shader.inputs["Base Color"].default_value = (*INK, 1)
        links.new(shader.outputs["BSDF"], output.inputs["Surface"])

    skin = material(word, shade)
    thing = link(bpy.data.objects.new(word, mesh))

    def nodes_of(nodes, links, into, out):
        points, paint = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeSetMaterial")
        points.inputs["Radius"].default_value = radius
        paint.inputs["Material"].default_value = skin
        links.new(into, points.inputs["Mesh"])
        links.new(points.outputs["Points"], paint.inputs["Geometry"])
        links.new(paint.outputs["Geometry"], out)

    modifier(thing, nodes_of)
    return thing


# --- flakes ------------------------------------------------------------------------------------------------------


def card(folder, flake):
    """A flake of the atlas as a square of radius 1, transparent where there is no ice."""
    image = bpy.data.images.load(os.path.join(folder, flake["rgba"]), check_existing=True)
    width, height = flake["pixels"]
    half = flake["radius"] / flake["metres_per_pixel"]
    corner = [(x, y) for y in (-1, 1) for x in (-1, 1)]
    mesh = make_mesh(flake["name"], np.array([(x, y, 0) for x, y in corner]), {}, np.array([(0, 1, 3), (0, 3, 2)]))
    uv = mesh.uv_layers.new()
    for loop in mesh.loops:
        x, y = corner[loop.vertex_index]
        uv.data[loop.index].uv = ((flake["center"][0] + 0.5 + x * half) / width,
                                  1 - (flake["center"][1] + 0.5 - y * half) / height)

    def build(nodes, links, output):
        texture, shader = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeBsdfPrincipled")
        texture.image, texture.extension = image, "CLIP"
        shader.inputs["Roughness"].default_value = 0.15
        links.new(texture.outputs["Color"], shader.inputs["Base Color"])
        links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
        links.new(shader.outputs["BSDF"], output.inputs["Surface"])

    skin = material(flake["name"], build)
    skin.blend_method = "HASHED"
    mesh.materials.append(skin)
    return bpy.data.objects.new(flake["name"], mesh)


def euler_of(q):
    """XYZ angles of quaternions (w, x, y, z)."""
    w, x, y, z = q.T
    return np.stack([np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
                     np.arcsin(np.clip(2 * (w * y - z * x), -1, 1)),
                     np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))], axis=1)


def add_flakes(run, word, s, atlas):
    with open(atlas, encoding="utf-8") as file:
        flakes = json.load(file)["flakes"]
    kinds = bpy.data.collections.new(word + " kinds")  # not in the scene: only its instances show
    for number, flake in enumerate(flakes):
        thing = card(os.path.dirname(atlas), flake)
        thing.name = f"{number:04d} {flake['name']}"  # instances are picked by the order of names
        kinds.objects.link(thing)
    extra = {"turn": euler_of(s["orientation"]), "radius": s["radius"], "kind": s["kind"]}
    thing = link(bpy.data.objects.new(word, make_mesh(word, in_space(s["position"]), extra)))

    def named(nodes, name, kind):
        node = nodes.new("GeometryNodeInputNamedAttribute")
        node.data_type = kind
        node.inputs["Name"].default_value = name
        return next(o for o in node.outputs if o.enabled and o.name == "Attribute")

    def nodes_of(nodes, links, into, out):
        pick, place = nodes.new("GeometryNodeCollectionInfo"), nodes.new("GeometryNodeInstanceOnPoints")
        pick.inputs["Collection"].default_value = kinds
        pick.inputs["Separate Children"].default_value = True
        place.inputs["Pick Instance"].default_value = True
        links.new(into, place.inputs["Points"])
        links.new(next(iter(o for o in pick.outputs if o.enabled)), place.inputs["Instance"])
        links.new(named(nodes, "kind", "FLOAT"), place.inputs["Instance Index"])
        links.new(named(nodes, "turn", "FLOAT_VECTOR"), place.inputs["Rotation"])
        links.new(named(nodes, "radius", "FLOAT"), place.inputs["Scale"])
        links.new(place.outputs["Instances"], out)

    modifier(thing, nodes_of)
    return thing


# --- stage -------------------------------------------------------------------------------------------------------


def link(thing):
    bpy.context.scene.collection.objects.link(thing)
    return thing


def is_ink(run):
    return run.model == "tracer" or "ink" in run.yaml.lower()


def stand_up(things, run, wanted):
    """Blender's z is up: turn everything if the run's is not. Returns the middle and half size of what is there."""
    axis, sign = run.up(wanted)
    size, origin = run.size + [0.0] * (3 - len(run.size)), run.origin + [0.0] * (3 - len(run.origin))
    turn = {0: Matrix.Rotation(-math.pi / 2 * sign, 4, "Y"), 1: Matrix.Rotation(math.pi / 2 * sign, 4, "X"),
            2: Matrix.Identity(4) if sign > 0 else Matrix.Rotation(math.pi, 4, "X")}[axis]
    low, high = np.array(origin), np.array(origin) + np.array(size)
    for thing in things:
        thing.matrix_world = turn @ thing.matrix_world
    if all(thing.type == "MESH" for thing in things):  # closer, where it is known how far they reach
        corners = np.array([corner for thing in things for corner in thing.bound_box])
        low, high = np.maximum(low, corners.min(axis=0)), np.minimum(high, corners.max(axis=0))
    middle = turn @ Vector((low + high) / 2)
    half = turn.to_3x3() @ Vector((high - low) / 2)
    return middle, Vector([max(abs(h), 1e-9) for h in half])


def add_light(kind, name, place, target, energy, size):
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    if kind == "AREA":
        data.size = size
    thing = link(bpy.data.objects.new(name, data))
    thing.location = place
    thing.rotation_euler = (target - place).to_track_quat("-Z", "Y").to_euler()
    return thing


def add_camera(middle, half, flat, aspect):
    data = bpy.data.cameras.new("camera")
    data.lens = 50
    radius = half.length
    along = Vector((0, -1, 0)) if flat else Vector((0.55, -1, 0.35)).normalized()
    sight = 2 * math.atan(data.sensor_width / (2 * data.lens))
    narrow = sight if aspect < 1 else 2 * math.atan(math.tan(sight / 2) / aspect)
    reach = max(half.x / math.tan(sight / 2), half.z / math.tan(narrow / 2)) * 1.1 if flat else 0.8 * radius / math.sin(narrow / 2)
    thing = link(bpy.data.objects.new("camera", data))
    thing.location = middle + along * reach
    thing.rotation_euler = (-along).to_track_quat("-Z", "Y").to_euler()
    data.clip_start, data.clip_end = reach / 1000, reach * 100
    bpy.context.scene.camera = thing


def set_stage(run, middle, half, aspect):
    """Bright before ink, dark before all else; a large light above, a warm one behind."""
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    bright = is_ink(run)
    sky = world.node_tree.nodes["Background"]
    sky.inputs["Color"].default_value = (1, 1, 1, 1) if bright else (0.012, 0.018, 0.03, 1)
    sky.inputs["Strength"].default_value = 1.0
    r = half.length
    add_light("AREA", "key", middle + Vector((-1.2, -1.5, 2.2)) * r, middle, 30 * r * r, r)
    add_light("AREA", "back", middle + Vector((1.8, 1.6, 0.9)) * r, middle, 45 * r * r, r / 2)
    add_camera(middle, half, len(run.size) == 2, aspect)


def render(path, size, samples, white):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", samples
    scene.cycles.use_denoising = False  # Debian's build has no denoiser, and fails where one is asked for
    scene.cycles.volume_bounces = 2
    scene.view_settings.view_transform = "Standard" if white else "Filmic"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.filepath = os.path.abspath(path)
    scene.render.image_settings.file_format = "PNG"
    bpy.ops.render.render(write_still=True)


def build(run, o):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things, length = [], max(run.size)
    volume, surface = run.file("fields_{:06d}.vdb"), run.file("mesh_{:06d}.ply")
    if volume and not (surface and run.model in ("phase", "gel")):  # the surface is that of the volume
        things.append(add_volume(run, os.path.abspath(volume), length))
    if surface:
        things.append(add_surface(run, surface))
    atlas = run.word("atlas", "")
    for word, s in particle_files(run).items():
        if {"orientation", "radius", "kind"} <= set(s) and os.path.exists(atlas):
            things.append(add_flakes(run, word, s, atlas))
        elif not surface:  # of the particles, if there is one
            spacing = (math.prod(run.size) / len(s["position"])) ** (1 / len(run.size))
            things.append(add_balls(run, word, s, o.radius or min(0.25 * spacing, 0.004 * length)))
    things = [thing for thing in things if thing is not None]
    if not things:
        sys.exit(f"{run.folder}: frame {run.frame} has nothing to show")
    middle, half = stand_up(things, run, o.up)
    set_stage(run, middle, half, o.size[0] / o.size[1])
    return things


def main():
    parser = argparse.ArgumentParser(prog="blender -b -P recipes/blender.py --")
    parser.add_argument("run")
    parser.add_argument("--frame", type=int)
    parser.add_argument("-o", default="frame.png")
    parser.add_argument("--size", type=lambda t: tuple(int(n) for n in t.split("x")), default=(1280, 720))
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--up", choices=list("xyz"))
    parser.add_argument("--radius", type=float, help="of particles, m")
    parser.add_argument("--save")
    o = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    run = Run(o.run, o.frame)
    things = build(run, o)
    print("shown:", ", ".join(thing.name for thing in things))
    if o.save:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(o.save))
    render(o.o, o.size, o.samples, is_ink(run))
    print("picture:", o.o)


# Blender ends with 0 whatever its script does, unless told.
try:
    main()
except SystemExit as stop:
    if stop.code not in (None, 0):
        print(stop.code, file=sys.stderr)
        os._exit(1)
except Exception:
    import traceback
    traceback.print_exc()
    sys.stderr.flush()
    os._exit(1)
