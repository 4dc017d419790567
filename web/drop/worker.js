// The worker of the drop page: the library, the file that was dropped, and the surface that was made of it.
import { load } from "../../wasm/brio.mjs";
import { serve } from "../../wasm/serve.mjs";

/** The bytes of a file; those by gzip are unpacked, which this build of the library leaves to the browser. */
async function unpacked(bytes) {
    if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());
}

class Calls {
    constructor(brio) { this.brio = brio; this.file = this.surface = null; }
    set progress(f) { this.brio.progress = f; }

    /** Reads a file. Returns its page. */
    async open(name, bytes) {
        const plain = await unpacked(bytes);
        const file = this.brio.read(plain, plain === bytes ? name : name.replace(/\.gz$/i, ""));
        for (const old of [this.file, this.surface, this.surface?.explanation]) old?.free();
        Object.assign(this, { file, surface: null, name });
        return { page: this.brio.page([{ mesh: file, name }]), points: file.vertices.length / 3 };
    }
    /** Makes a surface through the points of the file. Returns the page of both, and what is certain of the surface. */
    reconstruct(options) {
        const began = performance.now(), surface = this.brio.surface(this.file, options);
        for (const old of [this.surface, this.surface?.explanation]) old?.free();
        this.surface = surface;
        const { certificate, facts, explanation } = surface, seconds = (performance.now() - began) / 1000;
        const page = this.brio.page([{ mesh: surface, name: `surface of ${this.name}`, explanation }, { mesh: this.file, name: this.name }], { selfIntersections: certificate.self_intersections > 0 });
        return { page, certificate, facts, seconds };
    }
    /** Writes the surface, or the file where there is none. */
    save(name) { return { bytes: this.brio.write(this.surface || this.file, name) }; }
}

serve({ post: (m, list) => postMessage(m, list), listen: f => { onmessage = e => f(e.data); } }, async start => new Calls(await load(start)));
