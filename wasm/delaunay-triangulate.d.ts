/** Cells of points of 1, 2 or 3 coordinates; with includePointAtInfinity also those of the hull, in which -1 stands for it. */
export default function triangulate(points: ArrayLike<number>[], includePointAtInfinity?: boolean): number[][];
