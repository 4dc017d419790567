/* Machined solids from profiles and bars: extrusions, frames, heat sinks, impellers. */
#include "testdata/solid_edges.h"
#include "testdata/solid_families.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;

/* --- extruded profiles --- */

/* Returns a polygon round the origin with `corners` corners, between 0.1 and 0.3 away. */
static uint32_t random_polygon(brio_solid_maker *m, double half) {
    uint32_t prism = brio_csg_add(m->tree, BRIO_CSG_PRISM, &half, 1);
    int corners = brio_solid_pick(m, 3, 9);
    bool even = brio_solid_chance(m, 0.5);
    double radius = brio_solid_uniform(m, 0.15, 0.3);
    for (int i = 0; i < corners; i++) {
        double r = even ? radius : brio_solid_uniform(m, 0.14, 0.3);
        double turn = FULL_TURN * (i + (even ? 0 : brio_solid_uniform(m, -0.25, 0.25))) / corners;
        brio_csg_point(m->tree, prism, r * cos(turn), r * sin(turn), 0, 0);
    }
    return prism;
}

/* Returns an I, T, U or Z section. */
static uint32_t beam(brio_solid_maker *m, double half) {
    uint32_t section = brio_solid_edged(m, BRIO_CSG_UNION);
    double x = brio_solid_uniform(m, 0.1, 0.25), y = brio_solid_uniform(m, 0.1, 0.25),
           t = 0.5 * fmin(brio_solid_size(m), 0.12);
    double u = brio_solid_uniform(m, -1, 1) * (x - t), v = brio_solid_uniform(m, -1, 1) * (x - t);
    brio_solid_join(m, section, brio_solid_box(m, t, y, half));
    brio_solid_join(m, section, brio_solid_move(m, brio_solid_box(m, x, t, half), u, y - t, 0));
    if (brio_solid_chance(m, 0.8))
        brio_solid_join(m, section, brio_solid_move(m, brio_solid_box(m, x, t, half), v, t - y, 0));
    return section;
}

uint32_t brio_solid_profile(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double half = brio_solid_uniform(m, 0.05, 0.45), twist[2] = {brio_solid_uniform(m, -1.5, 1.5), 1.2};
    int slots = brio_solid_pick(m, 0, 6), holes = brio_solid_pick(m, 0, 3);
    bool section = brio_solid_chance(m, 0.4);
    uint32_t body = section ? beam(m, half) : random_polygon(m, half);
    if (!section && brio_solid_chance(m, 0.2)) body = brio_csg_over(m->tree, BRIO_CSG_TWIST, body, twist, 2);
    brio_solid_join(m, part.body, body);
    if (!section && slots > 1) {
        double wide = 0.5 * brio_solid_size(m), deep = brio_solid_uniform(m, 0.14, 0.2);
        uint32_t slot = brio_solid_box(m, 0.2, fmin(wide, 0.25 * deep * FULL_TURN / slots), 1);
        brio_solid_join(m, part.root,
                        brio_solid_over(m, BRIO_CSG_RING, brio_solid_move(m, slot, 0.2 + deep, 0, 0), slots));
    }
    if (!section && brio_solid_chance(m, 0.6)) {
        double r = brio_solid_hole(m, 0.09);
        brio_solid_join(m, part.root, brio_solid_bolt(m, r, half));
    }
    for (int i = 0; i < holes; i++) {
        double r = brio_solid_hole(m, 0.35 * half), z = half * (2.0 * (i + 1) / (holes + 1) - 1);
        uint32_t hole = brio_solid_axis(m, brio_solid_cylinder(m, r, 1), brio_solid_pick(m, 0, 1));
        brio_solid_join(m, part.root, brio_solid_move(m, hole, 0, 0, z));
    }
    return part.root;
}

/* --- frames --- */

