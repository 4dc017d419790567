// Bundles src/main.js, src/page.css and src/page.html into page.html, which CMake turns into arrays of C. Called with node
// build.mjs; the packages of package.json are in ../out/web-env (sh ../scripts/setup.sh web). The first line of page.html has
// the hash of all sources, so that tests/cli/test_view.py sees a stale bundle without node.
import { createHash } from "node:crypto";
import { createRequire } from "node:module";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = new URL("./", import.meta.url);
const require = createRequire(new URL("../out/web-env/package.json", here));
const { buildSync, transformSync } = require("esbuild");
const text = name => readFileSync(new URL(`src/${name}`, here), "utf8");

const hash = createHash("sha256");
for (const name of readdirSync(new URL("src/", here)).sort()) hash.update(`${name}\n${text(name)}`);

const program = buildSync({
    entryPoints: [fileURLToPath(new URL("src/main.js", here))],
    bundle: true, minify: true, write: false, format: "iife", target: "es2022", charset: "utf8", legalComments: "none",
}).outputFiles[0].text;
const style = transformSync(text("page.css"), { loader: "css", minify: true, charset: "utf8" }).code;
const body = text("page.html").replace(/\n\s*/g, "\n").replace(/<!--(?!DATA)[^>]*-->\n/g, "");
const page = body.replace("/*STYLE*/", () => style.trim()).replace("/*PROGRAM*/", () => program.trim().replaceAll("</", "<\\/"))
    .replace("HASH", hash.digest("hex"));
writeFileSync(new URL("page.html", here), page);
console.log(`page.html: ${page.length} characters`);
