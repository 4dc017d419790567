// The package as it is installed: node --test package.test.mjs in a folder that has it (scripts/npm.sh test). BRIO is the program of
// this machine, which results are held against; without it these tests are skipped.
import { deepStrictEqual, ok, rejects, strictEqual, throws } from 'node:assert';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { alphaComplex, alphaShape, brio, BrioError, delaunay, hull, isCancelled, load, mesh, page, read, regular, room, surface, voronoi, write } from 'brio';
import triangulate from 'brio/delaunay-triangulate';
import convexHull from 'brio/convex-hull';
import alphaShapeOf from 'brio/alpha-shape';
import { start } from 'brio/worker';

const program = process.env.BRIO, folder = mkdtempSync(join(tmpdir(), 'brio-npm-'));
after(() => rmSync(folder, { recursive: true }));
const held = program ? {} : { skip: 'BRIO names no program' };

// --- points ---

function random(seed) {
  let state = BigInt(seed);
  return () => { state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn; return Number(state >> 40n) / 2 ** 24; };
}
const cube = (count, seed = 1, d = 3) => Float64Array.from({ length: d * count }, random(seed));
/** Points of a sphere, without the mathematical library, so that the program has the same. */
function sphere(count) {
  const points = new Float64Array(3 * count), next = random(2);
  for (let i = 0; i < count;) {
    const p = [0, 0, 0].map(() => 2 * next() - 1), r = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    if (r > 1 || r < 0.01) continue;
    points.set(p.map((c) => c / Math.sqrt(r)), 3 * i++);
  }
  return points;
}
const GRID = Float64Array.from({ length: 3 * 6 ** 3 }, (_, i) => [Math.floor(i / 3) % 6, Math.floor(i / 18) % 6, Math.floor(i / 108)][i % 3]);
const rows = (points, d = 3) => Array.from({ length: points.length / d }, (_, i) => [...points.subarray(d * i, d * i + d)]);

function npy(points, d = 3) {
  const header = `{'descr': '<f8', 'fortran_order': False, 'shape': (${points.length / d}, ${d}), }`.padEnd(117) + '\n';
  return Buffer.concat([Buffer.from([0x93, 78, 85, 77, 80, 89, 1, 0, 118, 0]), Buffer.from(header), Buffer.from(points.buffer, points.byteOffset, points.byteLength)]);
}
/** What the program reports of points. */
function reported(command, points, ...more) {
  const file = join(folder, 'points.npy');
  writeFileSync(file, npy(points));
  return JSON.parse(execFileSync(program, [command, file, '--json', ...more]));
}

function volume6(points, [a, b, c, d]) {
  const [p, q, r, s] = [a, b, c, d].map((v) => points.subarray(3 * v, 3 * v + 3));
  const [u, v, w] = [q, r, s].map((x) => [x[0] - p[0], x[1] - p[1], x[2] - p[2]]);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}
/** A cell up to even permutations. */
function canonical(cell) {
  let odd = false;
  for (let i = 0; i < cell.length; i++) for (let j = i + 1; j < cell.length; j++) if (cell[i] > cell[j]) odd = !odd;
  return (odd ? '-' : '+') + [...cell].sort((a, b) => a - b);
}

// --- calls ---

test('a grid has its volume, and no tetrahedron without one', () => {
  const { tetrahedra } = delaunay(GRID);
  let sum = 0, least = Infinity;
  for (let i = 0; i < tetrahedra.length; i += 4) { const v = volume6(GRID, tetrahedra.subarray(i, i + 4)); sum += v; least = Math.min(least, Math.abs(v)); }
  strictEqual(Math.abs(sum), 6 * 125);
  ok(least > 0);
  const cells = triangulate(rows(GRID));
  strictEqual(4 * cells.length, tetrahedra.length);
  ok(cells.every((cell) => volume6(GRID, cell) < 0), 'the orientation of delaunay-triangulate');
});

