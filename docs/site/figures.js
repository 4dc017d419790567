// Live figures of docs/theory.md, in the plane: <div class="figure" data-figure="cells"></div>. A drag moves a point, a slider moves a value.
// Cells are cut out of a box by one half-plane for each other point, so that a figure needs no triangulation: it has few points.
(function () {
    "use strict";
    const FAR = 40; // the box of the cells: so far out that cells of the hull meet where Delaunay triangles are
    const COLOURS = ["#8ecae6", "#ffb703", "#90be6d", "#f4978e", "#b8a1d9", "#f9c74f", "#77c2b5", "#e0a458", "#a3b18a", "#cdb4db"];
    const INNER = "#d1495b", OUTER = "#2e86ab";

    // --- geometry ---

    const square = (a, b) => (a.x - b.x) ** 2 + (a.y - b.y) ** 2;
    /** The power cell of site i: corners in order; `by` is the site behind the edge that begins there, -1 for the box. */
    function cellOf(sites, i) {
        let cell = [[-FAR, -FAR], [FAR, -FAR], [FAR, FAR], [-FAR, FAR]].map(([x, y]) => ({ x, y, by: -1 }));
        const s = sites[i], w = s.w || 0;
        for (let j = 0; j < sites.length && cell.length; j++) {
            if (j === i) continue;
            const t = sites[j], nx = t.x - s.x, ny = t.y - s.y, d = (t.x ** 2 + t.y ** 2 - (t.w || 0) - s.x ** 2 - s.y ** 2 + w) / 2;
            const side = cell.map(p => nx * p.x + ny * p.y - d), kept = [];
            if (side.every(x => x <= 0)) continue;
            cell.forEach((p, k) => {
                const next = (k + 1) % cell.length, q = cell[next], a = side[k], b = side[next];
                if (a <= 0) kept.push(p);
                if ((a <= 0) !== (b <= 0)) {
                    const f = a / (a - b), cut = { x: p.x + f * (q.x - p.x), y: p.y + f * (q.y - p.y) };
                    kept.push({ ...cut, by: a <= 0 ? j : p.by });
                }
            });
            cell = kept;
        }
        return cell;
    }
    const cellsOf = sites => sites.map((_, i) => cellOf(sites, i));
    /** The dual: pairs of sites whose cells share an edge, and triples whose cells share a corner. */
    function dualOf(cells) {
        const edges = new Map(), triangles = new Map();
        cells.forEach((cell, i) => cell.forEach((p, k) => {
            const before = cell[(k + cell.length - 1) % cell.length].by;
            if (p.by > i) edges.set(`${i} ${p.by}`, [i, p.by]);
            if (p.by >= 0 && before >= 0 && p.by !== before) {
                const t = [i, before, p.by].sort((a, b) => a - b);
                triangles.set(t.join(" "), { corners: t, centre: p });
            }
        }));
        return { edges: [...edges.values()], triangles: [...triangles.values()] };
    }
    /** The alpha filtration: squared radii from which on edges and triangles are there. */
    function filtrationOf(sites) {
        const cells = cellsOf(sites), { edges, triangles } = dualOf(cells);
        for (const t of triangles) t.value = square(t.centre, sites[t.corners[0]]);
        const list = edges.map(([a, b]) => {
            const p = sites[a], q = sites[b], middle = { x: (p.x + q.x) / 2, y: (p.y + q.y) / 2 }, own = square(p, q) / 4;
            const gabriel = sites.every((s, k) => k === a || k === b || square(s, middle) >= own);
            const above = triangles.filter(t => t.corners.includes(a) && t.corners.includes(b)).map(t => t.value);
            return { ends: [a, b], value: gabriel ? own : Math.min(...above) };
        });
        return { cells, edges: list, triangles };
    }
    /** Both poles of a sample: the corner of its cell that is farthest, and the farthest one on the other side of it. */
    function polesOf(sites, i, cell) {
        const s = sites[i], far = list => list.reduce((a, b) => square(b, s) > square(a, s) ? b : a), first = far(cell);
        const others = cell.filter(p => (p.x - s.x) * (first.x - s.x) + (p.y - s.y) * (first.y - s.y) < 0);
        return others.length ? [first, far(others)] : [first];
    }
    function isInside(curve, p) {
        let inside = false;
        curve.forEach((a, k) => {
            const b = curve[(k + 1) % curve.length];
            if ((a.y > p.y) !== (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
        });
        return inside;
    }

    // --- points ---

    function random(seed) {
        let state = seed;
        return () => (state = state * 48271 % 2147483647) / 2147483647;
    }
    const scattered = (n, seed) => { const r = random(seed); return Array.from({ length: n }, () => ({ x: 0.08 + 1.44 * r(), y: 0.08 + 0.84 * r(), w: 0 })); };
    const onCurve = t => ({ x: 0.8 + 0.58 * Math.cos(t) * (1 - 0.2 * Math.cos(2 * t)) + 0.04 * Math.sin(t + 1), y: 0.5 + 0.34 * Math.sin(t) * (1 + 0.4 * Math.cos(2 * t)) + 0.05 * Math.cos(t - 0.7) });
    const sampled = n => Array.from({ length: n }, (_, k) => onCurve(2 * Math.PI * k / n));

    // --- drawing: the figure is 1.6 wide and 1 high ---

    class Figure {
        constructor(box, kind) {
            Object.assign(this, { box, kind, chosen: 0, ...kind.begin() });
            this.canvas = document.createElement("canvas");
            this.canvas.setAttribute("role", "img");
            this.canvas.setAttribute("aria-label", kind.words);
            this.canvas.style.cssText = "display:block;width:100%;aspect-ratio:1.6;touch-action:none;cursor:grab;border:1px solid #8888;border-radius:6px";
            box.append(this.canvas);
            for (const [key, words, least, most, step] of kind.sliders || []) {
                const label = document.createElement("label"), slider = document.createElement("input");
                Object.assign(slider, { type: "range", min: least, max: most, step, value: this[key] ?? 0 });
                slider.oninput = () => { this[key] = +slider.value; kind.slid?.(this); this.draw(); };
                this.slider = slider;
                label.append(words + " ", slider);
                label.style.cssText = "display:inline-flex;gap:8px;align-items:center;margin-right:16px";
                box.append(label);
            }
            const place = e => { const r = this.canvas.getBoundingClientRect(); return { x: (e.clientX - r.left) / r.width * 1.6, y: (e.clientY - r.top) / r.height }; };
            const nearest = p => this.sites.reduce((a, s, i) => square(s, p) < square(this.sites[a], p) ? i : a, 0);
            this.canvas.addEventListener("pointerdown", e => { this.held = this.chosen = nearest(place(e)); this.canvas.setPointerCapture(e.pointerId); this.draw(); });
            this.canvas.addEventListener("pointermove", e => {
                if (this.held === undefined || kind.fixed) return;
                const p = place(e);
                Object.assign(this.sites[this.held], { x: Math.max(0.02, Math.min(1.58, p.x)), y: Math.max(0.02, Math.min(0.98, p.y)) });
                this.draw();
            });
            this.canvas.addEventListener("pointerup", () => { this.held = undefined; });
            if (kind.fixed) this.canvas.addEventListener("pointermove", e => { const i = nearest(place(e)); if (i !== this.chosen) { this.chosen = i; this.draw(); } });
            new ResizeObserver(() => this.draw()).observe(this.canvas);
        }
        draw() {
            const ratio = window.devicePixelRatio || 1, width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
            this.canvas.width = width;
            this.canvas.height = Math.round(width / 1.6);
            const c = this.pen = this.canvas.getContext("2d");
            c.scale(width / 1.6, width / 1.6);
            this.ink = getComputedStyle(this.box).color;
            this.line = 1.6 / width * ratio;
            this.kind.draw(this);
        }
        path(points) {
            this.pen.beginPath();
            points.forEach(p => this.pen.lineTo(p.x, p.y));
            this.pen.closePath();
        }
        fill(points, colour) { this.path(points); this.pen.fillStyle = colour; this.pen.fill(); }
        stroke(points, colour, wide = 1) { this.path(points); this.pen.strokeStyle = colour; this.pen.lineWidth = wide * this.line; this.pen.stroke(); }
        segment(a, b, colour, wide = 1) { this.stroke([a, b], colour, wide); }
        dot(p, colour = this.ink, size = 3.5) { this.circle(p, size * this.line, colour, true); }
        circle(p, radius, colour, full = false, wide = 1.5) {
            this.pen.beginPath();
            this.pen.arc(p.x, p.y, radius, 0, 2 * Math.PI);
            this.pen[full ? "fillStyle" : "strokeStyle"] = colour;
            this.pen.lineWidth = wide * this.line;
            this.pen[full ? "fill" : "stroke"]();
        }
    }

    const KINDS = {
        cells: {
            words: "Voronoi cells of points that can be moved, and their Delaunay triangulation",
            begin: () => ({ sites: scattered(22, 5) }),
            draw(f) {
                const cells = f.cells = cellsOf(f.sites), dual = f.dual = dualOf(cells);
                cells.forEach((cell, i) => { f.fill(cell, COLOURS[i % COLOURS.length] + "66"); f.stroke(cell, f.ink, 0.8); });
                for (const [a, b] of dual.edges) f.segment(f.sites[a], f.sites[b], INNER, 1.2);
                const mine = dual.triangles.filter(t => t.corners.includes(f.chosen));
                for (const t of mine) f.circle(t.centre, Math.sqrt(square(t.centre, f.sites[f.chosen])), OUTER, false, 1);
                f.sites.forEach((s, i) => f.dot(s, i === f.chosen ? INNER : f.ink, i === f.chosen ? 6 : 3.5));
            },
        },
        power: {
            words: "Power cells of circles that can be moved",
            sliders: [["radius", "radius of the chosen circle", 0, 0.3, 0.005]],
            begin: () => ({ sites: scattered(12, 11).map((s, i) => ({ ...s, w: (0.04 + 0.03 * (i % 4)) ** 2 }))}),
            slid(f) { f.sites[f.chosen].w = f.radius ** 2; },
            draw(f) {
                f.slider.value = Math.sqrt(f.sites[f.chosen].w);
                const cells = f.cells = cellsOf(f.sites);
                cells.forEach((cell, i) => { if (cell.length) { f.fill(cell, COLOURS[i % COLOURS.length] + "66"); f.stroke(cell, f.ink, 1); } });
                f.sites.forEach((s, i) => { f.circle(s, Math.sqrt(s.w), i === f.chosen ? INNER : OUTER); f.dot(s, cells[i].length ? f.ink : "#888"); });
            },
        },
        alpha: {
            words: "The alpha complex of points, with the balls that grow",
            sliders: [["radius", "radius of the balls", 0, 0.5, 0.005]],
            begin: () => ({ sites: scattered(26, 3), radius: 0.1 }),
            draw(f) {
                const { cells, edges, triangles } = f.filtration = filtrationOf(f.sites), alpha = f.radius ** 2;
                cells.forEach((cell, i) => {
                    f.pen.save();
                    f.path(cell);
                    f.pen.clip();
                    f.circle(f.sites[i], f.radius, "#8ecae688", true);
                    f.pen.restore();
                    f.stroke(cell, "#8886", 0.7);
                });
                f.shown = { triangles: triangles.filter(t => t.value <= alpha), edges: edges.filter(e => e.value <= alpha) };
                for (const t of f.shown.triangles) f.fill(t.corners.map(i => f.sites[i]), "#d1495b55");
                for (const e of f.shown.edges) f.segment(f.sites[e.ends[0]], f.sites[e.ends[1]], INNER, 1.5);
                f.sites.forEach(s => f.dot(s));
            },
        },
        poles: {
            words: "A sample of a curve, its cell, its poles, its polar balls and its co-cone",
            sliders: [["count", "samples", 12, 80, 1]],
            fixed: true,
            begin: () => ({ count: 36, sites: sampled(36) }),
            draw(f) {
                const n = Math.round(f.count);
                if (f.sites.length !== n) f.sites = sampled(n), f.chosen = Math.min(f.chosen, n - 1);
                const cells = f.cells = cellsOf(f.sites), s = f.sites[f.chosen], cell = cells[f.chosen];
                for (const other of cells) f.stroke(other, "#8886", 0.7);
                f.fill(cell, "#ffb70366");
                f.stroke(cell, f.ink, 1);
                const curve = sampled(400), poles = f.poles = polesOf(f.sites, f.chosen, cell);
                f.stroke(curve, f.ink, 1);
                const [p] = poles, angle = Math.atan2(p.y - s.y, p.x - s.x) + Math.PI / 2, wide = Math.PI / 8; // 22.5 degrees
                for (const turn of [0, Math.PI]) {
                    const ray = a => ({ x: s.x + 2 * Math.cos(angle + turn + a), y: s.y + 2 * Math.sin(angle + turn + a) });
                    f.pen.save();
                    f.path(cell);
                    f.pen.clip();
                    f.fill([s, ray(-wide), ray(wide)], "#90be6dcc");
                    f.pen.restore();
                }
                for (const q of poles) {
                    const colour = isInside(curve, q) ? INNER : OUTER;
                    f.circle(q, Math.sqrt(square(q, s)), colour);
                    f.dot(q, colour, 5);
                    f.segment(s, q, colour, 1);
                }
                f.sites.forEach((x, i) => f.dot(x, f.ink, i === f.chosen ? 6 : 3));
            },
        },
        crust: {
            words: "The power crust: edges between power cells of inner and outer polar balls",
            sliders: [["count", "samples", 8, 60, 1]],
            fixed: true,
            begin: () => ({ count: 26, sites: sampled(26) }),
            draw(f) {
                const n = Math.round(f.count);
                if (f.sites.length !== n) f.sites = sampled(n), f.chosen = Math.min(f.chosen, n - 1);
                const curve = sampled(400), cells = cellsOf(f.sites), poles = [];
                cells.forEach((cell, i) => {
                    for (const p of polesOf(f.sites, i, cell)) {
                        const w = square(p, f.sites[i]);
                        if (!poles.some(q => square(p, q) < 1e-12)) poles.push({ x: p.x, y: p.y, w, inner: isInside(curve, p) });
                    }
                });
                const power = cellsOf(poles);
                f.crust = [];
                power.forEach((cell, i) => {
                    f.fill(cell, (poles[i].inner ? INNER : OUTER) + "22");
                    f.stroke(cell, "#8884", 0.6);
                    if (poles[i].inner) f.circle(poles[i], Math.sqrt(poles[i].w), INNER + "88", false, 0.8);
                    cell.forEach((p, k) => { if (p.by >= 0 && poles[i].inner && !poles[p.by].inner) f.crust.push([p, cell[(k + 1) % cell.length]]); });
                });
                for (const [a, b] of f.crust) f.segment(a, b, f.ink, 2.5);
                poles.forEach(p => f.dot(p, p.inner ? INNER : OUTER, 2.5));
                f.sites.forEach(s => f.dot(s));
            },
        },
    };

    const begin = () => { window.brioFigures = [...document.querySelectorAll(".figure[data-figure]")].map(box => new Figure(box, KINDS[box.dataset.figure])); };
    if (document.readyState === "loading") addEventListener("DOMContentLoaded", begin);
    else begin();
})();
