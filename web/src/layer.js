// A layer: its data, decoded from the page's blocks, and what is derived from them. Nothing here knows WebGL.
//
// Positions are whole numbers q of 21 bits; low + step * q are the coordinates of the file, rounded. The exact ones, and the
// numbers of vertices and faces in the file, are decoded when something is picked for the first time.
import { Explanation } from "./explanation.js";
import { bytesOf, differences, inParts, reals, trianglesOf, valuesOf } from "./decode.js";

const CREASED = 0.03; // share of corners from which on a mesh has creases, not noise: chosen
const FEW_CROWDED = 50; // edges of more than two faces up to which these are faults in any case, as in src/picture/shapes.c: chosen

export class Layer {
    constructor(meta, blocks, number) {
        this.meta = meta;
        this.blocks = blocks;
        this.number = number;
        this.cache = new Map();
        this.kind = meta.tetrahedra ? "tetrahedra" : meta.triangles ? "mesh" : meta.edges ? "edges" : "cloud";
    }
    get name() { return this.meta.name || `layer ${this.number + 1}`; }
    /** How many edges of a kind are too many to be marked. */
    get many() { return Math.max(1000, 0.1 * this.meta.triangles); }
    /** Whether faces have sides: not in a complex, where many edges have more than two faces. Pictures have the same rule. */
    get sided() { return this.meta.nonmanifold <= FEW_CROWDED || this.meta.nonmanifold < Math.floor(this.meta.faces / 10); }
    has(name) { return name in this.blocks; }

    /** Coordinate k of a step, in halves: boxes may be wider than the largest double. */
    coordinate(k, step) { return 2 * (this.meta.low[k] / 2 + this.meta.step / 2 * step); }

    /** Decodes a block once. */
    once(name, decode) {
        if (!this.cache.has(name))
            this.cache.set(name, bytesOf(this.blocks[name]).then(bytes => { this.blocks[name].textContent = ""; return decode(bytes); }));
        return this.cache.get(name);
    }
    column(name, n, width) { return this.once(name, bytes => differences(bytes, n, width)); }
    /** The corners of n simplices of `size` corners, one after the other. */
    async corners(name, n, size) {
        const out = new Uint32Array(n * size);
        for (let k = 0; k < size && n; k++) {
            const column = await this.column(`${name}-${k}`, n, 4);
            await inParts(n, (from, to) => { for (let i = from; i < to; i++) out[size * i + k] = column[i]; });
            this.cache.delete(`${name}-${k}`);
        }
        return out;
    }

    async load() {
        const m = this.meta, n = m.vertices;
        const axes = [];
        for (const axis of "xyz") axes.push(await this.column(axis, n, 3));
        this.positions = new Float32Array(3 * n);
        this.size = [0, 0, 0]; // of the box, in steps
        await inParts(n, (from, to) => {
            for (let i = from; i < to; i++)
                for (let k = 0; k < 3; k++) {
                    const q = axes[k][i];
                    this.positions[3 * i + k] = q;
                    if (q > this.size[k]) this.size[k] = q;
                }
        });
        "xyz".split("").forEach(axis => this.cache.delete(axis));
        this.triangles = m.triangles ? await this.once("triangles", bytes => trianglesOf(bytes, m.triangles)) : new Uint32Array(0);
        await this.findFaces();
        this.tetrahedra = await this.corners("tetrahedra", m.tetrahedra, 4);
        this.hull = await this.corners("hull", m.hull, 3);
        this.edges = await this.corners("edges", m.edges, 2);
        this.boundary = await this.corners("boundary", m.boundary, 2);
        this.nonmanifold = await this.corners("nonmanifold", m.nonmanifold, 2);
        this.flipped = await this.corners("flipped", m.flipped, 2);
        this.crossing = this.has("crossing") ? await this.column("crossing", m.faces, 1) : null;
        await this.findNormals();
        await this.findFiltration();
    }

