// Vectors of three numbers, quaternions x y z w, and 4 by 4 matrices in columns.

export const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = a => Math.hypot(a[0], a[1], a[2]);
export const unit = a => { const l = length(a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };

export function multiply(a, b) {
    const out = new Float64Array(16);
    for (let c = 0; c < 4; c++)
        for (let r = 0; r < 4; r++)
            for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    return out;
}

/** Returns m (p, 1), divided. */
export function project(m, p) {
    const at = r => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    const w = at(3) || 1e-30;
    return [at(0) / w, at(1) / w, at(2) / w, w];
}

export function invert(m) {
    const a = Array.from({ length: 4 }, (_, r) => [m[r], m[4 + r], m[8 + r], m[12 + r], +(r === 0), +(r === 1), +(r === 2), +(r === 3)]);
    for (let c = 0; c < 4; c++) {
        let best = c;
        for (let r = c; r < 4; r++) if (Math.abs(a[r][c]) > Math.abs(a[best][c])) best = r;
        [a[c], a[best]] = [a[best], a[c]];
        const pivot = a[c][c] || 1e-300;
        for (let k = 0; k < 8; k++) a[c][k] /= pivot;
        for (let r = 0; r < 4; r++) {
            if (r === c) continue;
            const f = a[r][c];
            for (let k = 0; k < 8; k++) a[r][k] -= f * a[c][k];
        }
    }
    const out = new Float64Array(16);
    for (let r = 0; r < 4; r++) for (let c = 0; c < 4; c++) out[4 * c + r] = a[r][4 + c];
    return out;
}
