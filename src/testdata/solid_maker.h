/* What the makers of random solids share: random numbers, sizes of features, and shapes put in place.
 *
 * Solids are made about 1 in diagonal round the origin. Draw random numbers one a statement: C does not fix the order
 * in which the arguments of a call are evaluated. */
#ifndef BRIO_TESTDATA_SOLID_MAKER_H
#define BRIO_TESTDATA_SOLID_MAKER_H

#include "base/rng.h"
#include "testdata/csg.h"

typedef struct {
    brio_csg *tree;
    brio_rng rng;
    double spacing;  /* of a sampling: the unit of the sizes of features */
    uint64_t family; /* random: which family is drawn, modulo their number */
    int parts;       /* most components; a family that wants several sets it */
} brio_solid_maker;

/** Builds a random organic or machined solid into m->tree. */
void brio_solid_implicit(brio_solid_maker *m);
void brio_solid_machined(brio_solid_maker *m);

/* --- random numbers --- */

static inline double brio_solid_uniform(brio_solid_maker *m, double low, double high) {
    return low + (high - low) * brio_rng_double(&m->rng);
}

static inline bool brio_solid_chance(brio_solid_maker *m, double probability) {
    return brio_rng_double(&m->rng) < probability;
}

/** Returns an integer that is uniform in [low, high]. */
static inline int brio_solid_pick(brio_solid_maker *m, int low, int high) {
    return low + (int)brio_rng_below(&m->rng, (uint32_t)(high - low + 1));
}

/** Returns the size of a feature: log-uniform between `least` and `most` spacings. */
double brio_solid_spacings(brio_solid_maker *m, double least, double most);

/** Returns the thickness of a wall, a gap or a bar: one in five has 1.6 to 3 spacings, most have 3 to 10, the others
 *  10 to 20. */
double brio_solid_size(brio_solid_maker *m);

void brio_solid_direction(brio_solid_maker *m, double *d);

/* --- shapes --- */

uint32_t brio_solid_ball(brio_solid_maker *m, double radius);
uint32_t brio_solid_ellipsoid(brio_solid_maker *m, double x, double y, double z);
uint32_t brio_solid_torus(brio_solid_maker *m, double major, double minor);
uint32_t brio_solid_box(brio_solid_maker *m, double x, double y, double z); /* half sides */
uint32_t brio_solid_cylinder(brio_solid_maker *m, double radius, double half_height);

/** Makes the hull of the ball of radius r round a and the ball of radius s round b. */
uint32_t brio_solid_capsule(brio_solid_maker *m, const double *a, const double *b, double r, double s);

/** Makes a tube of balls along `count` points (x, y, z, radius); a closed one joins the last point to the first. */
uint32_t brio_solid_tube(brio_solid_maker *m, const double (*points)[4], int count, bool closed);

/* --- operations --- */

/** Makes a node without children that combines what is joined to it. */
uint32_t brio_solid_combine(brio_solid_maker *m, brio_csg_kind kind, brio_csg_blend blend, double reach);

void brio_solid_join(brio_solid_maker *m, uint32_t parent, uint32_t child);

/** Returns the child with a parameter: BRIO_CSG_SHELL, SHEET, GROW, RING, MIRROR. */
uint32_t brio_solid_over(brio_solid_maker *m, brio_csg_kind kind, uint32_t child, double parameter);

uint32_t brio_solid_move(brio_solid_maker *m, uint32_t child, double x, double y, double z);

/** Turns the child so that its z axis points along axis 0 (x), 1 (y) or 2 (z), by a cyclic exchange of axes. */
uint32_t brio_solid_axis(brio_solid_maker *m, uint32_t child, int axis);

/** Turns the child so that its z axis points along d, and moves its origin to `at`. */
uint32_t brio_solid_aim(brio_solid_maker *m, uint32_t child, const double *d, const double *at);

/** Turns the child round the z axis. */
uint32_t brio_solid_spin(brio_solid_maker *m, uint32_t child, double angle);

/** Turns the child by a random rotation. */
uint32_t brio_solid_tumble(brio_solid_maker *m, uint32_t child);

/** Returns the points of the child with d.x <= level, d being a unit vector; the edge is blended. */
uint32_t brio_solid_trim(brio_solid_maker *m, uint32_t child, const double *d, double level, double reach);

#endif