    /** The alpha filtration, where the faces have its three properties (brio_alpha_facets): for each face from which value on it is in
     *  the complex, a face of the solid, and inside it; and the values at which something changes, ascending. */
    async findFiltration() {
        const list = ["appears", "solid", "vanishes"].map(name => this.meta.face_properties.find(p => p.name === name));
        this.filtration = null;
        if (list.some(p => !p)) return;
        const values = [];
        for (const p of list) values.push(Float64Array.from(await this.property("f", p), x => Number.isNaN(x) ? Infinity : x));
        const sorted = Float64Array.from(values[1]).sort(); // when the solid changes
        this.filtration = { appears: values[0], solid: values[1], vanishes: values[2], levels: sorted.filter((x, i) => x < Infinity && x !== sorted[i - 1]) };
        // It begins where every point is a corner of the solid.
        const first = new Float64Array(this.meta.vertices).fill(Infinity);
        this.triangles.forEach((v, i) => { first[v] = Math.min(first[v], values[1][this.faceAt(Math.floor(i / 3))]); });
        const start = first.reduce((a, x) => x < Infinity && x > a ? x : a, -Infinity), levels = this.filtration.levels;
        this.filtration.start = Math.min(1, (levels.findIndex(x => x >= start) + 0.5) / Math.max(1, levels.length));
    }
    /** The triangles at a value alpha: of the boundary of the solid, and the singular ones; `of` has the face of each of both. */
    alphaShape(alpha) {
        const { appears, solid, vanishes } = this.filtration, n = this.triangles.length / 3, kind = new Uint8Array(n), count = [0, 0, 0];
        for (let t = 0; t < n; t++) {
            const f = this.faceAt(t);
            if (appears[f] <= alpha && alpha < vanishes[f]) kind[t] = solid[f] <= alpha ? 1 : 2;
            count[kind[t]]++;
        }
        const all = new Uint32Array(3 * (count[1] + count[2])), of = new Uint32Array(count[1] + count[2]), next = [0, 0, count[1]];
        for (let t = 0; t < n; t++) {
            if (!kind[t]) continue;
            const i = next[kind[t]]++;
            for (let k = 0; k < 3; k++) all[3 * i + k] = this.triangles[3 * t + k];
            of[i] = this.faceAt(t);
        }
        return { all, of, boundary: count[1], singular: count[2] };
    }

    /** The pieces that can be moved apart: cells, by the property `site` or `cell` of the faces, or tetrahedra; null where there are none.
     *  corner has three vertices for each triangle, piece[t] is a number from 0, centre three numbers for each piece; face[t] is the face
     *  or the tetrahedron of a triangle. */
    async pieces() {
        if (this.apart !== undefined) return this.apart;
        const cell = this.meta.face_properties.find(p => ["site", "cell"].includes(p.name) && !p.type.startsWith("float"));
        let corner, piece, face;
        if (cell && this.triangles.length) {
            const values = await this.property("f", cell), number = new Map();
            corner = this.triangles;
            face = Uint32Array.from({ length: corner.length / 3 }, (_, t) => this.faceAt(t));
            piece = face.map(f => { if (!number.has(values[f])) number.set(values[f], number.size); return number.get(values[f]); });
        } else if (this.tetrahedra.length && !this.triangles.length) {
            const facets = [1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1], t = this.tetrahedra;
            corner = new Uint32Array(3 * t.length);
            for (let i = 0; i < t.length; i += 4) facets.forEach((k, j) => { corner[3 * i + j] = t[i + k]; });
            face = Uint32Array.from({ length: t.length }, (_, i) => i >> 2);
            piece = face;
        } else return this.apart = null;
        const count = piece.reduce((a, b) => Math.max(a, b), -1) + 1, centre = new Float32Array(3 * count), corners = new Uint32Array(count), p = this.positions;
        for (let i = 0; i < corner.length; i++) {
            const c = piece[Math.floor(i / 3)];
            corners[c]++;
            for (let k = 0; k < 3; k++) centre[3 * c + k] += p[3 * corner[i] + k];
        }
        for (let i = 0; i < centre.length; i++) centre[i] /= corners[Math.floor(i / 3)];
        return this.apart = { corner, piece, face, centre, cells: corner === this.triangles };
    }
    get hasPieces() {
        return this.triangles.length ? this.meta.face_properties.some(p => ["site", "cell"].includes(p.name) && !p.type.startsWith("float")) : this.tetrahedra.length > 0;
    }

