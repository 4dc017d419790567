/* The sculpture: three rings, each linked with the other two, grow out of one plinth.
 *
 * The rings are Villarceau circles of a torus that stands upright: circles of one family are linked in pairs, and
 * turned by thirds of a revolution they keep their distance. So each makes one handle, and the plinth that swallows all
 * their feet makes the three one body of genus 3. The rings taper from foot to top, and everything is blended by a
 * smooth minimum, so the surface bends gently.
 *
 * Each part is a distance function or a little less: a ring's thickness is linear in height, of slope TAPER, so
 * dividing by 1 + TAPER keeps the sum from growing faster than the distance; the smooth minimum of such functions is
 * one too.
 *
 * Based on: Villarceau. Theoreme sur le tore. Nouvelles annales de mathematiques 1848. */
#include "testdata/sculpture.h"
#include <math.h>

static const double RING = 1.0;       /* radius of the rings */
static const double SPREAD = 0.5;     /* distance of their centres from the axis of the torus */
static const double THICKNESS = 0.17; /* of a ring at the height of the origin */
static const double TAPER = 0.04;     /* thickness lost per unit of height */
static const double RING_BLEND = 0.3; /* reach of the smooth minimum between rings, */
static const double BLEND = 0.4;      /* and between all else */
static const double LIFT = 0.4;       /* of the centre of the torus above the origin */

/* The minimum of a and b, rounded where they differ by less than `reach`; C2, and never above the minimum. */
static double smooth_min(double a, double b, double reach) {
    double h = fmax(reach - fabs(a - b), 0) / reach;
    return fmin(a, b) - h * h * h * reach / 6;
}

/* Distance to a circle with its plane through its centre. */
static double circle_distance(const double *p, const double *centre, const double *normal) {
    double d[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
    double height = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
    double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double in_plane = sqrt(fmax(square - height * height, 0)) - RING;
    return sqrt(in_plane * in_plane + height * height);
}

/* Distance to a ring. The torus' axis is y; the circle of angle phi has its centre in the direction u = (cos phi, 0,
 * sin phi), in a plane through u that leans so as to touch the torus twice. */
static double ring_distance(const double *p, double cos_phi, double sin_phi) {
    const double lean = SPREAD / RING, upright = sqrt(1 - lean * lean);
    const double centre[3] = {SPREAD * cos_phi, 0, LIFT + SPREAD * sin_phi};
    const double normal[3] = {lean * sin_phi, upright, -lean * cos_phi};
    return (circle_distance(p, centre, normal) - THICKNESS + TAPER * p[2]) / (1 + TAPER);
}

/* Distance to an upright cylinder with a rounded rim. */
static double disc_distance(const double *p, double z, double radius, double half_height, double rim) {
    double outside = sqrt(p[0] * p[0] + p[1] * p[1]) - radius + rim, above = fabs(p[2] - z) - half_height + rim;
    double x = fmax(outside, 0), y = fmax(above, 0);
    return sqrt(x * x + y * y) + fmin(fmax(outside, above), 0) - rim;
}

/* Distance to an upright capsule on the axis. */
static double neck_distance(const double *p, double low, double high, double radius) {
    double d = p[2] - fmin(fmax(p[2], low), high);
    return sqrt(p[0] * p[0] + p[1] * p[1] + d * d) - radius;
}

double brio_sculpture(const double *p, const void *user) {
    (void)user;
    const double half = 0.5, root = 0.86602540378443864676; /* cosine and sine of a sixth of a revolution */
    double rings = ring_distance(p, 0, 1);
    rings = smooth_min(rings, ring_distance(p, root, -half), RING_BLEND);
    rings = smooth_min(rings, ring_distance(p, -root, -half), RING_BLEND);
    double plinth = smooth_min(neck_distance(p, -1.25, -0.8, 0.5), disc_distance(p, -1.63, 0.76, 0.17, 0.15), BLEND);
    return smooth_min(rings, plinth, BLEND);
}

void brio_sculpture_box(double low[3], double high[3]) {
    const double box[2][3] = {{-1.65, -0.85, -1.92}, {1.65, 0.85, 2.06}};
    for (int k = 0; k < 3; k++) {
        low[k] = box[0][k];
        high[k] = box[1][k];
    }
}
