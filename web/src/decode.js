// Blocks of the page (src/page/block.h): base 64 to bytes, inflated, and columns of numbers. Long loops pause, so that the page
// answers meanwhile.

const channel = new MessageChannel();
const waiting = [];
channel.port1.onmessage = () => waiting.shift()();
/** Lets the browser do what waits: input, a frame. */
export const pause = () => new Promise(done => { waiting.push(done); channel.port2.postMessage(0); });

const PART = 1 << 18; // numbers between two pauses, some milliseconds

/** Calls work(from, to) on parts of 0..n-1 with pauses between them. */
export async function inParts(n, work) {
    for (let from = 0; from < n; from += PART) {
        work(from, Math.min(n, from + PART));
        if (from + PART < n) await pause();
    }
}

async function fromBase64(text) {
    const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
    const bytes = new Uint8Array(text.length / 4 * 3 - padding);
    const step = 1 << 20;
    for (let at = 0, n = 0; at < text.length; at += step) {
        const part = text.slice(at, at + step);
        if (Uint8Array.fromBase64) {
            const some = Uint8Array.fromBase64(part);
            bytes.set(some, n);
            n += some.length;
        } else {
            const some = atob(part);
            for (let i = 0; i < some.length; i++) bytes[n++] = some.charCodeAt(i);
        }
        await pause();
    }
    return bytes;
}

/** Returns the bytes of a block's element. */
export async function bytesOf(element) {
    const bytes = await fromBase64(element.textContent);
    if (element.dataset.packed !== "1") return bytes;
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

const ARRAYS = { 1: Uint8Array, 2: Uint16Array, 3: Uint32Array, 4: Uint32Array };

/** Returns the n numbers of a column of differences, as unsigned integers of `width` bytes. */
export async function differences(bytes, n, width) {
    const out = new ARRAYS[width](n);
    const mask = width === 4 ? -1 : (1 << 8 * width) - 1;
    let before = 0;
    await inParts(n, (from, to) => {
        for (let i = from; i < to; i++) {
            let z = 0;
            for (let p = 0; p < width; p++) z |= bytes[p * n + i] << 8 * p;
            before = before + ((z >>> 1) ^ -(z & 1)) & mask;
            out[i] = before;
        }
    });
    return out;
}

/** Returns the n numbers of a column of floating-point numbers of 4 or 8 bytes. */
export async function reals(bytes, n, width) {
    const words = new Uint32Array(n * width / 4);
    const step = width / 4;
    await inParts(n, (from, to) => {
        for (let i = from; i < to; i++)
            for (let w = 0; w < step; w++) {
                let x = i ? words[(i - 1) * step + w] : 0;
                for (let p = 0; p < 4; p++) x ^= bytes[(4 * w + p) * n + i] << 8 * p;
                words[i * step + w] = x;
            }
    });
    return width === 8 ? new Float64Array(words.buffer) : new Float32Array(words.buffer);
}

const TYPES = {
    int8: [1, Int8Array], uint8: [1, Uint8Array], int16: [2, Int16Array], uint16: [2, Uint16Array],
    int32: [4, Int32Array], uint32: [4, Uint32Array], float32: [4, null], float64: [8, null],
};

/** Returns the values of a property, as an array of its type. Those of 16 bits become doubles within their range. */
export async function valuesOf(property, bytes, n) {
    if ("low" in property) {
        const steps = await differences(bytes, n, 2);
        const width = property.high / 2 - property.low / 2;
        return Float64Array.from(steps, q => q ? property.low + 2 * (width * ((q - 1) / 65534)) : NaN);
    }
    const [width, kind] = TYPES[property.type];
    return kind ? new kind((await differences(bytes, n, width)).buffer) : reals(bytes, n, width);
}

/** Returns the corners of n triangles (src/page/triangles.c). */
export async function trianglesOf(bytes, n) {
    const out = new Uint32Array(3 * n), edges = new Uint32Array(32), corners = new Uint32Array(16);
    let at = n, next = 0, last = 0, edge = 0, corner = 0;
    const varint = () => {
        let x = 0, shift = 0, byte;
        do { byte = bytes[at++]; x |= (byte & 127) << shift; shift += 7; } while (byte > 127);
        return x >>> 0;
    };
    const signed = z => (z >>> 1) ^ -(z & 1);
    const pushEdge = (a, b) => { edges[2 * (edge & 15)] = a; edges[2 * (edge++ & 15) + 1] = b; };
    const pushCorner = v => { corners[corner++ & 15] = v; };
    await inParts(n, (from, to) => {
        for (let t = from; t < to; t++) {
            const high = bytes[t] >> 4, low = bytes[t] & 15;
            let a, b, c;
            if (high === 15) {
                const name = () => { const v = next - signed(varint()); if (v === next) next++; pushCorner(v); return v; };
                a = name(), b = name(), c = name();
                pushEdge(b, a);
            } else {
                const e = 2 * (edge - 1 - high & 15);
                a = edges[e], b = edges[e + 1];
                c = low === 0 ? next++ : low === 15 ? last + signed(varint()) : corners[corner - low & 15];
                if (low === 0 || low === 15) pushCorner(c);
            }
            last = c;
            pushEdge(c, b);
            pushEdge(a, c);
            out[3 * t] = a, out[3 * t + 1] = b, out[3 * t + 2] = c;
        }
    });
    return out;
}
