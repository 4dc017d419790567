/** Facets of the hull of points of 1, 2 or 3 coordinates. */
export default function convexHull(points: ArrayLike<number>[]): number[][];
