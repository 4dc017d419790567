/* Edges and holes of machined solids. */
#include "testdata/solid_edges.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;
static const double LONG = 2; /* longer than any solid */

uint32_t brio_solid_edged(brio_solid_maker *m, brio_csg_kind kind) {
    int treatment = brio_solid_pick(m, 0, 5);
    double reach = brio_solid_spacings(m, 1, 5);
    if (treatment < 4) return brio_solid_combine(m, kind, BRIO_BLEND_SHARP, 0);
    return brio_solid_combine(m, kind, treatment == 4 ? BRIO_BLEND_CHAMFER : BRIO_BLEND_ROUND, reach);
}

brio_solid_part brio_solid_part_new(brio_solid_maker *m) {
    brio_solid_part part;
    part.root = brio_solid_edged(m, BRIO_CSG_CUT);
    part.body = brio_solid_edged(m, BRIO_CSG_UNION);
    brio_solid_join(m, part.root, part.body);
    return part;
}

uint32_t brio_solid_rough_box(brio_solid_maker *m, double x, double y, double z) {
    int treatment = brio_solid_pick(m, 0, 5);
    double r = brio_solid_spacings(m, 1.5, 8), least = fmin(x, fmin(y, z));
    if (treatment == 4 && r < 0.9 * least)
        return brio_solid_over(m, BRIO_CSG_GROW, brio_solid_box(m, x - r, y - r, z - r), r);
    if (treatment == 5) {
        uint32_t common = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SHARP, 0);
        r = fmin(3 * r, 0.9 * fmin(x, y));
        uint32_t column = brio_solid_over(m, BRIO_CSG_GROW, brio_solid_box(m, x - r, y - r, LONG), r);
        brio_solid_join(m, common, column);
        brio_solid_join(m, common, brio_solid_box(m, LONG, LONG, z));
        return common;
    }
    return brio_solid_box(m, x, y, z);
}

double brio_solid_hole(brio_solid_maker *m, double most) {
    double r = 0.5 * brio_solid_size(m);
    return fmax(fmin(r, most), fmin(m->spacing, most));
}

uint32_t brio_solid_bolt(brio_solid_maker *m, double radius, double face) {
    uint32_t hole = brio_solid_cylinder(m, radius, LONG);
    int mouth = brio_solid_pick(m, 0, 4);
    double deep = brio_solid_spacings(m, 1.5, 5);
    if (mouth < 3) return hole;
    uint32_t both = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SHARP, 0), wide;
    if (mouth == 3) {
        wide = brio_solid_move(m, brio_solid_cylinder(m, 1.6 * radius, deep), 0, 0, face);
    } else {
        wide = brio_csg_add(m->tree, BRIO_CSG_LATHE, NULL, 0);
        brio_csg_point(m->tree, wide, -1, face - radius, 0, 0);
        brio_csg_point(m->tree, wide, 0.8 * radius, face - radius, 0, 0);
        brio_csg_point(m->tree, wide, 1.8 * radius, face, 0, 0);
        brio_csg_point(m->tree, wide, 1.8 * radius, face + 0.1, 0, 0);
        brio_csg_point(m->tree, wide, -1, face + 0.1, 0, 0);
    }
    brio_solid_join(m, both, hole);
    brio_solid_join(m, both, wide);
    return both;
}

uint32_t brio_solid_bolt_grid(brio_solid_maker *m, double x, double y, double face) {
    double r = brio_solid_hole(m, 0.25 * fmin(x, y)), room = fmax(2.6, 1.9 * 1.8) * r + 2 * m->spacing;
    double most[2], count[2], step[2], half[2] = {x - 0.5 * room, y - 0.5 * room};
    for (int k = 0; k < 2; k++) {
        most[k] = fmax(floor(half[k] / room), 0);
        count[k] = floor(brio_solid_uniform(m, 0, fmin(most[k], 3) + 0.99));
        step[k] = count[k] > 0 ? half[k] / count[k] : 1;
    }
    const double v[4] = {count[0], step[0], count[1], step[1]};
    return brio_csg_over(m->tree, BRIO_CSG_GRID, brio_solid_bolt(m, r, face), v, 4);
}

uint32_t brio_solid_bolt_ring(brio_solid_maker *m, double distance, double room, double face) {
    double r = brio_solid_hole(m, 0.4 * room);
    int most = (int)fmin(FULL_TURN * distance / (3.6 * r + 2 * m->spacing), 12);
    int count = brio_solid_pick(m, most < 3 ? most < 1 ? 1 : most : 3, most < 3 ? 3 : most);
    uint32_t hole = brio_solid_move(m, brio_solid_bolt(m, r, face), distance, 0, 0);
    return brio_solid_over(m, BRIO_CSG_RING, hole, count);
}
