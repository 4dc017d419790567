// The scene: all layers in one box of about [-1, 1], the cutting plane, and what stands at a place of the picture.
import { add, cross, dot, length, sub } from "./matrix.js";

export class Scene {
    constructor(layers) {
        this.layers = layers;
        const low = [0, 0, 0], high = [0, 0, 0], full = layers.filter(l => l.meta.vertices); // an empty one has no place
        for (let k = 0; k < 3 && full.length; k++) {
            low[k] = Math.min(...full.map(l => l.meta.low[k]));
            high[k] = Math.max(...full.map(l => l.coordinate(k, l.size[k])));
        }
        this.centre = low.map((x, k) => x / 2 + high[k] / 2);
        const half = Math.max(...low.map((x, k) => high[k] / 2 - x / 2));
        this.unit = half > 0 ? half : 1;
        this.half = low.map((x, k) => (high[k] / 2 - x / 2) / this.unit);
        this.cutting = { on: false, axis: 0, at: 0.5, flip: false };
    }
    /** From where it is looked at first: [yaw, pitch]. Of an open surface, most of which would be seen from behind, the side that is its
     *  front; undefined where the usual one will do. */
    front() {
        const sums = new Map(), views = [[-0.6, 0.45]];
        for (const pitch of [-1.2, -0.45, 0, 0.45]) for (let i = 0; i < 8; i++) views.push([i * Math.PI / 4, pitch]);
        const normals = this.layers.filter(l => l.boundary.length && !l.filtration).flatMap(l => {
            const t = l.triangles, p = l.positions, step = 3 * Math.max(1, Math.floor(t.length / 30000)), unit = l.meta.step / this.unit, out = [];
            for (let i = 0; i + 2 < t.length; i += step) {
                const [a, b, c] = [0, 1, 2].map(k => [0, 1, 2].map(x => unit * p[3 * t[i + k] + x]));
                out.push(cross(sub(b, a), sub(c, a)));
            }
            return out;
        });
        for (const [yaw, pitch] of views) {
            const to = [Math.cos(pitch) * Math.sin(yaw), -Math.cos(pitch) * Math.cos(yaw), Math.sin(pitch)];
            let front = 0, all = 1e-300;
            for (const n of normals) { const seen = dot(n, to); all += Math.abs(seen); if (seen > 0) front += seen; }
            sums.set([yaw, pitch], front / all);
        }
        const [usual] = sums.values(), best = [...sums].reduce((a, b) => b[1] > a[1] + 1e-6 ? b : a);
        return best[1] > usual + 0.25 ? best[0] : undefined;
    }
    /** The distance from the middle at which an eye sees all vertices, in a picture whose half sides are x and y at the distance 1.
     *  apart  by which part the pieces of each layer are farther from its middle. */
    reach({ right, up, back }, x, y, apart) {
        let most = 0;
        this.layers.forEach((l, i) => {
            const place = this.placeOf(l), p = l.positions, middle = l.size.map(s => s / 2), wider = 1 + apart[i];
            for (const side of [right.map(r => r / x), right.map(r => -r / x), up.map(u => u / y), up.map(u => -u / y)]) {
                const way = add(back, side), [a, b, c] = way.map(w => w * place[3]);
                let far = -Infinity;
                for (let v = 0; v < p.length; v += 3) {
                    const d = a * p[v] + b * p[v + 1] + c * p[v + 2];
                    if (d > far) far = d;
                }
                most = Math.max(most, dot(way, place) + (1 - wider) * dot([a, b, c], middle) + wider * far);
            }
        });
        return most;
    }
    /** Where the whole numbers of a layer are in the scene: xyz, and the length of a step. */
    placeOf(layer) {
        const m = layer.meta;
        return Float32Array.from([...m.low.map((x, k) => 2 * ((x / 2 - this.centre[k] / 2) / this.unit)), m.step / this.unit]);
    }
    fromFile(p) { return p.map((x, k) => 2 * ((x / 2 - this.centre[k] / 2) / this.unit)); }
    toFile(p) { return p.map((x, k) => this.centre[k] + this.unit * x); }

