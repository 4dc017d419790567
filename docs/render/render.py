#!/usr/bin/python3
"""A small software renderer for the pictures of the documentation: a scan's points beside the surface made of them.

    render.py POINTS.ply SURFACE.ply OUT.png [--width 1200] [--height 600] [--azimuth 78] [--elevation 16]

It reads binary little endian PLY files, as brio writes them. Needs numpy and nothing else; takes about a minute.

Method. The surface is rasterized into a depth buffer with its normals, at twice the size of the picture. Light comes
from many directions: a sky, and a lamp of some width. For each direction a depth map of points spread over the surface
tells which pixels the light reaches; the sum over all directions has soft shadows and dark creases at once. The floor
takes part as one more surface. Points are small discs with the same depth buffer.
"""
import argparse
import struct
import zlib

import numpy as np

SUPERSAMPLING = 2
SKY_DIRECTIONS, LAMP_DIRECTIONS = 160, 40
FLOOR_RADIUS = 1.5         # how far the floor is seen, in radii of the object
SHADOW_SIZE = 320          # cells of a shadow map along one side
SHADOW_POINTS = 700_000    # points spread over the surface for the shadow maps
BACKGROUND = np.array([0.955, 0.955, 0.95])
CLAY = np.array([0.80, 0.74, 0.66])
PALETTE = np.array([
    [230, 97, 72], [240, 150, 55], [236, 190, 60], [170, 190, 70], [90, 170, 100], [50, 165, 150],
    [50, 150, 190], [70, 120, 195], [105, 95, 190], [150, 90, 180], [195, 85, 150], [220, 85, 110]]) / 255.0

# --- files ---

TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
         "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
         "double": "f8", "float64": "f8"}


def read_header(data):
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in data[:end].decode("ascii").splitlines():
        word = line.split()
        if word[0] == "format" and word[1] != "binary_little_endian":
            raise SystemExit("only binary little endian PLY files are read")
        if word[0] == "element":
            elements.append((word[1], int(word[2]), []))
        if word[0] == "property":
            elements[-1][2].append(word[1:])
    return elements, end


def read_faces(data, at, count, columns):
    """Triangles of the polygons of a list property, which comes first, each cut into a fan; the polygon of each triangle; and the
    other properties of polygons by name."""
    size, index = (np.dtype("<" + TYPES[kind]) for kind in columns[0][1:3])
    rest = np.dtype([(c[1], "<" + TYPES[c[0]]) for c in columns[1:]])
    corners = np.empty(count, np.int64)
    starts = np.empty(count, np.int64)
    for f in range(count):
        n = data[at] if size.itemsize == 1 else int.from_bytes(data[at:at + size.itemsize], "little")
        starts[f], corners[f] = at + size.itemsize, n
        at += size.itemsize + n * index.itemsize + rest.itemsize
    raw = np.frombuffer(data, np.uint8)

    def corner(face, number):
        where = (starts[face] + number * index.itemsize)[:, None] + np.arange(index.itemsize)
        return np.ascontiguousarray(raw[where]).view(index)[:, 0].astype(np.int64)

    fan = np.repeat(np.arange(count), corners - 2)
    step = np.arange(len(fan)) - np.repeat(np.cumsum(corners - 2) - (corners - 2), corners - 2)
    triangles = np.stack([corner(fan, 0), corner(fan, step + 1), corner(fan, step + 2)], axis=1)
    if not columns[1:]:
        return triangles, fan, {}
    tail = raw[(starts + corners * index.itemsize)[:, None] + np.arange(rest.itemsize)]
    table = np.ascontiguousarray(tail).view(rest)[:, 0]
    return triangles, fan, {name: table[name] for name in rest.names}


