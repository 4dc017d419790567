// brio in WebAssembly: exact Delaunay and regular triangulations, Voronoi cells, hulls, alpha shapes, and surfaces from points, in
// browsers, workers, Node and Deno.
//
// `load` gives a Brio, whose methods run to their end in the thread that calls them; worker.mjs has them as promises. A call
// gives a result that stays in the module's memory (results.mjs): what one reads of it are views, no copies. Points that are
// such a view, as those of `room`, are not copied on their way in either.
//
// A function `progress(stage, share)` that returns true stops the call. Failures are BrioError, with the sentence of the library.
import { Files } from './files.mjs';
import { AlphaComplex, Cells, Explanation, Mesh, Points, Triangulation, TYPES } from './results.mjs';

export class BrioError extends Error {
  constructor(status, message) { super(message); this.name = 'BrioError'; this.status = status; }
}
const ARGUMENT = 10, NO_MEMORY = 30, CANCELLED = 32; // brio_status

const METHODS = ['labeled', 'power-crust', 'cocone', 'tight-cocone', 'offset'];
const NOISE = ['auto', 'keep', 'smooth'], HOLES = ['auto', 'closed'];
const HOLDS_FACES = 1;

/** Loads the module.   source  its bytes, a Response of fetch, a compiled WebAssembly.Module, or a promise of one; nothing: the
 *  file brio.wasm beside this one. */
export async function load(source) {
  source = await (source ?? own());
  const given = typeof Response !== 'undefined' && source instanceof Response ? await source.arrayBuffer() : source;
  const module = given instanceof WebAssembly.Module ? given : await WebAssembly.compile(given);
  const brio = new Brio();
  const instance = await WebAssembly.instantiate(module, {
    wasi_snapshot_preview1: brio.files.imports(),
    brio: { progress: (stage, share) => brio.asked(brio.text(stage), share) },
  });
  brio.begin(instance.exports);
  return brio;
}

/** The bytes of brio.wasm: by fetch, or from the file system where fetch takes no addresses of files, as in Node. */
async function own() {
  const address = new URL('./brio.wasm', import.meta.url);
  if (address.protocol === 'file:' && globalThis.process?.versions?.node) return (await import('node:fs/promises')).readFile(address);
  const answer = await fetch(address);
  if (!answer.ok) throw new BrioError(0, `${address}: the server answers ${answer.status} ${answer.statusText}`);
  return answer;
}

class Brio {
  constructor() { this.files = new Files(); this.progress = null; this.thrown = null; this.asking = false; }

  /* Whether to stop. What `progress` throws stops the call, too, and is thrown when the library has put its things away. */
  asked(stage, share) {
    this.asking = true;
    try {
      return this.progress?.(stage, share) === true ? 1 : 0;
    } catch (error) {
      this.thrown = { error };
      return 1;
    } finally {
      this.asking = false;
    }
  }

  begin(exports) {
    this.x = exports;
    this.files.memory = exports.memory;
    exports._initialize();
    this.context = exports.context();
    if (!this.context) throw new BrioError(NO_MEMORY, 'no memory for a context');
  }

  get version() { return this.text(this.x.version()); }
  /** Extensions that are read, and those that are written: of all formats, or of those that hold faces. */
  get reads() { return this.text(this.x.formats(0, 0)).split(' '); }
  get writes() { return this.text(this.x.formats(1, 0)).split(' '); }
  get writesFaces() { return this.text(this.x.formats(1, HOLDS_FACES)).split(' '); }
  /** The bytes of the module's memory, which never shrinks. */
  get memory() { return this.x.memory.buffer.byteLength; }

  /** Room for `count` points in the module's memory. Fill its `array`, and give that to a call, which takes it without a copy. */
  room(count, coordinates = 3) {
    const at = this.x.allocate(8 * count * coordinates);
    if (!at) throw new BrioError(NO_MEMORY, `no memory for ${count} points`);
    return new Points(this, at, count * coordinates);
  }

  /** Triangulates points.   options.dimension  2 for points of the plane. */
  delaunay(points, options = {}) { return this.triangulate(points, undefined, options); }
  /** Makes the regular triangulation of points with weights. */
  regular(points, weights, options = {}) { return this.triangulate(points, weights, options); }

