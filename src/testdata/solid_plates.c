/* Machined solids from plates and blocks: brackets, housings, blocks, levers. */
#include "testdata/solid_edges.h"
#include "testdata/solid_families.h"
#include <math.h>

/* Returns a wall's thickness, at most `most`. */
static double wall(brio_solid_maker *m, double most) {
    double t = brio_solid_size(m);
    return fmin(t, most);
}

/* --- brackets --- */

/* Returns a right triangle in the plane of x and z, with legs along both, extruded along y. */
static uint32_t gusset(brio_solid_maker *m, double leg, double half) {
    uint32_t prism = brio_csg_add(m->tree, BRIO_CSG_PRISM, &half, 1);
    double v[12] = {1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0};
    brio_csg_point(m->tree, prism, 0, 0, 0, 0);
    brio_csg_point(m->tree, prism, leg, 0, 0, 0);
    brio_csg_point(m->tree, prism, 0, leg, 0, 0);
    return brio_csg_over(m->tree, BRIO_CSG_PLACE, prism, v, 12);
}

/* Makes L, U and T brackets: a foot, one or two walls on it, gussets between, holes in each. */
uint32_t brio_solid_bracket(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double x = brio_solid_uniform(m, 0.2, 0.4), y = brio_solid_uniform(m, 0.1, 0.3),
           z = brio_solid_uniform(m, 0.1, 0.35);
    double t = wall(m, 0.12), rib = wall(m, 0.08), leg = brio_solid_uniform(m, 0.4, 0.9) * fmin(x, 1.5 * z);
    int walls = brio_solid_pick(m, 1, 2), gussets = brio_solid_pick(m, 0, 3);
    bool inner = brio_solid_chance(m, 0.3);
    brio_solid_join(m, part.body, brio_solid_rough_box(m, x, y, 0.5 * t));
    for (int i = 0; i < walls; i++) {
        double at = (i ? 1 : -1) * (inner ? 0.5 * x : x - 0.5 * t), side = i ? -1 : 1;
        uint32_t plate = brio_solid_rough_box(m, z, y, 0.5 * t);
        brio_solid_join(m, part.body, brio_solid_move(m, brio_solid_axis(m, plate, 0), at, 0, z - 0.5 * t));
        for (int g = 0; g < gussets; g++) {
            double where = gussets == 1 ? 0 : (y - 0.5 * rib) * (2.0 * g / (gussets - 1) - 1);
            uint32_t web = gusset(m, leg, 0.5 * rib);
            if (side < 0) web = brio_solid_spin(m, web, 3.14159265358979324);
            brio_solid_join(m, part.body, brio_solid_move(m, web, at, where, 0));
        }
        if (i == 0 || brio_solid_chance(m, 0.7)) {
            uint32_t holes = brio_solid_axis(m, brio_solid_bolt_grid(m, 0.4 * z, 0.7 * y, side * 0.5 * t), 0);
            uint32_t keep = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SHARP, 0);
            brio_solid_join(m, keep, brio_solid_move(m, holes, at, 0, 1.2 * z));
            brio_solid_join(m, keep, brio_solid_move(m, brio_solid_box(m, 2 * t, 1, 1), at, 0, 0));
            brio_solid_join(m, part.root, keep);
        }
    }
    brio_solid_join(m, part.root, brio_solid_bolt_grid(m, 0.45 * x, 0.7 * y, 0.5 * t));
    return part.root;
}

/* --- housings --- */

static void boss(brio_solid_maker *m, const brio_solid_part *part, uint32_t holes, const double *at, double top) {
    double r = 0.5 * brio_solid_size(m), hole = brio_solid_hole(m, r);
    r = fmax(r, hole + 1.6 * m->spacing);
    brio_solid_join(m, part->body, brio_solid_move(m, brio_solid_cylinder(m, r, 0.5 * top), at[0], at[1], 0.5 * top));
    brio_solid_join(m, holes, brio_solid_move(m, brio_solid_cylinder(m, hole, 0.5), at[0], at[1], at[2] + 0.5));
}

