// The page that takes a file, in Chromium: node drop_test.mjs BRIO PAGE.html [long]. Files of twelve formats, which the program makes,
// are dropped; one becomes a surface with its certificate and is saved; a call is stopped; a broken file says what is wrong. No page may
// ask for anything, or complain on the console. `bench` in place of `long` makes a surface of 60,000 points and says how long it took.
//
// Exit status 77, with the reason: a part is missing (sh scripts/setup.sh web; make page).
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [, , brio, html, length = "short"] = process.argv;
const root = new URL("../../", import.meta.url);
const chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
const packages = new URL("out/web-env/package.json", root);
function skip(reason) {
    console.log(`skipped: ${reason}`);
    process.exit(77);
}
if (!existsSync(html)) skip(`there is no ${html} (make page)`);
if (!chromium) skip("there is no Chromium (sh scripts/setup.sh web)");
if (!existsSync(packages)) skip("out/web-env is missing (sh scripts/setup.sh web)");
const require = createRequire(packages);
let playwright;
try { playwright = require("playwright-core"); } catch { skip("playwright-core is missing (sh scripts/setup.sh web)"); }
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const folder = mkdtempSync(join(tmpdir(), "brio-drop-")), at = name => join(folder, name);
const run = (...args) => execFileSync(brio, [...args, "--quiet"], { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
let failures = 0, checks = 0;
function expect(truth, words) {
    checks++;
    if (truth) return;
    failures++;
    console.log(`FAILED: ${words}`);
}

const browser = await playwright.chromium.launch({ executablePath: chromium, args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"] });

/** Opens the page, and watches what it asks for and says. */
async function open({ width = 900, height = 600, ...more } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, offline: true, acceptDownloads: true, ...more }), page = await context.newPage();
    page.on("console", m => expect(m.type() === "log", `console ${m.type()}: ${m.text()}`));
    page.on("pageerror", e => expect(false, e.message));
    page.on("request", r => expect(r.url() === `file://${html}` || r.url().startsWith("blob:"), `asks for ${r.url()}`));
    await page.goto(`file://${html}`);
    await page.evaluate(() => window.brioPage.ready);
    return page;
}
/** Drops a file on the page, as a hand does, and waits for what becomes of it. */
async function drop(page, name, wait = true) {
    const data = await page.evaluateHandle(([text, name]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], name));
        return transfer;
    }, [readFileSync(at(name)).toString("base64"), name]);
    await page.dispatchEvent("#stage", "dragover", { dataTransfer: data });
    await page.dispatchEvent("#stage", "drop", { dataTransfer: data });
    if (wait) await page.evaluate(() => window.brioDrop.ready);
}
const wrong = page => page.textContent(".wrong"), done = page => page.textContent(".done");
/** Waits until the picture is whole; page_test.mjs says why not by waitForFunction. */
const settled = page => page.evaluate(async () => {
    const app = window.brioPage, end = performance.now() + 60000;
    do await new Promise(f => requestAnimationFrame(() => requestAnimationFrame(f))); while (!(app.complete && !app.dirty) && performance.now() < end);
    if (!app.complete || app.dirty) throw new Error("the picture is not whole after a minute");
});
/** The pixels of the picture that differ from the background. */
const seen = page => page.evaluate(() => {
    const app = window.brioPage, gl = app.renderer.gl, { width, height } = app.canvas, p = new Uint8Array(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, p);
    const back = app.look().background.map(c => Math.round(255 * c));
    let count = 0;
    for (let i = 0; i < p.length; i += 4) if ([0, 1, 2].some(k => Math.abs(p[i + k] - back[k]) > 2)) count++;
    return count;
});
async function accessible(page, words) {
    await page.evaluate(axe);
    const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    for (const v of found.violations.filter(v => ["serious", "critical"].includes(v.impact)))
        expect(false, `${words}: axe: ${v.id}: ${v.nodes.map(n => n.html).join(" ").slice(0, 300)}`);
    checks++;
}

// --- tests ---

const FORMATS = ["ply", "obj", "off", "stl", "vtu", "vtp", "vtk", "csv", "npy", "las", "laz", "pcd", "ptx", "pts", "ply.gz"];
const FACES = ["ply", "obj", "off", "stl", "vtu", "vtp", "vtk"]; // of the ball; the others get its points

