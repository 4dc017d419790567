// In place of the npm package alpha-shape: the same call, the same kind of result, for points of 2 and 3 coordinates.
//
// Its alpha is 1 / radius: cells whose circumscribed sphere has a radius below 1 / alpha are in. The result is what bounds them: facets of
// one cell that is in, with the orientation that they have there.
import { brio } from './index.mjs';
import { dimensionOf, triangulated } from './arrays.mjs';

const FACETS = { 3: [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]], 2: [[1, 2], [2, 0], [0, 1]] }; // opposite to each corner

/** Returns the boundary, arrays of d numbers of points. */
export default function alphaShape(alpha, points) {
  const d = dimensionOf(points);
  if (d < 2) throw new RangeError(`points have ${d} coordinates; alpha shapes need 2 or 3`);
  return triangulated(points, d, (t, room) => {
    if (!t.size) return [];
    const complex = brio.alphaComplex(room.array, { dimension: d }), values = complex.values(d).slice(), out = [];
    complex.free();
    const r = t.records, corners = t.corners, stride = 2 * corners, most = 1 / alpha ** 2;
    const inside = (cell) => cell < t.size && values[cell] < most;
    for (let i = 0; i < t.size; i++) {
      if (!inside(i)) continue;
      for (let k = 0; k < corners; k++) // a mate is 4 times its cell, and the corner opposite to it
        if (!inside(r[stride * i + corners + k] >>> 2)) out.push(FACETS[d][k].map((c) => r[stride * i + c]).reverse());
    }
    return out;
  });
}
