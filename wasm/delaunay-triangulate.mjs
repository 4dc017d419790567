// In place of the npm package delaunay-triangulate: the same call, the same kind of result, for points of 1, 2 and 3 coordinates.
//
// Cells have its orientation (triangles clockwise). The triangulation is exact: it has no cell without a volume, and equal results for
// any order of the points, also on grids.
import { dimensionOf, sorted, triangulated } from './arrays.mjs';

const INFINITE = 0xffffffff;

/** Returns cells, arrays of d + 1 numbers of points.   includePointAtInfinity  also those of the hull, in which -1 stands for the point
 *  at infinity. */
export default function triangulate(points, includePointAtInfinity = false) {
  const d = dimensionOf(points);
  if (!d) return [];
  if (d === 1) return line(points, includePointAtInfinity);
  return triangulated(points, d, (t) => {
    const r = t.records, stride = 2 * t.corners, out = new Array(t.size + (includePointAtInfinity ? t.hullSize : 0));
    const name = (v) => (v === INFINITE ? -1 : v);
    for (let i = 0, at = 0; i < out.length; i++, at += stride) // brio's cells are turned the other way
      out[i] = d === 3 ? [name(r[at + 1]), name(r[at]), name(r[at + 2]), name(r[at + 3])] : [name(r[at + 1]), name(r[at]), name(r[at + 2])];
    return out;
  });
}

function line(points, infinite) {
  const order = sorted(points), cells = order.slice(1).map((b, i) => [order[i], b]);
  return infinite && order.length ? [...cells, [-1, order[0]], [order.at(-1), -1]] : cells;
}
