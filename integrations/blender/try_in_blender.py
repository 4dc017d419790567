"""try_in_blender.py: the add-on in Blender without a window (the package bpy, or blender -b -P): points become a surface and a hull."""
import importlib.util
import pathlib

import bpy
import numpy as np


def main():
    path = pathlib.Path(__file__).resolve().parent / "__init__.py"
    spec = importlib.util.spec_from_file_location("brio_addon", path)
    addon = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(addon)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    rows = np.random.default_rng(1).normal(size=(2000, 3))
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    mesh = bpy.data.meshes.new("scan")
    mesh.from_pydata(rows.tolist(), [], [])
    scan = bpy.data.objects.new("scan", mesh)
    bpy.context.scene.collection.objects.link(scan)
    bpy.context.view_layer.objects.active = scan
    assert bpy.ops.object.brio_surface() == {"FINISHED"}
    surface = bpy.data.objects["scan.surface"].data
    assert len(surface.vertices) - len(surface.edges) + len(surface.polygons) == 2
    print("surface closed:", len(surface.polygons), "faces")
    assert bpy.ops.object.brio_hull() == {"FINISHED"}
    print("hull:", len(bpy.data.objects["scan.hull"].data.polygons), "faces")
    addon.unregister()


if __name__ == "__main__":
    main()
