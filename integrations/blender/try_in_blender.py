"""try_in_blender.py [PICTURE.png]: the add-on in Blender without a window (the package bpy, or blender -b -P): points become a surface and a
hull, which the picture shows beside the points."""
import importlib.util
import pathlib
import sys

import bpy
import numpy as np


def draw(path, scan):
    """Renders the points as small balls, the surface and the hull side by side, by the processor."""
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=1, radius=0.014)
    ball = bpy.context.object
    ball.parent, scan.instance_type = scan, "VERTS"
    for place, thing in zip((-3.1, 0, 3.1), (scan, bpy.data.objects["scan.surface"], bpy.data.objects["scan.hull"])):
        thing.location = (place, 0, 0)
        thing.hide_render = False
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 9.4
    camera.location, camera.rotation_euler = (0, -7, 7), (0.785, 0, 0)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3, (0.7, 0.3, 0.4)
    scene.world = bpy.data.worlds.new("world")
    scene.world.color, scene.render.film_transparent = (0.05, 0.05, 0.05), True
    for thing in (camera, sun):
        scene.collection.objects.link(thing)
    scene.camera, scene.render.engine, scene.cycles.samples, scene.cycles.device = camera, "CYCLES", 24, "CPU"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.filepath = 1000, 260, str(path)
    bpy.ops.render.render(write_still=True)


def main():
    path = pathlib.Path(__file__).resolve().parent / "__init__.py"
    spec = importlib.util.spec_from_file_location("brio_addon", path)
    addon = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(addon)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    u, v = 2 * np.pi * np.random.default_rng(1).random((2, 4000))
    rows = np.column_stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)])  # a torus
    mesh = bpy.data.meshes.new("scan")
    mesh.from_pydata(rows.tolist(), [], [])
    scan = bpy.data.objects.new("scan", mesh)
    bpy.context.scene.collection.objects.link(scan)
    bpy.context.view_layer.objects.active = scan
    assert bpy.ops.object.brio_surface() == {"FINISHED"}
    surface = bpy.data.objects["scan.surface"].data
    assert len(surface.vertices) - len(surface.edges) + len(surface.polygons) == 0
    print("surface closed:", len(surface.polygons), "faces")
    assert bpy.ops.object.brio_hull() == {"FINISHED"}
    print("hull:", len(bpy.data.objects["scan.hull"].data.polygons), "faces")
    if len(sys.argv) > 1 and sys.argv[-1].endswith(".png"):
        draw(pathlib.Path(sys.argv[-1]).resolve(), scan)
    addon.unregister()


if __name__ == "__main__":
    main()
