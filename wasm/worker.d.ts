import type { AlphaComplex, AlphaOptions, CallOptions, Cells, Mesh, MeshInput, Numbers, PlaneOptions, SurfaceOptions, Triangulation, VoronoiOptions, WriteOptions } from './load.js';
/** What a call to the worker has besides: `transfer` lists memory that is sent, and not kept. */
export interface Asked { signal?: AbortSignal; progress?: (stage: string, share: number) => void; transfer?: ArrayBuffer[] }
type To<O extends CallOptions> = Omit<O, 'progress'> & Asked;
type Copy<R extends { copy(): unknown }> = Promise<ReturnType<R['copy']>>;
export interface BrioWorker {
  delaunay(points: Numbers, options?: To<PlaneOptions>): Copy<Triangulation>;
  regular(points: Numbers, weights: Numbers, options?: To<PlaneOptions>): Copy<Triangulation>;
  hull(points: Numbers, options?: To<CallOptions & { polygons?: boolean }>): Copy<Mesh>;
  alphaComplex(points: Numbers, options?: To<PlaneOptions & { weights?: Numbers }>): Copy<AlphaComplex>;
  alphaShape(points: Numbers, options?: To<AlphaOptions>): Copy<Mesh>;
  voronoi(points: Numbers, options?: To<VoronoiOptions>): Copy<Cells>;
  /** The copy has its certificate. */
  surface(points: Numbers, options?: To<SurfaceOptions>): Promise<ReturnType<Mesh['copy']> & { certificate: Mesh['certificate'] }>;
  read(bytes: Uint8Array, name?: string, options?: To<CallOptions>): Copy<Mesh>;
  write(mesh: MeshInput, name: string, options?: To<WriteOptions>): Promise<Uint8Array>;
  /** Ends the worker. */
  end(): void;
}
export declare function start(options?: { source?: WebAssembly.Module | BufferSource }): Promise<BrioWorker>;