/* Returns an open box with ribs, bosses and ports. */
uint32_t brio_solid_housing(brio_solid_maker *m) {
    double x = brio_solid_uniform(m, 0.2, 0.4), y = brio_solid_uniform(m, 0.15, 0.35),
           z = brio_solid_uniform(m, 0.06, 0.25);
    double t = wall(m, 0.3 * fmin(x, fmin(y, z))), rib = wall(m, 0.06), floor = wall(m, 0.5 * z);
    uint32_t root = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SHARP, 0);
    brio_solid_part inside = brio_solid_part_new(m);
    uint32_t tray = brio_solid_edged(m, BRIO_CSG_CUT);
    int ribs = brio_solid_pick(m, 0, 3), bosses = brio_solid_pick(m, 0, 4), ports = brio_solid_pick(m, 0, 3);
    double lower = brio_solid_uniform(m, 0.3, 1);
    brio_solid_join(m, tray, brio_solid_move(m, brio_solid_rough_box(m, x, y, z), 0, 0, z));
    brio_solid_join(m, tray, brio_solid_move(m, brio_solid_rough_box(m, x - t, y - t, z), 0, 0, z + floor));
    brio_solid_join(m, inside.body, tray);
    for (int i = 0; i < ribs; i++) {
        double at = (2.0 * (i + 1) / (ribs + 1) - 1) * x, half = lower * (z - 0.5 * floor);
        uint32_t web = brio_solid_box(m, 0.5 * rib, y - 0.5 * t, half);
        brio_solid_join(m, inside.body, brio_solid_move(m, web, at, 0, half + 0.5 * floor));
    }
    brio_solid_join(m, root, inside.root);
    for (int i = 0; i < bosses; i++) {
        double away = brio_solid_uniform(m, 0.3, 0.75);
        const double at[3] = {(i % 2 ? 1 : -1) * away * x, (i / 2 ? 1 : -1) * away * y, floor * (i % 3 - 1)};
        boss(m, &inside, root, at, brio_solid_uniform(m, 0.6, 1.9) * z);
    }
    for (int i = 0; i < ports; i++) {
        double r = brio_solid_hole(m, 0.4 * (2 * z - floor));
        double away = brio_solid_uniform(m, -0.6, 0.6), height = 0.5 * (floor + 2 * z);
        uint32_t port = brio_solid_axis(m, brio_solid_cylinder(m, r, 0.5), i % 2);
        double s = i / 2 ? -0.5 : 0.5;
        brio_solid_join(m, root,
                        i % 2 ? brio_solid_move(m, port, away * x, s, height)
                              : brio_solid_move(m, port, s, away * y, height));
    }
    return root;
}

/* --- blocks --- */

static void pocket(brio_solid_maker *m, const brio_solid_part *part, const double *half) {
    int axis = brio_solid_pick(m, 0, 2);
    double a = brio_solid_size(m), b = brio_solid_uniform(m, 0.2, 0.6), deep = brio_solid_uniform(m, 0.3, 0.9);
    double u = brio_solid_uniform(m, -0.5, 0.5), v = brio_solid_uniform(m, -0.5, 0.5);
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    uint32_t tool = brio_solid_rough_box(m, fmax(0.6 * a, m->spacing), b * half[j], deep * half[axis]);
    double at[3];
    at[axis] = brio_solid_chance(m, 0.5) ? half[axis] : -half[axis];
    at[i] = u * half[i];
    at[j] = v * half[j];
    brio_solid_join(m, part->root, brio_solid_move(m, brio_solid_axis(m, tool, axis), at[0], at[1], at[2]));
}