/* Bars between the nodes of a small grid. */
uint32_t brio_solid_frame(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    int n[3] = {0, 0, 0}, bars = 0;
    double pitch[3], half = 0.5 * brio_solid_size(m);
    bool round_bars = brio_solid_chance(m, 0.4);
    for (int k = 0; k < 3; k++) {
        n[k] = brio_solid_pick(m, 1, 2);
        pitch[k] = brio_solid_uniform(m, 0.35, 0.65) / n[k];
        half = fmin(half, 0.2 * pitch[k]);
    }
    double dropped = brio_solid_uniform(m, 0, 0.25);
    for (int i = 0; i < 81; i++) {
        int axis = i % 3, at[3] = {i / 3 % 3, i / 9 % 3, i / 27};
        if (at[0] > n[0] || at[1] > n[1] || at[2] > n[2] || at[axis] == n[axis]) continue;
        if (bars++ && brio_solid_chance(m, dropped)) continue;
        double c[3], r = fmax(half, 0.8 * m->spacing), longest = 0.5 * pitch[axis] + r;
        for (int k = 0; k < 3; k++) c[k] = (at[k] + (k == axis ? 0.5 : 0) - 0.5 * n[k]) * pitch[k];
        uint32_t bar = round_bars ? brio_solid_cylinder(m, r, longest) : brio_solid_box(m, r, r, longest);
        brio_solid_join(m, part.body, brio_solid_move(m, brio_solid_axis(m, bar, axis), c[0], c[1], c[2]));
    }
    if (brio_solid_chance(m, 0.4)) { /* a plate on one side, flush with the bars */
        double r = fmax(half, 0.8 * m->spacing);
        uint32_t plate = brio_solid_box(m, 0.5 * n[0] * pitch[0] + r, 0.5 * n[1] * pitch[1] + r, r);
        brio_solid_join(m, part.body, brio_solid_move(m, plate, 0, 0, 0.5 * n[2] * pitch[2]));
    }
    return part.root;
}

/* --- heat sinks --- */

/* Returns a plate with fins or pins in rows, or a plate with rows of holes. */
uint32_t brio_solid_sink(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double x = brio_solid_uniform(m, 0.2, 0.4), y = brio_solid_uniform(m, 0.15, 0.4), base = 0.5 * brio_solid_size(m);
    double wide = fmax(0.5 * brio_solid_size(m), 0.8 * m->spacing), gap = fmax(brio_solid_size(m), 1.8 * m->spacing);
    double tall = brio_solid_uniform(m, 0.04, 0.25), step = 2 * wide + gap;
    double nx = fmin(floor((x - wide) / step), 9), ny = fmin(floor((y - wide) / step), 9);
    int type = brio_solid_pick(m, 0, 2);
    double v[4] = {nx, step, type ? ny : 0, step};
    brio_solid_join(m, part.body, brio_solid_rough_box(m, x, y, base));
    if (type < 2) {
        uint32_t pin = type ? brio_solid_cylinder(m, wide, 0.5 * tall) : brio_solid_box(m, wide, y, 0.5 * tall);
        pin = brio_solid_move(m, pin, 0, 0, 0.5 * tall);
        brio_solid_join(m, part.body, brio_csg_over(m->tree, BRIO_CSG_GRID, pin, v, 4));
    } else {
        uint32_t hole = brio_solid_chance(m, 0.5) ? brio_solid_box(m, 0.5 * gap, 0.5 * gap, 1)
                                                  : brio_solid_cylinder(m, 0.5 * gap, 1);
        brio_solid_join(m, part.root, brio_csg_over(m->tree, BRIO_CSG_GRID, hole, v, 4));
    }
    return part.root;
}

/* --- impellers --- */

