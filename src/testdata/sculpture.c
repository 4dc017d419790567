/* The sculpture: three rings, each linked with the other two, grow out of one plinth.
 *
 * The rings are Villarceau circles of an upright torus. Circles of one family are linked in pairs; turned by thirds of
 * a revolution they keep their distance. Each ring makes one handle. The plinth contains the feet of all three rings,
 * so the whole is one body of genus 3. The rings taper from foot to top. A smooth minimum blends all parts, so the
 * surface bends gently.
 *
 * Each part is a lower bound of the distance. The thickness of a ring is linear in height with slope TAPER, so
 * dividing by 1 + TAPER keeps the function below the distance. The smooth minimum of such functions is such a function
 * too.
 *
 * Based on: Villarceau. Theoreme sur le tore. Nouvelles annales de mathematiques 1848. */
#include "testdata/sculpture.h"
#include <math.h>

static const double RING = 1.0;       /* radius of the rings */
static const double SPREAD = 0.5;     /* distance of their centres from the axis of the torus */
static const double THICKNESS = 0.17; /* of a ring at the height of the origin */
static const double TAPER = 0.04;     /* thickness lost per unit of height */
static const double RING_BLEND = 0.3; /* reach of the smooth minimum between rings */
static const double BLEND = 0.4;      /* reach of the smooth minimum between all other parts */
static const double LIFT = 0.4;       /* of the centre of the torus above the origin */

/* Returns the minimum of a and b, rounded where they differ by less than `reach`. The result is C2 and at most the
 * minimum. */
static double smooth_min(double a, double b, double reach) {
    double h = fmax(reach - fabs(a - b), 0) / reach;
    return fmin(a, b) - h * h * h * reach / 6;
}

/* Returns the distance to the circle of radius RING round a centre, in the plane with the given normal. */
static double circle_distance(const double *p, const double *centre, const double *normal) {
    double d[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
    double height = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
    double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double in_plane = sqrt(fmax(square - height * height, 0)) - RING;
    return sqrt(in_plane * in_plane + height * height);
}

/* Returns the distance to a ring. The axis of the torus is y. The circle of angle phi has its centre in direction u =
 * (cos phi, 0, sin phi). Its plane contains u and leans so that it touches the torus twice. */
static double ring_distance(const double *p, double cos_phi, double sin_phi) {
    const double lean = SPREAD / RING, upright = sqrt(1 - lean * lean);
    const double centre[3] = {SPREAD * cos_phi, 0, LIFT + SPREAD * sin_phi};
    const double normal[3] = {lean * sin_phi, upright, -lean * cos_phi};
    return (circle_distance(p, centre, normal) - THICKNESS + TAPER * p[2]) / (1 + TAPER);
}

/* Returns the distance to an upright cylinder with a rounded rim. */
static double disc_distance(const double *p, double z, double radius, double half_height, double rim) {
    double outside = sqrt(p[0] * p[0] + p[1] * p[1]) - radius + rim, above = fabs(p[2] - z) - half_height + rim;
    double x = fmax(outside, 0), y = fmax(above, 0);
    return sqrt(x * x + y * y) + fmin(fmax(outside, above), 0) - rim;
}

/* Returns the distance to an upright capsule on the axis. */
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
