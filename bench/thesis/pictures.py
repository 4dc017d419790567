"""The pictures of chapter 3: samples and surfaces side by side, each face in the light of its own normal, by the renderer of
the documentation."""
import os
import sys

import numpy as np
import planar

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(1, os.path.join(HERE, '..', '..', 'docs', 'render'))
import render

SIZE, GAP, TONES = 300, 6, 12  # pixels of a panel, between two; steps of grey
INK = np.array([0.25, 0.35, 0.55])
# figure: (set, azimuth, elevation, panels). A panel is 'samples', or the label of a run
PICTURES = {
    '3.3': ('shared-hand', 60, 10, ('samples', 'shared-hand, candidates')),
    '3.5': ('scan', 78, 16, ('samples', 'scan, crust', 'scan, shape')),
    '3.6': ('foot', 30, 40, ('samples', 'closed', 'open')),
    '3.3.3': ('part', 30, 35, ('part, greedy', 'part, naive', 'part, theoretical')),
    '3.9': ('shell', 20, 40, ('samples', 'closed', 'open')),
    '3.10': ('cube', 30, 30, ('samples', 'cocone', 'sharp')),
    '3.11': ('part', 30, 35, ('samples', 'part, crust')),
    '3.12': ('stamp', 30, 40, ('samples', 'greedy')),
    '3.13': ('torus', 30, 35, ('samples', 'torus')),
}
INSTEAD = {'shared-hand': 'hand'}  # where the data are not there


def shaded(camera, vertices, triangles):
    frame = render.Frame(camera.width, camera.height)
    render.raster_triangles(frame, *camera.project(vertices), triangles)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normal = render.unit(np.cross(b - a, c - a))
    light = 0.35 + 0.65 * np.abs(normal @ render.unit(camera.back + 0.7 * camera.up - 0.5 * camera.right))
    seen = frame.what >= 0
    return np.where(seen[:, None], render.CLAY * light[frame.what][:, None], render.BACKGROUND)


def dotted(camera, points):
    image = np.tile(render.BACKGROUND, (camera.width * camera.height, 1))
    render.points_image(image, camera, points, np.tile(INK, (len(points), 1)), 1.8)
    return image


def panel(camera, path):
    vertices, _, triangles = render.read_ply(path)
    image = shaded(camera, vertices, triangles) if len(triangles) else dotted(camera, vertices)
    k = render.SUPERSAMPLING
    small = image.reshape(SIZE, k, SIZE, k, 3).mean(axis=(1, 3))
    return np.round(small.clip(0, 1) * 255 / TONES) * TONES


def draw(name, surfaces, out):
    """Draws the picture of a figure to the file `out`, if it has one and its surfaces are there."""
    if name == '3.4': planar.draw(surfaces.folder, out)
    if name not in PICTURES: return
    which, azimuth, elevation, panels = PICTURES[name]
    if not surfaces.scenes.scene(which):
        panels = [p.replace(which, INSTEAD[which]) for p in panels]
        which = INSTEAD[which]
    samples = surfaces.scenes.scene(which).samples
    paths = [samples if p == 'samples' else surfaces.path_of(p, which) for p in panels]
    if not all(os.path.exists(p) for p in paths): return
    points = render.read_ply(samples)[0]
    centre = 0.5 * (points.min(0) + points.max(0))
    big = SIZE * render.SUPERSAMPLING
    camera = render.Camera(centre, np.linalg.norm(points - centre, axis=1).max(), azimuth, elevation, big, big)
    rows = []
    for p in paths: rows += [np.full((SIZE, GAP, 3), 255.0)] * bool(rows) + [panel(camera, p)]
    render.write_png(out, np.concatenate(rows, axis=1).clip(0, 255).astype(np.uint8))
