"""Opens results in ParaView; run by tools/check-paraview, which explains."""
import pathlib
import sys

import h5py
import numpy as np
from paraview import simple
from paraview.servermanager import Fetch
from vtkmodules.util.numpy_support import vtk_to_numpy

PICTURE = (1200, 900)


class Differs(Exception):
    """ParaView shows something else than what the file holds."""


def require(same, what):
    if not same:
        raise Differs(what)


def arrays(data):
    """The point arrays of an image or of points, by name."""
    points = data.GetPointData()
    return {points.GetArrayName(k): vtk_to_numpy(points.GetArray(k)) for k in range(points.GetNumberOfArrays())}


def compare(shown, stored, what):
    """Same numbers, with undefined ones at the same places."""
    require(shown.size == stored.size, f"{what}: {shown.size} numbers in ParaView, {stored.size} in the file")
    require(np.array_equal(shown.reshape(-1).astype(float), stored.reshape(-1).astype(float), equal_nan=True),
            f"{what}: the numbers differ")


def view_of(source):
    """A view of everything that is visible, from the side and a little above."""
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewSize = PICTURE
    view.OrientationAxesVisibility = 1
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = (1, -2, 0.7), (0, 0, 0), (0, 0, 1)
    simple.ResetCamera(view)
    return view


def draw(source, field, picture):
    """Draws one source coloured by a field and hides it again."""
    view = view_of(source)
    display = simple.Show(source, view)
    if field:
        simple.ColorBy(display, ("POINTS", field))
        display.RescaleTransferFunctionToDataRange(True)
        display.SetScalarBarVisibility(view, True)
    simple.ResetCamera(view)
    simple.SaveScreenshot(str(picture), view, ImageResolution=PICTURE)
    simple.Hide(source, view)
    if field:
        simple.HideUnusedScalarBars(view)
    print(f"  drew {picture}")


def outline(source):
    view = view_of(source)
    display = simple.Show(simple.Outline(Input=source), view)
    display.AmbientColor = display.DiffuseColor = (0, 0, 0)


def draw_image(source, field, values, folder, stem):
    """A slice through the middle and a contour halfway between the extremes of a field."""
    outline(source)
    box = source.GetDataInformation().GetBounds()
    middle = [(box[2 * k] + box[2 * k + 1]) / 2 for k in range(3)]
    cut = simple.Slice(Input=source)
    cut.SliceType.Origin = middle
    cut.SliceType.Normal = (0, 1, 0)
    draw(cut, field, folder / f"{stem}_slice.png")
    finite = values[np.isfinite(values)]
    if finite.size and finite.min() < finite.max():
        contour = simple.Contour(Input=source, ContourBy=("POINTS", field), Isosurfaces=[(finite.min() + finite.max()) / 2])
        contour.UpdatePipeline()
        require(contour.GetDataInformation().GetNumberOfPoints() > 0, f"{stem}: the contour of {field} is empty")
        draw(contour, None, folder / f"{stem}_contour.png")


def check_image(data, file, time):
    """All fields of an image at one output time; returns the name and the numbers of the first."""
    shown = arrays(data)
    stored = file["VTKHDF/PointData"]
    require(set(shown) == set(stored), f"fields {sorted(shown)} in ParaView, {sorted(stored)} in the file")
    for name, dataset in stored.items():
        compare(shown[name], dataset[time] if "time" in dataset.dims[0].keys() else dataset[()], name)
    spacing = file["VTKHDF"].attrs["Spacing"]
    require(np.allclose(data.GetSpacing(), spacing), f"voxels of {data.GetSpacing()} in ParaView, {spacing} in the file")
    first = "phi" if "phi" in shown else next(name for name in shown if name != "mask")
    return first, shown[first]


def check_fields(folder, pictures):
    path = folder / "fields.hdf"
    with h5py.File(path) as file:
        series = folder / "fields.xmf2"
        source = simple.OpenDataFile(str(series if series.exists() else path))
        require(source is not None, f"{path}: ParaView has no reader for it")
        source.UpdatePipeline()
        times = list(source.TimestepValues) if series.exists() else [None]
        if series.exists():
            require(np.allclose(times, file["time"]), f"times {times} in ParaView, {list(file['time'])} in the file")
        for k, time in enumerate(times):
            if time is not None:
                simple.GetAnimationScene().AnimationTime = time
                source.UpdatePipeline(time)
            field, values = check_image(Fetch(source), file, k)
        print(f"{source.GetXMLName()} opens {(series if series.exists() else path).name}: {len(times)} output time(s), "
              f"{len(file['VTKHDF/PointData'])} fields, equal to the file")
        draw_image(source, field, values, pictures, "fields")


def check_volumes(folder, pictures):
    volumes = sorted(folder.glob("fields*.vdb"))
    if not volumes:
        return
    if not hasattr(simple, "OpenVDBReader"):
        print(f"this ParaView reads no OpenVDB: {volumes[0].name} is not checked")
        return
    source = simple.OpenVDBReader(FileName=str(volumes[0]))
    source.UpdatePipeline()
    print(f"{source.GetXMLName()} opens {volumes[0].name}")


def check_tracers(folder, pictures):
    path = folder / "tracers.xmf2"
    if not path.exists():
        return
    with h5py.File(folder / "tracers.h5") as file:
        source = simple.OpenDataFile(str(path))
        source.UpdatePipeline()
        stored = file["particles/tracers/position/value"]
        times = list(source.TimestepValues)
        require(len(times) == stored.shape[0], f"{len(times)} times in ParaView, {stored.shape[0]} in {path.name}")
        for k in (0, len(times) - 1):
            source.UpdatePipeline(times[k])
            compare(vtk_to_numpy(Fetch(source).GetPoints().GetData()), stored[k], f"positions at time {times[k]:g}")
        print(f"{source.GetXMLName()} opens {path.name}: {stored.shape[1]} tracers at {len(times)} times, equal to the file")
        outline(source)
        names = sorted(arrays(Fetch(source)))
        glyphs = simple.Glyph(Input=source, GlyphType="Sphere", GlyphMode="All Points")
        box = source.GetDataInformation().GetBounds()
        glyphs.ScaleFactor = max(box[2 * k + 1] - box[2 * k] for k in range(3)) / 60 or 1
        draw(glyphs, names[0] if names else None, pictures / "tracers.png")


def main():
    folder = pathlib.Path(sys.argv[1])
    pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else folder / "paraview"
    pictures.mkdir(parents=True, exist_ok=True)
    if not any((folder / name).exists() for name in ("fields.hdf", "tracers.xmf2")):
        sys.exit(f"check-paraview: {folder} holds no fields.hdf and no tracers.xmf2")
    if (folder / "fields.hdf").exists():
        check_fields(folder, pictures)
        check_volumes(folder, pictures)
    check_tracers(folder, pictures)


if __name__ == "__main__":
    try:
        main()
    except Differs as error:
        sys.exit(f"check-paraview: {error}")
