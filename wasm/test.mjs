// test.mjs BRIO.wasm [BRIO]: the module under Node, held against the program of this machine where it is given.
import { deepStrictEqual, strictEqual, ok, throws } from 'node:assert';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { load, BrioError } from './brio.mjs';

const [, , wasm, program] = process.argv;
const brio = await load(readFileSync(wasm));
const tests = [];
const test = (name, run) => tests.push([name, run]);

// points of a sphere, without the mathematical library
function sphere(count) {
  const points = new Float64Array(3 * count);
  let state = 1n;
  const random = () => { state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn; return Number(state >> 40n) / 2 ** 23 - 1; };
  for (let i = 0; i < count;) {
    const p = [random(), random(), random()], r = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    if (r > 1 || r < 0.01) continue;
    points.set(p.map((c) => c / Math.sqrt(r)), 3 * i++);
  }
  return points;
}

const GRID = Float64Array.from({ length: 3 * 6 ** 3 }, (_, i) => [Math.floor(i / 3) % 6, Math.floor(i / 18) % 6, Math.floor(i / 108)][i % 3]);

function volume6(points, t, i) {
  const [a, b, c, d] = [0, 1, 2, 3].map((k) => points.subarray(3 * t[4 * i + k], 3 * t[4 * i + k] + 3));
  const [u, v, w] = [b, c, d].map((p) => [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

test('a grid has its volume, and no tetrahedron without one', () => {
  const { tetrahedra } = brio.delaunay(GRID);
  let sum = 0, least = Infinity;
  for (let i = 0; i < tetrahedra.length / 4; i++) { const v = volume6(GRID, tetrahedra, i); sum += v; least = Math.min(least, Math.abs(v)); }
  strictEqual(Math.abs(sum), 6 * 125);
  ok(least > 0);
});

test('the checksum is that of the program', () => {
  if (!program) return 'skipped: no program was given';
  const points = sphere(2000), folder = mkdtempSync(join(tmpdir(), 'brio-wasm-')), file = join(folder, 'points.npy');
  const header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2000, 3), }".padEnd(117) + '\n';
  writeFileSync(file, Buffer.concat([Buffer.from([0x93, 78, 85, 77, 80, 89, 1, 0, 118, 0]), Buffer.from(header), Buffer.from(points.buffer)]));
  const report = JSON.parse(execFileSync(program, ['delaunay', file, '--json']));
  strictEqual(brio.delaunay(points).checksum, report.checksum);
  deepStrictEqual(brio.read(readFileSync(file), 'points.npy').vertices, points);
});

test('weights make a regular triangulation', () => {
  const points = sphere(300), weights = Float64Array.from({ length: 300 }, (_, i) => (i * 7919 % 1000) / 4096);
  ok(brio.delaunay(points, weights).checksum !== brio.delaunay(points).checksum);
});

test('a surface has its certificate', () => {
  const { faces, certificate } = brio.surface(sphere(3000));
  ok(faces.length > 3 * 5000);
  ok(certificate.closed && certificate.manifold && certificate.oriented);
  strictEqual(certificate.genus, 0);
  strictEqual(certificate.components, 1);
  strictEqual(certificate.self_intersections, 0);
});

test('what is written is read', () => {
  const surface = brio.surface(sphere(500));
  for (const name of ['a.ply', 'a.obj', 'a.off', 'a.vtu', 'a.glb', 'a.stl']) {
    const bytes = brio.write(surface, name);
    ok(bytes && bytes.length > 1000, name);
    if (name === 'a.glb') continue; // read where brio has cJSON
    const again = brio.read(bytes, name);
    strictEqual(again.faces.length, surface.faces.length, name);
    if (name !== 'a.stl') deepStrictEqual(again.vertices, surface.vertices, name);
  }
});

test('failures have the sentence of the library, and leave nothing', () => {
  throws(() => brio.read(new TextEncoder().encode('ply\nformat ascii 1.0\nelement vertex 2\n'), 'broken.ply'), (e) => e instanceof BrioError && e.message.startsWith('broken.ply: '));
  throws(() => brio.delaunay(Float64Array.of(NaN, 0, 0)), BrioError);
  throws(() => brio.write({ vertices: new Float64Array(3) }, 'a.unknown'), BrioError);
  strictEqual(brio.files.files.size, 0);
});

test('a call can be stopped', () => {
  const stages = new Set();
  brio.progress = (stage) => stages.add(stage).size > 0;
  throws(() => brio.delaunay(sphere(50000)), /cancelled/);
  brio.progress = null;
  ok(stages.size > 0);
});

let failed = 0;
for (const [name, run] of tests) {
  let said = 'ok';
  try { said = run() || 'ok'; } catch (error) { failed++; said = 'FAILED: ' + error.stack; }
  console.log(said === 'ok' ? 'ok     ' + name : name + ': ' + said);
}
console.log(tests.length + ' tests, ' + failed + ' failures; ' + readFileSync(wasm).length + ' bytes, brio ' + brio.version);
process.exit(failed ? 1 : 0);
