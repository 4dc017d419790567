// Bundles src/main.js, src/page.css and src/page.html into page.html, which CMake turns into arrays of C. Called with node
// build.mjs; the packages of package.json are in ../out/web-env (sh ../scripts/setup.sh web). The first line of page.html has
// the hash of all sources, so that tests/cli/test_view.py sees a stale bundle without node.
//
// With two names, node build.mjs BRIO.wasm OUT.html bundles the page that takes a file: the same, with drop/ and the module in it.
import { createHash } from "node:crypto";
import { createRequire } from "node:module";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = new URL("./", import.meta.url);
const require = createRequire(new URL("../out/web-env/package.json", here));
const { buildSync, transformSync } = require("esbuild");
const text = name => readFileSync(new URL(name, here), "utf8");

// Lines that begin with blanks are those of shaders.
const bundled = name => buildSync({
    entryPoints: [fileURLToPath(new URL(name, here))], bundle: true, minify: true, write: false, format: "iife", target: "es2022", charset: "utf8",
    legalComments: "none", external: ["node:*"], define: { "import.meta.url": "''" }, // of the package's ways to find its files
}).outputFiles[0].text.trim().replace(/\n +/g, "\n").replaceAll("</", "<\\/");
const styled = css => transformSync(css, { loader: "css", minify: true, charset: "utf8" }).code.trim();
const body = text("src/page.html").replace(/\n\s*/g, "\n").replace(/<!--(?!DATA)[^>]*-->\n/g, "");
const filled = (page, style, program, hash) => page.replace("/*STYLE*/", () => style).replace("/*PROGRAM*/", () => program).replace("HASH", hash);

const [, , wasm, out] = process.argv;
if (wasm) {
    // The rule of this page allows what its worker and its module need, and no request either.
    const rule = body.replace("script-src 'unsafe-inline'", "script-src 'unsafe-inline' 'wasm-unsafe-eval'; worker-src blob:").replace("<title>brio</title>", "<title>brio: a surface from your file</title>");
    const data = `<script type="application/json" id="scene">{"title":"brio"}</script>\n<script type="text/plain" id="worker">${bundled("drop/worker.js")}</script>\n`
        + `<script type="text/plain" id="wasm">${gzipSync(readFileSync(wasm), { level: 9 }).toString("base64")}</script>\n`
        + `<script type="text/plain" id="notices">${readFileSync(join(dirname(wasm), "NOTICES"), "utf8").replaceAll("</", "<\\/")}</script>`; // of what is in the module
    const page = filled(rule, styled(text("src/page.css") + text("drop/drop.css")), bundled("drop/main.js"), "drop").replace("<!--DATA-->", () => data);
    writeFileSync(out, page);
    console.log(`${out}: ${page.length} characters`);
} else {
    const hash = createHash("sha256");
    for (const name of readdirSync(new URL("src/", here)).sort()) hash.update(`${name}\n${text(`src/${name}`)}`);
    const page = filled(body, styled(text("src/page.css")), bundled("src/main.js"), hash.digest("hex"));
    writeFileSync(new URL("page.html", here), page);
    console.log(`page.html: ${page.length} characters`);
}
