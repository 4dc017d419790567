// What a page shows, in Chromium with its software renderer: node page_test.mjs BRIO [long|bench]. Pages are made of files written here,
// so that what has to be seen is known: silhouettes and colours of pictures, coordinates of picked vertices to the last bit, every
// control, touch, keys, a narrow window, and what axe-core finds. No page may ask for anything, or complain on the console.
//
// Exit status 77, with the reason: a part is missing (sh scripts/setup.sh web).
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [, , brio, length = "short"] = process.argv;
const root = new URL("../../", import.meta.url);
const chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
const packages = new URL("out/web-env/package.json", root);
function skip(reason) {
    console.log(`skipped: ${reason} (sh scripts/setup.sh web)`);
    process.exit(77);
}
if (!chromium) skip("there is no Chromium");
if (!existsSync(packages)) skip("out/web-env is missing");
const require = createRequire(packages);
let playwright;
try { playwright = require("playwright-core"); } catch { skip("playwright-core is missing"); }
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const folder = mkdtempSync(join(tmpdir(), "brio-browser-"));
const at = name => join(folder, name);
const run = (...args) => execFileSync(brio, [...args, "--quiet"], { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
let failures = 0, checks = 0;
function expect(truth, words) {
    checks++;
    if (truth) return;
    failures++;
    console.log(`FAILED: ${words}`);
}

// --- files ---

function ply(name, vertices, faces, { vertex = "", face = "", rows = () => "", marks = () => "" } = {}) {
    const head = ["ply", "format ascii 1.0", `element vertex ${vertices.length}`, "property double x", "property double y", "property double z",
        ...vertex.split(";").filter(Boolean).map(p => `property ${p}`), `element face ${faces.length}`, "property list uchar int vertex_indices",
        ...face.split(";").filter(Boolean).map(p => `property ${p}`), "end_header"];
    writeFileSync(at(name), [...head, ...vertices.map((v, i) => `${v.join(" ")} ${rows(i)}`), ...faces.map((f, i) => `${f.length} ${f.join(" ")} ${marks(i)}`), ""].join("\n"));
}
const CUBE = [0, 1].flatMap(x => [0, 1].flatMap(y => [0, 1].map(z => [x, y, z])));
const QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
/** A grid of bumps over a square: coordinates that no float holds. */
function bumps(n) {
    const vertices = [], faces = [];
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) vertices.push([i / (n - 1) + 1e-9 / 3, j / (n - 1) - 1 / 7e8, 0.2 * Math.sin(3 * i) * Math.cos(2 * j) / 3]);
    for (let i = 0; i + 1 < n; i++) for (let j = 0; j + 1 < n; j++) faces.push([i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1], [i * n + j, (i + 1) * n + j + 1, i * n + j + 1]);
    return [vertices, faces];
}

// --- pages ---

const browser = await playwright.chromium.launch({ executablePath: chromium, args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"] });

/** Opens a page, and watches what it asks for and says. */
async function open(name, { width = 900, height = 600, hash = "", ...more } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, offline: true, acceptDownloads: true, ...more });
    const page = await context.newPage();
    page.on("console", m => expect(m.type() === "log", `${name}: console ${m.type()}: ${m.text()}`));
    page.on("pageerror", e => expect(false, `${name}: ${e.message}`));
    page.on("request", r => expect(r.url().startsWith("file://" + folder) || r.url().startsWith("blob:"), `${name}: asks for ${r.url()}`));
    await page.goto(`file://${at(name)}${hash}`);
    await page.evaluate(() => window.brioPage.ready);
    await settled(page);
    return page;
}
/** Waits until the picture is whole, after frames that were asked for. Not by waitForFunction: it takes the promise that its function
 *  returns for an answer that is true, and would wait for two frames only, while the address is written when the picture is whole. */
const settled = page => page.evaluate(async () => {
    const app = window.brioPage, end = performance.now() + 60000;
    do await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))); while (!(app.complete && !app.dirty) && performance.now() < end);
    if (!app.complete || app.dirty) throw new Error("the picture is not whole after a minute");
});

/** The pixels of the canvas that differ from the background: their number, box and mean colour. In the page, since a picture is large. */
const picture = page => page.evaluate(() => {
    const app = window.brioPage, gl = app.renderer.gl, { width, height } = app.canvas, pixels = new Uint8Array(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const back = app.look().background.map(c => Math.round(255 * c)), sum = [0, 0, 0];
    let count = 0, box = [width, height, 0, 0], opaque = true;
    for (let i = 0; i < width * height; i++) {
        if (pixels[4 * i + 3] !== 255) opaque = false;
        if ([0, 1, 2].every(k => Math.abs(pixels[4 * i + k] - back[k]) < 3)) continue;
        const x = i % width, y = Math.floor(i / width);
        box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
        for (let k = 0; k < 3; k++) sum[k] += pixels[4 * i + k];
        count++;
    }
    return { width, height, count, box, opaque, mean: sum.map(s => s / Math.max(1, count)) };
});
/** Where a place of the file is on the page. */
const placeOf = (page, p) => page.evaluate(p => {
    const app = window.brioPage, { width, height } = app.canvas, m = app.camera.matrix(width, height), q = app.scene.fromFile(p);
    const row = r => m[r] * q[0] + m[4 + r] * q[1] + m[8 + r] * q[2] + m[12 + r], box = app.canvas.getBoundingClientRect();
    return [box.left + (row(0) / row(3) + 1) / 2 * box.width, box.top + (1 - row(1) / row(3)) / 2 * box.height];
}, p);
const camera = page => page.evaluate(() => window.brioPage.camera.toArray());
const moved = (a, b) => a.some((x, i) => Math.abs(x - b[i]) > 1e-4);
async function press(page, ...keys) {
    for (const key of keys) await page.keyboard.press(key);
    await settled(page);
}
/** Fails where axe finds something serious. */
async function accessible(page, name) {
    await page.evaluate(axe);
    const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    for (const v of found.violations.filter(v => ["serious", "critical"].includes(v.impact)))
        expect(false, `${name}: axe: ${v.id}: ${v.nodes.map(n => n.html).join(" ").slice(0, 300)}`);
    checks++;
}

// --- tests ---

/** A red square, seen from above in parallel projection, has its silhouette, to a pixel, and its colour. */
async function silhouetteAndColour() {
    ply("red.ply", [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]], { vertex: "uchar red;uchar green;uchar blue", rows: () => "200 30 20" });
    run("view", "red.ply", "-o", "red.html");
    const page = await open("red.html");
    const fronts = await page.evaluate(() => { // the same square, turned over, is looked at from below
        const { scene } = window.brioPage, t = scene.layers[0].triangles, usual = scene.front() ?? null;
        for (let i = 0; i < t.length; i += 3) [t[i], t[i + 1]] = [t[i + 1], t[i]];
        return [usual, scene.front()];
    });
    expect(fronts[0] === null && fronts[1][1] < 0, `open surfaces are seen from ${JSON.stringify(fronts)}`);
    const out = await page.evaluate(() => { // the whole box is seen at first
        const app = window.brioPage, { width, height } = app.canvas, m = app.camera.matrix(width, height);
        return [0, 1, 2, 3, 4, 5, 6, 7].map(i => app.scene.half.map((x, k) => i >> k & 1 ? x : -x)).map(q => [0, 1].map(r => (m[r] * q[0] + m[4 + r] * q[1] + m[8 + r] * q[2] + m[12 + r]) / (m[3] * q[0] + m[7] * q[1] + m[11] * q[2] + m[15])));
    });
    expect(out.every(p => p.every(x => Math.abs(x) < 1)) && out.some(p => p.some(x => Math.abs(x) > 0.6)), `corners of the box are at ${JSON.stringify(out)}`);
    await page.uncheck("text=boundary");
    await page.focus("#canvas");
    await press(page, "o", "5");
    const seen = await picture(page);
    const [low, high] = [await placeOf(page, [0, 0, 0]), await placeOf(page, [2, 1, 0])];
    const [w, h] = [high[0] - low[0], low[1] - high[1]];
    expect(seen.opaque, "the canvas is not opaque");
    expect(Math.abs(w - 2 * h) < 1, `the square is ${w} by ${h}`);
    expect(Math.abs(seen.box[2] - seen.box[0] + 1 - w) <= 3 && Math.abs(seen.box[3] - seen.box[1] + 1 - h) <= 5, `silhouette ${seen.box}, expected ${w} by ${h}`);
    expect(Math.abs(seen.count - w * h) < 0.03 * w * h, `${seen.count} pixels of ${w * h}`);
    expect(seen.mean[0] > 120 && seen.mean[1] < 60 && seen.mean[2] < 60, `colour ${seen.mean}`);
    await page.context().close();
}

