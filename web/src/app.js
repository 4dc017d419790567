// The page: reads the layers out of a document, and connects the picture, the controls and the address.
import { pause } from "./decode.js";
import { Layer } from "./layer.js";
import { Drawing, defaultState } from "./drawing.js";
import { Renderer } from "./renderer.js";
import { Camera } from "./camera.js";
import { Scene } from "./scene.js";
import { Picker } from "./picker.js";
import { layerPanel } from "./panel.js";
import { listen } from "./input.js";
import { tools } from "./tools.js";
import { readAddress, writeAddress } from "./address.js";
import { at, count, labelled, make } from "./dom.js";

const THEMES = {
    light: { background: [0.933, 0.941, 0.953], line: [0.12, 0.14, 0.17], back: [0.72, 0.5, 0.46] },
    dark: { background: [0.086, 0.098, 0.114], line: [0.03, 0.04, 0.05], back: [0.55, 0.34, 0.31] },
};
const REST = 140; // milliseconds without a move after which the picture is drawn whole
// Marks that turn the direction of text: a name with them would turn what stands behind it.
const plain = (_, x) => typeof x === "string" ? x.replace(/[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]/g, "\ufffd") : x;
const A_FRAME = 450000; // vertices in a frame of a whole picture

export class App {
    constructor() {
        this.canvas = at("canvas");
        this.camera = new Camera();
        this.beside = false;
        this.first = []; // elements of the panel before those of the layers
        this.moved = -Infinity;
        this.dirty = false;
        this.longest = 0; // milliseconds that a frame took on this side, and when the first picture was there: for tests
        this.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
    }

    /** Shows the layers of this page's document. */
    async start() {
        const opening = JSON.parse(at("scene").textContent, plain);
        this.title = opening.title;
        this.beside = !!opening.beside;
        this.setTheme(this.theme);
        this.renderer = new Renderer(this.canvas);
        this.picker = new Picker(this);
        await this.show(document);
        this.watchGraphics();
        listen(this);
        new ResizeObserver(() => this.resize()).observe(at("stage"));
        addEventListener("hashchange", () => { if (readAddress(this)) this.recolourAll(); });
    }
    /** Shows the layers of a document, which may be that of another page, instead of those that were shown. */
    async show(source) {
        const metas = [...source.querySelectorAll("script.layer")].map(e => JSON.parse(e.textContent, plain));
        if (!globalThis.DecompressionStream && source.querySelector('script[data-packed="1"]')) throw new Error("This browser is too old for the page: it cannot decompress (DecompressionStream). Browsers of 2023 and later can.");
        document.title = at("title").textContent = this.title || metas.map(m => m.name).filter(Boolean).join(", ") || "brio";
        const layers = [];
        for (const [i, meta] of metas.entries()) {
            this.say(`Reading ${meta.name || `layer ${i + 1}`}`);
            await pause();
            const blocks = {};
            for (const e of source.querySelectorAll(`script[data-layer="${i}"]`)) blocks[e.dataset.name] = e;
            layers.push(new Layer(meta, blocks, i));
            await layers[i].load();
        }
        this.size();
        const before = this.drawings || [], scene = new Scene(layers), pixels = this.canvas.width * this.canvas.height / this.ratio ** 2 / (this.beside ? layers.length : 1);
        const drawings = layers.map(layer => new Drawing(this.renderer.gl, layer, defaultState(layer, pixels)));
        for (const d of drawings) d.place = scene.placeOf(d.layer);
        if (layers.length === 2 && layers[1].filtration) drawings[0].state.visible = false; // the shape at one alpha, which the filtration has
        this.renderer.queue = null; // a picture that was begun is of what was there before
        Object.assign(this, { scene, drawings, front: scene.front(), initial: JSON.parse(JSON.stringify(drawings.map(d => d.state))) });
        this.fit();
        if (source === document) readAddress(this);
        for (const d of drawings) if (d.layer.hull.length && !d.layer.triangles.length && !this.addressed) Object.assign(scene.cutting, { on: true, axis: 1, flip: true });
        this.preparing = true;
        await this.prepare();
        this.preparing = false;
        for (const d of before) for (const name of Object.keys(d.buffers)) d.drop(name);
        this.picker.clear();
        this.fillPanel();
        this.tools = tools(this);
        this.recut();
        this.moved = performance.now(); // the first picture is a coarse one
        this.timed = this.fast = false;
        this.resize();
        this.say(this.summary());
    }
    /** Brings the layers to the graphics card. */
    async prepare() {
        for (const d of this.drawings) {
            await d.prepare(this.renderer.budget);
            if (d.state.wire) await d.wireframe();
        }
    }
    /** Browsers may take the graphics card away, and give it back: then everything is brought there again. */
    watchGraphics() {
        this.canvas.addEventListener("webglcontextlost", e => {
            e.preventDefault();
            this.lost = true;
            this.complete = false;
            this.say("The browser took the graphics card away. The picture comes back with it; if not, load the page again.");
        });
        this.canvas.addEventListener("webglcontextrestored", async () => {
            this.renderer.forget();
            await this.prepare();
            this.recut();
            this.lost = false;
            this.say(this.summary());
            this.redraw();
        });
    }
    summary() {
        const sum = key => this.drawings.reduce((n, d) => n + d.layer.meta[key], 0);
        return [["all_vertices", "vertices"], ["all_faces", "faces"], ["tetrahedra", "tetrahedra"], ["edges", "edges"]].filter(([key]) => sum(key)).map(([key, words]) => `${count(sum(key))} ${words}`).join(", ") || "There are no points.";
    }
    say(words) { at("status").textContent = words; }