test('checksums and counts are those of the program', held, () => {
  for (const points of [cube(2000), sphere(1500), GRID]) {
    const r = reported('delaunay', points), t = delaunay(points);
    deepStrictEqual([t.checksum(points), t.size, t.hullSize], [r.checksum, r.tetrahedra, r.hull_facets]);
    t.check(points);
    const h = hull(points), s = reported('hull', points);
    deepStrictEqual([h.vertices.length / 3, h.faces.length / 3], [s.vertices, s.faces]);
    h.free();
    t.free();
  }
  const points = sphere(3000), file = join(folder, 'surface.ply'), r = reported('surface', points, '-o', file), s = surface(points), same = read(readFileSync(file), 'surface.ply');
  deepStrictEqual(s.faces.slice(), same.faces.slice());
  deepStrictEqual(s.vertices.slice(), same.vertices.slice());
  deepStrictEqual([s.certificate.genus, s.certificate.area, s.facts.noise], [r.certificate.genus, r.certificate.area, r.noise]);
  const c = reported('voronoi', points, '--box', '0,0,0,1,1,1'), v = voronoi(points, { box: [0, 0, 0, 1, 1, 1] });
  deepStrictEqual([v.size, v.volumeSum], [c.cells, c.volume]);
  const alpha = reported('alpha', points, '--alpha', 'auto'), a = alphaShape(points);
  deepStrictEqual([a.alpha, a.solid], [alpha.alpha, alpha.tetrahedra]);
});

test('weights make a regular triangulation', () => {
  const points = cube(300), weights = Float64Array.from({ length: 300 }, (_, i) => ((i * 7919) % 1000) / 4096), t = regular(points, weights);
  ok(t.hidden > 0);
  t.check(points, weights);
  throws(() => t.check(points), BrioError);
  throws(() => regular(points, weights.subarray(1)), /weights has 299 numbers; expected 300/);
});

test('points of the plane have triangles', () => {
  const points = cube(500, 3, 2), t = delaunay(points, { dimension: 2 });
  t.check(points);
  strictEqual(t.triangles.length, 3 * t.size);
  strictEqual(t.size, 2 * 500 - 2 - t.hullSize);
});

test('a hull has its corners, an alpha shape its points, cells their volumes', () => {
  const h = hull(GRID);
  deepStrictEqual([h.vertices.length / 3, h.faces.length / 3, h.certificate.closed, Math.round(1e9 * h.certificate.volume)], [8, 12, true, 125e9]);
  ok(h.samples.every((s, v) => GRID.subarray(3 * s, 3 * s + 3).every((x, k) => x === h.vertices[3 * v + k])));
  strictEqual(hull(GRID, { polygons: true }).offsets.length, 7);
  const a = alphaShape(GRID);
  deepStrictEqual([a.alpha, a.uncovered, Math.round(1e9 * a.certificate.volume)], [0.75, 0, 125e9]);
  throws(() => alphaShape(GRID, { alpha: -1 }), /squared radius/);
  const complex = alphaComplex(GRID);
  strictEqual(complex.values(1).length, complex.simplices(1).length / 2);
  strictEqual(Math.max(...complex.values(3)), 0.75);
  const points = cube(200), v = voronoi(points, { box: [0, 0, 0, 1, 1, 1], faces: true, vertices: true });
  ok(Math.abs(v.volumeSum - 1) < 1e-12 && v.size === 200 && v.bounded.every(Boolean));
  strictEqual(v.faceOffsets.at(-1), v.faceNeighbours.length);
  strictEqual(v.cornerOffsets.at(-1), v.faceVertices.length);
  ok(v.faceNeighbours.some((n) => n < 0) && v.faceVertices.every((i) => 3 * i < v.vertices.length));
  const copy = v.copy();
  v.free();
  strictEqual(copy.volume.length, 200);
  throws(() => v.volume, /freed/);
});

