/* Machined solids that are round: pipes, wheels, drums. */
#include "testdata/solid_edges.h"
#include "testdata/solid_families.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;

/* --- pipes --- */

/* Makes two to six arms that meet, hollow, with flanges. */
uint32_t brio_solid_pipe(brio_solid_maker *m) {
    static const double way[6][3] = {{1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, -1, 0}};
    brio_solid_part part = brio_solid_part_new(m);
    uint32_t inside = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SHARP, 0);
    double r = brio_solid_uniform(m, 0.05, 0.13), wall = fmin(brio_solid_size(m), 0.6 * r),
           flange = brio_solid_uniform(m, 1.5, 2);
    double thick = brio_solid_size(m);
    const double origin[3] = {0, 0, 0};
    int arms = brio_solid_pick(m, 2, 6);
    bool open = brio_solid_chance(m, 0.85);
    brio_solid_join(m, part.body, brio_solid_ball(m, 1.02 * r));
    brio_solid_join(m, inside, brio_solid_ball(m, r - wall));
    for (int i = 0; i < arms; i++) {
        double half = 0.5 * brio_solid_uniform(m, 0.25, 0.45), t = 0.5 * thick;
        bool flanged = brio_solid_chance(m, 0.6), bolts = brio_solid_chance(m, 0.7);
        uint32_t arm = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SHARP, 0);
        uint32_t tube = brio_solid_cylinder(m, r - wall, open ? 0.5 : 0.9 * half);
        brio_solid_join(m, arm, brio_solid_move(m, brio_solid_cylinder(m, r, half), 0, 0, half));
        if (flanged)
            brio_solid_join(m, arm, brio_solid_move(m, brio_solid_cylinder(m, flange * r, t), 0, 0, 2 * half - t));
        brio_solid_join(m, part.body, brio_solid_aim(m, arm, way[i], origin));
        brio_solid_join(m, inside,
                        brio_solid_aim(m, brio_solid_move(m, tube, 0, 0, open ? 0.5 : 0.9 * half), way[i], origin));
        if (!flanged || !bolts) continue;
        double room = 0.5 * (flange - 1) * r;
        uint32_t keep = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SHARP, 0);
        brio_solid_join(m, keep, brio_solid_bolt_ring(m, r + room, room, 2 * half));
        brio_solid_join(m, keep, brio_solid_move(m, brio_solid_box(m, 1, 1, 3 * t), 0, 0, 2 * half - t));
        brio_solid_join(m, part.root, brio_solid_aim(m, keep, way[i], origin));
    }
    brio_solid_join(m, part.root, inside);
    return part.root;
}

/* --- wheels --- */

/* Returns a rim, a hub and spokes. */
uint32_t brio_solid_wheel(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double r = brio_solid_uniform(m, 0.3, 0.42), half = brio_solid_uniform(m, 0.02, 0.1),
           rim = fmin(brio_solid_size(m), 0.15);
    double hub = brio_solid_uniform(m, 0.05, 0.12), tall = half * brio_solid_uniform(m, 0.8, 1.8),
           bore = brio_solid_hole(m, 0.7 * hub);
    double spoke = 0.5 * brio_solid_size(m), thick = fmin(0.5 * brio_solid_size(m), half);
    int count = brio_solid_pick(m, 3, 9);
    uint32_t hoop = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SHARP, 0), arm;
    brio_solid_join(m, hoop,
                    brio_solid_chance(m, 0.5) ? brio_solid_cylinder(m, r, half) : brio_solid_torus(m, r - half, half));
    brio_solid_join(m, hoop, brio_solid_cylinder(m, r - rim, 1));
    brio_solid_join(m, part.body, hoop);
    spoke = fmin(spoke, 0.8 * hub * sin(0.5 * FULL_TURN / count));
    if (brio_solid_chance(m, 0.5))
        arm = brio_solid_box(m, 0.5 * (r - 0.5 * rim), spoke, thick);
    else
        arm = brio_solid_axis(m, brio_solid_cylinder(m, fmin(spoke, half), 0.5 * (r - 0.5 * rim)), 0);
    arm = brio_solid_move(m, arm, 0.5 * (r - 0.5 * rim), 0, 0);
    brio_solid_join(m, part.body, brio_solid_over(m, BRIO_CSG_RING, arm, count));
    brio_solid_join(m, part.body, brio_solid_cylinder(m, hub, tall));
    brio_solid_join(m, part.root, brio_solid_cylinder(m, bore, 1));
    return part.root;
}

/* --- drums --- */

/* Returns a hoop or a pot with rows of holes or slots through its wall: sieves, cages of bearings, slotted rotors. */
uint32_t brio_solid_drum(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double r = brio_solid_uniform(m, 0.2, 0.35), half = brio_solid_uniform(m, 0.06, 0.3),
           wall = fmin(brio_solid_size(m), 0.1);
    double size = fmax(brio_solid_size(m), 1.8 * m->spacing), bar = fmax(brio_solid_size(m), 1.8 * m->spacing);
    double holes = fmin(floor(FULL_TURN * r / (size + bar)), 24),
           rows = fmin(floor((2 * half - bar) / (size + bar)), 4);
    bool pot = brio_solid_chance(m, 0.4), slots = brio_solid_chance(m, 0.4);
    uint32_t hoop = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SHARP, 0);
    brio_solid_join(m, hoop, brio_solid_cylinder(m, r, half));
    brio_solid_join(
        m, hoop,
        brio_solid_move(m, brio_solid_cylinder(m, r - wall, 1), 0, 0, pot ? 1 + fmax(wall, m->spacing) - half : 0));
    brio_solid_join(m, part.body, hoop);
    if (holes < 2 || (!slots && rows < 1)) return part.root;
    for (int row = 0; row < (slots ? 1 : (int)rows); row++) {
        double z = slots ? 0 : (row - 0.5 * (rows - 1)) * (size + bar);
        uint32_t hole = slots ? brio_solid_box(m, 0.5, 0.5 * size, half - bar)
                              : brio_solid_axis(m, brio_solid_cylinder(m, 0.5 * size, 0.5), 0);
        if (slots && half < 1.2 * bar) break;
        hole = brio_solid_over(m, BRIO_CSG_RING, brio_solid_move(m, hole, 0.5 + 0.3 * r, 0, z), holes);
        brio_solid_join(m, part.root, row % 2 ? brio_solid_spin(m, hole, 0.5 * FULL_TURN / holes) : hole);
    }
    return part.root;
}