    fillPanel() {
        const c = this.scene.cutting;
        const changed = () => { this.recut(); this.redraw(true); };
        const axis = make("select", { onchange: e => { c.axis = +e.target.value; changed(); } }, ...["x", "y", "z"].map((name, k) => make("option", { value: k, selected: k === c.axis }, name)));
        const place = make("input", { type: "range", min: 0, max: 1, step: 0.002, value: c.at, oninput: e => { c.at = +e.target.value; changed(); } });
        const on = make("input", { type: "checkbox", checked: c.on, onchange: e => { c.on = e.target.checked; changed(); } });
        const flip = make("input", { type: "checkbox", checked: c.flip, onchange: e => { c.flip = e.target.checked; changed(); } });
        const up = make("select", { onchange: e => { this.camera.up = +e.target.value; this.redraw(true); } }, ...["x", "y", "z"].map((name, k) => make("option", { value: k, selected: k === this.camera.up }, name)));
        at("panel").replaceChildren(...this.first,
            ...this.drawings.map(d => layerPanel(d, this)),
            make("section", { "aria-label": "Scene" }, make("h2", { className: "scene" }, "Scene"),
                labelled("cutting plane", on), labelled("Across", axis), labelled("Place", place), labelled("other side", flip), labelled("Upright", up)));
    }

    get cutShown() { return this.scene.cut; }
    /** Cuts the tetrahedra by the plane; pieces that are apart stay whole, or go. */
    recut() {
        for (const d of this.drawings) {
            d.cutting = this.scene.cut ? this.scene.cutIn(d.place) : null;
            if (d.state.explode > 0) d.apart();
        }
        if (!this.scene.cut) return;
        for (const d of this.drawings) if (d.layer.tetrahedra.length) d.cutAt(...this.scene.cutIn(d.place));
    }
    async recolour(drawing) { await drawing.recolour(); this.recut(); }
    async recolourAll() {
        for (const d of this.drawings) { await d.recolour(); d.atAlpha(); await d.tell(); if (d.state.wire) await d.wireframe(); }
        this.recut();
        this.fillPanel();
        this.tools.forEach(t => t.sync());
        this.redraw();
    }