/** Files of all formats are read and shown, with as many points as they have. */
async function formats() {
    run("generate", "sphere", "-n", "400", "-o", "points.ply");
    run("surface", "points.ply", "-o", "ball.ply");
    const count = new Map(), page = await open(), one = length === "short" ? ["stl", "laz", "csv"] : FORMATS;
    for (const format of one) {
        const name = `ball.${format}`;
        if (format === "ptx") { // read, not written
            const rows = run("convert", "points.ply", "-", "--format", "xyz").toString().trim().split("\n");
            writeFileSync(at(name), ["20", "20", "0 0 0", "1 0 0", "0 1 0", "0 0 1", "1 0 0 0", "0 1 0 0", "0 0 1 0", "0 0 0 1", ...rows.filter(r => /^[-\d.]/.test(r)).map(r => r.split(/[\s,]+/).slice(0, 3).join(" ") + " 0.5")].join("\n") + "\n");
        } else if (format === "ply.gz") writeFileSync(at(name), (await import("node:zlib")).gzipSync(readFileSync(at("ball.ply"))));
        else if (format !== "ply") run("convert", FACES.includes(format) ? "ball.ply" : "points.ply", name);
        await drop(page, name);
        const facts = await page.evaluate(() => { const d = window.brioPage.drawings[0]; return d && { name: d.layer.meta.name, vertices: d.layer.meta.vertices, faces: d.layer.meta.faces }; });
        count.set(format, facts?.vertices);
        expect(await wrong(page) === "", `${name}: ${await wrong(page)}`);
        expect(facts?.name === name && facts.vertices === 400, `${name}: ${JSON.stringify(facts)}`);
        expect(!FACES.includes(format) || facts?.faces === 796, `${name}: ${facts?.faces} faces`);
        await settled(page);
        expect(await seen(page) > 1000, `${name}: the picture is empty`);
    }
    await page.context().close();
    if (length === "long") console.log(`${count.size} formats`);
}

/** A surface by the button, by keys alone; its certificate; the files that are saved are read again. */
async function surface() {
    if (!existsSync(at("points.ply"))) run("generate", "sphere", "-n", "400", "-o", "points.ply");
    const page = await open();
    await drop(page, "points.ply");
    await page.getByRole("button", { name: "Reconstruct" }).focus();
    await page.keyboard.press("Enter");
    await page.evaluate(() => window.brioDrop.ready);
    expect(await page.evaluate(() => document.activeElement.textContent) === "Reconstruct", "the focus went away");
    expect(/^Surface in .* s: closed, manifold, oriented, genus 0, 0 crossing pairs of faces/.test(await done(page)), `said ${await done(page)}, ${await wrong(page)}`);
    expect((await page.textContent("#panel")).includes("crossing faces0 pairs"), "the panel has the certificate");
    await settled(page);
    expect(await seen(page) > 5000, "the surface is not seen");
    run("surface", "points.ply", "-o", "ours.ply");
    for (const format of length === "short" ? ["ply"] : ["ply", "stl", "obj", "glb"]) {
        await page.getByLabel("Format").selectOption(format);
        const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Download" }).click()]);
        expect(download.suggestedFilename() === `points-surface.${format}`, `saved as ${download.suggestedFilename()}`);
        await download.saveAs(at(`saved.${format}`));
        if (format === "ply") {
            for (const name of ["saved", "ours"]) run("convert", `${name}.ply`, `${name}.off`);
            expect(readFileSync(at("saved.off")).equals(readFileSync(at("ours.off"))), "the surface that was saved is not the program's");
        }
        const info = JSON.parse(run("info", `saved.${format}`, "--json").toString());
        expect(info.points === 400 && info.faces === 796, `saved.${format}: ${info.points} vertices, ${info.faces} faces`);
    }
    await page.context().close();
}

/** How the surface came to be is told, where it is asked for: of each method, with polar balls that pass through their sample, and the faces
 *  that the mesh has there; by a finger, too, dark, and at 400 pixels. */
async function explained() {
    if (!existsSync(at("points.ply"))) run("generate", "sphere", "-n", "400", "-o", "points.ply");
    const page = await open({ width: 400, height: 760, hasTouch: true });
    await drop(page, "points.ply");
    const make = async method => {
        await page.getByLabel("Method").selectOption(method);
        await page.getByRole("button", { name: "Reconstruct" }).click();
        await page.evaluate(() => window.brioDrop.ready);
        expect(/^Surface/.test(await done(page)), `${method}: ${await done(page)} ${await wrong(page)}`);
    };
    await make("labeled");
    expect(await page.locator(".explanation").count() === 0, "an explanation is there that nobody asked for");
    await page.getByLabel("tell how it comes to be").tap();
    for (const method of length === "short" ? ["labeled"] : ["power-crust", "cocone", "tight-cocone", "labeled"]) {
        await make(method);
        await page.locator(".explanation").getByLabel("show a sample").tap();
        await page.getByRole("slider", { name: "Sample" }).fill("150");
        await page.waitForFunction(async () => { const d = window.brioPage.drawings[0]; return d.told?.point === (await d.layer.explained()).points[150]; });
        const facts = await page.evaluate(() => {
            const d = window.brioPage.drawings[0], t = d.told, l = d.layer, far = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
            return { balls: t.poles.filter(p => Number.isFinite(p.radius)).map(p => far(p.centre, t.place) / p.radius), tetrahedra: t.tetrahedra.length,
                taken: [...l.triangles].filter(v => far([0, 1, 2].map(k => l.meta.low[k] + l.meta.step * l.positions[3 * v + k]), t.place) < 1e-4).length };
        });
        const rows = await page.evaluate(() => [...document.querySelectorAll(".told dt")].map(e => [e.textContent, e.nextSibling.textContent]));
        expect(facts.balls.length > 0 && facts.balls.every(x => Math.abs(x - 1) < 1e-9) && facts.tetrahedra > 3, `${method}: ${JSON.stringify(facts)}`);
        if (method !== "power-crust") expect(rows.find(r => r[0] === "faces taken")?.[1] === String(facts.taken), `${method}: ${JSON.stringify(rows)}, ${facts.taken} faces`);
    }
    const before = await page.evaluate(() => window.brioPage.drawings[0].told.point), box = await page.locator("#canvas").boundingBox();
    await page.touchscreen.tap(box.x + box.width / 2 + 20, box.y + box.height / 2 - 20);
    await page.waitForFunction(was => window.brioPage.drawings[0].told.point !== was, before, { timeout: 5000 });
    await accessible(page, "explained");
    await page.getByRole("button", { name: "Dark" }).tap();
    await accessible(page, "explained and dark");
    expect(await page.evaluate(() => document.documentElement.scrollWidth) <= 400, "wider than the window");
    await page.context().close();
}

