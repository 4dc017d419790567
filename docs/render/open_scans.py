#!/usr/bin/python3
"""The pictures of docs/open-scans.md: generated scans and the surfaces that brio makes of them.

    open_scans.py BRIO FOLDER

Each picture is a row of squares: points, or a surface in the light of a lamp beside the camera. What looks at the camera has the
colour of clay, its other side is blue, bridges are red. Needs numpy and nothing else; takes a minute.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

from render import CLAY, SUPERSAMPLING, Camera, Frame, raster_discs, raster_triangles, read_ply, unit, write_png

SIZE, GAP, COLOURS = 280, 6, 24
WHITE, BACK, BRIDGE, POINT = np.ones(3), np.array([0.45, 0.56, 0.72]), np.array([0.85, 0.25, 0.2]), np.array([0.2, 0.2, 0.25])


# --- points ---

def write_points(path, points):
    with open(path, "wb") as out:
        out.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
                  % len(points))
        out.write(np.ascontiguousarray(points, "<f8").tobytes())


class Brio:
    """The program, and a folder for its files."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def path(self, name):
        return os.path.join(self.folder, name + ".ply")

    def generate(self, name, *arguments):
        subprocess.run([self.program, "generate", *arguments, "-o", self.path(name), "--quiet"], check=True)
        return read_ply(self.path(name))[0]

    def surface(self, name, *options):
        out = self.path(name + "-surface")
        subprocess.run([self.program, "surface", self.path(name), "-o", out, "--quiet", *options], check=True)
        return read_ply(out)

    def points(self, name, points):
        write_points(self.path(name), points)
        return points


# --- pictures ---

class View:
    """A direction, and what of space is seen."""

    def __init__(self, points, azimuth, elevation, zoom=1.0):
        low, high = points.min(0), points.max(0)
        self.centre, self.radius = 0.5 * (low + high), 0.5 * np.linalg.norm(high - low) / zoom
        self.azimuth, self.elevation = azimuth, elevation

    def camera(self):
        big = SIZE * SUPERSAMPLING
        return Camera(self.centre, self.radius, self.azimuth, self.elevation, big, big)


def shrunk(image):
    """The mean of each pixel's parts, in few steps of light, which make small files."""
    small = image.reshape(SIZE, SUPERSAMPLING, SIZE, SUPERSAMPLING, 3).mean(axis=(1, 3))
    return np.round(small * COLOURS) / COLOURS


def of_points(view, points):
    camera = view.camera()
    frame = Frame(camera.width, camera.height)
    raster_discs(frame, *camera.project(points), 1.6)
    return shrunk(np.where((frame.what >= 0)[:, None], POINT, WHITE))


def of_surface(view, surface):
    vertices, properties, triangles = surface
    camera = view.camera()
    frame = Frame(camera.width, camera.height)
    raster_triangles(frame, *camera.project(vertices), triangles)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normal = unit(np.cross(b - a, c - a))
    front = ((camera.eye - a) * normal).sum(1) > 0
    colour = np.where(front[:, None], CLAY, BACK)
    bridge = properties.get("face bridge", np.zeros(len(triangles)))
    colour[bridge != 0] = BRIDGE
    shade = colour * (0.35 + 0.65 * np.abs(normal @ unit(camera.back + 0.5 * camera.up - 0.4 * camera.right)))[:, None]
    return shrunk(np.where((frame.what >= 0)[:, None], shade[frame.what], WHITE))


def write_row(path, squares):
    parts = []
    for square in squares:
        parts += [np.ones((SIZE, GAP, 3))] if parts else []
        parts.append(square)
    write_png(path, (255 * np.concatenate(parts, axis=1)).clip(0, 255).astype(np.uint8))


# --- what is shown ---

def of_one_view(brio):
    points = brio.generate("one", "scan", "-n", "9000", "--views", "1")
    front, behind = View(points, 60, 15, 1.2), View(points, 150, 15, 1.2)
    opened = brio.surface("one")
    yield "open-one-view", [of_points(front, points), of_surface(front, opened), of_surface(behind, opened)]
    closed = brio.surface("one", "--closed")
    yield "open-closed", [of_surface(front, closed), of_surface(behind, closed)]


def of_three_views(brio):
    points = brio.generate("three", "scan", "-n", "12000", "--views", "3")
    view = View(points, 60, 15, 1.2)
    yield "open-three-views", [of_points(view, points), of_surface(view, brio.surface("three"))]


def of_noise(brio):
    points = brio.generate("noise", "scan", "-n", "9000", "--views", "2", "--noise", "1")
    view = View(points, 60, 15, 1.2)
    yield "open-noise", [of_surface(view, brio.surface("noise", "--noise", "keep")), of_surface(view, brio.surface("noise"))]


def of_strays(brio):
    points = brio.generate("clean", "scan", "-n", "9000", "--views", "2")
    rng = np.random.default_rng(3)
    low, high = points.min(0), points.max(0)
    dust = 0.5 * (low + high) + rng.uniform(-0.8, 0.8, (len(points) // 100, 3)) * (high - low)
    points = brio.points("strays", np.concatenate([points, dust]))
    view = View(points, 60, 15, 1.5)
    yield "open-strays", [of_points(view, points), of_surface(view, brio.surface("strays"))]


def of_depth(brio):
    points = brio.generate("depth", "depth", "-n", "12000")
    spread = View(points, 180, -60, 1.3)
    yield "open-depth", [of_points(spread, points), of_surface(spread, brio.surface("depth", "--from", "0,0,0"))]


def of_holes(brio):
    points = brio.generate("ball", "sphere", "-n", "8000")
    axis = unit(points - points.mean(0))
    for centre, angle in [((1, 0, 0.2), 25), ((0.6, 0.8, 0.1), 10), ((0.7, -0.6, 0.4), 5)]:
        keep = axis @ unit(np.array(centre, float)) < np.cos(np.radians(angle))
        points, axis = points[keep], axis[keep]
    brio.points("holes", points)
    view = View(points, 5, 15, 1.7)
    yield "open-holes", [of_points(view, points), of_surface(view, brio.surface("holes")), of_surface(view, brio.surface("holes", "--closed"))]


def of_room(brio):
    """The walls, the floor and the ceiling of a box, seen from inside; the wall towards the reader is missing."""
    place = brio.generate("inside", "cube", "-n", "9000")
    place = (place - place.min(0)) / np.ptp(place, axis=0)
    wall = np.arange(len(place)) % 5
    for number, (axis, value) in enumerate([(0, 0), (1, 0), (1, 1), (2, 0), (2, 1)]):
        place[wall == number, axis] = value
    points = brio.points("room", place * [4, 5, 3])
    view = View(points, 20, 20, 1.2)
    yield "open-room", [of_surface(view, brio.surface("room", "--from", "2,2.5,1.5")), of_surface(view, brio.surface("room"))]


def main():
    program, folder = sys.argv[1:]
    with tempfile.TemporaryDirectory() as work:
        brio = Brio(os.path.abspath(program), work)
        for make in of_one_view, of_three_views, of_noise, of_strays, of_depth, of_holes, of_room:
            for name, squares in make(brio):
                path = os.path.join(folder, name + ".png")
                write_row(path, squares)
                print("%s: %d bytes" % (path, os.path.getsize(path)), flush=True)


if __name__ == "__main__":
    main()