/** The colours of the picture that at least one in a hundred of its pixels has, and how many have each; pixels in `where`, or all. */
const colours = (page, where = "() => true") => page.evaluate(where => {
    const app = window.brioPage, gl = app.renderer.gl, { width, height } = app.canvas, p = new Uint8Array(4 * width * height), inside = eval(where), count = new Map();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, p);
    const back = app.look().background.map(c => Math.round(255 * c));
    let all = 0;
    for (let i = 0; i < width * height; i++) {
        if ([0, 1, 2].every(k => Math.abs(p[4 * i + k] - back[k]) < 3) || !inside(i % width, height - 1 - Math.floor(i / width))) continue;
        const colour = [0, 1, 2].map(k => p[4 * i + k] >> 2).join();
        count.set(colour, (count.get(colour) || 0) + 1);
        all++;
    }
    return [...count].filter(([, n]) => n > 0.01 * all).map(([c, n]) => [c.split(",").map(x => 4 * x), n]);
}, where);

/** At first, after a reset, in a window of another shape, and side by side, things fill the picture, and none is cut off. */
async function filled() {
    ply("tall.ply", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 5]], [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    run("view", "tall.ply", "tall.ply", "-o", "tall.html");
    const page = await open("tall.html"), fills = async (words, parts = 1) => {
        await settled(page);
        const { width, height, box } = await picture(page), share = Math.max((box[2] - box[0]) / (width / parts), (box[3] - box[1]) / height);
        expect(share > (parts > 1 ? 0.5 : 0.78) && box[0] > 1 && box[1] > 1 && box[2] < width - 2 && box[3] < height - 2, `${words}: ${box} of ${width} by ${height}`);
    };
    await fills("at first");
    await page.setViewportSize({ width: 520, height: 900 });
    await fills("in a tall window");
    await page.focus("#canvas");
    await press(page, "s");
    await fills("side by side", 2);
    await press(page, "s", "+", "+", "ArrowLeft");
    const moved = await camera(page);
    await page.setViewportSize({ width: 900, height: 600 });
    await settled(page);
    expect(JSON.stringify(await camera(page)) === JSON.stringify(moved), "a window of another size takes back where one moved to");
    await press(page, "0");
    await fills("after a reset");
    await page.context().close();
}

/** Of a cloud without normals, what is behind something near it is darker; of a mesh with a crease, each side has its own shade. */
async function shades() {
    const rows = ["x,y,z"];
    for (let i = 0; i < 120; i++) for (let j = 0; j < 120; j++) rows.push(`${i / 119},${j / 119},0`);
    for (let i = 0; i < 70; i++) for (let j = 0; j < 70; j++) rows.push(`${0.3 + 0.4 * i / 69},${0.3 + 0.4 * j / 69},0.6`);
    writeFileSync(at("steps.csv"), rows.join("\n") + "\n");
    run("view", "steps.csv", "-o", "steps.html");
    for (const parallel of [false, true]) {
        const page = await open("steps.html");
        await page.getByLabel("Colour by").selectOption("plain");
        await page.getByRole("slider", { name: "Point size" }).fill("7");
        await page.focus("#canvas");
        await press(page, "5", ...(parallel ? ["o"] : []));
        const [[x0, y1], [x1, y0]] = [await placeOf(page, [0.3, 0.3, 0.6]), await placeOf(page, [0.7, 0.7, 0.6])], box = await page.locator("#canvas").boundingBox();
        const square = [x0 - box.x, y0 - box.y, x1 - box.x, y1 - box.y], brightest = list => Math.max(...list.map(([c]) => c[0])), out = (d, e) => `(x, y) => { const [a, b, c, d] = ${JSON.stringify(square)}, far = Math.max(a - x, x - c, b - y, y - d); return far > ${d} && far < ${e}; }`;
        const on = brightest(await colours(page, out(-200, -8))), beside = await colours(page, out(2, 6)), away = await colours(page, out(20, 200));
        expect(Math.abs(brightest(away) - on) < 6, `far from the step ${brightest(away)}, on it ${on}`);
        const dark = beside.filter(([c]) => c[0] < 0.8 * on).reduce((n, [, m]) => n + m, 0), all = beside.reduce((n, [, m]) => n + m, 0);
        expect(dark > 0.15 * all, `behind the step ${dark} of ${all} pixels are darker`);
        await page.context().close();
    }
    const vertices = [], faces = [], n = 9;
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) vertices.push([i, j, 0]);
    for (let i = 1; i < n; i++) for (let j = 0; j < n; j++) vertices.push([0, j, i]);
    const number = (side, i, j) => side && i ? n * n + (i - 1) * n + j : i * n + j;
    for (const side of [0, 1]) for (let i = 0; i + 1 < n; i++) for (let j = 0; j + 1 < n; j++) {
        const q = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([a, b]) => number(side && a ? 1 : 0, side && !a ? 0 : a, b));
        faces.push(...(side ? [[q[0], q[2], q[1]], [q[0], q[3], q[2]]] : [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]));
    }
    ply("crease.ply", vertices, faces);
    run("view", "crease.ply", "-o", "crease.html");
    const page = await open("crease.html");
    await page.uncheck("text=boundary");
    await settled(page);
    const { flat, sharp } = await page.evaluate(() => ({ flat: window.brioPage.drawings[0].state.flat, sharp: window.brioPage.drawings[0].layer.sharp }));
    const shown = await colours(page);
    expect(!flat && sharp > 0.03, `the crease has ${sharp} of the corners`);
    expect(shown.length === 2, `two sides have the colours ${JSON.stringify(shown)}`);
    await page.context().close();
}