/** Cancel ends a call; the page goes on. A broken file says what is wrong; what was there stays. */
async function stopped() {
    run("generate", "sphere", "-n", length === "short" ? "30000" : "200000", "-o", "many.npy");
    writeFileSync(at("broken.ply"), "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n");
    const page = await open();
    await drop(page, "many.npy");
    await page.getByRole("button", { name: "Reconstruct" }).click();
    await page.waitForSelector(".running:not([hidden])");
    await page.waitForFunction(() => /: /.test(document.querySelector(".stage").textContent));
    await page.getByRole("button", { name: "Cancel" }).click();
    await page.evaluate(() => window.brioDrop.ready);
    expect(await done(page) === "Cancelled." && await page.isHidden(".running"), `after Cancel: ${await done(page)}`);
    await drop(page, "broken.ply");
    expect(/^broken\.ply: /.test(await wrong(page)), `a broken file: ${await wrong(page)}`);
    expect(await page.evaluate(() => window.brioPage.drawings[0].layer.meta.name) === "many.npy", "the file before it stays");
    await drop(page, "points.ply");
    expect(await wrong(page) === "" && /points/.test(await done(page)), "the page goes on");
    await page.getByRole("button", { name: "Reconstruct" }).click();
    await page.evaluate(() => window.brioDrop.ready);
    expect(/^Surface/.test(await done(page)), `a surface after Cancel: ${await done(page)} ${await wrong(page)}`);
    await page.context().close();
}

/** At 400 pixels, light and dark, empty and with a surface: nothing is wider than the window, and axe finds nothing serious. */
async function narrow() {
    const page = await open({ width: 400, height: 760 });
    await accessible(page, "empty");
    await drop(page, "points.ply");
    await page.getByRole("button", { name: "Reconstruct" }).click();
    await page.evaluate(() => window.brioDrop.ready);
    expect(await page.evaluate(() => document.documentElement.scrollWidth) <= 400, "wider than the window");
    await accessible(page, "with a surface");
    await page.getByRole("button", { name: "Dark" }).click();
    await accessible(page, "dark");
    await page.context().close();
}

/** Processor time of this process' descendants, the browser's, in seconds: of Linux. */
function used(parent = process.pid) {
    const children = execFileSync("ps", ["-eo", "pid=,ppid=,cputimes="]).toString().trim().split("\n").map(l => l.trim().split(/\s+/).map(Number));
    const sum = of => children.filter(([, ppid]) => ppid === of).reduce((s, [pid, , seconds]) => s + seconds + sum(pid), 0);
    return sum(parent);
}
/** A surface of 60,000 points: seconds in the worker, and until it is seen. */
async function measured() {
    run("generate", "torus", "-n", "60000", "-o", "torus.npy");
    const page = await open();
    await drop(page, "torus.npy");
    const began = Date.now(), before = used();
    await page.getByRole("button", { name: "Reconstruct" }).click();
    await page.evaluate(() => window.brioDrop.ready);
    const all = (Date.now() - began) / 1000, last = await page.evaluate(() => window.brioDrop.last);
    expect(last.seconds < 5, `the surface of 60,000 points took ${last.seconds} s`);
    console.log(`60,000 points: ${last.seconds.toFixed(2)} s for the surface and its certificate, ${all.toFixed(2)} s until it is shown, ${used() - before} s of processor time of the whole browser; ${await done(page)}`);
    await page.context().close();
}

try {
    for (const [name, test] of Object.entries(length === "bench" ? { measured } : { formats, surface, explained, stopped, narrow })) {
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
