// The buttons above the picture. Icons are strokes in a square of 24.
import { at, make } from "./dom.js";

const NS = "http://www.w3.org/2000/svg";
function icon(path) {
    const svg = document.createElementNS(NS, "svg"), stroke = document.createElementNS(NS, "path");
    svg.setAttribute("viewBox", "0 0 24 24");
    svg.setAttribute("aria-hidden", "true");
    stroke.setAttribute("d", path);
    svg.append(stroke);
    return svg;
}

async function save(app) {
    const link = make("a", { href: URL.createObjectURL(await app.picture()), download: `${document.title.replace(/[^\w.-]+/g, "_") || "picture"}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    app.say("The picture was saved.");
}
async function copy(app) {
    if (location.protocol === "about:") return app.say("A page within another one has no address. Save it as a file first.");
    try {
        await navigator.clipboard.writeText(location.href);
        app.say("The address of this view was copied.");
    } catch {
        app.say("The address bar has this view; copy it from there.");
    }
}

/** Fills the toolbar; returns [{name, key, button}]. */
export function tools(app) {
    const narrow = matchMedia("(max-width: 700px)").matches;
    const list = [
        ["Reset the view", "r", "M4 12a8 8 0 1 0 2.6-5.9M4 4v5h5", () => app.resetView()],
        ["Parallel projection", "o", "M4 8l8-4 8 4v8l-8 4-8-4zM4 8l8 4 8-4M12 12v8", on => { app.camera.parallel = on; app.redraw(true); }, () => app.camera.parallel],
        app.drawings.length > 1 && ["Side by side", "s", "M4 5h7v14H4zM13 5h7v14h-7z", on => { app.beside = on; app.fit(); app.redraw(); }, () => app.beside],
        ["Measure between two vertices", "m", "M4 17L17 4l3 3L7 20zM8 13l2 2M11 10l2 2M14 7l2 2", on => { app.picker.measuring = on; document.body.classList.toggle("measuring", on); app.say(on ? "Pick two vertices." : app.summary()); }, () => app.picker.measuring],
        ["Save a picture", "p", "M12 4v11m-4-4l4 4 4-4M4 19h16", () => save(app)],
        ["Copy the address of this view", "c", "M10 14l4-4M8.5 11.5l-3 3a3 3 0 0 0 4 4l3-3M15.5 12.5l3-3a3 3 0 0 0-4-4l-3 3", () => copy(app)],
        ["Dark", "d", "M20 14A8 8 0 1 1 10 4a6.5 6.5 0 0 0 10 10z", on => app.setTheme(on ? "dark" : "light"), () => app.theme === "dark"],
        document.fullscreenEnabled && ["Full screen", "f", "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5", () => document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()],
        ["Help", "h", "M9 9a3 3 0 1 1 4 2.8c-.7.3-1 .9-1 1.7M12 17.5v.1M12 3a9 9 0 1 0 .01 0", () => document.body.classList.toggle("quiet")],
        ["Layers", "l", "M12 4l8 4-8 4-8-4zM4 12l8 4 8-4M4 16l8 4 8-4", on => document.body.classList.toggle("folded", !on), () => !document.body.classList.contains("folded")],
    ].filter(Boolean);
    if (narrow) document.body.classList.add("quiet");
    const made = list.map(([name, key, path, act, pressed]) => {
        const button = make("button", { type: "button", title: `${name} (${key})`, "aria-label": name }, icon(path));
        const sync = () => { if (pressed) button.setAttribute("aria-pressed", String(!!pressed())); };
        button.addEventListener("click", () => { act(pressed ? !pressed() : undefined); sync(); });
        sync();
        return { name, key, button, sync };
    });
    at("tools").replaceChildren(...made.map(t => t.button));
    return made;
}
