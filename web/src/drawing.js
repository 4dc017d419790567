// A layer on the graphics card: buffers, made when something first needs them, and the list of what to draw.
import { inParts } from "./decode.js";
import { LAYER_COLOURS } from "./colours.js";
import { colourOf, pictureOf } from "./explanation.js";

const NOTHING = 3.4e38; // a value that is no number

/** How large the points of a cloud are at first: between three and four times as far as they are apart, if they fill half of the picture. */
const sizeOf = (points, pixels) => Math.max(2, Math.min(8, Math.round(3.6 * Math.sqrt(0.5 * pixels / Math.max(1, points)))));

/** How a layer is shown, at first.   pixels  of the picture. */
export function defaultState(layer, pixels) {
    const m = layer.meta, colours = layer.colours("v");
    const few = edges => edges < layer.many && layer.sided; // more would hide the faces
    const state = {
        visible: true, faces: m.triangles > 0 || m.hull > 0, points: layer.kind === "cloud", wire: false, edges: m.edges > 0,
        boundary: few(m.boundary), nonmanifold: few(m.nonmanifold), flipped: few(m.flipped), crossing: true, bridges: false,
        flat: layer.sharp > 0.12, opacity: 1, pointSize: layer.kind === "cloud" ? sizeOf(m.vertices, pixels) : m.vertices < 5000 ? 6 : m.vertices < 100000 ? 4 : 3,
        source: "plain", map: "viridis", low: 0, high: 1, alpha: 0.3, explode: 0, balls: false,
    };
    if (m.explanation) Object.assign(state, { explain: -1, cell: true, polar: true, cocone: true, labels: false, taken: true, power: true });
    if (layer.hasPieces && m.triangles && m.triangles < 60000) state.explode = 0.15; // so that cells are seen as such
    if (layer.hasPieces) state.nonmanifold = false; // edges of cells have many faces by their nature
    if (layer.filtration) Object.assign(state, { boundary: false, nonmanifold: false, flipped: false, flat: true, points: true, alpha: layer.filtration.start });
    if (colours) state.source = "colours";
    else if (layer.colours("f")) state.source = "face-colours";
    else if (layer.hasPieces && m.face_properties.some(p => p.name === "volume")) state.source = m.face_properties.find(p => p.name === "volume").block;
    else if (layer.kind === "cloud") {
        const value = m.properties.find(p => ["confidence", "distance", "intensity", "value", "radius"].includes(p.name));
        state.source = value ? value.block : "z";
    }
    const distance = m.properties.find(p => p.name === "distance"); // of brio compare
    if (distance && state.source === "plain") state.source = distance.block;
    return state;
}

export class Drawing {
    constructor(gl, layer, state) {
        this.gl = gl;
        this.layer = layer;
        this.state = state;
        this.colour = LAYER_COLOURS[layer.number % LAYER_COLOURS.length].map(c => c / 255);
        const n = layer.meta.vertices;
        // A cloud is stored in an order whose beginnings are even choices of its points: place j has vertex j * stride % n.
        this.stride = 1;
        if (layer.kind === "cloud" && n > 2) {
            const common = (a, b) => b ? common(b, a % b) : a;
            this.stride = Math.max(1, Math.round(n * 0.6180339887));
            while (common(this.stride, n) !== 1) this.stride++;
        }
    }
    vertexAt(j) { return this.stride === 1 ? j : (j * this.stride) % this.layer.meta.vertices; }

    buffer(name, data, target = this.gl.ARRAY_BUFFER) {
        const gl = this.gl;
        if (!this.buffers[name]) this.buffers[name] = { handle: gl.createBuffer(), count: 0 };
        gl.bindVertexArray(null);
        gl.bindBuffer(target, this.buffers[name].handle);
        gl.bufferData(target, data, gl.STATIC_DRAW);
        this.buffers[name].count = data.length;
    }
    drop(name) {
        if (this.buffers[name]) this.gl.deleteBuffer(this.buffers[name].handle);
        delete this.buffers[name];
    }
    indices(name, data) { this.buffer(name, data, this.gl.ELEMENT_ARRAY_BUFFER); }

    /** Returns rows of `width` numbers in the order of the buffers. */
    arranged(rows, width) {
        if (this.stride === 1 || !rows) return rows;
        const out = new rows.constructor(rows.length), n = this.layer.meta.vertices;
        for (let j = 0, v = 0; j < n; j++, v = (v + this.stride) % n)
            for (let k = 0; k < width; k++) out[width * j + k] = rows[width * v + k];
        return out;
    }