  /** Makes the convex hull: a mesh, with `samples`, the point of each vertex.   options.polygons  facets are not cut. */
  hull(points, options = {}) {
    return this.during(options, (blocks) => {
      const p = blocks.points(points, 3), samples = blocks.room(4 * p.count), dimension = blocks.room(4), out = blocks.room(4);
      const mesh = this.made(this.x.hull(this.context, p.at, p.count, options.polygons ? 1 : 0, samples, out, dimension), out, Mesh);
      mesh.samples = this.numbers(Uint32Array, samples, mesh.vertices.length / 3).slice();
      mesh.dimension = this.numbers(Int32Array, dimension, 1)[0];
      return mesh;
    });
  }

  /** Makes the alpha complex of points, or of points with weights: every simplex with its alpha, a squared radius. */
  alphaComplex(points, options = {}) {
    const flat = isFlat(options);
    return this.during(options, (blocks) => {
      const given = blocks.weighted(points, options.weights, flat), out = blocks.room(4), t = this.triangulated(given, flat, out);
      try {
        return this.alphaValues(t, given, out);
      } finally {
        t.free();
      }
    });
  }

  /** Makes the surface of an alpha shape.   options.alpha  a squared radius; not given: the least one that makes one solid of all
   *  points. Of the mesh, `alpha` is the one that was taken, `solid` the number of its tetrahedra, `uncovered` that of the points
   *  outside. */
  alphaShape(points, options = {}) {
    if (options.alpha !== undefined && !(options.alpha >= 0)) throw new BrioError(ARGUMENT, `alpha is ${options.alpha}; expected a squared radius of 0 or more`);
    return this.during(options, (blocks) => {
      const given = blocks.weighted(points, options.weights, false), out = blocks.room(4), facts = blocks.room(24);
      const t = this.triangulated(given, false, out);
      let complex = null;
      try {
        complex = this.alphaValues(t, given, out);
        this.numbers(Uint32Array, out, 1)[0] = 0;
        const mesh = this.made(this.x.alpha_shape(this.context, given.at, complex.at, options.alpha ?? -1, out, facts), out, Mesh);
        [mesh.alpha, mesh.solid, mesh.uncovered] = this.numbers(Float64Array, facts, 3);
        return mesh;
      } finally {
        complex?.free();
        t.free();
      }
    });
  }

  /** Makes Voronoi cells, or power cells of points with weights.   options  weights; box: x0 y0 z0 x1 y1 z1, which clips them; faces,
   *  vertices: whether these are made. */
  voronoi(points, options = {}) {
    return this.during(options, (blocks) => {
      const { at, weights, count } = blocks.weighted(points, options.weights, false), out = blocks.room(4);
      const box = options.box ? blocks.doubles(options.box, 6, 'box') : 0;
      return this.made(this.x.voronoi(this.context, at, weights, count, box, options.faces ? 1 : 0, options.vertices ? 1 : 0, out), out, Cells);
    });
  }

  /** Makes a surface through points: a mesh with `certificate` and `facts`.   points  an array, or a mesh, whose normals and scanners'
   *  places tell where outside is, and whose properties the surface gets.   options  see load.d.ts; `explain`: the mesh has an
   *  `explanation`, how the surface came to be, for `page`. */
  surface(points, options = {}) {
    return this.during(options, (blocks) => {
      const out = blocks.room(4), facts = blocks.room(48), given = blocks.doubles(choices(options)), told = options.explain ? blocks.room(4) : 0;
      let status;
      if (points instanceof Mesh) status = this.x.surface_of(this.context, points.address, given, out, facts, told);
      else {
        const p = blocks.points(points, 3);
        const normals = options.normals ? blocks.doubles(options.normals, 3 * p.count, 'normals') : 0;
        const origins = options.origins ? blocks.doubles(options.origins) : 0;
        status = this.x.surface(this.context, p.at, p.count, given, normals, origins, (options.origins?.length ?? 0) / 3, out, facts, told);
      }
      const explanation = told ? this.made(0, told, Explanation) : null;
      if (status) explanation?.free();
      const mesh = this.made(status, out, Mesh);
      const [noise, smoothed, holes, bridges, strays, agreement] = this.numbers(Float64Array, facts, 6);
      mesh.facts = { noise, smoothed: !!smoothed, holes, bridges, strays, agreement };
      if (explanation) mesh.explanation = explanation;
      return mesh;
    });
  }

  /** Reads a file's bytes: a mesh.   name  tells the format where the content does not, and stands in messages. */
  read(bytes, name, options = {}) {
    return this.during(options, (blocks) => {
      const out = blocks.room(4);
      return this.made(this.x.read(this.context, blocks.bytes(bytes), bytes.byteLength, name ? blocks.text(name) : 0, out), out, Mesh);
    });
  }

