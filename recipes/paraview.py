# SPDX-License-Identifier: MIT
"""A frame of a run in ParaView, without a display.

    pvpython recipes/paraview.py RUN [--frame N] [-o PICTURE.png] [--size 1280x720] [--field NAME] [--state FILE.pvsm]

RUN is a run's folder written with output.formats: [vtkhdf]. Shown is what it holds of the frame (the last one if none is
named): fields_000012.vtkhdf as a coloured plane (2D) or a volume (3D), mesh_000012.vtkhdf as a surface,
particles_000012.vtkhdf (and particles_SET_...) as points. --state keeps the scene for going on in the window.

Where ParaView was built to draw on a display only, as Debian's is, one is lent by: xvfb-run -a -s -noreset pvpython ...

ParaView opens these files itself from 5.12 on, also in its window. Versions before that (Debian 12 has 5.11) know
neither values of cells nor points and surfaces in them: here they are read with h5py, and --state is refused.
"""
import argparse
import os
import re
import sys

sys.path[:] = [p for p in sys.path if os.path.realpath(p or ".") != os.path.dirname(os.path.realpath(__file__))]
from paraview import simple as pv  # noqa: E402, and not this file, which has its name
from vtkmodules.util import numpy_support  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData  # noqa: E402

VERSION = pv.GetParaViewVersion()
READS_ALL = (int(VERSION.major), int(VERSION.minor)) >= (5, 12)
if not READS_ALL:
    import h5py


def find_frame(folder, frame):
    """{word: path} of the files of the frame, and the frame."""
    files = {}
    for name in os.listdir(folder):
        found = re.match(r"(fields|mesh|particles(?:_\w+?)?)_(\d{6,})\.vtkhdf$", name)
        if found:
            files.setdefault(int(found.group(2)), {})[found.group(1)] = os.path.join(folder, name)
    if not files:
        sys.exit(f"{folder}: nothing to show: run the scene with output.formats: [vtkhdf]")
    frame = max(files) if frame is None else frame
    if frame not in files:
        sys.exit(f"{folder}: frame {frame} is not there; there are {min(files)} to {max(files)}")
    return files[frame], frame


def colour(display, view, where, name):
    """By a field, over all its values, with a bar."""
    pv.ColorBy(display, (where, name))
    display.RescaleTransferFunctionToDataRange(True, False)
    display.SetScalarBarVisibility(view, True)


def add_arrays(data, group):
    for name, values in group.items():
        values = values[()]
        flat = values.reshape(-1, values.shape[-1]) if values.ndim in (2, 4) else values.ravel()
        array = numpy_support.numpy_to_vtk(flat, deep=True)
        array.SetName(name)
        data.AddArray(array)


def read_image(root):
    image = vtkImageData()
    image.SetExtent([int(n) for n in root.attrs["WholeExtent"]])
    image.SetOrigin(root.attrs["Origin"])
    image.SetSpacing(root.attrs["Spacing"])
    add_arrays(image.GetCellData(), root["CellData"])
    return image


def read_polygons(root):
    data = vtkPolyData()
    points = vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(root["Points"][()], deep=True))
    data.SetPoints(points)
    for word, put in (("Vertices", data.SetVerts), ("Polygons", data.SetPolys)):
        cells = vtkCellArray()
        parts = [root[word][name][()].astype("i8") for name in ("Offsets", "Connectivity")]
        cells.SetData(*(numpy_support.numpy_to_vtkIdTypeArray(p, deep=True) for p in parts))
        put(cells)
    add_arrays(data.GetPointData(), root["PointData"])
    return data


def open_frame(path):
    if READS_ALL:
        return pv.OpenDataFile(path)
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        data = read_image(root) if root.attrs["Type"] == b"ImageData" else read_polygons(root)
    source = pv.TrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    return source


def show_fields(path, view, wanted):
    source = open_frame(path)
    source.UpdatePipeline()
    names = [source.CellData.GetArray(i).GetName() for i in range(len(source.CellData))]
    name = wanted or names[0]
    if name not in names:
        sys.exit(f"{path}: has no field {name}; there are {', '.join(names)}")
    extent = source.GetDataInformation().GetExtent()
    flat = extent[5] - extent[4] <= 1
    if not flat:  # volumes are drawn from values at points
        source = pv.CellDatatoPointData(Input=source)
    display = pv.Show(source, view)
    display.SetRepresentationType("Surface" if flat else "Volume")
    colour(display, view, "CELLS" if flat else "POINTS", name)
    return flat


def show_points(path, view, points):
    source = open_frame(path)
    source.UpdatePipeline()
    display = pv.Show(source, view)
    if points:
        display.SetRepresentationType("Points")
        display.PointSize = 3
    names = [source.PointData.GetArray(i).GetName() for i in range(len(source.PointData))]
    names = [n for n in names if n not in ("id", "Normals") and source.PointData[n].GetNumberOfComponents() == 1]
    if names:
        colour(display, view, "POINTS", names[0])


def main():
    parser = argparse.ArgumentParser(prog="pvpython recipes/paraview.py")
    parser.add_argument("run")
    parser.add_argument("--frame", type=int)
    parser.add_argument("-o", default="frame.png")
    parser.add_argument("--size", type=lambda t: [int(n) for n in t.split("x")], default=[1280, 720])
    parser.add_argument("--field")
    parser.add_argument("--state")
    o = parser.parse_args()
    if o.state and not READS_ALL:
        sys.exit(f"--state: ParaView {VERSION.major}.{VERSION.minor} cannot open these files again; 5.12 can")
    files, frame = find_frame(o.run, o.frame)
    view = pv.CreateView("RenderView")
    view.ViewSize = o.size
    view.Background = [0.07, 0.09, 0.12]
    view.UseColorPaletteForBackground = 0
    flat = True
    for word, path in sorted(files.items()):
        if word == "fields":
            flat = show_fields(path, view, o.field)
        else:
            flat = flat and word != "mesh"
            show_points(path, view, word != "mesh")
    pv.ResetCamera(view)
    if not flat:
        camera = view.GetActiveCamera()
        camera.Azimuth(25)
        camera.Elevation(20)
        pv.ResetCamera(view)
    print("shown:", ", ".join(sorted(files)), "of frame", frame)
    if o.state:
        pv.SaveState(o.state)
    pv.SaveScreenshot(o.o, view, ImageResolution=o.size)
    print("picture:", o.o)


main()
