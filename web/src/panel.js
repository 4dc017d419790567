// The panel: for each layer what is shown of it, its colours, counts and certificate.
import { MAPS, colourAt } from "./colours.js";
import { count, exactly, labelled, make, short } from "./dom.js";
import { facesTaken } from "./explanation.js";

const BINS = 64;

const rows = list => make("dl", {}, ...list.filter(Boolean).flatMap(([k, v, bad]) => [make("dt", {}, k), make("dd", { className: bad ? "bad" : "" }, v)]));

/** What a layer holds. */
function counts(m) {
    return rows([
        ["vertices", count(m.all_vertices)],
        m.all_vertices > m.vertices && ["of these on the page", count(m.vertices)],
        m.all_faces && ["faces", count(m.all_faces)],
        m.all_faces > m.faces && ["of these under three corners", count(m.all_faces - m.faces)],
        m.tetrahedra && ["tetrahedra", count(m.tetrahedra)],
        m.edges && ["edges", count(m.edges)],
    ]);
}
function certificate(c) {
    const yes = x => x ? "yes" : "no";
    return rows([
        ["closed", yes(c.closed)], ["manifold", yes(c.manifold), !c.manifold], ["oriented", yes(c.oriented), !c.oriented],
        ["components", count(c.components)], ["genus", count(c.genus)],
        c.boundary_edges && ["boundary", `${count(c.boundary_edges)} edges, ${count(c.boundary_loops)} ${c.boundary_loops === 1 ? "loop" : "loops"}`],
        c.nonmanifold_edges && ["edges of over two faces", count(c.nonmanifold_edges), true],
        c.nonmanifold_vertices && ["pinched vertices", count(c.nonmanifold_vertices), true],
        c.flipped_edges && ["edges whose faces disagree", count(c.flipped_edges), true],
        ["crossing faces", c.self_intersections < 0 ? "not counted" : `${count(c.self_intersections)} pairs`, c.self_intersections > 0],
        c.area !== null && ["area", short(c.area)], c.closed && c.volume !== null && ["volume", short(c.volume)],
    ]);
}

