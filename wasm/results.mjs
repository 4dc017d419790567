// What the calls of brio.mjs give. A result is in the module's memory until free(); one that nobody holds is freed some time later.
//
// An array that one reads of it is a view of that memory: no copy. A view is good until the next call, which may let the memory
// grow: then the array has the length 0, and the result gives a new one. copy() has all arrays of its own, for keeping or for
// sending to another thread. A result lives as long as one of its views; subarrays of a view do not count.

/** Types of properties, in the order of brio_scalar. */
export const TYPES = [Int8Array, Uint8Array, Int16Array, Uint16Array, Int32Array, Uint32Array, Float32Array, Float64Array];

const owners = new WeakMap(); // a view keeps its result from being freed
const forgotten = new FinalizationRegistry(({ x, free, at }) => x[free](at));

class Result {
  constructor(brio, at, free) {
    this.brio = brio;
    this.at = at;
    this.release = free;
    forgotten.register(this, { x: brio.x, free, at }, this);
  }
  /** Releases the memory. */
  free() {
    if (!this.at) return;
    forgotten.unregister(this);
    this.brio.x[this.release](this.at);
    this.at = 0;
  }
  /* Where it is, for a call. */
  get address() {
    if (!this.at) throw new Error('the result was freed');
    return this.at;
  }
  /* The numbers that a function of the module gives of this. */
  parts(name, count, ...more) {
    if (!this.at) throw new Error('the result was freed');
    return this.brio.during({}, (blocks) => {
      const at = blocks.room(4 * count);
      this.brio.x[name](this.at, at, ...more);
      return Array.from(this.brio.numbers(Uint32Array, at, count));
    });
  }
  view(kind, at, count) {
    const view = at ? this.brio.numbers(kind, at, count) : new kind(0);
    owners.set(view, this);
    return view;
  }
}
if (Symbol.dispose) Result.prototype[Symbol.dispose] = Result.prototype.free; // for `using`

/** Room for points. */
export class Points extends Result {
  constructor(brio, at, length) { super(brio, at, 'release'); this.length = length; }
  get array() { return this.view(Float64Array, this.at, this.length); }
}

/** A triangulation of space, or of the plane (`flat`). */
export class Triangulation extends Result {
  constructor(brio, at, flat) {
    super(brio, at, flat ? 'triangulation2_free' : 'triangulation_free');
    this.flat = !!flat;
    const [cells, hull, , , points, vertices, duplicates, hidden, dimension] = this.found();
    Object.assign(this, { size: cells, hullSize: hull, points, vertices, duplicates, hidden, dimension: dimension | 0 });
  }
  found() { return this.parts(this.flat ? 'triangulation2_parts' : 'triangulation_parts', 9); }
  /** Corners of a tetrahedron: 4; of a triangle of the plane: 3. */
  get corners() { return this.flat ? 3 : 4; }
  /** The view of all: for each its corners, then its mates. Finite ones come first, then those of the hull. */
  get records() {
    const [cells, hull, at] = this.found();
    return this.view(Uint32Array, at, 2 * this.corners * (cells + hull));
  }
  /** For each point the vertex that stands for it. */
  get representatives() { const [, , , at, points] = this.found(); return this.view(Uint32Array, at, points); }
  /** The corners of the finite tetrahedra (triangles), one after the other: a copy. */
  get cells() { return pick(this.records, 2 * this.corners, 0, this.size, this.corners); }
  get tetrahedra() { return this.flat ? new Uint32Array(0) : this.cells; }
  get triangles() { return this.flat ? this.cells : new Uint32Array(0); }
  /** The corners of the facets (edges) of the hull, seen counterclockwise from outside: a copy. */
  get hull() { return pick(this.records, 2 * this.corners, this.size, this.hullSize, this.corners - 1); }
  /** The hash that `brio delaunay` reports.   points  those that were given. */
  checksum(points) {
    return this.brio.during({}, (blocks) => {
      const p = blocks.points(points, this.flat ? 2 : 3), out = blocks.room(8);
      if (p.count !== this.points) throw new RangeError(`${p.count} points for a triangulation of ${this.points}`);
      this.brio.check(this.brio.x[this.flat ? 'triangulation2_checksum' : 'triangulation_checksum'](this.brio.context, this.address, p.at, out));
      return this.brio.numbers(BigUint64Array, out, 1)[0].toString(16).padStart(16, '0');
    });
  }
  /** Proves exactly that this is the triangulation of the points; an error says what is wrong. */
  check(points, weights) {
    this.brio.during({}, (blocks) => {
      const { at, count, weights: w } = blocks.weighted(points, weights, this.flat);
      this.brio.check(this.brio.x[this.flat ? 'triangulation2_check' : 'triangulation_check'](this.brio.context, this.address, at, w, count));
    });
  }
  copy() {
    const { size, hullSize, points, vertices, duplicates, hidden, dimension } = this;
    return { size, hullSize, points, vertices, duplicates, hidden, dimension, tetrahedra: this.tetrahedra, triangles: this.triangles,
      hull: this.hull, records: this.records.slice(), representatives: this.representatives.slice() };
  }
}

