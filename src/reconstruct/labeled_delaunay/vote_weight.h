/* How much the place of a tetrahedron in the cell of a sample tells about its side. */
#ifndef BRIO_RECONSTRUCT_VOTE_WEIGHT_H
#define BRIO_RECONSTRUCT_VOTE_WEIGHT_H

/** Returns the log-odds that a tetrahedron is on the side of a sample to which the sample's axis points.
 *  cosine     of the angle between the axis and the direction from the sample to the Voronoi vertex.
 *  thickness  the inradius of the tetrahedron in spacings of the samples; INFINITY for an infinite one.
 *  noise      of the samples, as brio_least_noise finds it. */
double brio_vote_log_odds(double cosine, double thickness, double noise);

/** The largest result. */
#define BRIO_MOST_LOG_ODDS 6.0

#endif
