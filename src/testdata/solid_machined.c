/* Machined solids: a family by chance, then a drilled hole or a plane cut by chance, and a random rotation. */
#include "testdata/solid_families.h"
#include <math.h>

static const brio_solid_family FAMILIES[] = {
    brio_solid_bracket, brio_solid_housing, brio_solid_block, brio_solid_lever,
    brio_solid_shaft,   brio_solid_gear,    brio_solid_pipe,  brio_solid_wheel,
    brio_solid_profile, brio_solid_frame,   brio_solid_sink,  brio_solid_impeller,
    brio_solid_screw,   brio_solid_crank,   brio_solid_drum,  brio_solid_bent_sheet};

/* Drills a hole through the part, or a blind one, at a slant. */
static uint32_t with_hole(brio_solid_maker *m, uint32_t node) {
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SHARP, 0);
    double r = brio_solid_size(m), d[3], at[3];
    bool blind = brio_solid_chance(m, 0.4);
    brio_solid_direction(m, d);
    brio_solid_direction(m, at);
    for (int k = 0; k < 3; k++) at[k] *= 0.15;
    uint32_t hole = brio_solid_cylinder(m, r, 1);
    if (blind) hole = brio_solid_move(m, hole, 0, 0, 1);
    brio_solid_join(m, cut, node);
    brio_solid_join(m, cut, brio_solid_aim(m, hole, d, at));
    return cut;
}

void brio_solid_machined(brio_solid_maker *m) {
    uint32_t node = FAMILIES[m->family % (sizeof FAMILIES / sizeof *FAMILIES)](m);
    if (brio_solid_chance(m, 0.15)) node = with_hole(m, node);
    if (brio_solid_chance(m, 0.1)) {
        double d[3], level = brio_solid_uniform(m, 0.1, 0.3);
        brio_solid_direction(m, d);
        node = brio_solid_trim(m, node, d, level, 0);
    }
    m->tree->root = brio_solid_tumble(m, node);
}
