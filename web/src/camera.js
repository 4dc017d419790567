// The camera turns about a target: the scene is in a box of about [-1, 1]. `up` is the axis that stays upright.
import { add, cross, dot, multiply, sub, unit } from "./matrix.js";

const FIELD = 35 * Math.PI / 180; // of view, the shorter side
const FIRST = [-0.6, 0.45];
const FILLED = 0.9; // of the picture, at first
const NEAR_HOME = 0.5; // of a scene of one point
const NEAREST = 1e-5, FARTHEST = 200; // distances from the target

export class Camera {
    constructor() {
        this.up = 2;
        this.parallel = false;
        this.first = FIRST; // yaw and pitch, and the distance, at first
        this.home = 4;
        this.reset();
    }
    /** Takes from where the scene is looked at first, [yaw, pitch], and the sides of the picture. All is seen then. Stays where it was
     *  moved to.   reach  gives the distance that is needed, of the axes and the half sides of the picture at the distance 1. */
    fit(reach, first = FIRST, width = 1, height = 1) {
        const was = [...this.first, this.home, 0, 0, 0], now = [this.yaw, this.pitch, this.distance, ...this.target], there = new Camera();
        Object.assign(there, { up: this.up, yaw: first[0], pitch: first[1] });
        const half = FILLED * Math.tan(FIELD / 2) / Math.min(width, height); // for each pixel
        this.first = first;
        this.home = Math.max(NEAR_HOME, Math.min(FARTHEST, reach(there.axes(), half * width, half * height)));
        if (now.every((x, i) => x === was[i])) this.reset();
    }
    reset() {
        [this.yaw, this.pitch] = this.first;
        this.distance = this.home;
        this.target = [0, 0, 0];
    }
    /** The axes of the view: to the right, upwards, towards the eye. */
    axes() {
        const [c, s, p, q] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
        const turn = v => this.up === 2 ? v : this.up === 1 ? [v[0], v[2], -v[1]] : [v[2], v[0], v[1]];
        const back = turn([p * s, -p * c, q]);
        const right = turn([c, s, 0]);
        return { right, up: cross(back, right), back };
    }
    get eye() { return add(this.target, this.axes().back, this.distance); }
    turn(dx, dy) {
        this.yaw -= dx;
        this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + dy));
    }
    /** Moves by parts of the view's shorter side. */
    pan(dx, dy) {
        const { right, up } = this.axes();
        const size = 2 * this.distance * Math.tan(FIELD / 2);
        this.target = add(add(this.target, right, -dx * size), up, dy * size);
    }
    /** Scales the distance by f; what is at (x, y), in parts of the shorter side from the middle, stays there. */
    zoom(f, x = 0, y = 0) {
        const to = Math.max(NEAREST, Math.min(FARTHEST, this.distance * f)) / this.distance;
        this.pan(-x * (1 - to), y * (1 - to));
        this.distance *= to;
    }
    /** Looks along an axis: 0 to 5 for -x, +x, -y, +y, -z, +z of an upright z. */
    look(side) {
        [this.yaw, this.pitch] = [[0, 0], [Math.PI / 2, 0], [Math.PI, 0], [-Math.PI / 2, 0], [0, Math.PI / 2], [0, -Math.PI / 2]][side];
    }
    view() {
        const { right, up, back } = this.axes(), eye = this.eye;
        return new Float64Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
            -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
    }
    /** near and far leave room for the scene, whose box has the radius 2 at most. */
    projection(width, height) {
        const far = this.distance + Math.hypot(...this.target) + 4, near = Math.max(this.distance * 0.01, far * 1e-5);
        const t = Math.tan(FIELD / 2) / Math.min(width, height);
        if (this.parallel) {
            const [x, y, back] = [t * width * this.distance, t * height * this.distance, far];
            return new Float64Array([1 / x, 0, 0, 0, 0, 1 / y, 0, 0, 0, 0, -1 / (far + back) * 2, 0, 0, 0, -(far - back) / (far + back), 1]);
        }
        return new Float64Array([1 / (t * width), 0, 0, 0, 0, 1 / (t * height), 0, 0,
            0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0]);
    }
    matrix(width, height) { return multiply(this.projection(width, height), this.view()); }
    /** The length of a pixel at the target. */
    pixel(width, height) { return 2 * this.distance * Math.tan(FIELD / 2) / Math.min(width, height); }
    toArray() { return [this.yaw, this.pitch, this.distance, ...this.target, this.up, +this.parallel].map(x => +x.toPrecision(6)); }
    fromArray(a) {
        if (a.length !== 8 || !a.every(Number.isFinite)) return;
        [this.yaw, this.pitch] = a;
        this.distance = Math.max(NEAREST, Math.min(FARTHEST, a[2]));
        this.target = a.slice(3, 6);
        this.up = Math.max(0, Math.min(2, Math.round(a[6])));
        this.parallel = !!a[7];
    }
}
export { unit, sub };
