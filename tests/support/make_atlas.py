# SPDX-License-Identifier: MIT
"""A small atlas of flakes for tests: make_atlas(FOLDER) writes atlas.json and its pictures, and returns its path."""
import json
import math
import os
import struct
import zlib

PIXELS = 32


def write_png(path, channels, pixel):
    """A picture of 16 bits a channel; pixel(x, y) gives its values in 0..1."""
    rows = b"".join(b"\0" + b"".join(struct.pack(f">{channels}H", *(round(65535 * v) for v in pixel(x, y)))
                                     for x in range(PIXELS)) for y in range(PIXELS))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", PIXELS, PIXELS, 16, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def make_atlas(folder):
    os.makedirs(folder, exist_ok=True)
    flakes, middle = [], (PIXELS - 1) / 2
    for name, arms in (("disc", 0), ("star", 6)):
        def inside(x, y):
            r, a = math.hypot(x - middle, y - middle), math.atan2(y - middle, x - middle)
            return r < (14 if arms == 0 else 8 + 6 * math.cos(arms * a))

        area = sum(inside(x, y) for x in range(PIXELS) for y in range(PIXELS)) * 1e-8
        write_png(os.path.join(folder, name + ".rgba.png"), 4, lambda x, y: (0.9, 0.95, 1, float(inside(x, y))))
        write_png(os.path.join(folder, name + ".height.png"), 1, lambda x, y: (float(inside(x, y)),))
        write_png(os.path.join(folder, name + ".normal.png"), 3, lambda x, y: (0.5, 0.5, 1))
        flakes.append({"name": name, "rgba": name + ".rgba.png", "height": name + ".height.png",
                       "normal": name + ".normal.png", "pixels": [PIXELS, PIXELS], "metres_per_pixel": 1e-4,
                       "center": [middle, middle], "radius": 1.4e-3, "area": area, "mean_thickness": 4e-5,
                       "height_scale": 2e-5, "mass": 917 * area * 4e-5, "symmetry": arms})
    path = os.path.join(folder, "atlas.json")
    with open(path, "w") as file:
        json.dump({"cattaneo_atlas": 1, "flakes": flakes}, file)
    return path