/* The first `width` of `stride` numbers, of `count` rows. */
function pick(rows, stride, from, count, width) {
  const out = new Uint32Array(width * count);
  for (let i = 0, at = stride * from, to = 0; i < count; i++, at += stride) for (let k = 0; k < width; k++) out[to++] = rows[at + k];
  return out;
}

/** Vertices with faces, tetrahedra, edges and properties. Face f has the corners faces[offsets[f]] to faces[offsets[f + 1] - 1]. */
export class Mesh extends Result {
  constructor(brio, at) { super(brio, at, 'mesh_free'); }
  found() { return this.parts('mesh_parts', 11); }
  get vertices() { const [count, at] = this.found(); return this.view(Float64Array, at, 3 * count); }
  get offsets() {
    const [, , faces, at] = this.found();
    return faces ? Uint32Array.from(this.view(BigUint64Array, at, faces + 1), Number) : new Uint32Array(1);
  }
  get faces() {
    const [, , faces, offsets, at] = this.found();
    return this.view(Uint32Array, at, faces ? Number(this.view(BigUint64Array, offsets, faces + 1)[faces]) : 0);
  }
  get tetrahedra() { const p = this.found(); return this.view(Uint32Array, p[6], 4 * p[5]); }
  get edges() { const p = this.found(); return this.view(Uint32Array, p[8], 2 * p[7]); }
  /** The properties of the vertices, and of the faces: { name: array }. */
  get properties() { return this.list(0); }
  get faceProperties() { return this.list(1); }
  list(of_faces) {
    const p = this.found(), out = {};
    for (let i = 0; i < p[of_faces ? 10 : 9]; i++) {
      const [name, type, at] = this.brio.during({}, (blocks) => {
        const to = blocks.room(12);
        this.brio.x.mesh_property(this.at, of_faces, i, to);
        return Array.from(this.brio.numbers(Uint32Array, to, 3));
      });
      out[this.brio.text(name)] = this.view(TYPES[type], at, p[of_faces ? 2 : 0]);
    }
    return out;
  }
  /** What is certain of the faces: counted once. */
  get certificate() { return (this.certified ??= this.certify()); }
  certify() {
    return this.brio.during({}, (blocks) => {
      const at = blocks.room(104);
      this.brio.check(this.brio.x.certificate(this.brio.context, this.at, at));
      const [closed, manifold, oriented, components, genus, boundary_edges, boundary_loops, nonmanifold_edges, nonmanifold_vertices,
        flipped_edges, self_intersections, area, volume] = this.brio.numbers(Float64Array, at, 13);
      return { closed: !!closed, manifold: !!manifold, oriented: !!oriented, components, genus, boundary_edges, boundary_loops,
        nonmanifold_edges, nonmanifold_vertices, flipped_edges, self_intersections, area, volume };
    });
  }
  copy() {
    const copies = (list) => Object.fromEntries(Object.entries(list).map(([name, a]) => [name, a.slice()])), out = {
      vertices: this.vertices.slice(), faces: this.faces.slice(), offsets: this.offsets, tetrahedra: this.tetrahedra.slice(),
      edges: this.edges.slice(), properties: copies(this.properties), faceProperties: copies(this.faceProperties),
    };
    for (const key of ['facts', 'samples', 'dimension', 'alpha', 'solid', 'uncovered']) if (this[key] !== undefined) out[key] = this[key];
    return out;
  }
}

