// Uses the package's types; tsc checks it, nothing runs it.
import { alphaComplex, alphaShape, brio, BrioError, delaunay, hull, load, read, regular, room, surface, voronoi, write } from 'brio';
import type { Certificate, Mesh, Triangulation } from 'brio';
import triangulate from 'brio/delaunay-triangulate';
import convexHull from 'brio/convex-hull';
import alphaShapeOf from 'brio/alpha-shape';
import { start } from 'brio/worker';

const points = room(4), t: Triangulation = delaunay(points.array, { progress: (stage, share) => share > 0.5 && stage !== '' });
const cells: Uint32Array = t.tetrahedra, flat: Uint32Array = delaunay([0, 0, 1, 0, 0, 1], { dimension: 2 }).triangles;
const s: Mesh = surface(points.array, { method: 'power-crust', noise: 'keep', simplify: true }), c: Certificate = s.certificate;
const facts: number | undefined = s.facts?.holes, bytes: Uint8Array = write(s, 'a.ply', { ascii: true });
const again: Mesh = read(bytes, 'a.ply'), sum: number = voronoi(again.vertices, { box: [0, 0, 0, 1, 1, 1] }).volumeSum;
regular(points.array, [1, 2, 3, 4]).check(points.array, [1, 2, 3, 4]);
const values: Float64Array = alphaComplex(points.array).values(3), alpha: number | undefined = alphaShape(points.array).alpha;
const corners: number[][] = [...triangulate([[0, 0]], true), ...convexHull([new Float32Array(3)]), ...alphaShapeOf(1, [[1, 2]])];
export async function use(): Promise<unknown[]> {
  const worker = await start(), stop = new AbortController();
  const done = await worker.surface(points.array, { signal: stop.signal, progress: (stage) => console.log(stage) });
  const other = await load(fetch('brio.wasm'));
  if (!(new Error() instanceof BrioError)) worker.end();
  return [cells, flat, c.genus, facts, sum, values, alpha, corners, done.certificate.closed, done.faces, other.version, brio.reads, hull(again.vertices).samples];
}
// @ts-expect-error: points are numbers
delaunay('points');
// @ts-expect-error: there is no such method
surface(points.array, { method: 'poisson' });