    /** Fills the buffers; again after the graphics card lost them. */
    async prepare(budget) {
        const l = this.layer;
        this.buffers = {};
        this.buffer("place", this.arranged(l.positions, 3));
        if (l.normals) this.buffer("normal", this.arranged(l.normals, 4));
        if (l.triangles.length) this.indices("triangles", l.triangles);
        if (l.hull.length) this.indices("hull", l.hull);
        if (l.edges.length) this.indices("edges", l.edges);
        for (const name of ["boundary", "nonmanifold", "flipped"]) this.wide(name, l[name]);
        if (l.edges.length < 80000) this.wide("edgesWide", l.edges);
        if (l.crossing) this.indices("crossing", l.trianglesWhere(f => l.crossing[f]));
        const bridge = l.meta.face_properties.find(p => p.name === "bridge");
        if (bridge) {
            const values = await l.property("f", bridge);
            const chosen = l.trianglesWhere(f => values[f]);
            if (chosen.length) this.indices("bridges", chosen);
        }
        const radius = l.meta.properties.find(p => p.name === "radius");
        if (radius) this.spheres(await l.property("v", radius));
        await this.recolour();
        this.atAlpha();
        await this.tell();
        const all = l.triangles.length || l.hull.length;
        if (all / 3 > budget / 4 && !l.filtration) {
            let coarse = await l.coarse(96);
            if (coarse.length / 3 > budget) coarse = await l.coarse(48);
            if (coarse.length < all * 0.7) this.indices("coarse", coarse);
        }
    }
    wide(name, list) {
        if (!list.length) return;
        const p = this.layer.positions, ends = new Float32Array(3 * list.length);
        list.forEach((v, i) => ends.set(p.subarray(3 * v, 3 * v + 3), 3 * i));
        this.buffer(name, ends);
    }
    /** Balls about the vertices, in steps of the layer: a place and a radius for each. */
    spheres(radii) {
        const l = this.layer, p = l.positions, rows = new Float32Array(4 * radii.length);
        for (let v = 0; v < radii.length; v++) rows.set([p[3 * v], p[3 * v + 1], p[3 * v + 2], Math.abs(radii[v]) / (l.meta.step || 1)], 4 * v);
        this.buffer("spheres", rows);
    }
    /** The value alpha at which a filtration is shown: the slider goes through the values in their order. */
    get alpha() {
        const levels = this.layer.filtration.levels;
        return levels[Math.min(levels.length - 1, Math.floor(this.state.alpha * levels.length))] ?? 0;
    }
    /** Fills the buffers of the alpha shape. */
    atAlpha() {
        if (!this.layer.filtration) return;
        const shape = this.shape = this.layer.alphaShape(this.alpha), lines = new Uint32Array(2 * shape.all.length);
        for (let i = 0; i < shape.all.length; i++) lines[2 * i] = shape.all[i], lines[2 * i + 1] = shape.all[i % 3 === 2 ? i - 2 : i + 1];
        this.indices("shape", shape.all.subarray(0, 3 * shape.boundary));
        this.indices("singular", shape.all.subarray(3 * shape.boundary));
        this.indices("shapeWire", lines);
    }
    /** Fills the buffers of pieces that are moved apart, from the middle of all. */
    async apart() {
        const l = this.layer, pieces = this.state.explode > 0 ? await l.pieces() : null;
        if (!pieces) return this.drop("placeE");
        const { piece, centre } = pieces, p = l.positions, far = this.state.explode, cut = this.cutting;
        // A piece whose centre the cutting plane cuts away is left out.
        const stays = c => !cut || [0, 1, 2].reduce((sum, k) => sum + cut[0][k] * centre[3 * c + k], 0) <= cut[1];
        const chosen = this.chosen = Uint32Array.from(piece.keys()).filter(t => stays(piece[t])), n = 3 * chosen.length;
        const corner = new Uint32Array(n), face = chosen.map(t => pieces.face[t]);
        for (let i = 0; i < n; i++) corner[i] = pieces.corner[3 * chosen[Math.floor(i / 3)] + i % 3];
        const place = new Float32Array(3 * n), normal = new Int8Array(4 * n), middle = l.size.map(x => x / 2), q = [[], [], []];
        for (let i = 0; i < n; i += 3) {
            const c = 3 * piece[chosen[i / 3]];
            for (let j = 0; j < 3; j++) for (let k = 0; k < 3; k++) place[3 * (i + j) + k] = q[j][k] = p[3 * corner[i + j] + k] + far * (centre[c + k] - middle[k]);
            const u = [0, 1, 2].map(k => q[1][k] - q[0][k]), v = [0, 1, 2].map(k => q[2][k] - q[0][k]);
            const w = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], size = Math.hypot(...w) || 1;
            for (let j = 0; j < 3; j++) for (let k = 0; k < 3; k++) normal[4 * (i + j) + k] = Math.round(127 * w[k] / size);
        }
        this.buffer("placeE", place);
        this.buffer("normalE", normal);
        for (const [name, width] of [["rgba", 4], ["value", 1]]) {
            const rows = this.rows?.[name], ofFaces = this.rows?.where === "f";
            if (!rows || (ofFaces && !pieces.cells)) { this.drop(`${name}E`); continue; }
            const out = new rows.constructor(width * n);
            for (let i = 0; i < n; i++) for (let k = 0; k < width; k++) out[width * i + k] = rows[width * (ofFaces ? face[Math.floor(i / 3)] : corner[i]) + k];
            this.buffer(`${name}E`, out);
        }
    }
    /** Fills the buffers of how the surface came to be at the sample of the state; none below 0. */
    async tell() {
        const l = this.layer, e = this.state.explain;
        if (!l.meta.explanation) return;
        const all = e >= 0 ? await l.explained() : null;
        if (this.state.explain !== e) return; // another was asked for meanwhile
        this.told = all && all.at(e);
        this.onTold?.();
        const picture = this.picture = this.told && pictureOf(this.told, l, l.meta.explanation.theta), empty = { place: [], rgba: [] };
        for (const [set, name] of [["C", "cell"], ["K", "cone"], ["L", "labels"], ["T", "faces"]]) {
            const pile = picture ? picture[name] : empty;
            this.buffer(`place${set}`, Float32Array.from(pile.place));
            this.buffer(`rgba${set}`, Uint8Array.from(pile.rgba));
        }
        for (const name of ["loops", "power", "lines"]) this.buffer(name, Float32Array.from(picture ? picture[name] : []));
        this.ballsTold = picture ? picture.balls : [];
        this.ballsTold.forEach((b, i) => this.buffer(`ball${i}`, Float32Array.from(b.row)));
        const dots = picture ? [{ row: picture.origin, colour: [0.95, 0.7, 0.2] }, ...picture.balls] : [];
        this.buffer("placeP", Float32Array.from(dots.flatMap(d => d.row.slice(0, 3))));
        this.buffer("rgbaP", Uint8Array.from(dots.flatMap(d => [...d.colour.map(c => Math.round(255 * c)), 255])));
    }
    /** What to draw of it: the faces, edges and poles, and over them what is seen through. */
    toldItems(put, colours) {
        const s = this.state, b = this.buffers, gl = this.gl, plain = { mode: 1, back: false, uncut: true };
        const pile = (set, more) => { if (b[`place${set}`].count) put("faces", { ...plain, set, count: b[`place${set}`].count / 3, opacity: 1, ...more }); };
        const wide = (name, colour, size) => { if (b[name].count) put("wide", { ...plain, mode: 0, wide: name, count: b[name].count / 6, colour, size, lit: false, opacity: 1 }); };
        if (s.taken) pile("T");
        if (s.labels) pile("L");
        if (s.cell) wide("loops", [0.45, 0.3, 0.75], 1.6);
        if (s.power) wide("power", colours.line, 1);
        if (s.polar) wide("lines", colours.line, 1.4);
        put("points", { ...plain, set: "P", count: s.polar ? b.placeP.count / 3 : 1, primitive: gl.POINTS, size: 9, lit: false, opacity: 1 });
        if (s.cell) pile("C", { veil: true, opacity: 0.16 });
        if (s.cocone) pile("K", { veil: true, opacity: 0.3 });
        if (s.polar) this.ballsTold.forEach((ball, i) => put("balls", { ...plain, mode: 0, spheres: `ball${i}`, count: 1, colour: colourOf(ball.side), veil: true, opacity: 0.35 }));
    }
    async wireframe() {
        if (!this.buffers.wire) this.indices("wire", await this.layer.wireframe());
    }

    /** Fills the buffers of colours as the state asks. `values` and the range stay for the histogram. */
    async recolour() {
        const s = this.state, l = this.layer;
        const byFace = s.source === "face-colours" ? "f" : null;
        this.mode = 0;
        this.rows = null;
        this.values = null;
        this.expanded = false;
        if (s.source === "colours" || byFace) {
            const { white, channels } = l.colours(byFace || "v"), count = byFace ? l.meta.faces : l.meta.vertices;
            const rgba = new Uint8ClampedArray(4 * count).fill(255); // wrong colours do not wrap
            for (let k = 0; k < 3; k++) {
                const c = await l.property(byFace || "v", channels[k]);
                for (let i = 0; i < count; i++) rgba[4 * i + k] = white === 65535 ? Math.floor(c[i] / 256) : c[i] / white * 255;
            }
            this.mode = 1;
            this.rows = { rgba, where: byFace || "v" };
            if (byFace) await this.expand("rgba", rgba, 4);
            else this.buffer("rgba", this.arranged(rgba, 4));
        } else if (s.source !== "plain") {
            const source = l.sources().find(x => x.id === s.source);
            const values = await source.values();
            let least = Infinity, most = -Infinity;
            for (const x of values) { if (x < least && x > -Infinity) least = x; if (x > most && x < Infinity) most = x; }
            if (least > most) least = most = 0;
            Object.assign(this, { values, least, most, half: most / 2 - least / 2 || 1, mode: 2 });
            if (this.shownSource !== s.source && !s.keepRange) [s.low, s.high] = [least, most];
            s.keepRange = false;
            const scaled = Float32Array.from(values, x => this.part(x));
            this.rows = { value: scaled, where: source.where };
            if (source.where === "f") await this.expand("value", scaled, 1);
            else this.buffer("value", this.arranged(scaled, 1));
        }
        this.shownSource = s.source;
        await this.apart();
    }
    /** Where a value is between the least and the greatest one, 0 to 1; in halves, since their difference may be no double. */
    part(x) { return Number.isFinite(x) ? (x / 2 - this.least / 2) / this.half : NOTHING; }
    valueAt(part) { return 2 * (this.least / 2 + part * this.half); }
    /** The range of colours in the unit of the buffer. */
    range() { return [this.part(this.state.low), this.part(this.state.high)]; }

    /** Triangles with corners of their own, for colours of faces. */
    async expand(name, rows, width) {
        const l = this.layer, t = l.triangles;
        if (!this.buffers.placeX) {
            const place = new Float32Array(3 * t.length), normal = new Int8Array(4 * t.length);
            await inParts(t.length, (from, to) => {
                for (let i = from; i < to; i++) {
                    for (let k = 0; k < 3; k++) place[3 * i + k] = l.positions[3 * t[i] + k];
                    for (let k = 0; k < 4; k++) normal[4 * i + k] = l.normals[4 * t[i] + k];
                }
            });
            this.buffer("placeX", place);
            this.buffer("normalX", normal);
        }
        const out = new rows.constructor(width * t.length);
        await inParts(t.length, (from, to) => {
            for (let i = from; i < to; i++) {
                const f = l.faceAt(Math.floor(i / 3));
                for (let k = 0; k < width; k++) out[width * i + k] = rows[width * f + k];
            }
        });
        this.buffer(`${name}X`, out);
        this.expanded = true;
    }

    /** The section with the plane; `values` of the vertices colour it. */
    cutAt(normal, at) {
        const l = this.layer, cut = l.section(normal, at), gl = this.gl;
        this.section = cut;
        this.buffer("placeS", cut.places);
        this.drop("valueS");
        if (this.mode === 2 && !this.expanded) {
            const v = this.values;
            this.buffer("valueS", Float32Array.from(cut.weights, ([a, b, f]) => this.part((1 - f) * v[a] + f * v[b])));
        }
        const lines = new Uint32Array(6 * cut.of.length);
        let n = 0; // the outlines of the polygons: triangles of one tetrahedron follow each other
        for (let i = 0; i < cut.of.length; i++) {
            const first = i === 0 || cut.of[i - 1] !== cut.of[i], last = i + 1 === cut.of.length || cut.of[i + 1] !== cut.of[i];
            if (first) lines[n++] = 3 * i, lines[n++] = 3 * i + 1;
            lines[n++] = 3 * i + 1, lines[n++] = 3 * i + 2;
            if (last) lines[n++] = 3 * i + 2, lines[n++] = 3 * i;
        }
        this.buffer("linesS", lines.subarray(0, n), gl.ELEMENT_ARRAY_BUFFER);
    }

    /** What to draw: [{program, set, index, primitive, count, mode, colour, ...}].   moving  fewer of it. */
    items(moving, budget, cutting, colours) {
        const s = this.state, b = this.buffers, gl = this.gl, out = [], l = this.layer;
        const single = this.expanded ? 0 : this.mode; // colours of faces are none of points and edges
        if (!s.visible) return out;
        const put = (program, more) => out.push({ drawing: this, program, set: "", index: null, primitive: gl.TRIANGLES, mode: single,
            colour: this.colour, size: 1, lit: true, back: true, opacity: s.opacity, ...more });
        const stroke = colours.background[0] > 0.5 ? this.colour.map(c => 0.55 * c) : this.colour; // lines of one colour stand out from the background
        const thin = this.told ? { veil: true, opacity: Math.min(s.opacity, 0.22) } : {}; // so that what is told of a sample is seen
        const back = l.sided; // of faces without sides both look alike
        const solid = l.triangles.length ? "triangles" : "hull", apart = s.explode > 0 && b.placeE;
        if (s.faces && l.filtration) {
            if (b.shape.count) put("faces", { index: "shape", pick: "shape", mode: this.expanded ? 0 : this.mode });
            if (b.singular.count) put("faces", { index: "singular", pick: "singular", mode: 0, colour: [0.35, 0.6, 0.95], back: false });
            if (s.wire && b.shapeWire.count) put("lines", { index: "shapeWire", primitive: gl.LINES, mode: 0, colour: colours.line, lit: false, opacity: 0.55 });
        } else if (s.faces && apart) put("faces", { set: "E", mode: b.valueE || b.rgbaE ? this.mode : 0, count: b.placeE.count / 3, pick: "piece", uncut: true });
        else if (s.faces && b[solid]) {
            if (moving && b.coarse) put("faces", { index: "coarse", pick: false, back, ...thin });
            else if (this.expanded) put("faces", { set: "X", mode: this.mode, count: b.placeX.count / 3, pick: "corner", back, ...thin });
            else put("faces", { index: solid, pick: "triangle", back, ...thin });
        }
        if (s.balls && b.spheres) put("balls", { spheres: "spheres", count: b.spheres.count / 4, mode: 0, back: false });
        const small = (!moving || !b.coarse) && !apart;
        if (small && s.faces && s.crossing && b.crossing) put("marks", { index: "crossing", mode: 0, colour: [0.92, 0.16, 0.24], back: false, opacity: 1 });
        if (small && s.faces && s.bridges && b.bridges) put("marks", { index: "bridges", mode: 0, colour: [0.98, 0.66, 0.1], back: false, opacity: 1 });
        if (cutting && !apart && b.placeS && this.section && this.section.of.length && s.faces) {
            put("faces", { set: "S", count: b.placeS.count / 3, mode: b.valueS ? 2 : 0, colour: this.colour.map(c => 0.85 * c), lit: false, uncut: true, back: false, pick: "section", opacity: 1 });
            if (!moving || b.linesS.count < 2e5) put("lines", { set: "S", index: "linesS", primitive: gl.LINES, mode: 0, colour: colours.line, lit: false, uncut: true, opacity: this.section.of.length > 10000 ? 0.35 : 0.75 });
        }
        if (s.wire && b.wire && small) put("lines", { index: "wire", primitive: gl.LINES, mode: s.faces ? 0 : single, colour: s.faces ? colours.line : this.colour, lit: false, opacity: s.faces ? 0.55 : 1 });
        if (s.edges && b.edges && (!moving || b.edges.count < 4 * budget)) put("lines", { index: "edges", primitive: gl.LINES, colour: stroke, lit: false, pick: "edge", opacity: s.faces && b[solid] ? 0.5 : 1 });
        if (s.edges && b.edgesWide && single === 0 && !(s.faces && b[solid])) put("wide", { wide: "edgesWide", count: b.edgesWide.count / 6, colour: stroke, size: 1.8, lit: false, opacity: 1 });
        const wides = { boundary: [0.1, 0.62, 1], nonmanifold: [1, 0.24, 0.65], flipped: [0.95, 0.85, 0.1] };
        for (const [name, colour] of Object.entries(wides))
            if (s[name] && b[name] && s.faces && !apart) put("wide", { wide: name, count: b[name].count / 6, mode: 0, colour, size: 2.5, lit: false, opacity: 1 });
        if (this.told && b.placeC) this.toldItems(put, colours);
        if (s.points) {
            const all = l.meta.vertices, count = moving ? Math.min(all, 2 * budget) : all;
            put("points", { count, primitive: gl.POINTS, size: s.pointSize, pick: "point", deep: l.kind === "cloud" && !l.normals });
        }
        return out;
    }
}
