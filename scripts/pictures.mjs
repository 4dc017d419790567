// Pictures of pages that brio wrote, as Chromium shows them: node pictures.mjs FOLDER OUT NAME... takes FOLDER/NAME.html, and writes OUT/NAME.jpg.
import { createRequire } from "node:module";
import { existsSync, mkdirSync } from "node:fs";
import { join, resolve } from "node:path";

const [, , folder, out, ...names] = process.argv;
const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
const { chromium } = createRequire(new URL("../out/web-env/package.json", import.meta.url))("playwright-core");
const browser = await chromium.launch({ executablePath, args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"] });
mkdirSync(out, { recursive: true });
for (const name of names) {
    const page = await browser.newPage({ viewport: { width: 900, height: 560 } });
    await page.goto("file://" + resolve(folder, `${name}.html`));
    await page.click("#hint");
    await page.waitForTimeout(3000);
    await page.screenshot({ path: join(out, `${name}.jpg`), type: "jpeg", quality: 80 });
    await page.close();
}
await browser.close();
