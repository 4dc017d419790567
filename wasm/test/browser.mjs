// The installed package in Chromium, as a server gives it, without a bundler: node browser.mjs WEB-ENV, in a folder that has the package.
// Exit status 77 where Chromium or playwright-core is missing.
import { deepStrictEqual, ok, strictEqual } from 'node:assert';
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { extname } from 'node:path';

const chromium = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
let playwright;
try { playwright = createRequire(`${process.argv[2]}/package.json`)('playwright-core'); } catch { /* said below */ }
if (!chromium || !playwright) { console.log('skipped: Chromium or playwright-core is missing (sh scripts/setup.sh web)'); process.exit(77); }

const TYPES = { '.mjs': 'text/javascript', '.wasm': 'application/wasm', '.html': 'text/html' };
const html = '<!doctype html><title>brio</title><script type="importmap">{"imports":{"brio":"/brio/index.mjs","brio/worker":"/brio/worker.mjs"}}</script>';
for (const isolated of [false, true]) { // with and without memory that may be shared
  const server = createServer((request, answer) => {
    const file = request.url.startsWith('/brio/') && `node_modules${request.url}`, there = file && existsSync(file);
    answer.writeHead(!file || there ? 200 : 404, { 'content-type': TYPES[extname(request.url)] ?? 'text/html',
      ...(isolated && { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' }) });
    answer.end(!file ? html : there ? readFileSync(file) : '');
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const browser = await playwright.chromium.launch({ executablePath: chromium, args: ['--no-sandbox'] });
  try {
    const page = await browser.newPage(), wrong = [];
    page.on('pageerror', (e) => wrong.push(e.message));
    page.on('console', (m) => { if (m.type() === 'error' && !m.text().includes('favicon')) wrong.push(m.text()); });
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    const found = await page.evaluate(async () => {
      const { delaunay } = await import('brio'), { start } = await import('brio/worker');
      let state = 1;
      const cube = (n) => Float64Array.from({ length: 3 * n }, () => (state = (state * 48271) % 2147483647) / 2147483647);
      const points = cube(5000), t = delaunay(points), worker = await start(), stop = new AbortController(), shares = [];
      t.check(points);
      const same = (await worker.delaunay(points)).tetrahedra.join() === t.tetrahedra.join();
      const stopped = await worker.delaunay(cube(400000), { signal: stop.signal, progress: (_, share) => { shares.push(share); stop.abort(); } }).catch((e) => e.name);
      const after = (await worker.hull(points)).vertices.length > 30;
      return { same, stopped, after, shares: shares.length, isolated: crossOriginIsolated, size: t.size };
    });
    deepStrictEqual([found.same, found.stopped, found.after, found.isolated], [true, 'AbortError', true, isolated]);
    ok(found.shares > 0 && found.size > 30000);
    strictEqual(wrong.join(), '');
  } finally {
    await browser.close();
    server.close();
  }
}
console.log('browser: the package works in Chromium, with and without shared memory');