/** How a surface came to be, at `samples` of its `allSamples`: for `page`. */
export class Explanation extends Result {
  constructor(brio, at) {
    super(brio, at, 'explanation_free');
    [this.samples, this.allSamples] = this.parts('explanation_parts', 2);
  }
}

/** Simplices with their alphas: of dimension 0 to 3, `simplices(k)` has k + 1 points of each, `values(k)` a number. */
export class AlphaComplex extends Result {
  constructor(brio, at) { super(brio, at, 'alpha_free'); }
  found(k) { return this.parts('alpha_parts', 12).slice(3 * k, 3 * k + 3); }
  simplices(k) { const [count, at] = this.found(k); return this.view(Uint32Array, at, (k + 1) * count); }
  values(k) { const [count, , at] = this.found(k); return this.view(Float64Array, at, count); }
  copy() {
    const of = (name) => [0, 1, 2, 3].map((k) => this[name](k).slice());
    return { simplices: of('simplices'), values: of('values') };
  }
}

const CELLS = { // name: type, place among the parts, number of rows, numbers in a row
  site: [Uint32Array, 4, 'cells', 1], volume: [Float64Array, 5, 'cells', 1], bounded: [Uint8Array, 6, 'cells', 1],
  area: [Float64Array, 7, 'cells', 1], centroid: [Float64Array, 8, 'cells', 3], faceNeighbours: [BigInt64Array, 10, 'faces', 1],
  faceAreas: [Float64Array, 11, 'faces', 1], faceNormals: [Float64Array, 12, 'faces', 3], faceVertices: [Uint32Array, 14, 'corners', 1],
  vertices: [Float64Array, 15, 'count', 3], faceOffsets: [BigUint64Array, 9, 'cells', 1], cornerOffsets: [BigUint64Array, 13, 'faces', 1],
};

/** Cells, with their faces where they were asked for. Offsets and neighbours are 64 bits wide in the module, and copies here. */
export class Cells extends Result {
  constructor(brio, at) {
    super(brio, at, 'cells_free');
    brio.during({}, (blocks) => {
      const parts = blocks.room(64), facts = blocks.room(16);
      brio.x.cells_parts(at, parts, facts);
      this.places = Array.from(brio.numbers(Uint32Array, parts, 16)); // the arrays stay where they are
      [this.volumeSum, this.regionVolume] = brio.numbers(Float64Array, facts, 2);
    });
    const [cells, faces, corners, count] = this.places;
    this.counts = { cells, faces, corners, count };
    this.size = cells;
  }
  array(name) {
    const [kind, place, rows, width] = CELLS[name], wide = kind === BigUint64Array, at = this.places[place];
    if (!this.at) throw new Error('the result was freed');
    if (!at) return wide ? new Uint32Array(1) : kind === BigInt64Array ? new Int32Array(0) : new kind(0);
    const view = this.view(kind, at, this.counts[rows] * width + (wide ? 1 : 0));
    return wide ? Uint32Array.from(view, Number) : kind === BigInt64Array ? Int32Array.from(view, Number) : view;
  }
  copy() {
    const own = Object.fromEntries(Object.keys(CELLS).map((name) => [name, this[name].slice()]));
    return { size: this.size, volumeSum: this.volumeSum, regionVolume: this.regionVolume, ...own };
  }
}
for (const name of Object.keys(CELLS)) Object.defineProperty(Cells.prototype, name, { get() { return this.array(name); } });
