// How a surface came to be at its samples (src/page/explanation.c): decoded when first asked for. Places and polar balls are exact;
// vertices of cells, tetrahedra and power faces are relative to their sample.
import { differences, reals } from "./decode.js";

const CELL = 0, TAKEN = 1; // kinds of polygons: brio_explained_polygon
const UNKNOWN = 255, CONFIDENCES = 254;

export class Explanation {
    constructor(layer) {
        this.layer = layer;
        this.meta = layer.meta.explanation;
    }
    async load() {
        const l = this.layer, m = this.meta, n = m.samples;
        const whole = (name, count, width) => l.once(`e-${name}`, bytes => differences(bytes, count, width));
        const real = (name, count, width) => l.once(`e-${name}`, bytes => reals(bytes, count, width));
        const rows = async (name, columns, count, width) => { const list = []; for (let k = 0; k < columns; k++) list.push(await real(`${name}-${k}`, count, width)); return list; };
        const offsets = async (name, count) => {
            const counts = await whole(name, count, 4), out = new Float64Array(count + 1);
            for (let i = 0; i < count; i++) out[i + 1] = out[i] + counts[i];
            return out;
        };
        Object.assign(this, {
            points: await whole("point", n, 4), place: await rows("place", 3, n, 8), pole: await rows("pole", 8, n, 8), axis: await rows("axis", 3, n, 4),
            poleSide: await whole("pole-side", 2 * n, 1), vertexFrom: await offsets("vertices", n), tetrahedronFrom: await offsets("tetrahedra", n), polygonFrom: await offsets("polygons", n),
            vertex: await rows("vertex", 3, m.vertices, 4), tetrahedron: [], side: await whole("side", m.tetrahedra, 1), confidence: await whole("confidence", m.tetrahedra, 1),
            taken: await whole("taken", m.tetrahedra, 1), kind: await whole("kind", m.polygons, 1), cornerFrom: await offsets("corners", m.polygons), corner: await whole("corner", m.corners, 4),
        });
        for (let k = 0; k < 3; k++) this.tetrahedron.push(await whole(`tetrahedron-${k}`, m.tetrahedra, 4));
        return this;
    }

    /** What is known of sample e. Sides are -1 inner, 1 outer, 0 not known; corners are numbers of `vertices`, and the sample is number 0. */
    at(e) {
        const vertices = [], tetrahedra = [], polygons = [];
        const unit = 2 ** this.meta.exponent;
        for (let v = this.vertexFrom[e]; v < this.vertexFrom[e + 1]; v++) vertices.push(this.vertex.map(c => unit * c[v]));
        for (let t = this.tetrahedronFrom[e]; t < this.tetrahedronFrom[e + 1]; t++)
            tetrahedra.push({ corners: [0, ...this.tetrahedron.map(c => c[t])], side: this.side[t] - 1, taken: this.taken[t], confidence: this.confidence[t] === UNKNOWN ? null : this.confidence[t] / CONFIDENCES });
        for (let p = this.polygonFrom[e]; p < this.polygonFrom[e + 1]; p++)
            polygons.push({ cell: this.kind[p] === CELL, taken: this.kind[p] === TAKEN, corners: Array.from(this.corner.subarray(this.cornerFrom[p], this.cornerFrom[p + 1])) });
        const poles = [0, 1].map(i => ({ centre: [0, 1, 2].map(k => this.pole[4 * i + k][e]), radius: this.pole[4 * i + 3][e], side: this.poleSide[2 * e + i] - 1 }));
        return { point: this.points[e], place: this.place.map(c => c[e]), axis: this.axis.map(c => c[e]), poles, vertices, tetrahedra, polygons };
    }
    /** The sample that is nearest to a place of the file. */
    nearest(p) {
        let best = 0, least = Infinity;
        for (let e = 0; e < this.meta.samples; e++) {
            const far = Math.hypot(this.place[0][e] - p[0], this.place[1][e] - p[1], this.place[2][e] - p[2]);
            if (far < least) least = far, best = e;
        }
        return best;
    }
}

/** How many faces the surface took at a sample: facets, whether one of its tetrahedra has them or two, and faces of power cells. */
export function facesTaken(told) {
    const facets = new Set();
    for (const t of told.tetrahedra)
        for (let i = 1; i < 4; i++)
            if (t.taken >> i & 1) facets.add(t.corners.filter((_, c) => c && c !== i).sort((a, b) => a - b).join());
    return facets.size + told.polygons.filter(p => p.taken).length;
}

