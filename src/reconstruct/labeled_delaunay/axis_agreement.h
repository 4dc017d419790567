/* How neighbouring samples tell whether their axes have one sign. */
#ifndef BRIO_RECONSTRUCT_AXIS_AGREEMENT_H
#define BRIO_RECONSTRUCT_AXIS_AGREEMENT_H

/** Returns the log-odds that the axes of two samples point to one side of the surface; negative if they rather point to
 *  different sides.
 *  along     cosine between the axes.
 *  mirrored  cosine between one axis and the mirror image of the other, across the plane between the samples: the
 *            samples of a circle have 1 if their axes point to one side of it.
 *  distance  of the samples, in spacings.
 *  noise     of the samples, as brio_least_noise finds it. */
double brio_axis_log_odds(double along, double mirrored, double distance, double noise);

#endif
