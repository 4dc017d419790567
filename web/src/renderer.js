// Draws the layers: coarse while the camera moves, whole when it rests, in parts over several frames, so that no frame blocks.
// Everything goes to a picture in memory (with four samples a pixel), and from there to the page when it is complete.
import { PROGRAMS } from "./shaders.js";
import { paletteOf } from "./colours.js";
import { invert, multiply, project } from "./matrix.js";

const PICK = 9; // pixels about the pointer in which something is picked
const PART = 300000; // vertices drawn at once, a multiple of 6
const PLACES = { aPlace: 0, aNormal: 1, aRgba: 2, aValue: 3, aFrom: 0, aTo: 1, aBall: 0 };

function compile(gl, [vertex, fragment]) {
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
    }
    for (const [name, at] of Object.entries(PLACES)) if (vertex.includes(` ${name};`)) gl.bindAttribLocation(program, at, name);
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
        const { name } = gl.getActiveUniform(program, i);
        uniforms[name] = gl.getUniformLocation(program, name);
    }
    return { program, uniforms };
}

export class Renderer {
    constructor(canvas) {
        this.canvas = canvas;
        const gl = canvas.getContext("webgl2", { antialias: false, alpha: true, depth: false, preserveDrawingBuffer: true });
        if (!gl) throw new Error("This browser shows no WebGL 2, which the picture needs. Another browser may, or this one with its graphics acceleration switched on.");
        this.gl = gl;
        this.budget = 250000; // triangles or half the points while moving
        this.forget();
    }
    /** Begins without anything on the graphics card. */
    forget() {
        this.programs = {};
        this.palettes = {};
        this.target = this.shaded = this.picked = this.queue = null;
    }
    program(name) { return this.programs[name] ||= compile(this.gl, PROGRAMS[name]); }
    palette(name) {
        const gl = this.gl;
        if (!this.palettes[name]) {
            const texture = this.palettes[name] = gl.createTexture();
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, paletteOf(name));
            for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
            for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
        }
        return this.palettes[name];
    }
    makeTarget(width, height) {
        const gl = this.gl, samples = Math.min(4, gl.getParameter(gl.MAX_SAMPLES));
        if (this.target) {
            gl.deleteFramebuffer(this.target.frame);
            gl.deleteRenderbuffer(this.target.colour);
            gl.deleteRenderbuffer(this.target.depth);
        }
        const t = this.target = { width, height, frame: gl.createFramebuffer(), colour: gl.createRenderbuffer(), depth: gl.createRenderbuffer() };
        gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
        for (const [buffer, format, at] of [[t.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [t.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
            gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
            gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
            gl.framebufferRenderbuffer(gl.FRAMEBUFFER, at, gl.RENDERBUFFER, buffer);
        }
    }

    /** A copy of the picture in memory, with one sample a pixel, that programs can read. */
    makeShaded(width, height) {
        const gl = this.gl, t = this.shaded ||= { frame: gl.createFramebuffer(), colour: gl.createTexture(), depth: gl.createTexture() };
        gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
        for (const [texture, inside, format, type, at] of [[t.colour, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, gl.COLOR_ATTACHMENT0], [t.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, gl.DEPTH_ATTACHMENT]]) {
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.texImage2D(gl.TEXTURE_2D, 0, inside, width, height, 0, format, type, null);
            for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
            gl.framebufferTexture2D(gl.FRAMEBUFFER, at, gl.TEXTURE_2D, texture, 0);
        }
        Object.assign(t, { width, height });
    }
    /** Copies the picture in memory to the page. Views of clouds without normals get shades by depth: what is behind something near it is
     *  darker (Boucheny. Visualisation scientifique de grands volumes de donnees. Thesis, 2009: eye-dome lighting). */
    present() {
        const gl = this.gl, { width, height } = this.target;
        const copy = (to, what) => {
            gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.target.frame);
            gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
            gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, what, gl.NEAREST);
        };
        gl.disable(gl.SCISSOR_TEST);
        copy(null, gl.COLOR_BUFFER_BIT);
        if (this.deep.length) {
            if (this.shaded?.width !== width || this.shaded?.height !== height) this.makeShaded(width, height);
            copy(this.shaded.frame, gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        }
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        for (const view of this.deep) this.shade(view);
    }
    shade({ x, y, width, height, projection, parallel, distance }) {
        const gl = this.gl, { program, uniforms: u } = this.program("depths");
        gl.useProgram(program);
        gl.viewport(x, y, width, height);
        gl.disable(gl.DEPTH_TEST);
        gl.disable(gl.BLEND);
        gl.colorMask(true, true, true, true);
        for (let i = 0; i < 4; i++) gl.disableVertexAttribArray(i);
        for (const [unit, texture, at] of [[1, this.shaded.depth, u.uDepth], [0, this.shaded.colour, u.uColours]]) {
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.uniform1i(at, unit);
        }
        gl.uniform4i(u.uBox, x, y, x + width - 1, y + height - 1);
        gl.uniform4f(u.uLens, projection[10], projection[14], +parallel, distance);
        gl.uniform1i(u.uApart, Math.max(1, Math.round(this.scene.ratio)));
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    /** Begins a picture.   views  [{x, y, width, height, drawings}], in pixels from the lower left corner. */
    begin(views, camera, scene, moving) {
        const gl = this.gl, { width, height } = this.canvas;
        if (!this.target || this.target.width !== width || this.target.height !== height) this.makeTarget(width, height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.target.frame);
        gl.disable(gl.SCISSOR_TEST);
        gl.colorMask(true, true, true, true);
        gl.depthMask(true);
        gl.clearColor(...scene.background, 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        this.scene = scene;
        this.queue = [];
        this.deep = [];
        for (const view of views) {
            const matrix = camera.matrix(view.width, view.height), look = camera.view(), clear = [];
            for (const d of view.drawings)
                for (const item of d.items(moving, this.budget, scene.cut, scene.colours)) {
                    const whole = { ...item, view, matrix, look };
                    if (item.veil) clear.push({ ...whole, blended: true });
                    else if (item.opacity < 1 && item.primitive === gl.TRIANGLES) clear.push({ ...whole, depthOnly: true }, { ...whole, blended: true });
                    else this.queue.push(item.opacity < 1 ? { ...whole, blended: true } : whole);
                }
            this.queue.push(...clear);
            if (this.queue.some(item => item.deep && item.view === view))
                this.deep.push({ ...view, projection: camera.projection(view.width, view.height), parallel: camera.parallel, distance: camera.distance });
        }
        this.moving = moving;
    }
    /** Goes on; draws at most about `most` vertices. Returns whether the picture is complete and on the page. */
    go(most) {
        const gl = this.gl;
        if (!this.queue) return true;
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.target.frame);
        while (this.queue.length && most > 0) {
            const item = this.queue[0];
            most -= this.draw(item, item.program, Math.min(most, PART));
            if (item.done) this.queue.shift();
        }
        gl.bindVertexArray(null);
        if (this.queue.length) return false;
        this.present();
        this.queue = null;
        return true;
    }

    attribute(at, buffer, size, type, normalised, stride = 0, offset = 0) {
        const gl = this.gl;
        if (!buffer) return;
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer.handle);
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, size, type, normalised, stride, offset);
    }
    bind(item) {
        const gl = this.gl, b = item.drawing.buffers;
        for (let i = 0; i < 4; i++) { gl.disableVertexAttribArray(i); gl.vertexAttribDivisor(i, 0); }
        gl.vertexAttrib4f(1, 0, 0, 0, 0);
        if (item.spheres) {
            this.attribute(0, b[item.spheres], 4, gl.FLOAT, false);
            gl.vertexAttribDivisor(0, 1);
            return;
        }
        if (item.wide) {
            this.attribute(0, b[item.wide], 3, gl.FLOAT, false, 24, 0);
            this.attribute(1, b[item.wide], 3, gl.FLOAT, false, 24, 12);
            gl.vertexAttribDivisor(0, 1);
            gl.vertexAttribDivisor(1, 1);
            return;
        }
        this.attribute(0, b[`place${item.set}`], 3, gl.FLOAT, false);
        this.attribute(1, b[`normal${item.set}`], 4, gl.BYTE, true);
        if (item.mode === 1) this.attribute(2, b[`rgba${item.set}`], 4, gl.UNSIGNED_BYTE, true);
        if (item.mode === 2) this.attribute(3, b[`value${item.set}`], 1, gl.FLOAT, false);
        if (item.index) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, b[item.index].handle);
    }
    uniforms(item, p) {
        const gl = this.gl, u = p.uniforms, d = item.drawing, s = d.state, scene = this.scene;
        const set = (name, kind, ...x) => { if (u[name] !== undefined) gl[`uniform${kind}`](u[name], ...x); };
        set("uPlace", "4fv", d.place);
        if (u.uMatrix) gl.uniformMatrix4fv(u.uMatrix, false, Float32Array.from(item.matrix));
        if (u.uView) gl.uniformMatrix4fv(u.uView, false, Float32Array.from(item.look));
        set("uCut", "4fv", scene.cut && !item.uncut ? scene.cut : [0, 0, 0, 1]);
        set("uMode", "1i", item.mode);
        set("uColour", "4f", ...item.colour, 1);
        set("uFlat", "1i", +s.flat);
        set("uLit", "1i", +item.lit);
        set("uOpacity", "1f", item.opacity);
        set("uBack", "3f", ...(item.back ? scene.colours.back : [-1, -1, -1]));
        set("uSize", "1f", item.size * scene.ratio);
        set("uPixels", "2f", item.view.width, item.view.height);
        set("uLayer", "1ui", d.layer.number + 1);
        if (item.mode === 2 && u.uRange) {
            gl.uniform2f(u.uRange, ...d.range());
            gl.bindTexture(gl.TEXTURE_2D, this.palette(s.map));
        }
    }
    /** Draws a part of an item; returns the number of vertices, and sets item.done. */
    draw(item, name, most) {
        const gl = this.gl, p = this.program(name), v = item.view;
        gl.useProgram(p.program);
        gl.viewport(v.x, v.y, v.width, v.height);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(v.x, v.y, v.width, v.height);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(item.blended ? gl.LEQUAL : gl.LESS);
        gl.depthMask(!item.blended);
        gl.colorMask(!item.depthOnly, !item.depthOnly, !item.depthOnly, !item.depthOnly);
        gl[item.blended ? "enable" : "disable"](gl.BLEND);
        gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        this.bind(item);
        this.uniforms(item, p);
        const count = item.count ?? item.drawing.buffers[item.index].count, from = item.from ?? 0;
        const whole = item.wide || item.spheres, part = whole ? count : Math.min(count - from, Math.max(6, Math.floor(most / 6) * 6));
        if (whole) gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
        else if (item.index) gl.drawElements(item.primitive, part, gl.UNSIGNED_INT, 4 * from);
        else gl.drawArrays(item.primitive, from, part);
        item.from = from + part;
        item.done = item.from >= count;
        return part + 1000;
    }

    /** Finds what is at (x, y) of a view, from its lower left corner: {drawing, item, id, point} or null. */
    pick(view, camera, scene, x, y) {
        const gl = this.gl;
        if (!this.picked) {
            const t = this.picked = { frame: gl.createFramebuffer() };
            gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
            for (const [format, at] of [[gl.RGBA32UI, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
                const buffer = gl.createRenderbuffer();
                gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
                gl.renderbufferStorage(gl.RENDERBUFFER, format, PICK, PICK);
                gl.framebufferRenderbuffer(gl.FRAMEBUFFER, at, gl.RENDERBUFFER, buffer);
            }
        }
        this.queue = null; // a picture that was begun is begun again
        // the few pixels about the pointer fill the picture
        const [sx, sy] = [view.width / PICK, view.height / PICK];
        const closer = new Float64Array([sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 1, 0, -(2 * x / view.width - 1) * sx, -(2 * y / view.height - 1) * sy, 0, 1]);
        const matrix = multiply(closer, camera.matrix(view.width, view.height)), small = { x: 0, y: 0, width: PICK, height: PICK };
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.picked.frame);
        gl.disable(gl.SCISSOR_TEST);
        gl.colorMask(true, true, true, true);
        gl.depthMask(true);
        gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
        gl.clearBufferfi(gl.DEPTH_STENCIL, 0, 1, 0);
        this.scene = scene;
        const items = view.drawings.flatMap(d => d.items(false, this.budget, scene.cut, scene.colours)).filter(item => item.pick);
        const pixels = new Uint32Array(4 * PICK * PICK);
        let best = null, least = Infinity;
        items.forEach((item, number) => { // the item's number stands for its layer's
            const whole = { ...item, view: small, matrix, look: camera.view(), blended: false, depthOnly: false };
            while (!whole.done) this.draw(whole, item.primitive === gl.POINTS ? "pickPoints" : "pickFaces", PART * 100);
            gl.readPixels(0, 0, PICK, PICK, gl.RGBA_INTEGER, gl.UNSIGNED_INT, pixels);
            for (let i = 0; i < PICK * PICK; i++) {
                if (pixels[4 * i] !== item.drawing.layer.number + 1) continue;
                const [px, py] = [i % PICK, Math.floor(i / PICK)];
                const depth = new Float32Array(new Uint32Array([pixels[4 * i + 2]]).buffer)[0];
                const far = Math.hypot(px - (PICK - 1) / 2, py - (PICK - 1) / 2) + 0.5 * depth;
                if (far >= least) continue;
                least = far;
                best = { item, number, id: pixels[4 * i + 1], ndc: [2 * (px + 0.5) / PICK - 1, 2 * (py + 0.5) / PICK - 1, 2 * depth - 1] };
            }
            gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]); // its depth stays: what comes later has to be in front
        });
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        return best && { drawing: best.item.drawing, kind: best.item.pick, id: best.id, point: project(invert(matrix), best.ndc).slice(0, 3) };
    }
}