    /** faceOf[t]: the face of triangle t; null where every face is one triangle. */
    async findFaces() {
        this.faceOf = null;
        if (!this.has("corners")) return;
        const corners = await this.column("corners", this.meta.faces, 4);
        this.faceOf = new Uint32Array(this.meta.triangles);
        for (let f = 0, t = 0; f < corners.length; f++) for (let k = 2; k < corners[f]; k++) this.faceOf[t++] = f;
    }
    faceAt(t) { return this.faceOf ? this.faceOf[t] : t; }

    /** Normals of vertices, four bytes each: sums over the faces of a mesh or a hull, or the properties nx, ny, nz of a cloud.
     *  `sharp` is the share of corners at which a face is far from the normal there: then faces are better shaded flat. */
    async findNormals() {
        const n = this.meta.vertices, triangles = this.triangles.length ? this.triangles : this.hull;
        this.sharp = 0;
        this.normals = null;
        if (!triangles.length) return this.takeNormals();
        const p = this.positions, sum = new Float32Array(3 * n), normal = new Float32Array(3);
        const face = t => {
            const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
            const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
            const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
            normal[0] = uy * vz - uz * vy, normal[1] = uz * vx - ux * vz, normal[2] = ux * vy - uy * vx;
        };
        await inParts(triangles.length / 3, (from, to) => {
            for (let t = 3 * from; t < 3 * to; t += 3) {
                face(t);
                for (let k = 0; k < 3; k++) {
                    const v = 3 * triangles[t + k];
                    sum[v] += normal[0], sum[v + 1] += normal[1], sum[v + 2] += normal[2];
                }
            }
        });
        this.normals = new Int8Array(4 * n);
        await inParts(n, (from, to) => {
            for (let v = from; v < to; v++) {
                const l = Math.hypot(sum[3 * v], sum[3 * v + 1], sum[3 * v + 2]) || 1;
                for (let k = 0; k < 3; k++) this.normals[4 * v + k] = Math.round(127 * sum[3 * v + k] / l);
            }
        });
        const step = 3 * Math.max(1, Math.floor(triangles.length / 3 / 20000));
        let far = 0, all = 0;
        // Bit k: the face is far from the normal at its corner k.
        const bends = t => {
            let out = 0;
            face(t);
            const l = Math.hypot(normal[0], normal[1], normal[2]);
            for (let k = 0; k < 3 && l > 0; k++) {
                const v = 4 * triangles[t + k];
                if (normal[0] * this.normals[v] + normal[1] * this.normals[v + 1] + normal[2] * this.normals[v + 2] < 0.8 * 127 * l) out |= 1 << k;
            }
            return out;
        };
        for (let t = 0; t < triangles.length; t += step, all += 3) for (let k = 0, b = bends(t); k < 3; k++) far += b >> k & 1;
        this.sharp = all ? far / all : 0;
        if (this.sharp > CREASED) await this.dropNormals(triangles, bends);
    }
    /** Leaves vertices at creases without normals: the shades of a face are its own there. */
    async dropNormals(triangles, bends) {
        const at = new Uint8Array(this.meta.vertices);
        await inParts(triangles.length / 3, (from, to) => {
            for (let t = 3 * from; t < 3 * to; t += 3) for (let k = 0, b = bends(t); b >> k; k++) if (b >> k & 1) at[triangles[t + k]] = 1;
        });
        await inParts(at.length, (from, to) => { for (let v = from; v < to; v++) if (at[v]) this.normals.fill(0, 4 * v, 4 * v + 3); });
    }
    async takeNormals() {
        const list = ["nx", "ny", "nz"].map(name => this.meta.properties.find(p => p.name === name));
        if (list.some(p => !p)) return;
        const values = [];
        for (const p of list) values.push(await this.property("v", p));
        this.normals = new Int8Array(4 * this.meta.vertices);
        await inParts(this.meta.vertices, (from, to) => {
            for (let v = from; v < to; v++) {
                const l = Math.hypot(values[0][v], values[1][v], values[2][v]) || 1;
                for (let k = 0; k < 3; k++) this.normals[4 * v + k] = Math.round(127 * values[k][v] / l);
            }
        });
    }

