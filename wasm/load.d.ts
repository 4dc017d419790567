/** Failures: the sentence of the library, and its status. */
export declare class BrioError extends Error {
  status: number;
  constructor(status: number, message: string);
}
/** Whether an error says that a call was stopped. */
export declare function isCancelled(error: unknown): boolean;

/** Is told the stage and the share of it that is done; returning true stops the call. */
export type Progress = (stage: string, share: number) => boolean | void;
export interface CallOptions { progress?: Progress }
/** Numbers, those of one point after the other. A view of the module's memory is taken without a copy. */
export type Numbers = Float64Array | ArrayLike<number>;
export type Values = Int8Array | Uint8Array | Int16Array | Uint16Array | Int32Array | Uint32Array | Float32Array | Float64Array;

/** A result in the module's memory. Its arrays are views, good until the next call; it gives new ones when asked again. */
export declare abstract class Result {
  /** Releases the memory. A result that nobody holds is released some time later. */
  free(): void;
}
export declare class Points extends Result {
  readonly length: number;
  readonly array: Float64Array;
}

export interface TriangulationFacts {
  /** Finite tetrahedra, or triangles of the plane. */
  size: number;
  /** Facets of the hull, or edges. */
  hullSize: number;
  points: number; vertices: number; duplicates: number; hidden: number;
  /** Of the points: -1 (none) to 3. */
  dimension: number;
}
export interface TriangulationArrays {
  /** Four corners of each tetrahedron; empty in the plane. */
  tetrahedra: Uint32Array;
  /** Three corners of each triangle of the plane; else empty. */
  triangles: Uint32Array;
  /** Corners of the hull's facets (3) or edges (2), seen counterclockwise from outside. */
  hull: Uint32Array;
  /** For each cell, finite ones first, its corners, then its mates: 4 times a neighbour, and the corner opposite to the common facet. */
  records: Uint32Array;
  /** For each point the vertex that stands for it. */
  representatives: Uint32Array;
}
export declare class Triangulation extends Result implements TriangulationFacts, TriangulationArrays {
  size: number; hullSize: number; points: number; vertices: number; duplicates: number; hidden: number; dimension: number;
  readonly flat: boolean;
  readonly corners: 3 | 4;
  readonly tetrahedra: Uint32Array; readonly triangles: Uint32Array; readonly cells: Uint32Array; readonly hull: Uint32Array;
  readonly records: Uint32Array; readonly representatives: Uint32Array;
  /** The hash that `brio delaunay` reports.   points  those that were given. */
  checksum(points: Numbers): string;
  /** Proves exactly that this is the triangulation of the points; throws a BrioError that says what is wrong. */
  check(points: Numbers, weights?: Numbers): void;
  copy(): TriangulationFacts & TriangulationArrays;
}

export interface Certificate {
  closed: boolean; manifold: boolean; oriented: boolean;
  components: number; genus: number; boundary_edges: number; boundary_loops: number;
  nonmanifold_edges: number; nonmanifold_vertices: number; flipped_edges: number;
  /** Pairs of faces that cross. */
  self_intersections: number;
  area: number; volume: number;
}
export interface SurfaceFacts { noise: number; smoothed: boolean; holes: number; bridges: number; strays: number; agreement: number }
export interface MeshArrays {
  vertices: Float64Array;
  /** Corners of the faces; face f has faces[offsets[f]] to faces[offsets[f + 1] - 1]. */
  faces: Uint32Array; offsets: Uint32Array;
  tetrahedra: Uint32Array; edges: Uint32Array;
  properties: Record<string, Values>; faceProperties: Record<string, Values>;
}
export interface MeshFacts {
  /** Of `surface`. */
  facts?: SurfaceFacts;
  /** Of `hull`: the point of each vertex, and the dimension of the points. */
  samples?: Uint32Array; dimension?: number;
  /** Of `alphaShape`: the squared radius that was taken, tetrahedra of the solid, points outside of it. */
  alpha?: number; solid?: number; uncovered?: number;
}
export declare class Mesh extends Result implements MeshArrays, MeshFacts {
  readonly vertices: Float64Array; readonly faces: Uint32Array; readonly offsets: Uint32Array; readonly tetrahedra: Uint32Array;
  readonly edges: Uint32Array; readonly properties: Record<string, Values>; readonly faceProperties: Record<string, Values>;
  facts?: SurfaceFacts; samples?: Uint32Array; dimension?: number; alpha?: number; solid?: number; uncovered?: number;
  /** Of `surface` with `explain`; released by itself. */
  explanation?: Explanation;
  /** Counted when it is first asked for. */
  readonly certificate: Certificate;
  copy(): MeshArrays & MeshFacts;
}
/** How a surface came to be, at some of its samples: for `page`. */
export declare class Explanation extends Result { readonly samples: number; readonly allSamples: number }
export declare class AlphaComplex extends Result {
  /** Those of dimension k, 0 to 3: k + 1 points each, ascending. */
  simplices(k: number): Uint32Array;
  /** The least alpha, a squared radius, at which each is in the complex. */
  values(k: number): Float64Array;
  copy(): { simplices: Uint32Array[]; values: Float64Array[] };
}
export interface CellsArrays {
  size: number; volumeSum: number; regionVolume: number;
  site: Uint32Array; volume: Float64Array; bounded: Uint8Array; area: Float64Array; centroid: Float64Array;
  /** Cell c has the faces faceOffsets[c] to faceOffsets[c + 1] - 1; a neighbour below 0 is a wall of the box. */
  faceOffsets: Uint32Array; faceNeighbours: Int32Array; faceAreas: Float64Array; faceNormals: Float64Array;
  cornerOffsets: Uint32Array; faceVertices: Uint32Array; vertices: Float64Array;
}
export interface Cells extends CellsArrays {}
export declare class Cells extends Result { copy(): CellsArrays }

