// The page that takes a file: it is read, shown and made into a surface by the library, in a worker of this page. Nothing leaves the
// page: its own rule (Content-Security-Policy) forbids every request.
import { App } from "../src/app.js";
import { at, count, labelled, make, short } from "../src/dom.js";
import { Caller } from "../../wasm/worker.mjs";

const METHODS = [["labeled", "for most data"], ["power-crust", "power crust"], ["tight-cocone", "all points, closed"], ["cocone", "all points"]];
const SAVED = ["ply", "stl", "obj", "glb"];

/** The bytes of an element's text: base 64, packed by gzip. */
async function embedded(id) {
    const packed = Uint8Array.from(atob(at(id).textContent), c => c.charCodeAt(0));
    at(id).textContent = "";
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

class Drop {
    constructor(app) {
        this.app = app;
        this.file = null; // that is shown
        this.held = null; // the one that the worker has read
        this.stop = null; // of the call that runs
        const button = (words, onclick, more) => make("button", { type: "button", onclick, ...more }, words);
        this.input = make("input", { type: "file", hidden: true, tabIndex: -1, "aria-label": "File", onchange: () => { this.take(this.input.files); this.input.value = ""; } });
        this.choose = button("Choose a file", () => this.input.click());
        this.method = make("select", {}, ...METHODS.map(([value, words]) => make("option", { value }, words)));
        this.closed = make("input", { type: "checkbox" });
        this.simplify = make("input", { type: "checkbox" });
        this.explain = make("input", { type: "checkbox" });
        this.go = button("Reconstruct", () => this.reconstruct(), { className: "go" });
        this.format = make("select", {}, ...SAVED.map(value => make("option", { value }, value.toUpperCase())));
        this.saving = button("Download", () => this.save());
        this.stopping = button("Cancel", () => this.stop?.abort(new DOMException("Cancelled.", "AbortError")));
        this.bar = make("progress", { max: 1, value: 0, "aria-label": "Progress" });
        this.stage = make("span", { className: "stage" });
        this.running = make("div", { className: "running", hidden: true }, this.stage, this.bar, this.stopping);
        this.wrong = make("p", { className: "wrong", role: "alert" });
        this.done = make("p", { className: "note done", role: "status" });
        this.making = make("div", { hidden: true }, labelled("Method", this.method), labelled("close all holes", this.closed), labelled("fewer triangles", this.simplify), labelled("tell how it comes to be", this.explain), this.go);
        this.keeping = make("div", { className: "keep", hidden: true }, labelled("Format", this.format), this.saving);
        app.first = [make("section", { className: "layer", "aria-label": "File" }, make("p", { className: "note" }, "Drop a file here, or choose one. It stays on this computer."),
            this.choose, this.input, this.wrong, this.making, this.running, this.done, this.keeping)];
    }

    /** The words in the middle of an empty page. */
    invite() {
        at("stage").append(make("div", { id: "invite" }, make("p", {}, "Drop a scan here"), make("p", { className: "note" }, "PLY, OBJ, STL, OFF, LAS, LAZ, PCD, PTX, PTS, XYZ, CSV, NPY, VTU, VTP, VTK, also by gzip")));
        document.body.classList.add("without");
    }
    async start() {
        this.invite();
        this.module = WebAssembly.compile(await embedded("wasm"));
        const program = URL.createObjectURL(new Blob([at("worker").textContent], { type: "text/javascript" }));
        const module = await this.module;
        this.caller = new Caller(async () => {
            const worker = new Worker(program);
            this.held = null;
            return { post: (m, list) => worker.postMessage(m, list), listen: f => { worker.onmessage = e => f(e.data); },
                fail: f => { worker.onerror = e => f(new Error(e.message || "the worker did not start")); }, end: () => worker.terminate() };
        }, { start: module });
        const over = e => { e.preventDefault(); document.body.classList.add("dropping"); };
        addEventListener("dragover", over);
        addEventListener("dragenter", over);
        addEventListener("dragleave", e => { if (!e.relatedTarget) document.body.classList.remove("dropping"); });
        addEventListener("drop", e => { e.preventDefault(); document.body.classList.remove("dropping"); this.take(e.dataTransfer.files); });
    }

    /** Runs what calls the worker, with progress and a way to stop it. Failures are said; returns whether there was none. */
    async run(words, work) {
        this.stop?.abort(new DOMException("Cancelled.", "AbortError"));
        const stop = this.stop = new AbortController(), focused = document.activeElement;
        const say = (stage, share) => { this.stage.textContent = stage; if (share >= 0) this.bar.value = share; else this.bar.removeAttribute("value"); };
        this.wrong.textContent = this.done.textContent = "";
        this.running.hidden = false;
        this.go.disabled = this.saving.disabled = true;
        say(words, -1);
        try {
            await work({ signal: stop.signal, progress: (stage, share) => say(`${words}: ${stage}`, share) });
            return true;
        } catch (error) {
            if (error.name === "AbortError") this.done.textContent = "Cancelled.";
            else this.wrong.textContent = error.message;
            return false;
        } finally {
            if (this.stop === stop) {
                this.stop = null;
                this.running.hidden = true;
                this.go.disabled = this.saving.disabled = false;
                if (document.activeElement === document.body) focused.focus(); // whoever works by keys stays where they were
            }
        }
    }
    async read(file, how) {
        const bytes = new Uint8Array(await file.arrayBuffer());
        const read = await this.caller.call("open", [file.name, bytes], { ...how, transfer: [bytes.buffer] });
        this.held = file;
        return read;
    }
    /** Shows a page.   crossings  of its first layer, where they were counted before. */
    show(page, crossings) {
        const source = new DOMParser().parseFromString(new TextDecoder().decode(page), "text/html"), first = source.querySelector("script.layer"), meta = JSON.parse(first.textContent);
        if (crossings !== undefined) meta.certificate.self_intersections = crossings;
        first.textContent = JSON.stringify(meta);
        return this.app.show(source);
    }

    /** Takes the files of a drop or a choice: the first one. */
    take(files) {
        const [file] = files;
        if (file) this.ready = this.run(`Reading ${file.name}`, async how => {
            const { page, points } = await this.read(file, how);
            this.file = file;
            this.app.camera.reset();
            await this.show(page);
            at("invite")?.remove();
            document.body.classList.remove("without");
            this.making.hidden = false;
            this.keeping.hidden = true;
            this.done.textContent = `${file.name}: ${count(points)} points`;
        });
    }
    reconstruct() {
        this.ready = this.run("Reconstructing", async how => {
            if (this.held !== this.file) await this.read(this.file, how); // its worker was ended
            const method = this.method.value, holes = this.closed.checked && method !== "cocone" ? "closed" : "auto";
            const simplify = this.simplify.checked && ["labeled", "power-crust"].includes(method);
            const { page, certificate: c, facts, seconds } = await this.caller.call("reconstruct", [{ method, holes, simplify, explain: this.explain.checked }], how);
            await this.show(page, c.self_intersections);
            Object.assign(this.app.drawings[1].state, { visible: false });
            this.app.fillPanel();
            this.app.redraw();
            this.keeping.hidden = false;
            const words = [c.closed ? "closed" : `open along ${count(c.boundary_loops)} ${c.boundary_loops === 1 ? "loop" : "loops"}`, c.manifold && "manifold", c.oriented && "oriented",
                `genus ${c.genus}`, `${count(c.self_intersections)} crossing pairs of faces`, facts.smoothed && "smoothed"].filter(Boolean);
            this.done.textContent = `Surface in ${short(+seconds.toFixed(2))} s: ${words.join(", ")}.`;
            this.last = { certificate: c, seconds };
        });
    }
    save() {
        const said = this.done.textContent, name = `${this.file.name.replace(/\.\w+$/, "")}-surface.${this.format.value}`;
        this.ready = this.run(`Writing ${name}`, async how => {
            const { bytes } = await this.caller.call("save", [name], how);
            const link = make("a", { href: URL.createObjectURL(new Blob([bytes])), download: name });
            link.click();
            setTimeout(() => URL.revokeObjectURL(link.href), 10000);
            this.done.textContent = said;
        });
    }
}

const app = window.brioPage = new App();
const drop = window.brioDrop = new Drop(app);
app.ready = app.start().then(() => drop.start()).then(() => { app.say("Drop a file, or choose one."); }).catch(error => {
    at("status").className = "failed";
    app.say(error.message);
    throw error;
});