/** The histogram of the values, in the colours that they have. A drag over it sets the range. */
function histogram(drawing, changed) {
    const canvas = make("canvas", { className: "histogram", width: 256, height: 56, role: "img" });
    const bins = new Float64Array(BINS);
    for (const x of drawing.values) if (Number.isFinite(x)) bins[Math.min(BINS - 1, Math.floor(drawing.part(x) * BINS))]++;
    const most = Math.max(1, ...bins), state = drawing.state;
    canvas.setAttribute("aria-label", `Histogram of ${count(drawing.values.length)} values from ${short(drawing.least)} to ${short(drawing.most)}`);
    const draw = () => {
        const c = canvas.getContext("2d");
        c.clearRect(0, 0, 256, 56);
        for (let i = 0; i < BINS; i++) {
            const [low, high] = drawing.range(), t = high > low ? ((i + 0.5) / BINS - low) / (high - low) : 0.5;
            c.fillStyle = `rgb(${colourAt(state.map, t)})`;
            const h = bins[i] ? Math.max(2, 46 * Math.sqrt(bins[i] / most)) : 0;
            c.fillRect(4 * i, 48 - h, 4, h);
            c.fillRect(4 * i, 50, 4, 6);
        }
    };
    let from = null;
    const partAt = e => { const r = canvas.getBoundingClientRect(); return Math.max(0, Math.min(1, (e.clientX - r.left) / r.width)); };
    canvas.addEventListener("pointerdown", e => { from = partAt(e); canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener("pointermove", e => {
        if (from === null) return;
        const to = partAt(e);
        if (Math.abs(to - from) < 0.01) return;
        [state.low, state.high] = [Math.min(from, to), Math.max(from, to)].map(x => drawing.valueAt(x));
        changed();
    });
    canvas.addEventListener("pointerup", () => { from = null; });
    canvas.addEventListener("dblclick", () => { [state.low, state.high] = [drawing.least, drawing.most]; changed(); });
    return { canvas, draw };
}

/** What is told of a sample, as rows. */
function toldRows(told) {
    const name = side => side < 0 ? "inner" : side > 0 ? "outer" : "without a label", place = p => p.map(x => exactly(x)).join(" ");
    const sides = told.tetrahedra.map(t => t.side), sure = told.tetrahedra.map(t => t.confidence).filter(c => c !== null);
    return rows([["sample", `point ${told.point}`], ["at", place(told.place)],
        ...told.poles.flatMap((p, i) => {
            const words = `${i ? "other" : "farther"} pole`;
            if (Number.isNaN(p.radius)) return [[words, "none"]];
            return p.radius === Infinity ? [[words, `at infinity, ${name(p.side)}`]] : [[words, name(p.side)], ["centre", place(p.centre)], ["radius", exactly(p.radius)]];
        }),
        sides.some(Boolean) && ["tetrahedra", `${sides.filter(x => x < 0).length} inner, ${sides.filter(x => x > 0).length} outer`],
        sure.length > 0 && ["least sure of these", short(+sure.reduce((a, b) => Math.min(a, b)).toFixed(2))],
        ["faces taken", count(facesTaken(told))]]);
}

/** How the surface came to be: a sample is chosen by a slider, or by a click on the surface. */
function explanationPanel(drawing, app, tick) {
    const { layer, state } = drawing, m = layer.meta.explanation, about = make("div", { role: "status", className: "told" });
    const note = m.samples < m.all_samples ? `An even choice of ${count(m.samples)} of ${count(m.all_samples)} samples.` : `All ${count(m.samples)} samples.`;
    const slider = make("input", { type: "range", min: 0, max: m.samples - 1, step: 1, value: Math.max(0, state.explain), oninput: async e => { state.explain = +e.target.value; on.checked = true; await drawing.tell(); app.redraw(true); } });
    const on = make("input", { type: "checkbox", checked: state.explain >= 0, onchange: async e => { state.explain = e.target.checked ? +slider.value : -1; await drawing.tell(); app.redraw(); } });
    drawing.onTold = () => {
        about.replaceChildren(...(drawing.told ? [toldRows(drawing.told)] : []));
        if (state.explain >= 0) slider.value = state.explain;
        on.checked = state.explain >= 0;
    };
    drawing.onTold();
    return make("details", { open: true, className: "explanation" }, make("summary", {}, "How it came to be"),
        make("p", { className: "note" }, `${note} Tick, and click the surface: the nearest sample is shown.`), labelled("show a sample", on), labelled("Sample", slider),
        make("button", { type: "button", onclick: () => app.lookAt(drawing) }, "Look at it"),
        make("fieldset", {}, make("legend", {}, "Show of it"), tick("cell", "its cell", true), tick("polar", "poles and polar balls", true), tick("cocone", "co-cone", true),
            tick("labels", "labels of tetrahedra", m.method !== "power-crust"), tick("taken", "faces taken", true), tick("power", "faces of power cells", m.method === "power-crust")), about);
}

/** The part of the panel about one layer.   app  has redraw() and recolour(drawing). */
export function layerPanel(drawing, app) {
    const { layer, state } = drawing, m = layer.meta, name = layer.name;
    const tick = (key, words, there, then = () => {}) => there ? labelled(words, make("input", {
        type: "checkbox", checked: state[key], onchange: async e => { state[key] = e.target.checked; await then(); app.redraw(); },
    })) : null;
    const slide = (key, words, least, most, step) => labelled(words, make("input", {
        type: "range", min: least, max: most, step, value: state[key], oninput: e => { state[key] = +e.target.value; app.redraw(true); },
    }));
    const level = make("p", { className: "note", role: "status" });
    const tell = () => {
        const { boundary, singular } = drawing.shape, a = drawing.alpha;
        level.textContent = `alpha ${short(a)}${a >= 0 ? `, radius ${short(Math.sqrt(a))}` : ""}: ${count(boundary)} triangles bound the solid, ${count(singular)} bound nothing`;
    };
    const alphas = layer.filtration ? [labelled("Alpha", make("input", {
        type: "range", min: 0, max: 1, step: 0.001, value: state.alpha, oninput: e => { state.alpha = +e.target.value; drawing.atAlpha(); tell(); app.redraw(true); },
    })), level] : [];
    if (layer.filtration) tell();
    const apart = layer.hasPieces ? labelled("Apart", make("input", {
        type: "range", min: 0, max: 2, step: 0.02, value: state.explode, oninput: async e => { state.explode = +e.target.value; await drawing.apart(); app.redraw(true); },
    })) : null;
    const b = drawing.buffers, surface = m.triangles > 0 || m.hull > 0;
    const range = make("div", { className: "range" });
    const map = make("select", { onchange: e => { state.map = e.target.value; refresh(); app.redraw(); } }, ...Object.keys(MAPS).map(x => make("option", { value: x, selected: x === state.map }, x)));
    let shown = null;
    const number = (key, words) => labelled(words, make("input", {
        type: "text", inputMode: "decimal", value: short(state[key]),
        onchange: e => { if (Number.isFinite(+e.target.value) && e.target.value.trim()) state[key] = +e.target.value; refresh(); app.redraw(); },
    }));
    const refresh = () => {
        range.replaceChildren();
        if (drawing.mode !== 2) return;
        if (!shown || shown.values !== drawing.values) shown = { values: drawing.values, ...histogram(drawing, () => { refresh(); app.redraw(true); }) };
        shown.draw();
        range.append(labelled("Colour map", map), shown.canvas, make("div", { className: "pair" }, number("low", "from"), number("high", "to")));
    };
    const sources = [["plain", "one colour"], layer.colours("v") && ["colours", "colours of the file"], layer.colours("f") && ["face-colours", "colours of faces"],
        ...layer.sources().map(s => [s.id, s.label])].filter(Boolean);
    const source = make("select", {
        onchange: async e => { state.source = e.target.value; await app.recolour(drawing); refresh(); app.redraw(); },
    }, ...sources.map(([value, words]) => make("option", { value, selected: value === state.source }, words)));
    refresh();
    const shownParts = make("fieldset", {}, make("legend", {}, "Show"),
        tick("faces", "faces", surface), tick("wire", "wireframe", surface, () => drawing.wireframe()), tick("points", "points", true),
        tick("edges", "edges", m.edges > 0), tick("boundary", "boundary", m.boundary > 0), tick("nonmanifold", "edges of over two faces", m.nonmanifold > 0),
        tick("flipped", "edges whose faces disagree", m.flipped > 0), tick("crossing", "crossing faces", !!(b.crossing && b.crossing.count)),
        tick("bridges", "bridges", !!b.bridges), tick("balls", "balls of their radii", !!b.spheres), tick("flat", "flat shading", surface));
    const notes = [!m.exact && `Rounded: coordinates to ${short(m.step)}, properties in floating point to 16 bits of their range. Vertices and faces have no numbers here. brio view --exact keeps all.`,
        m.normals_left_out && "The normals of the file are left out: shades follow the faces. brio view --exact keeps them.",
        m.all_vertices > m.vertices && `An even choice of ${count(m.vertices)} of ${count(m.all_vertices)} points.`].filter(Boolean);
    return make("section", { className: "layer", "aria-label": name },
        make("h2", {}, make("input", { type: "checkbox", id: `visible${layer.number}`, checked: state.visible, onchange: e => { state.visible = e.target.checked; app.redraw(); } }),
            make("label", { htmlFor: `visible${layer.number}`, className: "name" }, make("span", { className: "swatch", style: `background: rgb(${drawing.colour.map(c => Math.round(255 * c))})` }), name)),
        counts(m), m.explanation ? explanationPanel(drawing, app, tick) : null, ...notes.map(words => make("p", { className: "note" }, words)), ...alphas, apart, shownParts, labelled("Colour by", source), range,
        surface ? slide("opacity", "Opacity", 0.1, 1, 0.05) : null, slide("pointSize", "Point size", 1, 16, 1),
        m.certificate && !layer.filtration ? make("details", { open: true }, make("summary", {}, "Certificate"), certificate(m.certificate)) : null,
        m.report ? make("details", {}, make("summary", {}, "Report"), make("pre", { tabIndex: 0 }, m.report)) : null);
}