test('a surface has its certificate, by every method', () => {
  for (const method of ['labeled', 'power-crust', 'cocone', 'tight-cocone']) {
    const { closed, manifold, oriented, genus, components, self_intersections } = surface(sphere(2000), { method }).certificate;
    deepStrictEqual({ closed, manifold, oriented, genus, components, self_intersections }, { closed: true, manifold: true, oriented: true, genus: 0, components: 1, self_intersections: 0 }, method);
  }
  throws(() => surface(sphere(100), { method: 'poisson' }), /method is 'poisson'; expected one of labeled/);
  const points = sphere(1000), inward = points.map((x) => -x), s = surface(points, { normals: inward });
  ok(s.certificate.volume < 0 || s.facts.agreement < 0.5, 'normals tell where outside is');
});

test('a surface has the properties of its points', () => {
  const points = sphere(800), red = Uint8Array.from({ length: 800 }, (_, i) => i % 256), m = mesh({ vertices: points, properties: { red, depth: [...points.subarray(0, 800)] } });
  const s = surface(m), { sample, red: carried, depth } = s.properties;
  ok(carried instanceof Uint8Array && depth instanceof Float64Array);
  ok(carried.every((x, v) => x === red[sample[v]]));
});

test('what is written is read', () => {
  const made = surface(sphere(500));
  for (const name of ['a.ply', 'a.obj', 'a.off', 'a.vtu', 'a.vtp', 'a.vtk', 'a.glb', 'a.stl']) {
    const bytes = write(made, name);
    ok(bytes.length > 1000, name);
    if (name === 'a.glb') continue; // read where brio has cJSON
    const again = read(bytes, name);
    strictEqual(again.faces.length, made.faces.length, name);
    if (name !== 'a.stl') deepStrictEqual(again.vertices.slice(), made.vertices.slice(), name);
  }
  const polygons = write({ vertices: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], faces: [0, 1, 2, 3], offsets: [0, 4] }, 'square.off', { ascii: true });
  ok(new TextDecoder().decode(polygons).includes('4 0 1 2 3'));
  ok(new TextDecoder().decode(page([{ mesh: made, name: 'ball' }])).includes('"name":"ball"'));
  ok(brio.reads.includes('.laz') && brio.writes.includes('.glb') && !brio.writesFaces.includes('.laz'));
});

test('a surface tells how it came to be, and a page shows it', () => {
  const told = surface(sphere(300), { explain: true }), text = new TextDecoder().decode(page([{ mesh: told, explanation: told.explanation }]));
  strictEqual(told.explanation.samples, 300);
  strictEqual(told.explanation.allSamples, 300);
  ok(text.includes('"explanation":{') && text.includes('data-name="e-pole-0"'));
  ok(!new TextDecoder().decode(page([{ mesh: told }])).includes('"explanation":{'));
  told.explanation.free();
  throws(() => page([{ mesh: told, explanation: told.explanation }]), /freed/);
  throws(() => surface(sphere(300), { explain: true, method: 'offset', distance: 0.1 }), BrioError);
  strictEqual(surface(sphere(50)).explanation, undefined);
});

test('failures have the sentence of the library, and leave nothing', () => {
  throws(() => read(new TextEncoder().encode('ply\nformat ascii 1.0\nelement vertex 2\n'), 'broken.ply'), (e) => e instanceof BrioError && e.message.startsWith('broken.ply: '));
  throws(() => delaunay(Float64Array.of(NaN, 0, 0)), BrioError);
  throws(() => delaunay([1, 2, 3, 4]), /points have 4 numbers; expected 3/);
  throws(() => write({ vertices: new Float64Array(3) }, 'a.unknown'), BrioError);
  throws(() => surface(Float64Array.of(0, 0, 0, 1, 1, 1)), BrioError);
  throws(() => triangulate([[1, 2, 3, 4]]), RangeError);
  strictEqual(brio.files.files.size, 0);
});