    /** The values of a property of the vertices ("v") or the faces ("f"). */
    property(where, p) {
        return this.once(p.block, bytes => valuesOf(p, bytes, where === "v" ? this.meta.vertices : this.meta.faces));
    }

    /** What colours can show: [{id, label, where, values}], values a function that promises an array. */
    sources() {
        const m = this.meta;
        const list = "xyz".split("").map((axis, k) => ({
            id: axis, label: `coordinate ${axis}`, where: "v",
            values: async () => Float64Array.from({ length: m.vertices }, (_, i) => this.coordinate(k, this.positions[3 * i + k])),
        }));
        for (const p of m.properties) list.push({ id: p.block, label: p.name, where: "v", values: () => this.property("v", p) });
        for (const p of m.face_properties)
            list.push({ id: p.block, label: `${p.name} of faces`, where: "f", values: () => this.property("f", p) });
        return list;
    }
    /** The properties that are colours, of the vertices or of the faces, and what white is in them (src/io/colour.h); or null. */
    colours(where) {
        const [list, white] = where === "v" ? [this.meta.properties, this.meta.white] : [this.meta.face_properties, this.meta.face_white];
        return white ? { white, channels: ["red", "green", "blue"].map(name => list.find(p => p.name === name)) } : null;
    }

    /** What is known of a vertex: its number in the file, its coordinates, and its properties, each with its value. */
    async vertex(v) {
        const m = this.meta, n = m.vertices;
        const number = this.has("vertices") ? (await this.column("vertices", n, 4))[v] : null;
        const place = [];
        for (let k = 0; k < 3; k++) {
            const name = `exact-${"xyz"[k]}`;
            place.push(m.exact ? (await this.once(name, bytes => reals(bytes, n, 8)))[v] : this.coordinate(k, this.positions[3 * v + k]));
        }
        const properties = [];
        for (const p of m.properties) properties.push([p, (await this.property("v", p))[v]]);
        return { number, place, properties, exact: !!m.exact };
    }
    /** What is known of a face: its number in the file and its properties. */
    async face(f) {
        const number = this.has("faces") ? (await this.column("faces", this.meta.faces, 4))[f] : null;
        const properties = [];
        for (const p of this.meta.face_properties) properties.push([p, (await this.property("f", p))[f]]);
        return { number, properties };
    }

    /** How the surface came to be; null where the page does not tell. */
    explained() {
        if (!this.meta.explanation) return null;
        return this.explanation ||= new Explanation(this).load();
    }

    /** The triangles of faces that `chosen(face)` holds of. */
    trianglesWhere(chosen) {
        const out = [];
        for (let t = 0; t < this.triangles.length / 3; t++)
            if (chosen(this.faceAt(t))) out.push(this.triangles[3 * t], this.triangles[3 * t + 1], this.triangles[3 * t + 2]);
        return Uint32Array.from(out);
    }