/** Walls between small rooms are a complex, whose edges are not marked, as in pictures; few fins on a surface are faults. */
async function complexes() {
    const n = 4, at3 = (x, y, z) => (x * n + y) * n + z, vertices = [], walls = [];
    for (let x = 0; x < n; x++) for (let y = 0; y < n; y++) for (let z = 0; z < n; z++) {
        vertices.push([x, y, z]);
        if (y + 1 < n && z + 1 < n) walls.push([at3(x, y, z), at3(x, y + 1, z), at3(x, y + 1, z + 1), at3(x, y, z + 1)]);
        if (x + 1 < n && z + 1 < n) walls.push([at3(x, y, z), at3(x + 1, y, z), at3(x + 1, y, z + 1), at3(x, y, z + 1)]);
        if (x + 1 < n && y + 1 < n) walls.push([at3(x, y, z), at3(x + 1, y, z), at3(x + 1, y + 1, z), at3(x, y + 1, z)]);
    }
    ply("walls.ply", vertices, walls);
    ply("fin.ply", [...CUBE, [0.5, 0.5, 3]], [...QUADS, [0, 1, 8]]);
    for (const [name, marked] of [["walls", false], ["fin", true]]) {
        run("view", `${name}.ply`, "-o", `${name}.html`);
        const page = await open(`${name}.html`);
        const shown = await page.evaluate(() => { const d = window.brioPage.drawings[0]; return [d.layer.meta.nonmanifold, d.state.nonmanifold]; });
        expect(shown[0] > 0 && shown[1] === marked, `${name}: ${shown}`);
        await page.context().close();
    }
}

/** Picking ten vertices gives the coordinates of the file, to the last bit, with number and properties. */
async function picking() {
    const [vertices, faces] = bumps(14);
    ply("bumps.ply", vertices, faces, { vertex: "double depth;float size", rows: i => `${i / 3} ${Math.fround(i / 7)}`, face: "uchar bridge", marks: i => i % 5 === 0 ? 1 : 0 });
    run("view", "bumps.ply", "-o", "bumps.html");
    const page = await open("bumps.html");
    await page.focus("#canvas");
    await press(page, "5");
    for (const v of [15, 30, 47, 61, 76, 92, 108, 121, 140, 165]) {
        const [x, y] = await placeOf(page, vertices[v]);
        await page.mouse.click(x, y);
        await page.waitForSelector("#card:not([hidden])");
        const card = await page.evaluate(() => [...document.querySelectorAll("#card dt")].map(e => [e.textContent, e.nextSibling.textContent]));
        const facts = Object.fromEntries(card), title = await page.textContent("#card h2 span");
        expect(title === `vertex ${v} of bumps.ply`, `picked ${title}, not vertex ${v}`);
        "xyz".split("").forEach((axis, k) => expect(Object.is(+facts[axis], vertices[v][k]), `vertex ${v}: ${axis} is ${facts[axis]}, not ${vertices[v][k]}`));
        expect(+facts.depth === v / 3, `depth ${facts.depth}`);
        expect(Math.fround(+facts.size) === Math.fround(v / 7) && facts.size.length < 12, `size ${facts.size}`);
        expect(faces[+facts.face].includes(v) && +facts["bridge of the face"] === (+facts.face % 5 === 0 ? 1 : 0), `face ${facts.face}`);
    }
    // the distance of two of them
    await press(page, "Escape", "m");
    for (const v of [15, 165]) { await page.mouse.click(...await placeOf(page, vertices[v])); await page.waitForFunction(v => window.brioPage.picker.picks.at(-1)?.number === v, v); }
    await page.waitForFunction(() => window.brioPage.picker.distance !== null);
    const distance = await page.evaluate(() => window.brioPage.picker.distance);
    expect(Math.abs(distance - Math.hypot(...vertices[15].map((x, k) => x - vertices[165][k]))) < 1e-15, `distance ${distance}`);
    expect((await page.textContent("#overlay")).length > 2, "the distance is not in the picture");
    await press(page, "Escape");
    expect(await page.isHidden("#card"), "Escape closes the card");
    await page.context().close();
}

/** Every control changes the picture, and the address brings it back. */
async function controls() {
    const [vertices, faces] = bumps(14);
    ply("flaws.ply", [...vertices, [0.5, 0.5, 0.7], [0.2, 0.2, -0.3], [0.8, 0.3, -0.3], [0.4, 0.6, 0.5]], [...faces, [15, 29, 196], [197, 198, 199]],
        { vertex: "double depth", rows: i => i / 3, face: "uchar bridge", marks: i => i % 5 === 0 ? 1 : 0 });
    run("view", "flaws.ply", "bumps.ply", "--self-intersections", "-o", "flaws.html");
    const page = await open("flaws.html");
    const seen = () => picture(page).then(p => JSON.stringify([p.count, p.mean.map(x => x.toFixed(3))]));
    let before = await seen();
    const changes = async (words, act) => {
        await act();
        await settled(page);
        const after = await seen();
        expect(after !== before, `${words} changes nothing in the picture`);
        before = after;
    };
    const part = page.locator("section.layer").first();
    await changes("hiding a layer", () => page.uncheck("#visible1"));
    for (const name of ["wireframe", "points", "boundary", "edges of over two faces", "crossing faces", "bridges", "flat shading", "faces"])
        await changes(name, () => part.getByLabel(name, { exact: true }).click());
    await part.getByLabel("faces", { exact: true }).check();
    await settled(page);
    before = await seen();
    for (const value of ["z", "v0", "f0", "plain"]) await changes(`colour by ${value}`, () => part.getByLabel("Colour by").selectOption(value));
    await changes("colour by depth", () => part.getByLabel("Colour by").selectOption("v0"));
    await changes("the colour map", () => part.getByLabel("Colour map").selectOption("turbo"));
    await changes("the range", async () => { await part.getByRole("textbox", { name: "from" }).fill("30"); await part.getByRole("textbox", { name: "from" }).press("Enter"); });
    const histogram = await part.locator(".histogram").boundingBox();
    await changes("a drag over the histogram", async () => {
        await page.mouse.move(histogram.x + 40, histogram.y + 20);
        await page.mouse.down();
        await page.mouse.move(histogram.x + 120, histogram.y + 20, { steps: 3 });
        await page.mouse.up();
    });
    await changes("opacity", () => part.getByLabel("Opacity").fill("0.4"));
    await changes("size of points", async () => { await part.getByLabel("points", { exact: true }).check(); await part.getByLabel("Point size").fill("9"); });
    await changes("the cutting plane", () => page.getByLabel("cutting plane").check());
    await changes("its place", () => page.getByLabel("Place").fill("0.3"));
    await changes("its other side", () => page.getByLabel("other side").check());
    await changes("across", () => page.getByLabel("Across").selectOption("1"));
    await changes("upright", () => page.getByLabel("Upright").selectOption("1"));
    await changes("parallel projection", () => page.getByRole("button", { name: "Parallel projection" }).click());
    await changes("dark", () => page.getByRole("button", { name: "Dark" }).click());
    const address = await page.evaluate(() => location.hash);
    await changes("both layers side by side", async () => { await page.check("#visible1"); await page.getByRole("button", { name: "Side by side" }).click(); });
    expect((await page.locator("#names span").allTextContents()).join() === "flaws.ply,bumps.ply", "names over the views");
    const hidden = await page.evaluate(() => document.getElementById("hint").getBoundingClientRect().width);
    await page.getByRole("button", { name: "Help" }).click();
    expect(hidden > 0, "the hint");
    await page.getByRole("button", { name: "Layers" }).click();
    expect(await page.isHidden("#panel"), "the panel folds");
    await settled(page);
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save a picture" }).click()]);
    const png = readFileSync(await download.path());
    expect(png.subarray(1, 4).toString() === "PNG" && png.length > 5000, "the saved picture");
    await page.getByRole("button", { name: "Copy the address of this view" }).click();
    await page.waitForFunction(() => /address/.test(document.getElementById("status").textContent), null, { timeout: 5000 });
    await page.context().close();
    const again = await open("flaws.html", { hash: address });
    const state = await again.evaluate(() => { const a = window.brioPage; return { map: a.drawings[0].state.map, source: a.drawings[0].state.source, visible: a.drawings[1].state.visible, opacity: a.drawings[0].state.opacity, parallel: a.camera.parallel, cut: a.scene.cutting.at, theme: a.theme }; });
    expect(JSON.stringify(state) === JSON.stringify({ map: "turbo", source: "v0", visible: false, opacity: 0.4, parallel: true, cut: 0.3, theme: "dark" }), `the address brings back ${JSON.stringify(state)}`);
    expect(await again.evaluate(() => location.hash) === address, "the address stays as it was");
    await again.context().close();
    for (const nonsense of ["#%7B", "#null", "#[1]", "#" + encodeURIComponent('{"c":["a"],"l":{"0":{"source":"<b>","map":"constructor","opacity":"x"}},"p":[1,9,"z"]}')])
        await (await open("flaws.html", { hash: nonsense })).context().close();
}