test('what cannot be right is refused, not answered', () => {
  const points = cube(400), freed = hull(points), t = delaunay(points);
  freed.free();
  for (const call of [() => write(freed, 'x.ply'), () => surface(freed), () => page([{ mesh: freed, name: 'x' }])]) throws(call, /freed/);
  throws(() => t.checksum(points.subarray(0, 3)), /1 points for a triangulation of 400/);
  throws(() => delaunay(points, { dimension: 4 }), /dimension is 4; expected 2 or 3/);
  throws(() => delaunay(), BrioError);
  throws(() => read('text', 'x.xyz'), BrioError);
  strictEqual(read(new TextEncoder().encode('0 0 0\n1 2 3\n').buffer, 'x.xyz').vertices.length, 6);
  throws(() => delaunay(cube(50000), { progress: () => { delaunay(points); } }), /no other can begin/);
  strictEqual(delaunay(points).checksum(points), t.checksum(points), 'calls go on');
});

test('weights in the memory are read where points are copied, and the memory grows', () => {
  const weights = room(200000, 1);
  weights.array.fill(0.1);
  const before = brio.memory, points = Float64Array.from({ length: 600000 }, (_, i) => (i % 3 ? i % 7 : i));
  ok(regular(points, weights.array).size > 0);
  ok(brio.memory > before);
});

test('memory is used again, and views and room need no copies', () => {
  const points = cube(20000);
  for (let i = 0; i < 3; i++) delaunay(points).free();
  const before = brio.memory;
  for (let i = 0; i < 10; i++) delaunay(points).free();
  strictEqual(brio.memory, before, 'calls leave memory behind');
  const few = cube(100); // their blocks shrink to less than 64 KiB
  delaunay(few).free();
  const small = brio.memory;
  for (let i = 0; i < 100; i++) delaunay(few).free();
  ok(brio.memory - small <= 2 ** 18, `100 small calls leave ${brio.memory - small} bytes behind`);
  const own = room(20000);
  own.array.set(points);
  const t = delaunay(own.array);
  strictEqual(t.records.buffer, t.representatives.buffer);
  strictEqual(t.records.buffer, brio.x.memory.buffer);
  strictEqual(t.checksum(own.array), t.checksum(points));
  own.free();
  t.free();
  t.free();
  throws(() => t.records, /freed/);
});

test('a result lives as long as its views', { skip: globalThis.gc ? false : 'run by node --expose-gc' }, async () => {
  const gone = [], watch = new FinalizationRegistry((what) => gone.push(what));
  const viewed = (what) => { const made = hull(cube(400)); watch.register(made, what); return made.vertices; };
  const seen = viewed('held');
  (() => viewed('dropped'))();
  for (let i = 0; i < 100 && !gone.includes('dropped'); i++) { globalThis.gc(); await new Promise((done) => setTimeout(done, 10)); }
  for (let i = 0; i < 5; i++) { globalThis.gc(); await new Promise((done) => setTimeout(done, 10)); }
  deepStrictEqual(gone, ['dropped']);
  ok(seen.length >= 0);
});

test('a call can be stopped, and says how far it is', () => {
  const stages = new Set(), points = cube(50000);
  throws(() => delaunay(points, { progress: (stage) => { stages.add(stage); return true; } }), (e) => isCancelled(e) && /cancelled/.test(e.message));
  ok(stages.size > 0);
  throws(() => delaunay(points, { progress: () => { throw new RangeError('of the caller'); } }), /of the caller/);
  delaunay(points).free();
});

test('a worker has the calls as promises, and stops them', async () => {
  const worker = await start(), points = cube(3000);
  const t = await worker.delaunay(points);
  deepStrictEqual(t.tetrahedra, delaunay(points).tetrahedra);
  strictEqual((await worker.surface(sphere(500), { holes: 'closed' })).certificate.closed, true);
  await rejects(worker.delaunay([NaN, 0, 0]), BrioError);
  const stop = new AbortController(), said = [];
  const much = worker.delaunay(cube(300000), { signal: stop.signal, progress: (stage, share) => { said.push(share); stop.abort(); } });
  await rejects(much, (e) => e === stop.signal.reason);
  ok(said.length > 0);
  strictEqual((await worker.hull(GRID)).vertices.length, 24, 'the worker goes on');
  await rejects(worker.delaunay(points, { unknown: () => 1 }), /could not be cloned/);
  const ended = worker.delaunay(cube(300000));
  setTimeout(() => worker.end(), 50);
  await rejects(ended, /the worker was ended/);
  strictEqual((await worker.hull(GRID)).vertices.length, 24, 'the next call starts another one');
  worker.end();
});

