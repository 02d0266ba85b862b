#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks frames as other programs see them: check_vtkhdf.py FILE.vtkhdf ...

With h5py: the layout that the contract promises, and that nothing in the files carries a time stamp. With vtk, if it is
installed: that its reader gives the same arrays, bounds and time. Exit code 0: all good; 1: the first thing wrong.
"""
import json
import os
import re
import sys

import h5py
import numpy as np


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def check_image(file):
    """The layout of fields_*.vtkhdf; returns what VTK must show: name -> array."""
    root = file["VTKHDF"]
    extent = root.attrs["WholeExtent"]
    nx, ny, nz = (int(n) for n in extent[1::2])
    check(list(extent[::2]) == [0, 0, 0], f"WholeExtent {extent}: must start at 0")
    check(file.attrs["dim"] == 3 or nz == 1, "2D: one cell thick")
    check(root.attrs["Direction"].shape == (9,), "Direction is missing")
    check(len(root["CellData"]) > 0 or len(root["FieldData"]) > 1, "no fields")
    shown = {}
    for name, array in root["CellData"].items():
        check(array.shape in ((nz, ny, nx), (nz, ny, nx, 3)), f"{name}: shape {array.shape}, cells {(nz, ny, nx)}")
        check("unit" in array.attrs, f"{name}: no unit")
        shown[name] = array[...]
    for name, faces in file.get("faces", {}).items():
        check(name in root["CellData"], f"faces of {name} without its vectors")
        for axis, letter in enumerate("xyz"[: file.attrs["dim"]]):
            shape = [nz, ny, nx]
            shape[2 - axis] += 1
            values = faces[letter][...]
            check(values.shape == tuple(shape), f"faces {name}/{letter}: shape {values.shape}, expected {shape}")
            low, high = (np.take(values, range(s, s + shape[2 - axis] - 1), axis=2 - axis) for s in (0, 1))
            check(np.array_equal((low + high) / 2, shown[name][..., axis]), f"{name}/{letter}: vectors are not the means")
    return shown


def check_points(file):
    root = file["VTKHDF"]
    n = int(root["NumberOfPoints"][0])
    check(root["Points"].shape == (n, 3), f"Points {root['Points'].shape}, expected {(n, 3)}")
    for group in ("Vertices", "Lines", "Polygons", "Strips"):
        cells, ids = int(root[group]["NumberOfCells"][0]), int(root[group]["NumberOfConnectivityIds"][0])
        check(root[group]["Offsets"].shape == (cells + 1,), f"{group}: Offsets")
        check(root[group]["Connectivity"].shape == (ids,), f"{group}: Connectivity")
        if group == "Polygons" and cells > 0:
            corner = root[group]["Connectivity"][...]
            check(np.array_equal(root[group]["Offsets"][...], 3 * np.arange(cells + 1)), "not all polygons are triangles")
            check(corner.min() >= 0 and corner.max() < n, "a triangle has a corner that is not there")
        else:
            surface = int(root["Polygons"]["NumberOfCells"][0]) > 0
            check(ids == (n if group == "Vertices" and not surface else 0), f"{group}: {ids} ids for {n} points")
    shown = {name: array[...] for name, array in root["PointData"].items()}
    check(all(len(values) == n for values in shown.values()), "an attribute has another count than the points")
    return shown


def check_no_stamps(file):
    def visit(name, item):
        info = h5py.h5g.get_objinfo(item.id)
        check(info.mtime == 0, f"{name} carries a time stamp")

    file.visititems(visit)


def check_with_vtk(path, file, shown):
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkVersion
        from vtkmodules.vtkIOHDF import vtkHDFReader
    except ImportError:
        return False
    if (vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) < (9, 3):
        return False  # knows values at points alone
    reader = vtkHDFReader()
    check(reader.CanReadFile(path), "vtkHDFReader refuses the file")
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    check(data is not None and data.GetNumberOfPoints() >= 0, "vtkHDFReader gives nothing")
    root = file["VTKHDF"]
    if text(root.attrs["Type"]) == "ImageData":
        origin, spacing, extent = root.attrs["Origin"], root.attrs["Spacing"], root.attrs["WholeExtent"]
        bounds = [origin[a] + spacing[a] * extent[2 * a + end] for a in range(3) for end in (0, 1)]
        check(np.allclose(data.GetBounds(), bounds, rtol=1e-12), f"bounds {data.GetBounds()}, expected {bounds}")
        arrays = data.GetCellData()
    else:
        points = vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() > 0 else np.zeros((0, 3))
        check(np.array_equal(points, root["Points"][...]), "points differ")
        triangles = int(root["Polygons/NumberOfCells"][0])
        check(data.GetNumberOfVerts() == (1 if len(points) and not triangles else 0), "vertices differ")
        check(data.GetNumberOfPolys() == triangles, "triangles differ")
        arrays = data.GetPointData()
    for name, values in shown.items():
        array = arrays.GetArray(name)
        check(array is not None, f"vtk does not show {name}")
        seen = vtk_to_numpy(array)
        check(seen.dtype == values.dtype, f"{name}: vtk shows {seen.dtype}, the file has {values.dtype}")
        check(np.array_equal(seen.reshape(values.shape), values), f"{name}: vtk shows other values")
    time = data.GetFieldData().GetArray("Time")
    check(time is not None and time.GetValue(0) == file.attrs["time"], "vtk does not show the time")
    return True


def check_series(path, file):
    folder, name = os.path.split(os.path.abspath(path))
    word = re.match(r"(.+)_\d{6,}\.vtkhdf$", name)
    check(word, "the name is not WORD_000012.vtkhdf")
    series = os.path.join(folder, word.group(1) + ".vtkhdf.series")
    with open(series, encoding="ascii") as text_file:
        listed = json.load(text_file)
    check(listed["file-series-version"] == "1.0", "version of the series")
    times = {entry["name"]: entry["time"] for entry in listed["files"]}
    check(times.get(name) == file.attrs["time"], f"{series} has time {times.get(name)}")


def check_file(path):
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        check(list(root.attrs["Version"]) == [1, 0], "Version is not 1.0")
        for name in ("title", "version", "git", "precision"):
            check(name in file.attrs, f"no attribute {name}")
        check(root["FieldData/Time"][0] == file.attrs["time"], "FieldData/Time is not the time")
        kind = text(root.attrs["Type"])
        check(kind in ("ImageData", "PolyData"), f"Type {kind}")
        shown = check_image(file) if kind == "ImageData" else check_points(file)
        wanted = np.float64 if text(file.attrs["precision"]) == "double" else np.float32
        check(all(values.dtype == (np.int64 if name == "id" else wanted) for name, values in shown.items()),
              "arrays are not in the precision of the state")
        check_no_stamps(file)
        check_series(path, file)
        return check_with_vtk(path, file, shown)


def main():
    if len(sys.argv) < 2:
        print(__doc__)
        return 1
    for path in sys.argv[1:]:
        try:
            with_vtk = check_file(path)
        except Exception as error:  # whatever is wrong with a file: one line that names it
            print(f"{path}: {type(error).__name__}: {error}")
            return 1
        print(f"{path}: good" + ("" if with_vtk else " (no vtk 9.3 or later: not asked)"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
