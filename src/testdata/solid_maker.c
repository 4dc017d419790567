/* Random numbers and shapes for the makers of random solids.
 *
 * Based on: Marsaglia. Choosing a point from the surface of a sphere. Annals of Mathematical Statistics 1972 (the
 * direction and, in four dimensions, the rotation). */
#include "testdata/solid_maker.h"
#include "base/vector.h"
#include <math.h>

enum { STRAND_POINTS = 4 /* of a tube that a node has: nodes far away are left out */ };

static const double THIN = 0.2, FAT = 0.8; /* shares of sizes below 3 spacings, and below 10 */

/* --- random numbers --- */

double brio_solid_spacings(brio_solid_maker *m, double least, double most) {
    return m->spacing * least * pow(most / least, brio_rng_double(&m->rng));
}

double brio_solid_size(brio_solid_maker *m) {
    double u = brio_rng_double(&m->rng);
    if (u < THIN) return brio_solid_spacings(m, 1.6, 3);
    return u < FAT ? brio_solid_spacings(m, 3, 10) : brio_solid_spacings(m, 10, 20);
}

/* Draws a uniform direction in n dimensions, 3 or 4, by rejection from the cube. */
static void direction(brio_solid_maker *m, double *d, int n) {
    double square;
    do {
        square = 0;
        for (int k = 0; k < n; k++) {
            d[k] = 2 * brio_rng_double(&m->rng) - 1;
            square += d[k] * d[k];
        }
    } while (square > 1 || square < 1e-3);
    for (int k = 0; k < n; k++) d[k] /= sqrt(square);
}

void brio_solid_direction(brio_solid_maker *m, double *d) {
    direction(m, d, 3);
}

/* --- shapes --- */

uint32_t brio_solid_ball(brio_solid_maker *m, double radius) {
    return brio_csg_add(m->tree, BRIO_CSG_BALL, &radius, 1);
}

uint32_t brio_solid_ellipsoid(brio_solid_maker *m, double x, double y, double z) {
    return brio_csg_add(m->tree, BRIO_CSG_ELLIPSOID, (const double[3]){x, y, z}, 3);
}

uint32_t brio_solid_torus(brio_solid_maker *m, double major, double minor) {
    return brio_csg_add(m->tree, BRIO_CSG_TORUS, (const double[2]){major, minor}, 2);
}

uint32_t brio_solid_box(brio_solid_maker *m, double x, double y, double z) {
    return brio_csg_add(m->tree, BRIO_CSG_BOX, (const double[3]){x, y, z}, 3);
}

uint32_t brio_solid_cylinder(brio_solid_maker *m, double radius, double half_height) {
    return brio_csg_add(m->tree, BRIO_CSG_CYLINDER, (const double[2]){radius, half_height}, 2);
}

uint32_t brio_solid_capsule(brio_solid_maker *m, const double *a, const double *b, double r, double s) {
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, height = sqrt(brio_dot(d, d));
    if (height <= fabs(r - s) * 1.01 + 1e-6) /* one ball contains the other */
        return brio_solid_move(m, brio_solid_ball(m, fmax(r, s)), r > s ? a[0] : b[0], r > s ? a[1] : b[1],
                               r > s ? a[2] : b[2]);
    for (int k = 0; k < 3; k++) d[k] /= height;
    return brio_solid_aim(m, brio_csg_add(m->tree, BRIO_CSG_CAPSULE, (const double[3]){height, r, s}, 3), d, a);
}

/* Sets the ball that contains a strand: round the middle of its ends. */
static void bound_strand(brio_csg *tree, brio_csg_node *strand) {
    const double(*points)[4] = (const double(*)[4])tree->points + strand->point;
    for (int k = 0; k < 3; k++) strand->v[k] = 0.5 * (points[0][k] + points[strand->points - 1][k]);
    for (uint32_t i = 0; i < strand->points; i++)
        strand->v[3] = fmax(strand->v[3], sqrt(brio_square_distance(strand->v, points[i])) + points[i][3]);
}

