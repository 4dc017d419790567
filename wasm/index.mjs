// The package: brio, loaded, and its calls as functions. The module is compiled while this is imported.
import { load } from './brio.mjs';

export const brio = await load();
const call = (name) => (...given) => brio[name](...given);

export const delaunay = call('delaunay');
export const regular = call('regular');
export const hull = call('hull');
export const alphaComplex = call('alphaComplex');
export const alphaShape = call('alphaShape');
export const voronoi = call('voronoi');
export const surface = call('surface');
export const mesh = call('mesh');
export const read = call('read');
export const write = call('write');
export const page = call('page');
export const room = call('room');
export const version = brio.version;
export { BrioError, isCancelled, load } from './brio.mjs';