    /** The edges of the faces, twice where they are boundaries or flipped: pairs of vertices. */
    async wireframe() {
        const t = this.triangles.length ? this.triangles : this.hull, inner = this.faceOf ? this.diagonals() : null;
        if (this.filtration) return new Uint32Array(0); // of the shape that is shown: drawing.js
        let out = new Uint32Array(t.length + 1024), n = 0;
        const put = (a, b) => {
            if (n + 2 > out.length) { const more = new Uint32Array(2 * out.length); more.set(out); out = more; }
            out[n++] = a, out[n++] = b;
        };
        await inParts(t.length / 3, (from, to) => {
            for (let i = 3 * from; i < 3 * to; i += 3)
                for (let k = 0; k < 3; k++) {
                    const a = t[i + k], b = t[i + (k + 1) % 3];
                    if (a < b && !(inner && inner.has(a * 4294967296 + b))) put(a, b);
                }
        });
        for (const list of [this.boundary, this.flipped, this.nonmanifold]) for (let i = 0; i < list.length; i += 2) put(list[i], list[i + 1]);
        return out.subarray(0, n);
    }
    /** The edges, a * 2^32 + b with a < b, that two triangles of one polygon share. */
    diagonals() {
        const inner = new Set(), t = this.triangles;
        let seen = new Set(), face = -1;
        for (let i = 0; i < t.length; i += 3) {
            const f = this.faceAt(i / 3);
            if (f !== face) seen = new Set(), face = f;
            for (let k = 0; k < 3; k++) {
                const a = t[i + k], b = t[i + (k + 1) % 3], key = Math.min(a, b) * 4294967296 + Math.max(a, b);
                if (seen.has(key)) inner.add(key);
                seen.add(key);
            }
        }
        return inner;
    }

    /** Fewer triangles for moving: vertices in a cell of a grid become one of them, and triangles in three cells stay. */
    async coarse(cells) {
        const p = this.positions, t = this.triangles.length ? this.triangles : this.hull, n = this.meta.vertices;
        const width = (Math.max(...this.size) + 1) / cells;
        const [w, h] = [0, 1].map(k => Math.floor(this.size[k] / width) + 1);
        const depth = Math.floor(this.size[2] / width) + 1;
        const first = new Int32Array(w * h * depth).fill(-1), stands = new Uint32Array(n);
        await inParts(n, (from, to) => {
            for (let v = from; v < to; v++) {
                const c = Math.floor(p[3 * v] / width) + w * (Math.floor(p[3 * v + 1] / width) + h * Math.floor(p[3 * v + 2] / width));
                if (first[c] < 0) first[c] = v;
                stands[v] = first[c];
            }
        });
        const out = [];
        await inParts(t.length / 3, (from, to) => {
            for (let i = 3 * from; i < 3 * to; i += 3) {
                const a = stands[t[i]], b = stands[t[i + 1]], c = stands[t[i + 2]];
                if (a !== b && b !== c && c !== a) out.push(a, b, c);
            }
        });
        return Uint32Array.from(out);
    }

    /** The section of the tetrahedra with the plane normal . q = at, in steps: triangles of the cut and the tetrahedron of each. */
    section(normal, at) {
        const p = this.positions, t = this.tetrahedra, places = [], weights = [], of = [], d = [0, 0, 0, 0];
        for (let i = 0; i < t.length; i += 4) {
            let above = 0;
            for (let k = 0; k < 4; k++) {
                const v = 3 * t[i + k];
                d[k] = normal[0] * p[v] + normal[1] * p[v + 1] + normal[2] * p[v + 2] - at;
                if (d[k] > 0) above |= 1 << k;
            }
            if (above === 0 || above === 15) continue;
            const crossing = [];
            const inside = [0, 1, 2, 3].filter(k => above >> k & 1), outside = [0, 1, 2, 3].filter(k => !(above >> k & 1));
            const cut = (j, k) => crossing.push([t[i + j], t[i + k], d[j] / (d[j] - d[k])]);
            if (inside.length === 1) outside.forEach(k => cut(inside[0], k));
            else if (outside.length === 1) inside.forEach(k => cut(k, outside[0]));
            else { cut(inside[0], outside[0]); cut(inside[0], outside[1]); cut(inside[1], outside[1]); cut(inside[1], outside[0]); }
            for (let k = 2; k < crossing.length; k++) {
                for (const [a, b, f] of [crossing[0], crossing[k - 1], crossing[k]]) {
                    for (let x = 0; x < 3; x++) places.push(p[3 * a + x] + f * (p[3 * b + x] - p[3 * a + x]));
                    weights.push([a, b, f]);
                }
                of.push(i / 4);
            }
        }
        return { places: Float32Array.from(places), weights, of };
    }
}