static void bore(brio_solid_maker *m, const brio_solid_part *part, const double *half) {
    int axis = brio_solid_pick(m, 0, 2);
    double r = brio_solid_hole(m, 0.4 * fmin(half[0], fmin(half[1], half[2])));
    double u = brio_solid_uniform(m, -0.6, 0.6), v = brio_solid_uniform(m, -0.6, 0.6);
    double shift = brio_solid_chance(m, 0.4) ? brio_solid_uniform(m, 0.2, 1) : 0;
    uint32_t hole = brio_solid_move(m, brio_solid_cylinder(m, r, 1), 0, 0, shift > 0 ? 1 - shift * half[axis] : 0);
    double at[3];
    at[axis] = 0;
    at[(axis + 1) % 3] = u * half[(axis + 1) % 3];
    at[(axis + 2) % 3] = v * half[(axis + 2) % 3];
    brio_solid_join(m, part->root, brio_solid_move(m, brio_solid_axis(m, hole, axis), at[0], at[1], at[2]));
}

/* Returns a block with steps, pockets, slots and crossing bores. */
uint32_t brio_solid_block(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double half[3];
    int steps = brio_solid_pick(m, 0, 2), pockets = brio_solid_pick(m, 0, 4), bores = brio_solid_pick(m, 0, 6);
    for (int k = 0; k < 3; k++) half[k] = brio_solid_uniform(m, 0.12, 0.35);
    brio_solid_join(m, part.body, brio_solid_rough_box(m, half[0], half[1], half[2]));
    for (int i = 0; i < steps; i++) {
        double a = brio_solid_uniform(m, 0.3, 0.9), b = brio_solid_uniform(m, 0.3, 0.9),
               h = brio_solid_uniform(m, 0.03, 0.12);
        uint32_t step = brio_solid_chance(m, 0.4) ? brio_solid_cylinder(m, a * fmin(half[0], half[1]), half[2] + h)
                                                  : brio_solid_box(m, a * half[0], b * half[1], half[2] + h);
        double u = brio_solid_uniform(m, -0.1, 0.1), v = brio_solid_uniform(m, -0.1, 0.1);
        brio_solid_join(m, part.body, brio_solid_move(m, step, u * half[0], v * half[1], h));
    }
    for (int i = 0; i < pockets; i++) pocket(m, &part, half);
    for (int i = 0; i < bores; i++) bore(m, &part, half);
    if (brio_solid_chance(m, 0.3)) brio_solid_join(m, part.root, brio_solid_bolt_grid(m, half[0], half[1], half[2]));
    return part.root;
}

/* --- levers --- */

/* Eyes joined by arms, in one plane: levers, links, connecting rods. */
uint32_t brio_solid_lever(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double thick = brio_solid_uniform(m, 0.02, 0.08), web = fmin(0.5 * brio_solid_size(m), thick), old[2] = {0, 0};
    double recess = brio_solid_chance(m, 0.5) ? web : 0, turn = brio_solid_uniform(m, 0, 6);
    int eyes = brio_solid_pick(m, 2, 4);
    for (int i = 0; i < eyes; i++) {
        double away = i ? brio_solid_uniform(m, 0.25, 0.5) : 0, eye = brio_solid_uniform(m, 0.05, 0.13);
        double at[2] = {old[0] * 0.3 + away * cos(turn), old[1] * 0.3 + away * sin(turn)};
        double tall = thick * brio_solid_uniform(m, 1, 2), hole = brio_solid_hole(m, 0.7 * eye),
               arm = brio_solid_uniform(m, 0.4, 0.9);
        if (i) {
            double d[2] = {at[0] - old[0], at[1] - old[1]}, length = sqrt(d[0] * d[0] + d[1] * d[1]);
            uint32_t bar = brio_solid_box(m, 0.5 * length, arm * 0.06 + m->spacing, thick - recess * 0.5);
            bar = brio_solid_spin(m, bar, atan2(d[1], d[0]));
            brio_solid_join(m, part.body, brio_solid_move(m, bar, old[0] + 0.5 * d[0], old[1] + 0.5 * d[1], 0));
        }
        brio_solid_join(m, part.body, brio_solid_move(m, brio_solid_cylinder(m, eye, tall), at[0], at[1], 0));
        brio_solid_join(m, part.root, brio_solid_move(m, brio_solid_bolt(m, hole, tall), at[0], at[1], 0));
        old[0] = at[0];
        old[1] = at[1];
        turn += brio_solid_uniform(m, 0.7, 2.5);
    }
    return part.root;
}
