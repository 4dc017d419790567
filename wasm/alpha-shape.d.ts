/** The boundary of the cells whose circumscribed radius is below 1 / alpha, of points of 2 or 3 coordinates. */
export default function alphaShape(alpha: number, points: ArrayLike<number>[]): number[][];