    /** The plane: what has normal . p > offset is cut away. Null without one. */
    get cut() {
        const c = this.cutting;
        if (!c.on) return null;
        const normal = [0, 0, 0], sign = c.flip ? -1 : 1;
        normal[c.axis] = sign;
        return [...normal, sign * this.half[c.axis] * (2 * c.at - 1) * 1.0001];
    }
    /** The plane in the steps of a layer. */
    cutIn(place) {
        const [x, y, z, d] = this.cut;
        return [[x, y, z], (d - dot([x, y, z], place)) / place[3]];
    }

    /** What a pick of the renderer found: {drawing, vertex, face, tetrahedron, point}. */
    identify(found) {
        const { drawing, kind, id, point } = found, l = drawing.layer, place = drawing.place;
        const q = point.map((x, k) => (x - place[k]) / place[3]);
        const at = v => [0, 1, 2].map(k => l.positions[3 * v + k]);
        const nearest = (list, to = q) => list.reduce((a, v) => length(sub(at(v), to)) < length(sub(at(a), to)) ? v : a);
        const out = { drawing, point, vertex: 0, face: null, tetrahedron: null };
        if (kind === "point") out.vertex = drawing.vertexAt(id);
        else if (kind === "edge") out.vertex = id;
        else if (kind === "section") {
            out.tetrahedron = drawing.section.of[Math.floor(id / 3)];
            out.vertex = nearest(Array.from(l.tetrahedra.subarray(4 * out.tetrahedron, 4 * out.tetrahedron + 4)));
        } else if (kind === "piece") {
            const { corner, face, cells } = l.apart, chosen = drawing.chosen[Math.floor(id / 3)];
            const c = 3 * l.apart.piece[chosen], far = drawing.state.explode, back = q.map((x, k) => x - far * (l.apart.centre[c + k] - l.size[k] / 2));
            out.vertex = nearest(Array.from(corner.subarray(3 * chosen, 3 * chosen + 3)), back);
            out.moved = true;
            if (cells) out.face = face[chosen];
            else out.tetrahedron = face[chosen];
        } else if (kind === "shape" || kind === "singular") {
            const { all, of, boundary } = drawing.shape, first = kind === "shape" ? 0 : boundary, end = kind === "shape" ? boundary : of.length;
            const chosen = first + nearestTriangle(all.subarray(3 * first, 3 * end), id, q, at);
            out.vertex = nearest(Array.from(all.subarray(3 * chosen, 3 * chosen + 3)));
            out.face = of[chosen];
        } else {
            const t = l.triangles.length ? l.triangles : l.hull;
            const chosen = kind === "corner" ? Math.floor(id / 3) : nearestTriangle(t, id, q, at);
            out.vertex = nearest(Array.from(t.subarray(3 * chosen, 3 * chosen + 3)));
            if (l.triangles.length) out.face = l.faceAt(chosen);
        }
        return out;
    }
}

/** Of the triangles whose last corner is v, the one that is nearest to q. */
function nearestTriangle(triangles, v, q, at) {
    let best = 0, least = Infinity;
    for (let i = 2; i < triangles.length; i += 3) {
        if (triangles[i] !== v) continue;
        const a = at(triangles[i - 2]), b = at(triangles[i - 1]), c = at(v);
        const far = distanceTo(a, b, c, q);
        if (far < least) least = far, best = (i - 2) / 3;
    }
    return best;
}

function distanceTo(a, b, c, q) {
    const u = sub(b, a), w = sub(c, a), p = sub(q, a);
    const uu = dot(u, u), uw = dot(u, w), ww = dot(w, w), pu = dot(p, u), pw = dot(p, w), d = uu * ww - uw * uw || 1e-30;
    let s = Math.max(0, Math.min(1, (ww * pu - uw * pw) / d)), t = Math.max(0, Math.min(1, (uu * pw - uw * pu) / d));
    if (s + t > 1) { const over = s + t; s /= over; t /= over; }
    return length([0, 1, 2].map(k => p[k] - s * u[k] - t * w[k]));
}