/** Drags, the wheel, keys and fingers move the camera; the place under the pointer stays where it is. */
async function moving() {
    const page = await open("bumps.html", { hasTouch: true });
    const box = await page.locator("#canvas").boundingBox(), [cx, cy] = [box.x + box.width / 2, box.y + box.height / 2];
    let before = await camera(page);
    const moves = async (words, act, which) => {
        await act();
        await settled(page);
        const after = await camera(page);
        expect(moved(after, before) && which(after, before), `${words}: ${before} to ${after}`);
        before = after;
    };
    const drag = (dx, dy, button = "left") => async () => {
        await page.mouse.move(cx, cy);
        await page.mouse.down({ button });
        await page.mouse.move(cx + dx, cy + dy, { steps: 4 });
        await page.mouse.up({ button });
    };
    await moves("a drag turns", drag(60, 20), (a, b) => a[0] < b[0] && a[1] > b[1] && a[3] === b[3]);
    await moves("the right button pans", drag(50, 10, "right"), (a, b) => a[0] === b[0] && a[3] !== b[3]);
    const place = [0.3, 0.4, 0], [px, py] = await placeOf(page, place);
    await moves("the wheel zooms", async () => { await page.mouse.move(px, py); await page.mouse.wheel(0, -300); }, (a, b) => a[2] < b[2]);
    const [qx, qy] = await placeOf(page, place);
    expect(Math.hypot(qx - px, qy - py) < 25, `what is under the pointer went ${[qx - px, qy - py]}`);
    await page.focus("#canvas");
    await moves("arrows turn", () => press(page, "ArrowLeft", "ArrowUp"), (a, b) => a[0] > b[0] && a[1] < b[1]);
    await moves("Shift and arrows pan", () => press(page, "Shift+ArrowRight"), (a, b) => a[3] !== b[3] || a[4] !== b[4]);
    await moves("plus zooms", () => press(page, "+"), (a, b) => a[2] < b[2]);
    await moves("minus zooms out", () => press(page, "-"), (a, b) => a[2] > b[2]);
    await moves("3 looks from behind", () => press(page, "3"), a => Math.abs(a[0] - Math.PI) < 1e-3 && a[1] === 0);
    await moves("0 resets", () => press(page, "0"), a => a[3] === 0 && a[2] > 3.9 && a[2] < 5.5);
    await press(page, "5", "Enter");
    await page.waitForSelector("#card:not([hidden])");
    const client = await page.context().newCDPSession(page);
    const touch = (type, points) => client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    before = await camera(page);
    await moves("a finger turns", async () => {
        await touch("touchStart", [[cx, cy]]);
        for (let i = 1; i < 5; i++) await touch("touchMove", [[cx + 15 * i, cy]]);
        await touch("touchEnd", []);
    }, (a, b) => a[0] < b[0] && a[2] === b[2]);
    await moves("two fingers zoom", async () => {
        await touch("touchStart", [[cx - 40, cy], [cx + 40, cy]]);
        for (let i = 1; i < 5; i++) await touch("touchMove", [[cx - 40 - 12 * i, cy], [cx + 40 + 12 * i, cy]]);
        await touch("touchEnd", []);
    }, (a, b) => a[2] < 0.8 * b[2] && Math.abs(a[0] - b[0]) < 1e-4);
    await page.context().close();
}

/** Tetrahedra: the section with the plane is seen, picked and coloured. */
async function tetrahedra() {
    run("generate", "cube", "-n", "300", "-o", "cube.xyz");
    run("delaunay", "cube.xyz", "-o", "cube.vtu");
    run("view", "cube.vtu", "-o", "cube.html");
    const page = await open("cube.html");
    await page.focus("#canvas");
    await press(page, "1");
    const box = await page.locator("#canvas").boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#card:not([hidden])");
    const pick = await page.evaluate(() => ({ tetrahedron: window.brioPage.picker.picks[0].tetrahedron, y: window.brioPage.scene.toFile(window.brioPage.picker.picks[0].point)[1] }));
    expect(pick.tetrahedron !== null && Math.abs(pick.y - 0.5) < 0.02, `picked ${JSON.stringify(pick)}`);
    const area = await page.evaluate(() => {
        const d = window.brioPage.drawings[0], p = d.section.places, s = d.layer.meta.step;
        let sum = 0;
        for (let i = 0; i < p.length; i += 9) {
            const [u, v] = [0, 2].map(k => [p[i + 3 + k] - p[i + k], p[i + 6 + k] - p[i + k]]);
            sum += Math.abs(u[0] * v[1] - u[1] * v[0]) / 2 * s * s;
        }
        return sum;
    });
    expect(area > 0.85 && area < 1, `the section of a cube has the area ${area}`);
    await page.context().close();
}

