"""Imports results into Blender; run by tools/check-blender, which explains."""
import pathlib
import sys

import bpy
import h5py
import numpy as np
from mathutils import Vector

AXES = "xyz"


def expected_grids(fields):
    """The grids that the fields of an HDF5 file become, with their types."""
    grids = {}
    for name, field in fields["VTKHDF/PointData"].items():
        components = field.shape[-1] if field.ndim > fields["VTKHDF/PointData/mask"].ndim else 1
        if name == "mask":
            grids[name] = "INT"
        elif components == 1:
            grids[name] = "FLOAT"
        elif components == 3:
            grids[name] = "VECTOR_FLOAT"
        elif components == 9:
            grids.update({f"{name}_{a}{b}": "FLOAT" for a in AXES for b in AXES})
        else:
            raise SystemExit(f"check-blender: {name} has {components} components: this check does not know its grids")
    return grids


def imported(file):
    """The volume that Blender makes of a file, its grids loaded."""
    bpy.ops.object.volume_import(filepath=str(file))
    volume = bpy.context.object
    volume.data.grids.load()
    if volume.data.grids.error_message:
        raise SystemExit(f"check-blender: {file}: {volume.data.grids.error_message}")
    return volume


def check(volume, fields, file):
    grids = {grid.name: grid for grid in volume.data.grids}
    wanted = expected_grids(fields)
    if {name: grid.data_type for name, grid in grids.items()} != wanted:
        raise SystemExit(f"check-blender: {file}: Blender has {[(n, g.data_type) for n, g in grids.items()]}, the fields are {wanted}")
    # A grid's matrix takes voxel (i, j, k) to its centre.
    axes = [fields[axis][:] for axis in AXES]
    voxel = axes[0][1] - axes[0][0]
    for name, grid in grids.items():
        for k, axis in enumerate(axes):
            unit = Vector([float(k == j) for j in range(3)])
            step = (grid.matrix_object @ unit - grid.matrix_object @ Vector((0, 0, 0)))[k]
            rest = (axis[0] - grid.matrix_object.translation[k]) / voxel
            if not np.isclose(step, voxel, rtol=1e-6) or abs(rest - round(rest)) > 1e-3:
                raise SystemExit(f"check-blender: {file}: {name} has its voxels elsewhere along {AXES[k]}")
    print(f"{file}: {len(grids)} grids are as they should be in Blender")


def draw(volume, picture):
    """phi as a cloud, enlarged so that the longest side is 2."""
    corners = np.array([list(corner) for corner in volume.bound_box])
    size = corners.max(0) - corners.min(0)
    scale = 2 / size.max()
    volume.scale = (scale,) * 3
    volume.location = Vector(-scale * (corners.max(0) + corners.min(0)) / 2)
    material = bpy.data.materials.new("grains")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    cloud, out = nodes.new("ShaderNodeVolumePrincipled"), nodes.new("ShaderNodeOutputMaterial")
    cloud.inputs["Density Attribute"].default_value = "phi"
    cloud.inputs["Density"].default_value = 30
    cloud.inputs["Color"].default_value = (0.9, 0.9, 0.9, 1)
    material.node_tree.links.new(cloud.outputs["Volume"], out.inputs["Volume"])
    volume.data.materials.append(material)
    scene = bpy.context.scene
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 0, 0, 1)
    camera = bpy.data.objects["Camera"]
    camera.location = (4, -4, 2.5)
    camera.rotation_euler = (Vector((0, 0, 0)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    bpy.data.objects["Light"].data.energy = 15000
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 480, 360
    scene.render.filepath = str(picture.resolve())
    bpy.ops.render.render(write_still=True)
    pixels = np.array(bpy.data.images.load(str(picture.resolve())).pixels).reshape(-1, 4)[:, :3]
    if pixels.std() < 0.01:
        raise SystemExit(f"check-blender: {picture} shows nothing")
    print(f"drew {picture}")


def main():
    words = sys.argv[sys.argv.index("--") + 1:]
    result = pathlib.Path(words[0])
    files = sorted(result.glob("fields*.vdb"))
    if not files:
        raise SystemExit(f"check-blender: {result}: there is no fields*.vdb: ask for output.formats: [hdf5, vdb]")
    with h5py.File(result / "fields.hdf") as fields:
        for file in files:
            volume = imported(file)
            check(volume, fields, file)
            if file is not files[-1]:
                bpy.data.objects.remove(volume)
    draw(volume, pathlib.Path(words[1]) if len(words) > 1 else result / "blender.png")


main()
