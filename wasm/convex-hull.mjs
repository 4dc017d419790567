// In place of the npm package convex-hull: the same call, the same kind of result, for points of 1, 2 and 3 coordinates.
//
// Facets are cut into triangles, seen counterclockwise from outside; edges of the plane run clockwise, as there. Only extreme points are
// corners: those inside a facet or an edge of the hull are none.
import { brio } from './index.mjs';
import { dimensionOf, flatten, sorted } from './arrays.mjs';

/** Returns the facets of the hull, arrays of d numbers of points. */
export default function convexHull(points) {
  if (points.length === 1) return [[0]];
  const d = dimensionOf(points);
  if (!d) return [];
  if (d === 1) {
    const order = sorted(points);
    return order.length > 1 ? [[order[0]], [order.at(-1)]] : [[order[0]]];
  }
  return d === 2 ? plane(points) : space(points);
}

function space(points) {
  const room = flatten(points, 3);
  try {
    const hull = brio.hull(room.array), faces = hull.dimension === 3 ? hull.faces : [], s = hull.samples, out = [];
    for (let i = 0; i < faces.length; i += 3) out.push([s[faces[i]], s[faces[i + 1]], s[faces[i + 2]]]);
    hull.free();
    return out;
  } finally {
    room.free();
  }
}

/* The hull of points of the plane z = 0 is one polygon, counterclockwise. */
function plane(points) {
  const room = flatten(points.map(([x, y]) => [x, y, 0]), 3);
  try {
    const hull = brio.hull(room.array, { polygons: true }), corners = [...hull.faces].map((v) => hull.samples[v]);
    hull.free();
    return corners.map((v, i) => [corners[(i + 1) % corners.length], v]).reverse();
  } finally {
    room.free();
  }
}