/** The slider over the alpha filtration: at each value the triangles that brio alpha finds there; what is picked is one of them. */
async function alphas() {
    run("generate", "cube", "-n", "120", "-o", "few.xyz");
    run("alpha", "few.xyz", "--alpha", "auto", "--view", "alphas.html");
    const page = await open("alphas.html"), slider = page.getByRole("slider", { name: "Alpha" });
    expect(await page.evaluate(() => window.brioPage.drawings.map(d => d.state.visible).join()) === "false,true", "the shape is shown within the filtration");
    const seen = [];
    for (const part of ["0.15", "0.5", "0.9", "1"]) {
        await slider.fill(part);
        await settled(page);
        const [alpha, boundary, singular] = await page.evaluate(() => { const d = window.brioPage.drawings[1]; return [d.alpha, d.shape.boundary, d.shape.singular]; });
        const facts = JSON.parse(execFileSync(brio, ["alpha", "few.xyz", "--alpha", String(alpha), "--json"], { cwd: folder }));
        expect(facts.faces === boundary && facts.internals.singular_facets === singular, `alpha ${alpha}: ${boundary} and ${singular} triangles, brio alpha has ${facts.faces} and ${facts.internals.singular_facets}`);
        seen.push([boundary, (await picture(page)).count]);
    }
    expect(new Set(seen.map(String)).size === 4 && seen[0][1] < seen[3][1], `the pictures do not differ: ${seen}`);
    expect((await page.locator("#panel [role=status]").textContent()).includes(`${seen[3][0]} triangles bound the solid`), "the panel says how many");
    const box = await page.locator("#canvas").boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#card:not([hidden])");
    const there = await page.evaluate(() => { const d = window.brioPage.drawings[1], f = window.brioPage.picker.picks[0].face; return d.shape.of.includes(f) && d.layer.filtration.vanishes[f] > d.alpha; });
    expect(there, "a triangle is picked that is not shown");
    const hash = await page.evaluate(() => location.hash);
    await page.context().close();
    const again = await open("alphas.html", { hash });
    const back = await again.evaluate(() => [window.brioPage.drawings[1].shape.boundary, window.brioPage.drawings[1].state.alpha, location.hash]);
    expect(back[0] === seen[3][0], `the address ${hash} brings back ${back}, not ${seen[3][0]} triangles`);
    await again.context().close();
}

/** Cells and tetrahedra moved apart: each by its own way, whole; the cutting plane takes whole pieces away; picking knows the cell. */
async function apart() {
    run("generate", "cube", "-n", "40", "-o", "sites.xyz");
    run("voronoi", "sites.xyz", "--box", "0,0,0,1,1,1", "--view", "cells.html");
    const page = await open("cells.html");
    await page.focus("#canvas");
    await press(page, "-", "-", "-", "-", "-");
    const before = await picture(page);
    await page.getByRole("slider", { name: "Apart" }).fill("0.6");
    await page.waitForFunction(() => window.brioPage.drawings[0].buffers.placeE);
    await settled(page);
    const after = await picture(page);
    expect(after.box[2] - after.box[0] > 1.2 * (before.box[2] - before.box[0]), `apart ${after.box}, together ${before.box}`);
    const pieces = await page.evaluate(async () => { const d = window.brioPage.drawings[0]; return [(await d.layer.pieces()).centre.length / 3, d.buffers.placeE.count / 9, d.layer.triangles.length / 3]; });
    expect(pieces[0] === 40 && pieces[1] === pieces[2], `40 cells, ${pieces}`);
    await page.focus("#canvas");
    await press(page, "1", "Enter");
    await page.waitForSelector("#card:not([hidden])");
    const card = await page.textContent("#card"), site = await page.evaluate(() => { const p = window.brioPage.picker.picks[0]; return [p.face, p.faceFacts.properties.find(([q]) => q.name === "site")[1]]; });
    expect(site[0] !== null && site[1] >= 0 && site[1] < 40 && card.includes("volume of the face"), `picked ${site}`);
    await page.getByLabel("cutting plane").check();
    await page.waitForFunction(n => window.brioPage.drawings[0].buffers.placeE.count / 9 < n, pieces[2]);
    const counts = await page.evaluate(async () => { const d = window.brioPage.drawings[0], { piece } = await d.layer.pieces(), kept = new Set(d.chosen.map(t => piece[t])); return [d.chosen.length, piece.filter(c => kept.has(c)).length, kept.size]; });
    expect(counts[0] === counts[1] && counts[2] > 5 && counts[2] < 35, `whole cells stay: ${counts}`);
    await page.context().close();
}

/** How a surface came to be: the poles that are told of are those of brio medial, to the last bit, and their balls are drawn as large as
 *  they are; a click chooses the nearest sample, and so does the address. */
async function explained(method = "power-crust") {
    run("generate", "scan", "-n", "300", "-o", "few.ply");
    run("medial", "few.ply", "--sides", "both", "--noise", "keep", "-o", "poles.csv");
    run("surface", "few.ply", "--method", method, "--noise", "keep", "-o", "explained.ply", "--explain", "--view", "explained.html");
    const lines = readFileSync(at("poles.csv"), "utf8").trim().split("\n").map(l => l.split(",")), column = lines[0].indexOf("radius");
    const known = new Map(lines.slice(1).map(l => [l.slice(0, 3).map(Number).join(" "), Number(l[column])]));
    const page = await open("explained.html"), panel = page.locator(".explanation"), slider = panel.getByRole("slider", { name: "Sample" });
    const told = () => page.evaluate(() => window.brioPage.drawings[0].told), samples = 1 + +await slider.getAttribute("max");
    await panel.getByLabel("show a sample").check();
    let same = 0, shown = 0;
    for (let i = 0; i < 10; i++) {
        const e = Math.floor(i * samples / 10);
        await slider.fill(String(e));
        await page.waitForFunction(async e => { const d = window.brioPage.drawings[0]; return d.told?.point === (await d.layer.explained()).points[e]; }, e);
        const rows = await page.evaluate(() => [...document.querySelectorAll(".told dt")].map(e => [e.textContent, e.nextSibling.textContent])), t = await told();
        rows.forEach(([name, value], k) => {
            if (name !== "centre") return;
            const centre = value.split(" ").map(Number), radius = +rows[k + 1][1], from = Math.hypot(...centre.map((x, k) => x - t.place[k]));
            expect(Math.abs(from - radius) < 1e-9 * radius, `a ball of ${t.point} has the radius ${radius}, and is ${from} from its sample`);
            shown++;
            same += Object.is(known.get(centre.join(" ")), radius);
        });
    }
    if (method === "power-crust") expect(shown >= 12 && same >= 10, `of ${shown} poles ${same} are those of brio medial`);
    const ticks = method === "power-crust" ? ["its cell", "co-cone", "faces taken", "faces of power cells"] : ["its cell", "co-cone", "faces taken"];
    await panel.getByRole("button", { name: "Look at it" }).click();
    await settled(page);
    let before = JSON.stringify(await picture(page));
    for (const name of ticks) {
        await panel.getByLabel(name).uncheck();
        await settled(page);
        const after = JSON.stringify(await picture(page));
        expect(after !== before, `${name} changes nothing in the picture`);
        before = after;
    }
    await page.getByLabel("faces", { exact: true }).uncheck();
    await page.focus("#canvas");
    await press(page, "o", "1");
    const wrong = await page.evaluate(() => { // pixels that are in a ball and empty, or full outside of both
        const app = window.brioPage, d = app.drawings[0], gl = app.renderer.gl, { width, height } = app.canvas, pixels = new Uint8Array(4 * width * height), m = app.camera.matrix(width, height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        const on = p => [(m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12] + 1) / 2 * width, (m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13] + 1) / 2 * height];
        const balls = d.told.poles.map(p => { const c = app.scene.fromFile(p.centre); return [...on(c), p.radius / app.scene.unit * height / 2 * Math.hypot(m[1], m[5], m[9])]; });
        const back = app.look().background.map(c => Math.round(255 * c));
        let wrong = 0, all = 0;
        for (let i = 0; i < width * height; i++) {
            const inside = balls.some(([x, y, r]) => Math.hypot(i % width + 0.5 - x, Math.floor(i / width) + 0.5 - y) < r), full = [0, 1, 2].some(k => Math.abs(pixels[4 * i + k] - back[k]) > 2);
            all += inside;
            wrong += inside !== full;
        }
        return [wrong, all, balls.map(b => b.map(Math.round)).join()];
    });
    expect(wrong[1] > 2000 && wrong[0] < 0.03 * wrong[1], `the balls are drawn with ${wrong}`);
    await page.getByLabel("faces", { exact: true }).check();
    await page.focus("#canvas"); // the key is the picture's
    await press(page, "0");
    const was = (await told()).point;
    await page.mouse.click(...await placeOf(page, await page.evaluate(async () => (await window.brioPage.drawings[0].layer.explained()).at(20).place)));
    await page.waitForFunction(was => window.brioPage.drawings[0].told.point !== was, was, { timeout: 5000 });
    const far = await page.evaluate(async () => { const d = window.brioPage.drawings[0], e = await d.layer.explained(), p = window.brioPage.picker.picks[0].place; return [e.nearest(p) === d.state.explain, Math.hypot(...p.map((x, k) => x - d.told.place[k]))]; });
    expect(far[0] && far[1] < 1, `a click tells of a sample ${far} away`);
    await page.evaluate(() => { location.hash = encodeURIComponent('{"l":{"0":{"explain":7,"cocone":false}}}'); });
    await page.waitForFunction(() => window.brioPage.drawings[0].state.explain === 7 && +document.querySelector(".explanation input[type=range]").value === 7 && window.brioPage.drawings[0].told, null, { timeout: 5000 });
    const unticked = await page.locator(".explanation").getByLabel("co-cone", { checked: false }).waitFor({ timeout: 5000 }).then(() => true, () => false);
    expect(unticked, "a new address unticks the co-cone");
    await page.context().close();
}

