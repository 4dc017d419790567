// What was picked: a card with coordinates and properties, a ring in the picture, and the distance of two picked vertices.
import { project, length, sub } from "./matrix.js";
import { about, at, make, shown, short } from "./dom.js";

const NS = "http://www.w3.org/2000/svg";

export class Picker {
    constructor(app) {
        this.app = app;
        this.picks = []; // one, or two while measuring
        this.measuring = false;
    }
    /** Picks at a place of the canvas; null where nothing is. */
    async pick(x, y) {
        if (this.app.lost) return null;
        const app = this.app, { view, x: px, y: py } = app.viewAt(x, y);
        const found = app.renderer.pick(view, app.camera, app.look(), px, py);
        app.redraw();
        if (!found) { this.clear(); return null; }
        const what = app.scene.identify(found);
        const facts = await what.drawing.layer.vertex(what.vertex);
        const pick = { ...what, ...facts, at: what.moved ? what.point : app.scene.fromFile(facts.place), view: app.views().indexOf(view) };
        if (what.face !== null) pick.faceFacts = await what.drawing.layer.face(what.face);
        this.picks = this.measuring && this.picks.length === 1 ? [this.picks[0], pick] : [pick];
        this.show();
        this.place();
        const { state, layer } = what.drawing;
        if (state.explain >= 0 && !this.measuring) { // the sample that is nearest to what was picked
            state.explain = (await layer.explained()).nearest(facts.place);
            await what.drawing.tell();
            app.redraw();
        }
        return pick;
    }
    clear() {
        this.picks = [];
        at("card").hidden = true;
        this.place();
    }
    get distance() { return this.picks.length === 2 ? length(sub(this.picks[0].place, this.picks[1].place)) : null; }

    show() {
        const pick = this.picks.at(-1), m = pick.drawing.layer.meta, list = [];
        const step = pick.exact ? 0 : m.step;
        if (this.distance !== null) list.push(["distance", about(this.distance, step)], ["difference", sub(this.picks[1].place, this.picks[0].place).map(short).join("  ")]);
        "xyz".split("").forEach((axis, k) => list.push([axis, about(pick.place[k], step)]));
        for (const [p, value] of pick.properties) list.push([p.name, shown(p, value)]);
        if (pick.face !== null) {
            list.push(["face", pick.faceFacts.number === null ? "without a number here" : String(pick.faceFacts.number)]);
            for (const [p, value] of pick.faceFacts.properties) list.push([`${p.name} of the face`, shown(p, value)]);
        }
        if (pick.tetrahedron !== null) list.push(["tetrahedron", String(pick.tetrahedron)]);
        const title = pick.number === null ? "a vertex" : `vertex ${pick.number}`;
        at("card").replaceChildren(
            make("h2", {}, make("span", {}, `${title} of ${pick.drawing.layer.name}`),
                make("button", { "aria-label": "Close", onclick: () => { this.clear(); at("canvas").focus(); } }, "×")),
            make("dl", {}, ...list.flatMap(([k, v]) => [make("dt", {}, k), make("dd", {}, v)])),
            ...(pick.exact ? [] : [make("p", { className: "note" }, `Rounded: coordinates to ${short(m.step)}, properties in floating point to 16 bits of their range.`)]));
        at("card").hidden = false;
        this.app.say([title, ...list.slice(0, 5).map(([k, v]) => `${k} ${v}`)].join(", "));
    }

    /** Puts rings, the line of a distance, and the names of views over the picture. */
    place() {
        const app = this.app, overlay = at("overlay"), views = app.views();
        overlay.replaceChildren();
        const put = (name, attributes, text) => {
            const e = document.createElementNS(NS, name);
            for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
            if (text) e.textContent = text;
            overlay.append(e);
        };
        const height = app.canvas.height / app.ratio;
        const onPage = (view, p) => {
            const [x, y, , w] = project(app.camera.matrix(view.width, view.height), p);
            return w > 0 ? [(view.x + (x + 1) / 2 * view.width) / app.ratio, height - (view.y + (y + 1) / 2 * view.height) / app.ratio] : null;
        };
        for (const view of views) {
            const ends = this.picks.map(pick => onPage(view, pick.at));
            for (const end of ends) if (end) put("circle", { cx: end[0], cy: end[1], r: 7 });
            if (ends.length === 2 && ends[0] && ends[1]) {
                put("line", { x1: ends[0][0], y1: ends[0][1], x2: ends[1][0], y2: ends[1][1] });
                put("text", { x: (ends[0][0] + ends[1][0]) / 2 + 8, y: (ends[0][1] + ends[1][1]) / 2 - 8 }, short(this.distance));
            }
        }
        at("names").replaceChildren(...(views.length > 1 ? views.map(v => make("span", { style: `left: ${v.x / app.ratio + 8}px; top: ${height - (v.y + v.height) / app.ratio + 8}px` }, v.drawings[0].layer.name)) : []));
        for (const v of views.slice(1)) {
            const [x, y] = [v.x / app.ratio, height - (v.y + v.height) / app.ratio];
            if (v.x) put("line", { class: "edge", x1: x, y1: y, x2: x, y2: y + v.height / app.ratio });
            if (y > 1) put("line", { class: "edge", x1: x, y1: y, x2: x + v.width / app.ratio, y2: y });
        }
    }
}