  /** Makes a mesh of arrays: { vertices, faces, offsets, tetrahedra, edges, properties, faceProperties }. Without offsets faces are
   *  triangles. */
  mesh({ vertices, faces = [], offsets, tetrahedra = [], edges = [], properties = {}, faceProperties = {} }) {
    return this.during({}, (blocks) => {
      const out = blocks.room(4), mesh = this.made(this.x.mesh(this.context, out), out, Mesh);
      try {
        const v = blocks.points(vertices, 3), count = offsets ? offsets.length - 1 : faces.length / 3;
        const ends = BigUint64Array.from({ length: count + 1 }, (_, i) => BigInt(offsets ? offsets[i] : 3 * i));
        if (ends[count] !== BigInt(faces.length)) throw new BrioError(ARGUMENT, `faces have ${faces.length} corners; expected ${ends[count]}`);
        this.check(this.x.mesh_set(mesh.at, v.at, v.count, blocks.bytes(ends), blocks.words(faces), count, blocks.words(tetrahedra),
          tetrahedra.length / 4, blocks.words(edges), edges.length / 2));
        for (const [list, of_faces, length] of [[properties, 0, v.count], [faceProperties, 1, count]])
          for (const [name, values] of Object.entries(list)) this.property(mesh, name, values, of_faces, length, blocks);
        return mesh;
      } catch (error) {
        mesh.free();
        throw error;
      }
    });
  }

  /** Writes a mesh, or arrays as `mesh` takes them, in the format of the name's extension.   options  ascii, float32.   Returns bytes. */
  write(mesh, name, options = {}) {
    return this.during(options, (blocks) => {
      const made = mesh instanceof Mesh ? mesh : this.mesh(mesh);
      try {
        this.check(this.x.write(this.context, blocks.text(name), made.address, options.ascii ? 1 : 0, options.float32 ? 1 : 0));
        return this.files.take(name);
      } finally {
        if (made !== mesh) made.free();
      }
    });
  }

  /** Makes a page that shows meshes (docs/view.md): the bytes of an HTML file.   layers  [{ mesh, name, report, explanation }]. */
  page(layers, options = {}) {
    return this.during(options, (blocks) => {
      const texts = (key) => blocks.words(layers.map((l) => (l[key] ? blocks.text(l[key]) : 0)));
      const name = 'page.html';
      this.check(this.x.page(this.context, blocks.text(name), blocks.words(layers.map((l) => l.mesh.address)), texts('name'), texts('report'),
        blocks.words(layers.map((l) => l.explanation?.address ?? 0)), layers.length, options.selfIntersections ? 1 : 0));
      return this.files.take(name);
    });
  }

  // --- within ---

  triangulate(points, weights, options) {
    const flat = isFlat(options);
    return this.during(options, (blocks) => this.triangulated(blocks.weighted(points, weights, flat), flat, blocks.room(4)));
  }
  triangulated({ at, weights, count }, flat, out) {
    return this.made(this.x[flat ? 'delaunay2' : 'delaunay'](this.context, at, weights, count, out), out, Triangulation, flat);
  }
  alphaValues(t, { at, weights, count }, out) {
    this.numbers(Uint32Array, out, 1)[0] = 0;
    return this.made(this.x[t.flat ? 'alpha_values2' : 'alpha_values'](this.context, t.at, at, weights, count, out), out, AlphaComplex);
  }

  property(mesh, name, values, of_faces, length, blocks) {
    const type = TYPES.findIndex((t) => values instanceof t), kind = TYPES[type] ?? Float64Array, out = blocks.room(4);
    if (values.length !== length) throw new BrioError(ARGUMENT, `the property ${name} has ${values.length} values; expected ${length}`);
    this.check(this.x.mesh_add(mesh.at, blocks.text(name), TYPES.indexOf(kind), of_faces, out));
    this.numbers(kind, this.numbers(Uint32Array, out, 1)[0], length).set(values);
  }

  /* What a call made, as a result of that kind; what a failed call left is released. */
  made(status, out, kind, ...more) {
    const at = this.numbers(Uint32Array, out, 1)[0];
    const result = at ? new kind(this, at, ...more) : null;
    try {
      this.check(status);
    } catch (error) {
      result?.free();
      throw error;
    }
    return result;
  }