/** Faces on the hull have one tetrahedron, others two: of those on the hull half a face was counted. */
async function takenOnTheHull() {
    run("generate", "sphere", "-n", "60", "-o", "round.ply");
    run("surface", "round.ply", "--noise", "keep", "-o", "hull.ply", "--explain", "--view", "hull.html");
    const page = await open("hull.html"), panel = page.locator(".explanation");
    await panel.getByLabel("show a sample").check();
    await page.waitForFunction(() => document.querySelectorAll(".told dt").length > 0);
    for (const i of [3, 30]) {
        await panel.getByRole("slider", { name: "Sample" }).fill(String(i));
        await page.waitForFunction(i => window.brioPage.drawings[0].state.explain === i && document.querySelector(".told dd").textContent.endsWith(` ${window.brioPage.drawings[0].told.point}`), i);
        const [said, known] = await page.evaluate(() => {
            const d = window.brioPage.drawings[0], l = d.layer, rows = [...document.querySelectorAll(".told dt")], near = v => Math.hypot(...d.told.place.map((x, k) => x - l.meta.low[k] - l.meta.step * l.positions[3 * v + k])) < 1e-4;
            return [rows.find(e => e.textContent === "faces taken").nextSibling.textContent, [...l.triangles].filter(near).length];
        });
        expect(known > 2 && said === String(known), `${said} faces were taken, and ${known} are there`);
    }
    await page.context().close();
}

/** Balls about points have the size of their radius. */
async function balls() {
    writeFileSync(at("two.csv"), "x,y,z,radius\n0,0,0,1\n4,0,0,0.5\n");
    run("view", "two.csv", "-o", "two.html");
    const page = await open("two.html");
    await page.getByLabel("points", { exact: true }).uncheck();
    await page.getByLabel("balls of their radii").check();
    await page.focus("#canvas");
    await press(page, "o", "1", "-", "-", "-", "-");
    const seen = await picture(page), [a, b] = [await placeOf(page, [0, 0, 0]), await placeOf(page, [4, 0, 0])], unit = Math.hypot(a[0] - b[0], a[1] - b[1]) / 4;
    expect(Math.abs(seen.count - Math.PI * 1.25 * unit * unit) < 0.03 * seen.count, `${seen.count} pixels of balls, expected ${Math.PI * 1.25 * unit * unit}`);
    expect(Math.abs(seen.box[2] - seen.box[0] + 1 - 5.5 * unit) < 3 && Math.abs(seen.box[3] - seen.box[1] + 1 - 2 * unit) < 3, `balls in ${seen.box}`);
    await page.context().close();
}

/** The live figures of docs/theory.md: cells have the places that are nearest, circles of triangles and polar balls are empty, a drag
 *  changes the figure. */
async function figures() {
    const kinds = ["cells", "power", "alpha", "poles", "crust"], script = readFileSync(new URL("docs/site/figures.js", root), "utf8");
    writeFileSync(at("figures.html"), `<!doctype html><html lang="en"><title>figures</title><body>${kinds.map(k => `<div class="figure" data-figure="${k}"></div>`).join("")}<script>${script}</script></body></html>`);
    const context = await browser.newContext({ viewport: { width: 700, height: 500 }, offline: true }), page = await context.newPage();
    page.on("console", m => expect(false, `figures: ${m.text()}`));
    page.on("pageerror", e => expect(false, `figures: ${e.message}`));
    await page.goto(`file://${at("figures.html")}`);
    await page.waitForFunction(() => window.brioFigures?.every(f => f.pen));
    const picture = kind => page.evaluate(k => window.brioFigures.find(f => f.box.dataset.figure === k).canvas.toDataURL(), kind);
    const wrong = await page.evaluate(() => {
        const [cells, power, alpha, poles, crust] = window.brioFigures, out = [], far = (a, b) => (a.x - b.x) ** 2 + (a.y - b.y) ** 2;
        const inside = (cell, p) => cell.length > 2 && cell.every((a, k) => { const b = cell[(k + 1) % cell.length]; return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) >= 0; });
        for (const f of [cells, power])
            for (let i = 0; i < 400; i++) {
                const p = { x: (i * 0.618034 % 1) * 1.6, y: (i * 0.754878) % 1 }, d = f.sites.map(s => far(s, p) - s.w), best = d.indexOf(Math.min(...d));
                if (!inside(f.cells[best], p)) out.push(`${f.kind.words}: ${p.x} ${p.y} is not in cell ${best}`);
            }
        for (const t of cells.dual.triangles) if (cells.sites.some((s, i) => !t.corners.includes(i) && far(s, t.centre) < far(cells.sites[t.corners[0]], t.centre) - 1e-9)) out.push(`the circle of ${t.corners} is not empty`);
        const { edges, triangles } = alpha.filtration, n = alpha.sites.length;
        if (n - edges.length + triangles.length !== 1) out.push(`${n} points, ${edges.length} edges, ${triangles.length} triangles: no disk`);
        for (const t of triangles) for (const e of edges) if (e.ends.every(v => t.corners.includes(v)) && e.value > t.value + 1e-12) out.push("an edge comes after its triangle");
        for (const q of poles.poles) if (poles.sites.some(s => far(s, q) < far(poles.sites[poles.chosen], q) - 1e-9)) out.push("a polar ball is not empty");
        if (poles.poles.length !== 2) out.push("not two poles");
        const edgesOf = crust.crust.filter(([a, b]) => far(a, b) > 1e-14), ends = edgesOf.flat();
        const odd = ends.filter(p => ends.filter(q => far(p, q) < 1e-12).length % 2);
        if (odd.length) out.push(`the crust is not closed at ${odd.map(p => `${p.x} ${p.y}`)}`);
        if (!crust.sites.every(s => crust.crust.some(e => e.some(p => far(p, s) < 1e-12)))) out.push("the crust leaves samples out");
        return out;
    });
    expect(wrong.length === 0, wrong.slice(0, 5).join("; "));
    const before = await picture("cells"), box = await page.locator("[data-figure=cells] canvas").boundingBox();
    const site = await page.evaluate(() => window.brioFigures[0].sites[7]), place = p => [box.x + p.x / 1.6 * box.width, box.y + p.y * box.height];
    await page.mouse.move(...place(site));
    await page.mouse.down();
    await page.mouse.move(...place({ x: 0.8, y: 0.5 }), { steps: 3 });
    await page.mouse.up();
    const moved = await page.evaluate(() => window.brioFigures[0].sites[7]);
    expect(Math.hypot(moved.x - 0.8, moved.y - 0.5) < 0.02 && await picture("cells") !== before, `a drag moves a point to ${moved.x} ${moved.y}`);
    for (const kind of kinds.slice(1)) {
        const was = await picture(kind);
        await page.locator(`[data-figure=${kind}] input`).evaluate(e => { e.value = e.max; e.dispatchEvent(new Event("input")); });
        expect(await picture(kind) !== was, `the slider of ${kind} changes nothing`);
    }
    await accessible(page, "figures");
    await context.close();
}