/* Makes slanted or twisted blades round a hub, by chance on a disc and under a ring. */
uint32_t brio_solid_impeller(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double r = brio_solid_uniform(m, 0.25, 0.42), half = brio_solid_uniform(m, 0.05, 0.15),
           hub = brio_solid_uniform(m, 0.06, 0.12);
    double blade = fmax(0.5 * brio_solid_size(m), 0.8 * m->spacing), lean = brio_solid_uniform(m, -0.8, 0.8),
           disc = brio_solid_size(m);
    double bore = brio_solid_hole(m, 0.6 * hub), twist[2] = {brio_solid_uniform(m, -2, 2), 1.3};
    int most = (int)fmin(FULL_TURN * hub / (2 * blade + 2 * m->spacing), 11),
        count = brio_solid_pick(m, 3, most < 3 ? 3 : most);
    bool disced = brio_solid_chance(m, 0.6), ringed = brio_solid_chance(m, 0.3), twisted = brio_solid_chance(m, 0.6);
    uint32_t wing = brio_solid_move(m, brio_solid_box(m, 0.5 * r, blade, half), 0.5 * r, 0, 0);
    if (!twisted) /* turned round the x axis */
        wing = brio_solid_axis(m, brio_solid_spin(m, brio_solid_axis(m, wing, 1), lean), 0);
    wing = brio_solid_over(m, BRIO_CSG_RING, wing, count);
    if (twisted) wing = brio_csg_over(m->tree, BRIO_CSG_TWIST, wing, twist, 2);
    uint32_t common = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SHARP, 0);
    brio_solid_join(m, common, wing);
    brio_solid_join(m, common, brio_solid_cylinder(m, r, half));
    brio_solid_join(m, part.body, common);
    brio_solid_join(m, part.body, brio_solid_cylinder(m, hub, half * 1.1));
    if (disced)
        brio_solid_join(m, part.body, brio_solid_move(m, brio_solid_cylinder(m, r * 1.03, 0.5 * disc), 0, 0, -half));
    if (ringed) {
        uint32_t hoop = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SHARP, 0);
        brio_solid_join(m, hoop, brio_solid_cylinder(m, r + disc, 0.7 * half));
        brio_solid_join(m, hoop, brio_solid_cylinder(m, r - m->spacing, 1));
        brio_solid_join(m, part.body, hoop);
    }
    brio_solid_join(m, part.root, brio_solid_cylinder(m, bore, 1));
    return part.root;
}

/* --- bent sheets --- */

/* Returns a strip of sheet metal along a polyline with round bends, with holes in it. */
uint32_t brio_solid_bent_sheet(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double points[8][4], turn = 0, x = -0.2, y = 0, half = brio_solid_uniform(m, 0.06, 0.25),
                         wall = 0.5 * fmin(brio_solid_size(m), 0.08);
    int legs = brio_solid_pick(m, 2, 7), holes = brio_solid_pick(m, 0, 4);
    for (int i = 0; i <= legs; i++) {
        double length = brio_solid_uniform(m, 0.1, 0.3);
        points[i][0] = x;
        points[i][1] = y;
        points[i][2] = 0;
        points[i][3] = wall;
        x += length * cos(turn);
        y += length * sin(turn);
        turn += (brio_solid_chance(m, 0.5) ? 1 : -1) *
                (brio_solid_chance(m, 0.7) ? 0.25 * FULL_TURN : brio_solid_uniform(m, 0.3, 1.8));
    }
    uint32_t strip = brio_solid_tube(m, (const double(*)[4])points, legs + 1, false);
    brio_solid_join(m, part.body, brio_solid_over(m, BRIO_CSG_FLAT, strip, half));
    for (int i = 0; i < holes; i++) {
        const double *a = points[i % legs], *b = points[i % legs + 1];
        double r = brio_solid_hole(m, 0.3 * half), z = brio_solid_uniform(m, -0.5, 0.5) * half;
        double length = hypot(b[0] - a[0], b[1] - a[1]), d[3] = {(a[1] - b[1]) / length, (b[0] - a[0]) / length, 0};
        const double at[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), z};
        brio_solid_join(m, part.root, brio_solid_aim(m, brio_solid_cylinder(m, r, 3 * wall), d, at));
    }
    return part.root;
}
