#!/usr/bin/python3
"""A close look at edges: surfaces side by side, every face in the light of its own normal.

    sharp.py OUT.png SURFACE.ply ... [--centre X Y Z] [--radius R] [--azimuth 30] [--elevation 30] [--size 560]

Without --centre the whole of the first surface is seen. Reads what render.py reads; needs numpy and nothing else.
"""
import argparse

import numpy as np

from render import BACKGROUND, CLAY, SUPERSAMPLING, Camera, Frame, raster_triangles, read_ply, unit, write_png

GAP = 8  # pixels between two pictures


def picture(path, centre, radius, azimuth, elevation, size):
    vertices, _, triangles = read_ply(path)
    if centre is None:
        centre = 0.5 * (vertices.min(0) + vertices.max(0))
        radius = 0.5 * np.linalg.norm(vertices.max(0) - vertices.min(0))
    big = size * SUPERSAMPLING
    camera = Camera(np.asarray(centre), radius, azimuth, elevation, big, big)
    frame = Frame(big, big)
    raster_triangles(frame, *camera.project(vertices), triangles)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normal = unit(np.cross(b - a, c - a))
    light = 0.35 + 0.65 * np.abs(normal @ unit(camera.back + 0.7 * camera.up - 0.5 * camera.right))
    seen = frame.what >= 0
    image = np.where(seen[:, None], CLAY * light[frame.what][:, None], BACKGROUND)
    return image.reshape(size, SUPERSAMPLING, size, SUPERSAMPLING, 3).mean(axis=(1, 3))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("surfaces", nargs="+")
    parser.add_argument("--centre", type=float, nargs=3)
    parser.add_argument("--radius", type=float, default=1)
    parser.add_argument("--azimuth", type=float, default=30)
    parser.add_argument("--elevation", type=float, default=30)
    parser.add_argument("--size", type=int, default=560)
    o = parser.parse_args()
    rows = []
    for path in o.surfaces:
        rows += [np.ones((o.size, GAP, 3))] if rows else []
        rows.append(picture(path, o.centre, o.radius, o.azimuth, o.elevation, o.size))
    write_png(o.out, (255 * np.concatenate(rows, axis=1)).clip(0, 255).astype(np.uint8))


if __name__ == "__main__":
    main()