export interface PlaneOptions extends CallOptions { /** Coordinates of a point. */ dimension?: 2 | 3 }
export interface AlphaOptions extends CallOptions { weights?: Numbers; /** A squared radius; not given: the least for one solid. */ alpha?: number }
export interface VoronoiOptions extends CallOptions {
  weights?: Numbers;
  /** x0 y0 z0 x1 y1 z1: clips the cells. */
  box?: Numbers;
  faces?: boolean; vertices?: boolean;
}
export interface SurfaceOptions extends CallOptions {
  /** docs/which-method.md; not given: labeled. */
  method?: 'labeled' | 'power-crust' | 'cocone' | 'tight-cocone' | 'offset';
  noise?: 'auto' | 'keep' | 'smooth';
  holes?: 'auto' | 'closed';
  /** Leaves holes of a larger radius open, in spacings of the points. */
  open?: number;
  simplify?: boolean; confidence?: boolean; polygons?: boolean;
  /** Of offset. */
  distance?: number;
  theta?: number; boundaries?: boolean | 'auto'; density?: boolean; pieces?: number; seed?: number;
  /** Keeps how the surface came to be: cells, poles, labels of at most 5,000 samples. Not with offset and pieces. */
  explain?: boolean;
  /** Where outside is: a normal of each point; places of scanners, one for all points or one of each. */
  normals?: Numbers; origins?: Numbers;
}
export interface WriteOptions extends CallOptions { ascii?: boolean; float32?: boolean }
export interface MeshInput {
  vertices: Numbers; faces?: ArrayLike<number>; offsets?: ArrayLike<number>; tetrahedra?: ArrayLike<number>; edges?: ArrayLike<number>;
  properties?: Record<string, Values | number[]>; faceProperties?: Record<string, Values | number[]>;
}

export declare class Brio {
  readonly version: string;
  /** Extensions of files that are read, written, and written with faces. */
  readonly reads: string[]; readonly writes: string[]; readonly writesFaces: string[];
  /** Bytes of the module's memory. */
  readonly memory: number;
  progress: Progress | null;
  room(count: number, coordinates?: number): Points;
  delaunay(points: Numbers, options?: PlaneOptions): Triangulation;
  regular(points: Numbers, weights: Numbers, options?: PlaneOptions): Triangulation;
  hull(points: Numbers, options?: CallOptions & { polygons?: boolean }): Mesh;
  alphaComplex(points: Numbers, options?: PlaneOptions & { weights?: Numbers }): AlphaComplex;
  alphaShape(points: Numbers, options?: AlphaOptions): Mesh;
  voronoi(points: Numbers, options?: VoronoiOptions): Cells;
  surface(points: Numbers | Mesh, options?: SurfaceOptions): Mesh;
  mesh(arrays: MeshInput): Mesh;
  read(bytes: Uint8Array, name?: string, options?: CallOptions): Mesh;
  write(mesh: Mesh | MeshInput, name: string, options?: WriteOptions): Uint8Array;
  page(layers: { mesh: Mesh; name?: string; report?: string; explanation?: Explanation }[], options?: CallOptions & { selfIntersections?: boolean }): Uint8Array;
}

export type Source = Response | BufferSource | WebAssembly.Module;
/** Loads the module.   source  not given: the package's brio.wasm. */
export declare function load(source?: Source | Promise<Source>): Promise<Brio>;
