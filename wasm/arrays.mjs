// What stands in for packages whose points and cells are arrays of arrays: the way from these to brio's arrays, and back.
import { brio } from './index.mjs';

/** The number of coordinates of the points; 0 without any. More than 3 are an error. */
export function dimensionOf(points) {
  const d = points.length ? points[0].length : 0;
  if (d > 3) throw new RangeError(`points have ${d} coordinates; brio has 1, 2 and 3`);
  return d;
}

/** The coordinates, one point after the other, in the module's memory. Call free() of it. */
export function flatten(points, d) {
  const room = brio.room(points.length, d), to = room.array;
  for (let i = 0, at = 0; i < points.length; i++) {
    const p = points[i];
    for (let k = 0; k < d; k++) to[at++] = p[k];
  }
  return room;
}

/** Points of a line in their order, each position once: numbers of points. */
export function sorted(points) {
  const order = points.map((_, i) => i).sort((a, b) => points[a][0] - points[b][0]);
  return order.filter((p, i) => !i || points[p][0] !== points[order[i - 1]][0]);
}

/** Calls with the triangulation of the points, which is freed at the end. */
export function triangulated(points, d, call) {
  const room = flatten(points, d);
  try {
    const t = brio.delaunay(room.array, { dimension: d });
    try {
      return call(t, room);
    } finally {
      t.free();
    }
  } finally {
    room.free();
  }
}