/** At 400 pixels nothing is wider than the window, and what axe calls serious is nowhere, dark or light. */
async function narrow(name = "flaws.html") {
    const page = await open(name, { width: 400, height: 760 });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(wide <= 400, `the page is ${wide} pixels wide`);
    const box = await page.locator("#canvas").boundingBox();
    expect(box.width > 390 && box.height > 250, `the picture is ${box.width} by ${box.height}`);
    expect((await picture(page)).count > 2000, "the narrow picture is empty");
    await accessible(page, "narrow");
    await page.getByRole("button", { name: "Dark" }).click();
    await accessible(page, "narrow and dark");
    await page.context().close();
}

/** Texts of files are texts. */
async function injection() {
    const evil = "<img src=x onerror=alert(1)>";
    writeFileSync(at(`${evil}.csv`), "x,y,z,</script><script>alert(2)</script>,\u202e\u2028turned\n0,0,0,1,1\n1,0,0,2,2\n0,1,0,3,3\n");
    run("view", `${evil}.csv`, `${evil}.csv`, "--side-by-side", "--title", evil, "-o", "evil.html");
    const page = await open("evil.html");
    page.on("dialog", () => expect(false, "a script of a file's name ran"));
    expect(await page.textContent("h1") === evil && await page.locator("img").count() === 0, "a name became an element");
    const names = await page.getByLabel("Colour by").first().textContent();
    expect(names.includes("script"), "the property is listed by its name");
    expect(names.includes("turned") && !names.includes("\u202e"), "a mark of direction turns what stands behind it");
    await page.context().close();
}

/** What an address says of layers is taken only where it makes sense; a new address sets the panel and the buttons, too. */
async function addresses() {
    const page = await open("heights.html", { hash: "#" + encodeURIComponent('{"l":{"0":{"map":"constructor","low":1}}}') });
    expect((await picture(page)).count > 50, "a map that there is not empties the picture");
    await page.context().close();
    await (await open("heights.html", { hash: "#" + encodeURIComponent('{"c":[0,0,0,0,0,0,2,0],"l":{"0":5}}') })).context().close();
    const other = await open("bumps.html");
    await other.evaluate(() => { location.hash = encodeURIComponent('{"d":1,"l":{"0":{"wire":true}}}'); });
    await settled(other);
    expect(await other.getByLabel("wireframe").isChecked(), "a new address ticks the wireframe");
    expect(await other.getByRole("button", { name: "Dark" }).getAttribute("aria-pressed") === "true", "a new address presses Dark");
    await other.getByLabel("wireframe").focus();
    await press(other, "o");
    expect(await other.evaluate(() => window.brioPage.camera.parallel), "a letter works while a box to tick has the focus");
    await other.context().close();
}

