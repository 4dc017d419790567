// The view in the address behind the #: the camera, the plane, and what of each layer is not as at first. The program takes
// nothing from there but numbers, and words that it knows.
import { MAPS } from "./colours.js";

const SWITCHES = ["visible", "faces", "points", "wire", "edges", "boundary", "nonmanifold", "flipped", "crossing", "bridges", "flat", "balls", "cell", "polar", "cocone", "labels", "taken", "power"];

export function writeAddress(app) {
    const c = app.scene.cutting, view = { c: app.camera.toArray() };
    if (app.beside) view.b = 1;
    view.d = +(app.theme === "dark");
    view.p = [+c.on, c.axis, c.at, +c.flip];
    const layers = {};
    app.drawings.forEach((d, i) => {
        const changed = {};
        for (const [key, value] of Object.entries(d.state)) if (value !== app.initial[i][key] && key !== "keepRange") changed[key] = value;
        if (d.mode !== 2) delete changed.low, delete changed.high;
        if (Object.keys(changed).length) layers[i] = changed;
    });
    if (Object.keys(layers).length) view.l = layers;
    const text = "#" + encodeURIComponent(JSON.stringify(view));
    app.address = text;
    if (text !== location.hash) try { history.replaceState(null, "", text); } catch { /* a page in a frame has no address */ }
}

/** Takes over what the address says; returns whether it says something new. */
export function readAddress(app) {
    if (location.hash.length < 2 || location.hash === app.address) return false;
    let view;
    try { view = JSON.parse(decodeURIComponent(location.hash.slice(1))); } catch { return false; }
    if (!view || typeof view !== "object") return false;
    const c = app.scene.cutting;
    app.addressed = true;
    if (Array.isArray(view.c)) app.camera.fromArray(view.c.map(Number));
    app.beside = !!view.b;
    if ("d" in view) app.setTheme(view.d ? "dark" : "light");
    if (Array.isArray(view.p)) Object.assign(c, { on: !!view.p[0], axis: [0, 1, 2].includes(view.p[1]) ? view.p[1] : 0, at: Math.max(0, Math.min(1, +view.p[2] || 0)), flip: !!view.p[3] });
    app.drawings.forEach((d, i) => {
        const given = (view.l || {})[i], layer = given && typeof given === "object" ? given : {}, s = Object.assign(d.state, app.initial[i]);
        for (const key of SWITCHES) if (key in layer) s[key] = !!layer[key];
        if (["plain", "colours", "face-colours", ...d.layer.sources().map(x => x.id)].includes(layer.source)) s.source = layer.source;
        if (Object.hasOwn(MAPS, layer.map)) s.map = layer.map;
        if (Number.isFinite(layer.opacity)) s.opacity = Math.max(0.1, Math.min(1, layer.opacity));
        if (Number.isFinite(layer.pointSize)) s.pointSize = Math.max(1, Math.min(16, layer.pointSize));
        if (Number.isFinite(layer.alpha)) s.alpha = Math.max(0, Math.min(1, layer.alpha));
        if (d.layer.meta.explanation && Number.isInteger(layer.explain)) s.explain = Math.max(-1, Math.min(d.layer.meta.explanation.samples - 1, layer.explain));
        if (Number.isFinite(layer.explode)) s.explode = Math.max(0, Math.min(2, layer.explode));
        if (Number.isFinite(layer.low) && Number.isFinite(layer.high)) Object.assign(s, { low: layer.low, high: layer.high, keepRange: true });
    });
    return true;
}