const COLOURS = { inner: [0.84, 0.22, 0.2], outer: [0.2, 0.46, 0.9], unknown: [0.55, 0.58, 0.62], cell: [0.45, 0.3, 0.75], cocone: [0.16, 0.62, 0.3], taken: [0.95, 0.7, 0.2] };
export const colourOf = side => side < 0 ? COLOURS.inner : side > 0 ? COLOURS.outer : COLOURS.unknown;

/** Triangles with colours. */
class Pile {
    constructor() { this.place = []; this.rgba = []; }
    triangle(a, b, c, colour) {
        this.place.push(...a, ...b, ...c);
        for (let i = 0; i < 3; i++) this.rgba.push(...colour.map(x => Math.round(255 * x)), 255);
    }
    fan(points, colour) { for (let i = 2; i < points.length; i++) this.triangle(points[0], points[i - 1], points[i], colour); }
}

/** The outside of the co-cone about a place: two mantles, as far as `reach`. */
function coconeOf(pile, place, axis, theta, reach) {
    const [x, y, z] = axis, other = Math.abs(x) < 0.8 ? [1, 0, 0] : [0, 1, 0], sides = 48;
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let u = cross([x, y, z], other);
    u = u.map(c => c / Math.hypot(...u));
    const v = cross([x, y, z], u);
    const at = (turn, up) => place.map((c, k) => c + reach * (Math.cos(theta) * (Math.cos(turn) * u[k] + Math.sin(turn) * v[k]) + up * Math.sin(theta) * axis[k]));
    for (const up of [-1, 1])
        for (let i = 0; i < sides; i++) pile.triangle(place, at(2 * Math.PI * i / sides, up), at(2 * Math.PI * (i + 1) / sides, up), COLOURS.cocone);
}

/** What to draw of a sample, in the steps of its layer: piles of triangles, ends of lines, and balls. Values are those of the page; only
 *  their places are turned into steps here, tetrahedra shrunk, and the cone cut off. */
export function pictureOf(told, layer, theta) {
    const { low, step } = layer.meta, toSteps = p => p.map((x, k) => 2 * ((x / 2 - low[k] / 2) / step)), origin = toSteps(told.place);
    const at = v => origin.map((x, k) => x + told.vertices[v][k] / step), loops = [], power = [], cell = new Pile(), faces = new Pile(), labels = new Pile(), cone = new Pile();
    const outline = (list, corners) => corners.forEach((v, i) => list.push(...at(v), ...at(corners[(i + 1) % corners.length])));
    for (const p of told.polygons) {
        if (p.cell) { cell.fan(p.corners.map(at), COLOURS.cell); outline(loops, p.corners); }
        else if (p.taken) { faces.fan(p.corners.map(at), COLOURS.taken); outline(power, p.corners); }
        else outline(power, p.corners);
    }
    const near = [...new Set(told.tetrahedra.flatMap(t => t.corners.slice(1)))].map(v => Math.hypot(...told.vertices[v]) / step).sort((a, b) => a - b);
    const reach = 1.2 * (near[Math.floor(near.length / 3)] || 0); // about to the neighbours along the surface
    for (const t of told.tetrahedra) {
        const corner = t.corners.map(at), middle = [0, 1, 2].map(k => corner.reduce((s, c) => s + c[k] / 4, 0)), sure = t.confidence === null ? 1 : Math.max(0.15, Math.min(1, 2 * t.confidence - 1));
        const colour = colourOf(t.side).map((c, k) => sure * c + (1 - sure) * 0.75 * (k < 3)), small = corner.map(c => c.map((x, k) => middle[k] + 0.85 * (x - middle[k])));
        for (const [i, j, k] of [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]) labels.triangle(small[i], small[j], small[k], colour);
        for (let i = 1; i < 4; i++) {
            if (!(t.taken >> i & 1)) continue;
            faces.triangle(...corner.filter((_, c) => c !== i), COLOURS.taken);
        }
    }
    if (Number.isFinite(told.axis[0])) coconeOf(cone, origin, told.axis, theta, reach);
    const balls = told.poles.filter(p => Number.isFinite(p.radius)).map(p => ({ row: [...toSteps(p.centre), p.radius / step], colour: colourOf(p.side), side: p.side }));
    const lines = [];
    for (const p of told.poles) if (p.radius === Infinity) lines.push(...origin, ...origin.map((x, k) => x + 3 * reach * p.centre[k])); // a pole at infinity: its direction
    for (const b of balls) lines.push(...origin, ...b.row.slice(0, 3));
    return { origin, reach, cell, loops, faces, power, labels, cone, balls, lines };
}
