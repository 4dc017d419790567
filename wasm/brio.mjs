// brio in WebAssembly: exact Delaunay and regular triangulations, and surfaces from points, in browsers, workers and Node.
//
//   const brio = await load(fetch('brio.wasm'));          // or the bytes of the file
//   const t = brio.delaunay(points);                      // Float64Array: x, y, z of each point
//   const s = brio.surface(points);                       // { vertices, faces, certificate }
//   const mesh = brio.read(bytes, 'scan.ply');            // any format; the name's extension tells where the content does not
//   const file = brio.write(mesh, 'surface.glb');         // Uint8Array, in the format of the extension
//
// A call returns copies, which the module no longer knows. It runs to its end in the thread that calls it: use a worker for
// much work. A function `progress(stage, share)` that returns true stops the call. Failures are BrioError, with the sentence
// of the library.
import { Files } from './files.mjs';

export class BrioError extends Error {
  constructor(status, message) { super(message); this.name = 'BrioError'; this.status = status; }
}

/** Loads the module.   source  its bytes, a Response of fetch, a compiled WebAssembly.Module, or a promise of one. */
export async function load(source) {
  source = await source;
  const given = typeof Response !== 'undefined' && source instanceof Response ? await source.arrayBuffer() : source;
  const module = given instanceof WebAssembly.Module ? given : await WebAssembly.compile(given);
  const brio = new Brio();
  const instance = await WebAssembly.instantiate(module, {
    wasi_snapshot_preview1: brio.files.imports(),
    brio: { progress: (stage, share) => (brio.progress && brio.progress(brio.text(stage), share) ? 1 : 0) },
  });
  brio.begin(instance.exports);
  return brio;
}

class Brio {
  constructor() { this.files = new Files(); this.progress = null; }

  begin(exports) {
    this.x = exports;
    this.files.memory = exports.memory;
    exports._initialize();
    this.context = exports.context();
    if (!this.context) throw new BrioError(0, 'no memory for a context');
  }

  get version() { return this.text(this.x.version()); }

  /** Triangulates.   weights  Float64Array or undefined.
   *  Returns { tetrahedra: Uint32Array of 4 corners each, hull: Uint32Array of 3 corners of each facet, checksum: text }. */
  delaunay(points, weights) {
    return this.during((blocks) => {
      const count = points.length / 3, out = blocks.room(4), parts = blocks.room(20);
      const status = this.x.delaunay(this.context, blocks.doubles(points), weights ? blocks.doubles(weights) : 0, count, out, parts);
      const t = this.word(out);
      try {
        this.check(status);
        const [finite, facets, at, low, high] = this.words(parts, 5);
        const all = new Uint32Array(this.x.memory.buffer, at, 8 * (finite + facets));
        const tetrahedra = new Uint32Array(4 * finite), hull = new Uint32Array(3 * facets);
        for (let i = 0; i < finite; i++) tetrahedra.set(all.subarray(8 * i, 8 * i + 4), 4 * i);
        for (let i = 0; i < facets; i++) hull.set(all.subarray(8 * (finite + i), 8 * (finite + i) + 3), 3 * i);
        return { tetrahedra, hull, checksum: ((BigInt(high) << 32n) | BigInt(low)).toString(16).padStart(16, '0') };
      } finally {
        if (t) this.x.triangulation_free(t);
      }
    });
  }

  /** Makes a surface through points of one.   Returns a mesh with its certificate. */
  surface(points) {
    return this.mesh((blocks, out) => this.x.surface(this.context, blocks.doubles(points), points.length / 3, out), true);
  }

  /** Reads a file's bytes.   Returns a mesh: { vertices, faces, offsets, tetrahedra }. */
  read(bytes, name) {
    return this.mesh((blocks, out) => this.x.read(this.context, blocks.bytes(bytes), bytes.length, name ? blocks.text(name) : 0, out), false);
  }

  /** Writes vertices and triangles.   Returns the bytes of the file. */
  write(mesh, name) {
    return this.during((blocks) => {
      const out = blocks.room(4);
      this.check(this.x.mesh(this.context, out));
      const made = this.word(out), faces = mesh.faces || new Uint32Array(0);
      try {
        this.check(this.x.mesh_set(made, blocks.doubles(mesh.vertices), mesh.vertices.length / 3, blocks.words(faces), faces.length / 3));
        this.check(this.x.write(this.context, blocks.text(name), made));
        return this.files.take(name);
      } finally {
        this.x.mesh_free(made);
      }
    });
  }

  // --- within ---

  /* Calls what fills a mesh, and copies its parts. Faces of three corners each need no offsets. */
  mesh(fill, certify) {
    return this.during((blocks) => {
      const out = blocks.room(4), parts = blocks.room(28), status = fill(blocks, out), mesh = this.word(out);
      try {
        this.check(status);
        this.x.mesh_parts(mesh, parts);
        const [vertices, at, faces, offsets_at, corners_at, tetrahedra, tetrahedra_at] = this.words(parts, 7);
        const buffer = this.x.memory.buffer;
        const offsets = faces ? Uint32Array.from(new BigUint64Array(buffer, offsets_at, faces + 1), Number) : new Uint32Array(1);
        const found = {
          vertices: new Float64Array(buffer, at, 3 * vertices).slice(), offsets,
          faces: new Uint32Array(buffer, corners_at, offsets[faces]).slice(),
          tetrahedra: new Uint32Array(buffer, tetrahedra_at, 4 * tetrahedra).slice(),
        };
        if (certify) found.certificate = this.certificate(mesh, blocks);
        return found;
      } finally {
        if (mesh) this.x.mesh_free(mesh);
      }
    });
  }

  certificate(mesh, blocks) {
    const at = blocks.room(80);
    this.check(this.x.certificate(this.context, mesh, at));
    const [closed, manifold, oriented, components, genus, boundary_edges, boundary_loops, self_intersections, area, volume] =
      new Float64Array(this.x.memory.buffer, at, 10);
    return { closed: !!closed, manifold: !!manifold, oriented: !!oriented, components, genus, boundary_edges, boundary_loops,
      self_intersections, area, volume };
  }

  /* Calls with blocks of the module's memory, which are released at the end. */
  during(call) {
    const taken = [], x = this.x;
    const room = (size) => {
      const at = x.allocate(size);
      if (!at) throw new BrioError(0, 'no memory for ' + size + ' bytes');
      taken.push(at);
      new Uint8Array(x.memory.buffer, at, size).fill(0);
      return at;
    };
    const bytes = (array) => {
      const at = room(array.byteLength);
      new Uint8Array(x.memory.buffer, at, array.byteLength).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
      return at;
    };
    const blocks = { room, bytes, doubles: (a) => bytes(a instanceof Float64Array ? a : Float64Array.from(a)),
      words: (a) => bytes(a instanceof Uint32Array ? a : Uint32Array.from(a)), text: (t) => bytes(new TextEncoder().encode(t + '\0')) };
    try {
      return call(blocks);
    } finally {
      for (const at of taken) x.release(at);
    }
  }

  check(status) {
    if (status !== 0) throw new BrioError(status, this.text(this.x.message(this.context)));
  }

  words(at, count) { return Array.from(new Uint32Array(this.x.memory.buffer, at, count)); }
  word(at) { return this.words(at, 1)[0]; }

  text(at) {
    const bytes = new Uint8Array(this.x.memory.buffer, at);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}
