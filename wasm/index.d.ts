import type { Brio } from './load.js';
export * from './load.js';
/** The module, loaded; the functions are its methods. */
export declare const brio: Brio;
export declare const delaunay: Brio['delaunay'];
export declare const regular: Brio['regular'];
export declare const hull: Brio['hull'];
export declare const alphaComplex: Brio['alphaComplex'];
export declare const alphaShape: Brio['alphaShape'];
export declare const voronoi: Brio['voronoi'];
export declare const surface: Brio['surface'];
export declare const mesh: Brio['mesh'];
export declare const read: Brio['read'];
export declare const write: Brio['write'];
export declare const page: Brio['page'];
export declare const room: Brio['room'];
export declare const version: string;