def read_ply(path):
    """Vertices (n, 3), other properties by name, triangles (m, 3). A property of polygons has a value a triangle, and "face "
    before its name."""
    data = open(path, "rb").read()
    elements, at = read_header(data)
    vertices, properties, triangles = None, {}, np.empty((0, 3), np.int64)
    for name, count, columns in elements:
        if name == "vertex":
            row = np.dtype([(c[1], "<" + TYPES[c[0]]) for c in columns])
            table = np.frombuffer(data, row, count, at)
            at += count * row.itemsize
            vertices = np.stack([table[k] for k in "xyz"], axis=1).astype(float)
            properties = {c[1]: table[c[1]] for c in columns if c[1] not in "xyz"}
        elif name == "face":
            triangles, fan, of_faces = read_faces(data, at, count, columns)
            properties = {**properties, **{"face " + name: values[fan] for name, values in of_faces.items()}}
            break
    return vertices, properties, triangles


def write_png(path, image):
    """8-bit RGB, each row with whichever filter makes its bytes smallest."""
    height, width, _ = image.shape
    rows = image.reshape(height, width * 3).astype(np.int16)
    up = np.vstack([np.zeros((1, width * 3), np.int16), rows[:-1]])
    left = np.hstack([np.zeros((height, 3), np.int16), rows[:, :-3]])
    corner = np.hstack([np.zeros((height, 3), np.int16), up[:, :-3]])
    estimate = left + up - corner
    a, b, c = abs(estimate - left), abs(estimate - up), abs(estimate - corner)
    paeth = np.where((a <= b) & (a <= c), left, np.where(b <= c, up, corner))
    filtered = np.stack([rows, rows - left, rows - up, rows - (left + up) // 2, rows - paeth]) & 255
    cost = np.minimum(filtered, 256 - filtered).sum(axis=2)
    best = cost.argmin(axis=0)
    chosen = filtered[best, np.arange(height)].astype(np.uint8)
    stream = np.hstack([best[:, None].astype(np.uint8), chosen]).tobytes()

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                  chunk(b"IDAT", zlib.compress(stream, 9)) + chunk(b"IEND", b""))

# --- geometry ---


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


def vertex_normals(vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    total = np.zeros_like(vertices)
    for i in range(3):
        for k in range(3):
            total[:, k] += np.bincount(triangles[:, i], normal[:, k], len(vertices))
    return unit(total)


def spread_points(vertices, triangles, count, random):
    """Points uniform by area."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    t = np.searchsorted(np.cumsum(area) / area.sum(), random.random(count)).clip(0, len(area) - 1)
    u, v = np.sqrt(random.random((count, 1))), random.random((count, 1))
    return a[t] * (1 - u) + b[t] * (u * (1 - v)) + c[t] * (u * v)


def direction(azimuth, elevation):
    """The unit vector towards two angles in degrees."""
    az, el = np.radians(azimuth), np.radians(elevation)
    return np.array([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)])


class Camera:
    """Looks at `centre` from a distance, with z up."""

    def __init__(self, centre, radius, azimuth, elevation, width, height):
        self.back = direction(azimuth, elevation)
        self.right = unit(np.cross([0, 0, 1.0], self.back))
        self.up = np.cross(self.back, self.right)
        self.distance = 6.0 * radius
        self.eye = centre + self.distance * self.back
        self.scale = min(width, height) * self.distance / (2.35 * radius)
        self.width, self.height = width, height

    def project(self, p):
        """Pixel coordinates and depth along the axis of view."""
        d = p - self.eye
        z = -(d @ self.back)
        return self.width / 2 + self.scale * (d @ self.right) / z, self.height / 2 - self.scale * (d @ self.up) / z, z

    def rays(self):
        y, x = np.mgrid[0:self.height, 0:self.width]
        u, v = (x + 0.5 - self.width / 2) / self.scale, (self.height / 2 - y - 0.5) / self.scale
        return u[..., None] * self.right + v[..., None] * self.up - self.back

# --- rasterization ---


class Frame:
    """A depth buffer with the number of what is seen at each pixel, and two barycentric coordinates."""

    def __init__(self, width, height):
        self.width, self.height = width, height
        self.depth = np.full(width * height, np.inf)
        self.what = np.full(width * height, -1, np.int64)
        self.bary = np.zeros((width * height, 2), np.float32)

    def put(self, pixel, depth, what, bary=None):
        """Keeps the nearest fragment of each pixel."""
        near = depth < self.depth[pixel]
        order = np.flatnonzero(near)[np.argsort(-depth[near], kind="stable")]
        pixel = pixel[order]  # the last one written is the nearest
        self.depth[pixel] = depth[order]
        self.what[pixel] = what[order]
        if bary is not None:
            self.bary[pixel] = bary[order]


def raster_triangles(frame, x, y, z, triangles):
    """Triangles in batches of like extent, all their candidate pixels at once."""
    tx, ty, tz = x[triangles], y[triangles], z[triangles]
    left, top = np.floor(tx.min(1)).astype(int), np.floor(ty.min(1)).astype(int)
    extent = np.maximum(np.ceil(tx.max(1)).astype(int) - left, np.ceil(ty.max(1)).astype(int) - top)
    size = 1
    while True:
        batch = np.flatnonzero((extent <= size) & (extent > size // 2 if size > 1 else True))
        per_step = max(1, 4_000_000 // (size * size))
        for first in range(0, len(batch), per_step):
            raster_batch(frame, batch[first:first + per_step], size, left, top, tx, ty, tz)
        if size >= extent.max():
            return
        size *= 2


def raster_batch(frame, batch, size, left, top, tx, ty, tz):
    step_y, step_x = np.mgrid[0:size, 0:size].reshape(2, -1)
    px, py = left[batch, None] + step_x, top[batch, None] + step_y
    ax, ay, bx, by, cx, cy = (v[batch, i][:, None] for i in range(3) for v in (tx, ty))
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    area = np.where(abs(area) < 1e-9, np.nan, area)  # seen edge on: covers nothing
    u = ((bx - px - 0.5) * (cy - py - 0.5) - (cx - px - 0.5) * (by - py - 0.5)) / area
    v = ((cx - px - 0.5) * (ay - py - 0.5) - (ax - px - 0.5) * (cy - py - 0.5)) / area
    inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (px >= 0) & (py >= 0) & (px < frame.width) & (py < frame.height)
    row, col = np.nonzero(inside)
    u, v = u[row, col], v[row, col]
    zb = tz[batch[row]]
    depth = u * zb[:, 0] + v * zb[:, 1] + (1 - u - v) * zb[:, 2]
    frame.put(py[row, col] * frame.width + px[row, col], depth, batch[row], np.stack([u, v], axis=1))


def raster_discs(frame, x, y, z, radius):
    reach = int(np.ceil(radius))
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            px, py = np.floor(x).astype(int) + dx, np.floor(y).astype(int) + dy
            inside = (px + 0.5 - x) ** 2 + (py + 0.5 - y) ** 2 <= radius * radius
            inside &= (px >= 0) & (py >= 0) & (px < frame.width) & (py < frame.height)
            which = np.flatnonzero(inside)
            frame.put(py[which] * frame.width + px[which], z[which], which)

# --- light ---


def spiral(count):
    """Directions spread evenly over the upper hemisphere."""
    i = np.arange(count) + 0.5
    z, angle = i / count, i * np.pi * (3 - np.sqrt(5))
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)


def lamp(axis, spread, count):
    i = np.arange(count) + 0.5
    r, angle = spread * np.sqrt(i / count), i * np.pi * (3 - np.sqrt(5))
    side = unit(np.cross(axis, [0, 0, 1.0]))
    other = np.cross(axis, side)
    return unit(axis + (r * np.cos(angle))[:, None] * side + (r * np.sin(angle))[:, None] * other)


class Shadows:
    """Which places a light from a direction reaches, by a depth map of the occluding points."""

    def __init__(self, points):
        self.points = points
        self.centre = 0.5 * (points.min(0) + points.max(0))
        self.radius = np.linalg.norm(points - self.centre, axis=1).max() * 1.001
        self.bias = 0.016 * self.radius

    def map_of(self, direction):
        side = unit(np.cross(direction, [0.2, 0.1, 1.0]))
        other = np.cross(direction, side)

        def cells(p):
            d = p - self.centre
            u = (d @ side / self.radius * 0.5 + 0.5) * SHADOW_SIZE
            v = (d @ other / self.radius * 0.5 + 0.5) * SHADOW_SIZE
            return u, v, d @ direction

        u, v, height = cells(self.points)
        cell = v.astype(int) * SHADOW_SIZE + u.astype(int)
        order = np.argsort(height)
        top = np.full(SHADOW_SIZE * SHADOW_SIZE, -np.inf)
        top[cell[order]] = height[order]
        return cells, top

    def reached(self, places, direction, jitter):
        cells, top = self.map_of(direction)
        u, v, height = cells(places)
        u, v = (u + jitter[0]).astype(int), (v + jitter[1]).astype(int)
        inside = (u >= 0) & (v >= 0) & (u < SHADOW_SIZE) & (v < SHADOW_SIZE)
        cell = np.where(inside, v * SHADOW_SIZE + u, 0)
        return ~inside | (height + self.bias > top[cell])


def illuminate(shadows, places, normals, lamp_axis, blur, random):
    """Light of sky and lamp at each place, each in [0, 1] for an open place that faces them. Places are moved at random
    by up to `blur` cells of the shadow maps."""
    places = places + normals * (0.5 * shadows.bias)
    sky, key = np.zeros(len(places)), np.zeros(len(places))
    for d in spiral(SKY_DIRECTIONS):
        cosine = normals @ d * 0.75 + 0.25  # a little wrapped: light from the floor
        sky += np.maximum(cosine, 0) * shadows.reached(places, d, blur * (2 * random.random((2, len(places))) - 1))
    for d in lamp(lamp_axis, 0.16, LAMP_DIRECTIONS):
        key += np.maximum(normals @ d, 0) * shadows.reached(places, d, blur * (2 * random.random((2, len(places))) - 1))
    return sky / (SKY_DIRECTIONS * 0.625), key / LAMP_DIRECTIONS

# --- the picture ---


def enlarged(light, width, height, factor):
    """A picture of one number a pixel at `factor` times its size, linear in between."""
    def taps(size, small):
        at = np.clip((np.arange(size) + 0.5) / factor - 0.5, 0, small - 1)
        low = np.minimum(at.astype(int), small - 2)
        return low, at - low

    y, fy = taps(height, light.shape[0])
    x, fx = taps(width, light.shape[1])
    rows = light[y] * (1 - fy)[:, None] + light[y + 1] * fy[:, None]
    return rows[:, x] * (1 - fx) + rows[:, x + 1] * fx


def smoothed(light):
    """The mean of each pixel and its neighbours, twice."""
    for axis in (0, 1, 0, 1):
        padded = np.pad(light, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        n = light.shape[axis]
        light = sum(np.take(padded, np.arange(n) + i, axis) for i in range(3)) / 3
    return light


def floor_image(camera, shadows, lamp_axis, random):
    """The floor and its shadow, which fades into the background. Soft as it is, a quarter of the pixels suffice."""
    factor = 4
    rays = camera.rays()[factor // 2::factor, factor // 2::factor]
    shape, rays = rays.shape[:2], rays.reshape(-1, 3)
    down = rays[:, 2] < -1e-6
    t = np.where(down, (shadows.points[:, 2].min() - camera.eye[2]) / np.where(down, rays[:, 2], 1), 0)
    places = camera.eye + rays * t[:, None]
    reach = np.linalg.norm(places[:, :2] - shadows.centre[:2], axis=1) / (FLOOR_RADIUS * shadows.radius)
    near = down & (reach < 1)
    up = np.tile([0, 0, 1.0], (near.sum(), 1))
    sky, key = illuminate(shadows, places[near], up, lamp_axis, 2, random)
    dark = 1 - (0.6 * np.minimum(sky, 1) + 0.4 * key / lamp_axis[2])
    light = np.ones(shape)
    light.reshape(-1)[near] -= 0.8 * np.maximum(dark, 0) * (1 - reach[near] ** 2) ** 2
    light = 1 - smoothed(1 - light)
    return BACKGROUND * enlarged(light, camera.width, camera.height, factor).reshape(-1, 1)


def surface_image(image, camera, shadows, lamp_axis, vertices, triangles, random):
    frame = Frame(camera.width, camera.height)
    raster_triangles(frame, *camera.project(vertices), triangles)
    seen = np.flatnonzero(frame.what >= 0)
    corner = triangles[frame.what[seen]]
    u, v = frame.bary[seen, 0:1], frame.bary[seen, 1:2]
    normal = vertex_normals(vertices, triangles)
    places = u * vertices[corner[:, 0]] + v * vertices[corner[:, 1]] + (1 - u - v) * vertices[corner[:, 2]]
    normals = unit(u * normal[corner[:, 0]] + v * normal[corner[:, 1]] + (1 - u - v) * normal[corner[:, 2]])
    sky, key = illuminate(shadows, places, normals, lamp_axis, 0.5, random)
    half = unit(unit(camera.eye - places) + lamp_axis)
    gloss = np.maximum((normals * half).sum(1), 0) ** 28 * np.minimum(key * 2, 1)
    cold, warm = np.array([0.86, 0.93, 1.0]), np.array([1.0, 0.95, 0.86])
    image[seen] = CLAY * (0.60 * sky[:, None] * cold + 0.78 * key[:, None] * warm) + 0.10 * gloss[:, None]
    return frame.what >= 0


def points_image(image, camera, points, colours, radius):
    frame = Frame(camera.width, camera.height)
    raster_discs(frame, *camera.project(points), radius)
    seen = np.flatnonzero(frame.what >= 0)
    depth = camera.project(points)[2]
    fog = np.clip((depth - depth.min()) / (depth.max() - depth.min()), 0, 1)[frame.what[seen], None]
    image[seen] = colours[frame.what[seen]] * (1 - 0.62 * fog) + BACKGROUND * 0.62 * fog
    return frame.what >= 0


def finish(image, covered, step, width, height):
    """Averages the supersamples and encodes for the screen, in steps of `step` where something is covered: among its
    detail they are not seen, and the file is smaller."""
    def average(values, *last):
        return values.reshape(height, SUPERSAMPLING, width, SUPERSAMPLING, *last).mean(axis=(1, 3))

    image = np.clip(average(image, 3), 0, 1) * 255
    steps = np.where(average(covered.astype(float)) > 0, step, 1)[..., None]
    return np.minimum(np.round(image / steps) * steps, 255).astype(np.uint8)


def main():
    parser = argparse.ArgumentParser(description="renders a scan beside the surface reconstructed from it")
    parser.add_argument("points")
    parser.add_argument("surface")
    parser.add_argument("output")
    parser.add_argument("--width", type=int, default=1200)
    parser.add_argument("--height", type=int, default=600)
    parser.add_argument("--azimuth", type=float, default=78)
    parser.add_argument("--elevation", type=float, default=16)
    parser.add_argument("--disc", type=float, default=3.0, help="radius of a point, in subpixels")
    a = parser.parse_args()
    random = np.random.default_rng(1)
    points, properties, _ = read_ply(a.points)
    vertices, _, triangles = read_ply(a.surface)
    shadows = Shadows(spread_points(vertices, triangles, SHADOW_POINTS, random))
    half, height = a.width // 2 * SUPERSAMPLING, a.height * SUPERSAMPLING
    camera = Camera(shadows.centre, shadows.radius, a.azimuth, a.elevation, half, height)
    lamp_axis = direction(a.azimuth - 48, 54)
    left = floor_image(camera, shadows, lamp_axis, random)
    right = left.copy()
    view = properties.get("view", np.zeros(len(points), int))
    dots = points_image(left, camera, points, PALETTE[view % len(PALETTE)], a.disc)
    clay = surface_image(right, camera, shadows, lamp_axis, vertices, triangles, random)
    panels = [finish(left, dots, 17, a.width // 2, a.height), finish(right, clay, 6, a.width // 2, a.height)]
    write_png(a.output, np.hstack(panels))


if __name__ == "__main__":
    main()