test('a compiled module is taken, and modules are apart', async () => {
  const module = await WebAssembly.compile(readFileSync(new URL(import.meta.resolve('brio/brio.wasm'))));
  const other = await load(module);
  strictEqual(other.delaunay(GRID).size, delaunay(GRID).size);
  ok(other.x.memory !== brio.x.memory);
});

// --- in place of other packages: what delaunay-triangulate 1.1.6, convex-hull 1.0.3 and alpha-shape 1.0.0 gave for these points ---

const SPACE = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.3, 0.2, 0.25], [1, 1, 1.2]];
const PLANE = [[0, 0], [1, 0], [0, 1], [1.1, 1], [0.4, 0.4], [0.5, 0]];
const same = (ours, theirs, words) => deepStrictEqual(ours.map(canonical).sort(), theirs.map(canonical).sort(), words);

test('delaunay-triangulate', () => {
  same(triangulate(SPACE), [[1, 4, 2, 5], [2, 4, 3, 5], [4, 1, 3, 5], [1, 3, 0, 4], [1, 0, 2, 4], [3, 2, 0, 4]]);
  same(triangulate(SPACE, true), [[-1, 1, 2, 5], [1, 4, 2, 5], [2, 3, -1, 5], [2, 4, 3, 5], [3, 1, -1, 5], [4, 1, 3, 5], [1, 3, 0, 4], [-1, 1, 3, 0], [1, 0, 2, 4], [-1, 1, 0, 2], [3, 2, 0, 4], [2, -1, 3, 0]]);
  same(triangulate(PLANE), [[1, 4, 3], [1, 5, 4], [4, 2, 3], [0, 4, 5], [4, 0, 2]]);
  same(triangulate(PLANE, true), [[-1, 1, 3], [1, -1, 5], [1, 4, 3], [1, 5, 4], [2, -1, 3], [4, 2, 3], [0, 4, 5], [4, 0, 2], [-1, 0, 5], [0, -1, 2]]);
  deepStrictEqual(triangulate([[3], [1], [2]]), [[1, 2], [2, 0]]);
  deepStrictEqual([triangulate([]), triangulate([[]]), triangulate([[0, 0], [1, 1], [2, 2]]), triangulate([[0, 0, 0], [1, 0, 0], [0, 1, 0]])], [[], [], [], []]);
});

test('convex-hull', () => {
  same(convexHull(SPACE), [[2, 0, 3], [0, 1, 3], [1, 0, 2], [5, 2, 3], [1, 5, 3], [5, 1, 2]]);
  same(convexHull(PLANE), [[1, 0], [0, 2], [2, 3], [3, 1]]);
  deepStrictEqual([convexHull([[3], [1], [2]]), convexHull([[5, 5]]), convexHull([]), convexHull([[0, 0], [1, 1], [2, 2]]), convexHull([[0, 0, 0], [1, 0, 0], [0, 1, 0]])], [[[1], [0]], [[0]], [], [], []]);
});

test('alpha-shape', () => {
  same(alphaShapeOf(0.5, SPACE), [[0, 1, 2], [3, 1, 0], [2, 3, 0], [2, 1, 5], [1, 3, 5], [3, 2, 5]]);
  same(alphaShapeOf(0.5, PLANE), [[0, 2], [3, 1], [5, 0], [2, 3], [1, 5]]);
  deepStrictEqual(alphaShapeOf(1e9, SPACE), []);
});