uint32_t brio_solid_tube(brio_solid_maker *m, const double (*points)[4], int count, bool closed) {
    uint32_t tube = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SHARP, 0);
    int last = closed ? count : count - 1;
    for (int first = 0; first < last; first += STRAND_POINTS - 1) {
        uint32_t strand = brio_csg_add(m->tree, BRIO_CSG_STRAND, NULL, 0);
        for (int i = first; i <= last && i < first + STRAND_POINTS; i++) {
            const double *p = points[i % count];
            brio_csg_point(m->tree, strand, p[0], p[1], p[2], p[3]);
        }
        if (!m->tree->full) bound_strand(m->tree, &m->tree->nodes[strand]);
        brio_solid_join(m, tube, strand);
    }
    return tube;
}

/* --- operations --- */

uint32_t brio_solid_combine(brio_solid_maker *m, brio_csg_kind kind, brio_csg_blend blend, double reach) {
    uint32_t node = brio_csg_add(m->tree, kind, &reach, 1);
    m->tree->nodes[node].blend = reach > 0 ? blend : BRIO_BLEND_SHARP;
    return node;
}

void brio_solid_join(brio_solid_maker *m, uint32_t parent, uint32_t child) {
    brio_csg_join(m->tree, parent, child);
}

uint32_t brio_solid_over(brio_solid_maker *m, brio_csg_kind kind, uint32_t child, double parameter) {
    return brio_csg_over(m->tree, kind, child, &parameter, 1);
}

uint32_t brio_solid_move(brio_solid_maker *m, uint32_t child, double x, double y, double z) {
    return brio_csg_over(m->tree, BRIO_CSG_MOVE, child, (const double[3]){x, y, z}, 3);
}

/* Places the child with the axes u, v, w. */
static uint32_t place(brio_solid_maker *m, uint32_t child, const double axes[3][3], const double *at) {
    double v[12];
    for (int k = 0; k < 3; k++) {
        for (int axis = 0; axis < 3; axis++) v[3 * k + axis] = axes[axis][k];
        v[9 + k] = at ? at[k] : 0;
    }
    return brio_csg_over(m->tree, BRIO_CSG_PLACE, child, v, 12);
}

uint32_t brio_solid_axis(brio_solid_maker *m, uint32_t child, int axis) {
    double axes[3][3] = {{0}};
    if (axis == 2) return child;
    for (int k = 0; k < 3; k++) axes[k][(k + axis + 1) % 3] = 1;
    return place(m, child, (const double(*)[3])axes, NULL);
}

uint32_t brio_solid_aim(brio_solid_maker *m, uint32_t child, const double *d, const double *at) {
    const double other[3] = {fabs(d[0]) < 0.8, fabs(d[0]) >= 0.8, 0};
    double axes[3][3], length;
    brio_cross(other, d, axes[0]);
    length = sqrt(brio_dot(axes[0], axes[0]));
    for (int k = 0; k < 3; k++) {
        axes[0][k] /= length;
        axes[2][k] = d[k];
    }
    brio_cross(axes[2], axes[0], axes[1]);
    return place(m, child, (const double(*)[3])axes, at);
}

uint32_t brio_solid_spin(brio_solid_maker *m, uint32_t child, double angle) {
    double c = cos(angle), s = sin(angle);
    return place(m, child, (const double[3][3]){{c, s, 0}, {-s, c, 0}, {0, 0, 1}}, NULL);
}

/* Turns a child at random. The rotation of a uniform unit quaternion is uniform. */
uint32_t brio_solid_tumble(brio_solid_maker *m, uint32_t child) {
    double q[4];
    direction(m, q, 4);
    double w = q[0], x = q[1], y = q[2], z = q[3];
    return place(m, child,
                 (const double[3][3]){{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                                      {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                                      {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}},
                 NULL);
}

uint32_t brio_solid_trim(brio_solid_maker *m, uint32_t child, const double *d, double level, double reach) {
    uint32_t common = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SMOOTH, reach);
    uint32_t half = brio_csg_add(m->tree, BRIO_CSG_HALF, NULL, 0);
    const double at[3] = {level * d[0], level * d[1], level * d[2]};
    brio_solid_join(m, common, child);
    brio_solid_join(m, common, brio_solid_aim(m, half, d, at));
    return common;
}