  /* Calls with blocks of the module's memory, which are released at the end. */
  during(options, call) {
    if (this.asking) throw new BrioError(ARGUMENT, 'progress is told of a call that runs: no other can begin');
    const taken = [], x = this.x, before = this.progress;
    const room = (size) => {
      const at = x.allocate(size);
      if (!at) throw new BrioError(NO_MEMORY, `no memory for ${size} bytes`);
      taken.push(at);
      new Uint8Array(x.memory.buffer, at, size).fill(0);
      return at;
    };
    const bytes = (given) => {
      const array = given instanceof ArrayBuffer ? new Uint8Array(given) : given;
      if (!ArrayBuffer.isView(array)) throw new BrioError(ARGUMENT, 'expected an array of numbers, or bytes');
      if (array.buffer.detached) throw new BrioError(ARGUMENT, 'an array was a view of memory that has moved since: read it from its result again');
      if (array.buffer === x.memory.buffer) return array.byteOffset; // it is there already
      const at = room(array.byteLength);
      new Uint8Array(x.memory.buffer, at, array.byteLength).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
      return at;
    };
    const doubles = (array, length, name) => {
      if (length !== undefined && array.length !== length) throw new BrioError(ARGUMENT, `${name} has ${array.length} numbers; expected ${length}`);
      return bytes(array instanceof Float64Array ? array : Float64Array.from(array));
    };
    const points = (array, coordinates) => {
      if (typeof array?.length !== 'number') throw new BrioError(ARGUMENT, 'expected points: an array of numbers');
      const count = array.length / coordinates;
      if (!Number.isInteger(count)) throw new BrioError(ARGUMENT, `points have ${array.length} numbers; expected ${coordinates} of each point, one after the other`);
      return { at: doubles(array), count };
    };
    const weights = (w, count) => (w ? doubles(w, count, 'weights') : 0);
    const weighted = (array, w, flat) => {
      const count = array?.length / (flat ? 2 : 3);
      const first = w?.buffer === x.memory.buffer ? weights(w, count) : undefined; // before the copy of points lets the memory grow
      const p = points(array, flat ? 2 : 3);
      return { ...p, weights: first ?? weights(w, p.count) };
    };
    const blocks = { room, bytes, doubles, points, weights, weighted,
      words: (a) => bytes(a instanceof Uint32Array ? a : Uint32Array.from(a)), text: (t) => bytes(new TextEncoder().encode(t + '\0')) };
    try {
      if (options.progress) this.progress = options.progress;
      return call(blocks);
    } finally {
      this.progress = before;
      for (const at of taken) x.release(at);
    }
  }

  check(status) {
    const thrown = this.thrown;
    this.thrown = null;
    if (thrown && status === CANCELLED) throw thrown.error;
    if (status !== 0) throw new BrioError(status, this.text(this.x.message(this.context)));
  }

  /** A view of numbers in the module's memory. */
  numbers(kind, at, count) { return new kind(this.x.memory.buffer, at, count); }

  text(at) {
    const bytes = new Uint8Array(this.x.memory.buffer, at);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}

/* Whether the points are of the plane. */
function isFlat({ dimension = 3 }) {
  if (dimension !== 2 && dimension !== 3) throw new BrioError(ARGUMENT, `dimension is ${dimension}; expected 2 or 3`);
  return dimension === 2;
}

/* The options of a surface as numbers, in the order of module.c. */
function choices(o) {
  const named = (list, key) => {
    const found = o[key] === undefined ? 0 : list.indexOf(o[key]);
    if (found < 0) throw new BrioError(ARGUMENT, `${key} is '${o[key]}'; expected one of ${list.join(', ')}`);
    return found;
  };
  const boundaries = o.boundaries === 'auto' ? 2 : o.boundaries ? 1 : 0;
  return [named(METHODS, 'method'), named(NOISE, 'noise'), o.open ?? 0, named(HOLES, 'holes'), o.simplify ? 1 : 0, o.confidence ? 1 : 0,
    o.polygons ? 1 : 0, o.distance ?? 0, o.theta ?? 0, boundaries, o.density ? 1 : 0, o.pieces ?? 0, o.seed ?? 0];
}

/** Whether an error says that a call was stopped. */
export const isCancelled = (error) => error?.name === 'BrioError' && error.status === CANCELLED;
export { AlphaComplex, Cells, Explanation, Mesh, Points, Triangulation };
