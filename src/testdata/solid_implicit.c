/* Organic solids: a family by chance, then waves, a plane cut and a rotation by chance. */
#include "testdata/solid_families.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;

/* A family that is named twice is drawn twice as often. */
static const brio_solid_family FAMILIES[] = {
    brio_solid_creature,  brio_solid_creature, brio_solid_bust,   brio_solid_bust,  brio_solid_blobs,
    brio_solid_blobs,     brio_solid_hand,     brio_solid_flower, brio_solid_coral, brio_solid_knot,
    brio_solid_tangle,    brio_solid_snail,    brio_solid_rings,  brio_solid_vase,  brio_solid_vase,
    brio_solid_sponge,    brio_solid_ribbon,   brio_solid_mask,   brio_solid_mask,  brio_solid_perforated,
    brio_solid_perforated};

/* Adds low waves, whose length is at least 8 times their height. */
static uint32_t with_waves(brio_solid_maker *m, uint32_t node) {
    double v[5], height = brio_solid_spacings(m, 0.2, 1), length = brio_solid_spacings(m, 6, 20);
    v[1] = FULL_TURN / length;
    v[0] = fmin(height, 0.3 / v[1]);
    for (int k = 2; k < 5; k++) v[k] = brio_solid_uniform(m, 0, FULL_TURN);
    return brio_csg_over(m->tree, BRIO_CSG_WAVES, node, v, 5);
}

static uint32_t with_plane_cut(brio_solid_maker *m, uint32_t node, double most) {
    double d[3], level = brio_solid_uniform(m, 0, most);
    brio_solid_direction(m, d);
    double reach = brio_solid_chance(m, 0.5) ? brio_solid_spacings(m, 1, 4) : 0;
    return brio_solid_trim(m, node, d, level, reach);
}

/* Leaves a wall of the body, and opens it by a plane. */
static uint32_t hollowed(brio_solid_maker *m, uint32_t node) {
    double wall = brio_solid_size(m);
    return with_plane_cut(m, brio_solid_over(m, BRIO_CSG_SHELL, node, wall), 0.15);
}

/* Cuts a bent tunnel through the body. */
static uint32_t with_tunnel(brio_solid_maker *m, uint32_t node) {
    enum { POINTS = 25 };
    double points[POINTS][4], a[3], b[3], r = fmax(0.5 * brio_solid_size(m), 0.9 * m->spacing);
    double reach = brio_solid_spacings(m, 0.5, 3);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, reach);
    brio_solid_direction(m, a);
    brio_solid_direction(m, b);
    for (int i = 0; i < POINTS; i++) {
        double t = (double)i / (POINTS - 1), s = 1 - t;
        for (int k = 0; k < 3; k++) points[i][k] = 0.6 * (s * s * a[k] + t * t * b[k]);
        points[i][3] = r;
    }
    brio_solid_join(m, cut, node);
    brio_solid_join(m, cut, brio_solid_tube(m, (const double(*)[4])points, POINTS, false));
    return cut;
}

/* Joins a ring that the body holds, if the ring meets the body. */
static uint32_t with_ring(brio_solid_maker *m, uint32_t node) {
    double at[3], r = fmax(0.5 * brio_solid_size(m), 0.9 * m->spacing), major = brio_solid_uniform(m, 0.08, 0.2);
    double reach = brio_solid_spacings(m, 1, 4);
    uint32_t both = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, reach);
    uint32_t ring = brio_solid_tumble(m, brio_solid_torus(m, fmax(major, 2.5 * r), r));
    brio_solid_direction(m, at);
    brio_solid_join(m, both, node);
    brio_solid_join(m, both, brio_solid_move(m, ring, 0.25 * at[0], 0.25 * at[1], 0.25 * at[2]));
    return both;
}

void brio_solid_implicit(brio_solid_maker *m) {
    uint32_t node = FAMILIES[m->family % (sizeof FAMILIES / sizeof *FAMILIES)](m);
    if (brio_solid_chance(m, 0.12)) node = with_ring(m, node);
    if (brio_solid_chance(m, 0.12)) node = hollowed(m, node);
    if (brio_solid_chance(m, 0.15)) node = with_tunnel(m, node);
    if (brio_solid_chance(m, 0.2)) node = with_waves(m, node);
    if (brio_solid_chance(m, 0.15)) node = with_plane_cut(m, node, 0.3);
    m->tree->root = brio_solid_tumble(m, node);
}
