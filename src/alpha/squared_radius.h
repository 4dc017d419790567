/* The smallest orthosphere of a simplex. */
#ifndef BRIO_ALPHA_SQUARED_RADIUS_H
#define BRIO_ALPHA_SQUARED_RADIUS_H

/** Returns the squared radius of the smallest sphere that is orthogonal to the `count` weighted vertices of a simplex, 2
 *  to 4; without weights, of the smallest circumscribed sphere. INFINITY where doubles cannot hold it. The result depends
 *  on the order of the vertices in its last bits only.
 *  p  the vertices, x y z weight; the weights are 0 without weights. */
double brio_squared_radius(const double *const *p, int count);

#endif