    setTheme(name) {
        this.theme = name;
        document.documentElement.dataset.theme = name;
        this.redraw();
    }
    /** Gives the picture the size of its place. */
    size() {
        const box = at("stage").getBoundingClientRect();
        this.ratio = Math.min(2, devicePixelRatio || 1);
        const [w, h] = [Math.max(1, Math.round(box.width * this.ratio)), Math.max(1, Math.round(box.height * this.ratio))];
        if (w !== this.canvas.width || h !== this.canvas.height) [this.canvas.width, this.canvas.height] = [w, h];
    }
    /** Finds from where all is seen, in pictures of this size. */
    fit() {
        const [{ width, height }] = this.views(), apart = this.drawings.map(d => d.layer.hasPieces ? d.state.explode : 0);
        this.camera.fit((axes, x, y) => this.scene.reach(axes, x, y, apart), this.front, width, height);
    }
    resize() {
        const { width, height } = this.canvas;
        this.size();
        if (width !== this.canvas.width || height !== this.canvas.height) this.fit();
        this.redraw();
        this.frame(); // a canvas that changed its size is empty until it is drawn
    }
    /** The parts of the canvas: one, or one for each visible layer. */
    views() {
        const { width, height } = this.canvas, list = this.drawings.filter(d => d.state.visible);
        if (!this.beside || list.length < 2) return [{ x: 0, y: 0, width, height, drawings: this.drawings }];
        const columns = Math.max(1, Math.min(list.length, Math.round(Math.sqrt(list.length * width / height)))), lines = Math.ceil(list.length / columns);
        const [w, h] = [Math.floor(width / columns), Math.floor(height / lines)];
        return list.map((d, i) => ({ x: (i % columns) * w, y: height - (Math.floor(i / columns) + 1) * h, width: w, height: h, drawings: [d] }));
    }
    /** The view at a place of the canvas in pixels of the page, and the place in it from its lower left corner. */
    viewAt(x, y) {
        const [px, py] = [x * this.ratio, this.canvas.height - y * this.ratio];
        const view = this.views().find(v => px >= v.x && px < v.x + v.width && py >= v.y && py < v.y + v.height) || this.views()[0];
        return { view, x: px - view.x, y: py - view.y };
    }
    look() {
        return { background: THEMES[this.theme].background, colours: THEMES[this.theme], cut: this.scene.cut, ratio: this.ratio };
    }

    /** Draws anew.   moving  more will follow soon: coarse, and whole when it rests. */
    redraw(moving = false) {
        if (moving) this.moved = performance.now();
        this.dirty = true;
        if (this.waiting || !this.drawings) return;
        this.waiting = true;
        requestAnimationFrame(() => { this.waiting = false; this.frame(); });
    }
    frame() {
        if (!this.drawings || this.preparing || this.lost) return;
        const began = performance.now(), moving = began - this.moved < REST && !this.fast;
        if (this.dirty) {
            this.dirty = false;
            this.whole = !moving;
            this.begun = began;
            this.renderer.begin(this.views(), this.camera, this.look(), moving);
            this.picker.place();
        }
        const complete = this.renderer.go(moving ? Infinity : A_FRAME);
        if (complete && this.whole && !this.timed) this.time();
        this.longest = Math.max(this.longest, performance.now() - began);
        this.complete = complete && this.whole;
        if (complete) this.firstPicture ??= performance.now();
        if (this.complete) writeAddress(this);
        else if (complete) setTimeout(() => this.rest(), REST + 10);
        else if (!this.waiting) {
            this.waiting = true;
            requestAnimationFrame(() => { this.waiting = false; this.frame(); });
        }
    }
    rest() { if (!this.dirty && !this.whole && performance.now() - this.moved >= REST) this.redraw(); }

    /** Finds whether whole pictures are fast enough for moving, by the time of one. */
    time() {
        const gl = this.renderer.gl, sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), began = this.begun;
        this.timed = true;
        gl.flush();
        const look = () => {
            if (gl.isContextLost()) return;
            if (gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) return requestAnimationFrame(look);
            gl.deleteSync(sync);
            this.fast = performance.now() - began < 34;
        };
        requestAnimationFrame(look);
    }

    /** Turns about the sample that is told of, from as near as shows the smaller one of its polar balls. */
    lookAt(drawing) {
        const p = drawing.picture, place = drawing.place;
        if (!p) return this.say("Tick “show a sample” first.");
        const size = Math.max(3 * p.reach, Math.min(12 * p.reach, ...p.balls.map(b => 2 * b.row[3])));
        this.camera.target = p.origin.map((x, k) => x * place[3] + place[k]);
        this.camera.distance = Math.max(1e-4, 6 * size * place[3]);
        this.redraw(true);
    }
    resetView() {
        this.fit();
        this.camera.reset();
        this.redraw(true);
    }
    async picture() {
        while (!this.complete) await new Promise(requestAnimationFrame);
        return new Promise(done => this.canvas.toBlob(done, "image/png"));
    }
}
