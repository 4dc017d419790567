// npm's delaunay-triangulate, brio's package and brio's program on the same points, one after the other in one run: node delaunay.mjs
// BRIO [POINTS [SECONDS]], copied into a folder that has `brio` and `delaunay-triangulate` (npm install). Seconds of processor time, which
// other programs on the machine change little; medians of 3 of ours. Theirs runs once, in a process that SECONDS of the clock end. That of
// the program is of its whole run, in one thread.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { brio, delaunay } from 'brio';
import instead from 'brio/delaunay-triangulate';

const [, , program, count = '100000', most = '600', alone] = process.argv, n = +count, theirs = createRequire(import.meta.url)('delaunay-triangulate');
let state = 1;
const next = () => (state = (state * 48271) % 2147483647) / 2147483647;
const points = Float64Array.from({ length: 3 * n }, next), rows = Array.from({ length: n }, (_, i) => [...points.subarray(3 * i, 3 * i + 3)]);
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];
const times = (work, runs = 3) => median(Array.from({ length: runs }, () => { const began = process.cpuUsage(); work(); const { user, system } = process.cpuUsage(began); return (user + system) / 1e6; }));
const flat = (cells) => cells.filter(([a, b, c, d]) => {
  const [u, v, w] = [b, c, d].map((k) => rows[k].map((x, i) => x - rows[a][i]));
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]) === 0;
}).length;

if (alone) { // the run of theirs
  let cells;
  const their_seconds = times(() => { cells = theirs(rows); }, 1);
  console.log(JSON.stringify({ their_seconds, their_tetrahedra: cells.length, their_flat: flat(cells) }));
  process.exit();
}
const folder = mkdtempSync(join(tmpdir(), 'brio-bench-')), file = join(folder, 'points.npy');
const header = `{'descr': '<f8', 'fortran_order': False, 'shape': (${n}, 3), }`.padEnd(117) + '\n';
writeFileSync(file, Buffer.concat([Buffer.from([0x93, 78, 85, 77, 80, 89, 1, 0, 118, 0]), Buffer.from(header), Buffer.from(points.buffer)]));
delaunay(points.subarray(0, 3000)).free();
const package_seconds = times(() => delaunay(points).free()), instead_seconds = times(() => instead(rows));
const report = () => JSON.parse(execFileSync(program, ['delaunay', file, '--threads', '1', '--json', '--quiet']));
const timed = () => +execFileSync('bash', ['-c', 'TIMEFORMAT=%U; { time "$0" delaunay "$1" --threads 1 --quiet >/dev/null 2>&1; } 2>&1', program, file], { encoding: 'utf8' });
const desktop_seconds = median([timed(), timed(), timed()]), same = delaunay(points).checksum(points) === report().checksum;
const run = spawnSync(process.execPath, [process.argv[1], program, count, most, 'alone'], { timeout: 1000 * most, encoding: 'utf8' });
const their = run.status === 0 ? JSON.parse(run.stdout) : { their_seconds: +most, their_end: 'stopped, so that ratios are at least these' };
rmSync(folder, { recursive: true });
const r = (x) => +x.toPrecision(4);
console.log(JSON.stringify({ points: n, package_seconds: r(package_seconds), instead_seconds: r(instead_seconds), desktop_seconds: r(desktop_seconds), ...their,
  faster_than_theirs: r(their.their_seconds / package_seconds), instead_faster_than_theirs: r(their.their_seconds / instead_seconds), slower_than_desktop: r(package_seconds / desktop_seconds),
  same_checksum: same, tetrahedra: delaunay(points).size, our_flat: flat(instead(rows)), megabytes: brio.memory / 1e6 }));