/** Values whose difference is no double, infinities and NaN; coordinates of such a box; a layer without points beside others. */
async function extremes() {
    const rows = ["-1.5e308", "1.5e308", "nan", "inf", "0", "7e307"];
    writeFileSync(at("heights.csv"), ["x,y,z,value", ...rows.map((v, i) => `${i},${i % 2},${i % 3},${v}`)].join("\n") + "\n");
    run("view", "heights.csv", "-o", "heights.html");
    let page = await open("heights.html");
    const shown = await page.evaluate(() => { const d = window.brioPage.drawings[0]; return [...d.values].map(x => d.part(x)).sort((a, b) => a - b); });
    expect(shown.slice(0, 4).every((x, i) => Math.abs(x - [0, 0.5, 0.7333333, 1][i]) < 1e-6) && shown[4] > 1e30, `parts ${shown}`);
    expect((await page.evaluate(() => { const d = window.brioPage.drawings[0].range(); return d.join(); })) === "0,1", "the range is that of the finite values");
    await page.context().close();
    writeFileSync(at("wide.csv"), "x,y,z\n-1e308,0,0\n1e308,1,2\n5e307,-8e307,1e308\n");
    run("view", "wide.csv", "-o", "wide.html");
    page = await open("wide.html");
    expect((await picture(page)).count > 20, "a box wider than doubles is empty");
    await page.context().close();
    writeFileSync(at("empty.ply"), "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
    writeFileSync(at("far.csv"), "x,y,z\n500000,5000000,100\n500001,5000000,100\n500000,5000001,101\n");
    run("view", "empty.ply", "far.csv", "-o", "beside.html");
    page = await open("beside.html");
    expect(await page.evaluate(() => window.brioPage.scene.unit) < 1, "a layer without points draws the scene to the origin");
    await page.context().close();
    run("view", "empty.ply", "-o", "empty.html");
    await (await open("empty.html")).context().close();
}

/** A large mesh is rounded, and what is picked says so, in digits that mean something. */
async function rounded() {
    const [vertices, faces] = bumps(501);
    ply("rounded.ply", vertices, faces, { vertex: "double depth;float nx;float ny;float nz", rows: i => `${i === 7 ? "inf" : i / 3} 0 0 1` });
    run("view", "rounded.ply", "-o", "rounded.html");
    const page = await open("rounded.html"), box = await page.locator("#canvas").boundingBox();
    const notes = await page.locator("#panel .note").allTextContents();
    expect(notes.some(n => /16 bits/.test(n) && /no numbers/.test(n)) && notes.some(n => /normals/.test(n)), `notes ${notes}`);
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#card:not([hidden])");
    const card = await page.evaluate(() => [...document.querySelectorAll("#card dt")].map(e => [e.textContent, e.nextSibling.textContent]));
    for (const [name, value] of card) expect(!/^-?\d/.test(value) || value.replace(/e.*|[-.]/g, "").replace(/^0+/, "").length < 9, `${name} ${value} has digits that say nothing`);
    expect(/16 bits/.test(await page.textContent("#card .note")), "the card does not say that properties are rounded");
    const value = await page.evaluate(async () => { const l = window.brioPage.drawings[0].layer, p = l.meta.properties.find(p => p.name === "depth"); return (await l.property("v", p)).findIndex(Number.isNaN); });
    expect(value >= 0, "an infinite value is no number where it is rounded");
    await page.context().close();
}

/** Colours of faces are none of points; those of vertices come back; the section of tetrahedra has no stale colours. */
async function coloursOfFaces() {
    ply("faces.ply", CUBE, QUADS, { vertex: "double depth", rows: i => i, face: "double mark", marks: i => 10 * i });
    run("view", "faces.ply", "-o", "faces.html");
    const page = await open("faces.html");
    await page.getByLabel("Colour by").selectOption("v0");
    await page.getByLabel("points", { exact: true }).check();
    await page.getByLabel("faces", { exact: true }).uncheck();
    await page.getByLabel("Colour by").selectOption("f0");
    await page.waitForFunction(() => window.brioPage.drawings[0].expanded);
    const modes = await page.evaluate(() => { const a = window.brioPage; return a.drawings[0].items(false, 1e6, null, a.look().colours).map(i => [i.program, i.mode].join()); });
    expect(modes.includes("points,0"), `points have colours of faces: ${modes}`);
    await page.context().close();
}

/** The graphics card goes and comes back: the picture is as before. Browsers without what the page needs get a sentence. */
async function lost() {
    const page = await open("faces.html");
    const before = await picture(page);
    await page.evaluate(() => { window.losing = window.brioPage.renderer.gl.getExtension("WEBGL_lose_context"); window.losing.loseContext(); });
    await page.waitForFunction(() => /graphics card/.test(document.getElementById("status").textContent));
    await page.mouse.click(200, 200);
    await page.evaluate(() => window.losing.restoreContext());
    await page.waitForFunction(() => !window.brioPage.lost);
    await settled(page);
    const after = await picture(page);
    expect(after.count === before.count && after.mean.every((x, k) => Math.abs(x - before.mean[k]) < 0.5), `after the loss ${JSON.stringify(after)}, before ${JSON.stringify(before)}`);
    await page.context().close();
    for (const [words, without] of [["WebGL 2", "HTMLCanvasElement.prototype.getContext = () => null"], ["DecompressionStream", "delete window.DecompressionStream"]]) {
        const context = await browser.newContext({ offline: true }), old = await context.newPage();
        await old.addInitScript(without);
        await old.goto(`file://${at("faces.html")}`);
        await old.waitForSelector("#status.failed");
        expect((await old.textContent("#status")).includes(words), `without ${words}: ${await old.textContent("#status")}`);
        await context.close();
    }
}

/** Opens a page and moves it; says how long that took. */
async function measure(name, words) {
    const began = Date.now(), page = await open(name), seconds = (Date.now() - began) / 1000, first = await page.evaluate(() => window.brioPage.firstPicture / 1000);
    await page.evaluate(() => { window.brioPage.longest = 0; });
    const box = await page.locator("#canvas").boundingBox();
    await page.mouse.move(box.x + 300, box.y + 300);
    await page.mouse.down();
    for (let i = 0; i < 20; i++) { await page.mouse.move(box.x + 300 + 5 * i, box.y + 300); await page.waitForTimeout(30); }
    const longest = await page.evaluate(() => window.brioPage.longest);
    await page.mouse.up();
    await settled(page);
    const size = statSync(at(name)).size / 1e6;
    console.log(`${words}: ${size.toFixed(1)} MB, ${first.toFixed(1)} s to the first picture, ${seconds.toFixed(1)} s to the whole one, longest block while moving ${longest.toFixed(0)} ms`);
    await page.context().close();
    return { size, longest, first, seconds };
}

/** What docs/view.md says of times, on a machine that does nothing else: the page of a scan of 35,000 points, and of 2 million triangles. */
async function bench() {
    const empty = statSync(new URL("web/page.html", root)).size / 1e3;
    console.log(`the page without data: ${empty.toFixed(0)} kB`);
    expect(empty < 250, "the page without data has 250 kB");
    run("generate", "scan", "-n", "35000", "-o", "scan.ply");
    run("surface", "scan.ply", "-o", "surface.ply");
    run("view", "surface.ply", "-o", "surface.html");
    expect((await measure("surface.html", "a surface of 35,000 points")).first < 1, "it is not seen within a second");
    const { first, seconds } = await large();
    expect(first < 5 && seconds < 10, "2 million triangles are not seen within five seconds");
}

/** Clouds, also of a million points: thinned while it moves; no frame blocks. */
async function large() {
    let state = 1;
    const noise = () => (state = (state * 48271) % 2147483647) / 2147483647;
    const n = 1001, vertices = [], faces = [];
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) vertices.push([i + 0.3 * noise(), j + 0.3 * noise(), 30 * Math.sin(i / 60) * Math.cos(j / 45) + 0.3 * noise()]);
    for (let i = 0; i + 1 < n; i++) for (let j = 0; j + 1 < n; j++) faces.push([i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1], [i * n + j, (i + 1) * n + j + 1, i * n + j + 1]);
    ply("large.ply", vertices, faces);
    run("view", "large.ply", "-o", "large.html");
    const mesh = await measure("large.html", "2 million triangles");
    expect(mesh.size < 15, `the page of 2 million triangles has ${mesh.size} MB`);
    expect(mesh.longest < 100, `a frame took ${mesh.longest} ms`);
    run("generate", "sphere", "-n", "2000000", "-o", "cloud.npy");
    run("view", "cloud.npy", "-o", "cloud.html");
    const cloud = await measure("cloud.html", "2 million points");
    expect(cloud.longest < 100, `a frame took ${cloud.longest} ms`);
    return mesh;
}

const SHORT = { silhouetteAndColour, filled, shades, complexes, picking, explained, takenOnTheHull, narrowed: () => narrow("explained.html"), injection, alphas, apart, figures };
const LONG = { silhouetteAndColour, filled, shades, complexes, picking, controls, moving, tetrahedra, alphas, apart, balls, explained, takenOnTheHull, labeled: () => explained("labeled-delaunay"), figures, narrow, narrowed: () => narrow("explained.html"), injection, extremes, addresses, rounded, coloursOfFaces, lost, large };
try {
    for (const [name, test] of Object.entries({ short: SHORT, long: LONG, bench: { bench } }[length])) {
        const began = Date.now();
        try { await test(); } catch (error) { expect(false, `${name}: ${error.stack}`); }
        if (length === "long") console.log(`${name}: ${((Date.now() - began) / 1000).toFixed(1)} s`);
    }
} finally {
    await browser.close();
    rmSync(folder, { recursive: true, force: true });
}
console.log(`${checks} checks, ${failures} failures`);
process.exit(failures ? 1 : 0);
