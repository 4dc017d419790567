/* Signed distances of simple shapes, negative inside. Each is exact or, where its comment says so, close to the
 * distance near the surface. */
#ifndef BRIO_TESTDATA_CSG_SHAPES_H
#define BRIO_TESTDATA_CSG_SHAPES_H

#include <stdint.h>

/** Returns the distance from an ellipsoid with half axes r, to first order in the distance; at most the least half axis
 *  deep. */
double brio_ellipsoid_distance(const double *p, const double *r);

/** Returns the distance from a segment on the z axis from 0 to `height`, less a radius that runs from `low` to `high`
 *  (the hull of two balls). |low - high| < height. */
double brio_capsule_distance(const double *p, double height, double low, double high);

/** Returns the distance from a torus round the z axis. */
double brio_torus_distance(const double *p, double major, double minor);

/** Returns the distance from a box with the given half sides round the origin. */
double brio_box_distance(const double *p, const double *half);

/** Returns the distance from an upright cylinder round the origin. */
double brio_cylinder_distance(const double *p, double radius, double half_height);

/** Returns the distance from a polygon in the plane. Point i of the polygon is at points[i][0], points[i][1]. */
double brio_polygon_distance(double x, double y, const double (*points)[4], uint32_t count);

/** Returns the distance from a polygon in the plane of x and y, extruded to |z| <= half. */
double brio_prism_distance(const double *p, double half, const double (*points)[4], uint32_t count);

/** Returns the distance from a polyline of balls: point i is a centre in [0] to [2], with its radius in [3]. Radii run
 *  linearly between the points; the value exceeds the distance by a factor of at most sqrt(1 + slope^2). */
double brio_strand_distance(const double *p, const double (*points)[4], uint32_t count);

/** Returns about the distance from a vessel round the z axis, between z = v[0] and z = v[1]. Its radius is v[2] times
 *  1 + the sum of v[3 + i] sin(pi (i + 1) t + v[6 + i]), i = 0 to 2, t being (z - v[9]) / v[10]. */
double brio_vessel_distance(const double *p, const double *v);

/** Returns about the distance from an upright screw thread round the origin with a triangular section. */
double brio_thread_distance(const double *p, const double *v); /* radius, depth, pitch, half height */

/** Returns about the distance from a periodic sheet, the gyroid of period 2 pi / frequency. */
double brio_gyroid_distance(const double *p, double frequency);

#endif
