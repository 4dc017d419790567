// Pointers, wheel and keys on the picture.
import { at } from "./dom.js";

const CLICK = 5; // pixels that a click may move

/** Connects the canvas with the camera. */
export function listen(app) {
    const canvas = app.canvas, down = new Map();
    let travelled = 0, button = 0;
    const place = e => { const r = canvas.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
    const side = () => { const { view } = app.viewAt(1, 1); return Math.min(view.width, view.height) / app.ratio; };
    /** The place from the middle of its view, in parts of the shorter side; upwards is positive. */
    const fromMiddle = (x, y) => {
        const { view, x: px, y: py } = app.viewAt(x, y), s = Math.min(view.width, view.height);
        return [(px - view.width / 2) / s, (py - view.height / 2) / s];
    };
    const middle = list => list.reduce((m, p) => [m[0] + p[0] / list.length, m[1] + p[1] / list.length], [0, 0]);
    const spread = list => Math.hypot(list[0][0] - list[1][0], list[0][1] - list[1][1]);

    canvas.addEventListener("pointerdown", e => {
        canvas.setPointerCapture(e.pointerId);
        canvas.focus({ preventScroll: true });
        if (!down.size) travelled = 0;
        down.set(e.pointerId, place(e));
        if (down.size > 1) travelled = Infinity;
        button = e.button;
        document.body.classList.add("quiet");
    });
    canvas.addEventListener("pointermove", e => {
        if (!down.has(e.pointerId)) return;
        const before = [...down.values()], was = down.get(e.pointerId), now = place(e);
        down.set(e.pointerId, now);
        const after = [...down.values()], [dx, dy] = [now[0] - was[0], now[1] - was[1]];
        travelled += Math.hypot(dx, dy);
        if (travelled < CLICK) return;
        if (before.length >= 2) {
            const [a, b] = [middle(before), middle(after)];
            app.camera.pan((b[0] - a[0]) / side(), (b[1] - a[1]) / side());
            app.camera.zoom(spread(before) / Math.max(1, spread(after)), ...fromMiddle(...b));
        } else if (button === 2 || button === 1 || e.shiftKey) app.camera.pan(dx / side(), dy / side());
        else app.camera.turn(3.2 * dx / side(), 3.2 * dy / side());
        app.redraw(true);
    });
    const up = e => {
        if (!down.delete(e.pointerId)) return;
        if (e.type === "pointerup" && travelled < CLICK && e.button === 0) app.picker.pick(...place(e));
    };
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    canvas.addEventListener("contextmenu", e => e.preventDefault());
    canvas.addEventListener("wheel", e => {
        e.preventDefault();
        const lines = e.deltaMode === 1 ? 16 : e.deltaMode === 2 ? 400 : 1;
        app.camera.zoom(Math.exp(Math.max(-1, Math.min(1, e.deltaY * lines * 0.0015))), ...fromMiddle(...place(e)));
        document.body.classList.add("quiet");
        app.redraw(true);
    }, { passive: false });
    canvas.addEventListener("dblclick", async e => {
        const pick = await app.picker.pick(...place(e));
        if (!pick) return;
        app.camera.target = [...pick.point];
        app.redraw(true);
    });

    canvas.addEventListener("keydown", e => {
        if (e.ctrlKey || e.altKey || e.metaKey) return;
        const step = 0.12, c = app.camera, [w, h] = [canvas.clientWidth, canvas.clientHeight];
        const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
        if (arrows[e.key]) e.shiftKey ? c.pan(arrows[e.key][0] * step, arrows[e.key][1] * step) : c.turn(arrows[e.key][0] * step, arrows[e.key][1] * step);
        else if (e.key === "+" || e.key === "=") c.zoom(1 / 1.15);
        else if (e.key === "-") c.zoom(1.15);
        else if (e.key === "0" || e.key === "Home") app.resetView();
        else if ("123456".includes(e.key)) c.look(+e.key - 1);
        else if (e.key === "Enter") app.picker.pick(w / 2, h / 2);
        else if (e.key === "Escape") app.picker.clear();
        else return;
        e.preventDefault();
        document.body.classList.add("quiet");
        app.redraw(true);
    });
    at("hint").addEventListener("click", () => document.body.classList.add("quiet"));
    // Letters work wherever no text is typed and no list is chosen from.
    document.addEventListener("keydown", e => {
        if (e.ctrlKey || e.altKey || e.metaKey || e.target.tagName === "SELECT" || e.target.type === "text") return;
        const tool = app.tools.find(t => t.key === e.key.toLowerCase());
        if (tool) tool.button.click();
    });
}
