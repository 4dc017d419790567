/* Organic solids with walls: vases, sponges, perforated shells, masks. */
#include "testdata/solid_families.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;

/* --- vases --- */

/* The parameters of BRIO_CSG_VESSEL, and the wall. */
typedef struct {
    double v[11], height, wall;
} vessel;

/* Draws a vessel that stands on z = -height / 2; its radius is at least 0.04. */
static vessel vessel_draw(brio_solid_maker *m) {
    vessel a = {.height = brio_solid_uniform(m, 0.3, 0.75)};
    a.wall = brio_solid_size(m);
    a.v[2] = brio_solid_uniform(m, 0.13, 0.27);
    for (int w = 0; w < 3; w++) {
        a.v[3 + w] = brio_solid_uniform(m, 0, 0.35) / (w + 1);
        a.v[6 + w] = brio_solid_uniform(m, 0, FULL_TURN);
    }
    a.v[9] = -0.5 * a.height;
    a.v[10] = a.height;
    return a;
}

static uint32_t vessel_between(brio_solid_maker *m, vessel a, double low, double high) {
    a.v[0] = low;
    a.v[1] = high;
    return brio_csg_add(m->tree, BRIO_CSG_VESSEL, a.v, 11);
}

static double radius_at(const vessel *a, double z) {
    double radius = 1;
    for (int w = 0; w < 3; w++)
        radius += a->v[3 + w] * sin(0.5 * FULL_TURN * (w + 1) * (z - a->v[9]) / a->v[10] + a->v[6 + w]);
    return a->v[2] * radius;
}

static uint32_t handle(brio_solid_maker *m, const vessel *v, double r) {
    enum { POINTS = 22 };
    double points[POINTS][4], low = brio_solid_uniform(m, -0.35, -0.05) * v->height;
    double high = brio_solid_uniform(m, 0.1, 0.4) * v->height, out = brio_solid_uniform(m, 0.08, 0.2);
    double bulge = fmax(radius_at(v, low), radius_at(v, high));
    for (int i = 0; i < POINTS; i++) {
        double t = (double)i / (POINTS - 1), s = sin(0.5 * FULL_TURN * t), base = radius_at(v, t < 0.5 ? low : high);
        points[i][0] = base + (bulge - base + out) * s - 0.5 * v->wall * (1 - s);
        points[i][1] = 0;
        points[i][2] = low + (high - low) * (0.5 - 0.5 * cos(0.5 * FULL_TURN * t));
        points[i][3] = r;
    }
    return brio_solid_tube(m, (const double(*)[4])points, POINTS, false);
}

uint32_t brio_solid_vase(brio_solid_maker *m) {
    vessel v = vessel_draw(m);
    double reach = brio_solid_spacings(m, 1, 4), lip = brio_solid_spacings(m, 0.5, 1.5), top = 0.5 * v.height;
    double r = fmax(0.5 * brio_solid_size(m), 0.8 * m->spacing), turn = brio_solid_uniform(m, 0.2, 1);
    int handles = brio_solid_pick(m, 0, 3);
    uint32_t outside = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, reach);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, lip);
    brio_solid_join(m, outside, vessel_between(m, v, -top, top));
    for (int i = 0; i < handles; i++)
        brio_solid_join(m, outside, brio_solid_spin(m, handle(m, &v, r), turn * FULL_TURN * i / fmax(handles, 1)));
    brio_solid_join(m, cut, outside);
    brio_solid_join(m, cut, brio_solid_over(m, BRIO_CSG_GROW, vessel_between(m, v, -top, top + 0.4), -v.wall));
    if (brio_solid_chance(m, 0.3)) { /* windows */
        double size = brio_solid_size(m), height = brio_solid_uniform(m, -0.2, 0.3) * v.height;
        int windows = brio_solid_pick(m, 3, 8);
        uint32_t window = brio_solid_axis(m, brio_solid_cylinder(m, fmax(size, 2 * m->spacing), 0.3), 0);
        brio_solid_join(m, cut, brio_solid_over(m, BRIO_CSG_RING, brio_solid_move(m, window, 0.3, 0, height), windows));
    }
    return cut;
}

/* --- sponges --- */

/* Makes one side of a periodic sheet, or the sheet with a thickness, within a round body. */
uint32_t brio_solid_sponge(brio_solid_maker *m) {
    double frequency = brio_solid_uniform(m, 7, 22), half = 0.5 * brio_solid_size(m), x = brio_solid_uniform(m, 0.6, 1);
    double y = brio_solid_uniform(m, 0.6, 1), reach = brio_solid_spacings(m, 0.5, 3);
    uint32_t gyroid = brio_csg_add(m->tree, BRIO_CSG_GYROID, &frequency, 1);
    uint32_t common = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SMOOTH, reach);
    uint32_t body = brio_solid_chance(m, 0.6) ? brio_solid_ellipsoid(m, 0.4, 0.4 * x, 0.4 * y)
                                              : brio_solid_box(m, 0.3, 0.3 * x, 0.3 * y);
    bool sheet = brio_solid_chance(m, 0.5);
    half = fmin(fmax(half, 0.9 * m->spacing), 0.6 / frequency);
    brio_solid_join(m, common, brio_solid_tumble(m, sheet ? brio_solid_over(m, BRIO_CSG_SHEET, gyroid, half) : gyroid));
    brio_solid_join(m, common, body);
    return common;
}

/* --- perforated shells --- */

static uint32_t round_body(brio_solid_maker *m) {
    double reach = brio_solid_spacings(m, 4, 12), x = brio_solid_uniform(m, 0.6, 1), y = brio_solid_uniform(m, 0.6, 1);
    uint32_t body = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, reach);
    int knobs = brio_solid_pick(m, 0, 3);
    brio_solid_join(m, body, brio_solid_ellipsoid(m, 0.36, 0.36 * x, 0.36 * y));
    for (int i = 0; i < knobs; i++) {
        double d[3], r = brio_solid_uniform(m, 0.1, 0.2);
        brio_solid_direction(m, d);
        brio_solid_join(m, body, brio_solid_move(m, brio_solid_ball(m, r), 0.25 * d[0], 0.25 * d[1], 0.25 * d[2]));
    }
    return body;
}

uint32_t brio_solid_perforated(brio_solid_maker *m) {
    double wall = brio_solid_size(m), reach = brio_solid_spacings(m, 0.5, 2), size = brio_solid_uniform(m, 0.04, 0.12);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, reach);
    int holes = brio_solid_pick(m, 1, 14);
    brio_solid_join(m, cut, brio_solid_over(m, BRIO_CSG_SHELL, round_body(m), wall));
    for (int i = 0; i < holes; i++) {
        double golden = 2.39996322972865332 * i, z = 1 - (2 * i + 1.0) / holes, r = sqrt(1 - z * z), d[3], shake[3];
        double radius = size * brio_solid_uniform(m, 0.6, 1.2);
        brio_solid_direction(m, shake);
        const double at[3] = {0, 0, 0};
        double norm = 0;
        d[0] = r * cos(golden) + 0.2 * shake[0];
        d[1] = r * sin(golden) + 0.2 * shake[1];
        d[2] = z + 0.2 * shake[2];
        for (int k = 0; k < 3; k++) norm += d[k] * d[k];
        for (int k = 0; k < 3; k++) d[k] /= sqrt(norm);
        uint32_t hole = brio_solid_move(m, brio_solid_cylinder(m, radius, 0.5), 0, 0, 0.55);
        brio_solid_join(m, cut, brio_solid_aim(m, hole, d, at));
    }
    return cut;
}

/* --- masks --- */

/* Returns an open sheet: a shell of which a plane leaves a part. */
uint32_t brio_solid_mask(brio_solid_maker *m) {
    double wall = brio_solid_size(m), level = brio_solid_uniform(m, -0.05, 0.2),
           reach = brio_solid_spacings(m, 0.5, 1.5);
    double d[3], rim = brio_solid_spacings(m, 0.3, 1);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, rim);
    int eyes = brio_solid_pick(m, 0, 5);
    brio_solid_direction(m, d);
    brio_solid_join(m, cut,
                    brio_solid_trim(m, brio_solid_over(m, BRIO_CSG_SHELL, round_body(m), wall), d, level, reach));
    for (int i = 0; i < eyes; i++) {
        double e[3], r = brio_solid_uniform(m, 0.03, 0.09), norm = 0;
        const double at[3] = {0, 0, 0};
        brio_solid_direction(m, e);
        for (int k = 0; k < 3; k++) e[k] -= 0.9 * d[k], norm += e[k] * e[k];
        for (int k = 0; k < 3; k++) e[k] /= sqrt(norm);
        uint32_t hole = brio_solid_move(m, brio_solid_cylinder(m, r, 0.5), 0, 0, 0.55);
        brio_solid_join(m, cut, brio_solid_aim(m, hole, e, at));
    }
    return cut;
}

/* --- ribbons --- */

/* Returns a sheet that stands upright on a plane curve: a scroll, or a meander whose turns nearly touch. */
uint32_t brio_solid_ribbon(brio_solid_maker *m) {
    enum { POINTS = 121 };
    double points[POINTS][4], wall = 0.5 * brio_solid_size(m), gap = brio_solid_size(m),
                              half = brio_solid_uniform(m, 0.08, 0.3);
    bool scroll = brio_solid_chance(m, 0.5);
    double step = fmax(gap, 1.8 * m->spacing) + 2 * wall, turns = fmin(0.35 / step, brio_solid_uniform(m, 0.8, 4));
    double swing = brio_solid_uniform(m, 0.1, 0.3), waves = fmin(0.35 / step, brio_solid_uniform(m, 1, 5));
    for (int i = 0; i < POINTS; i++) {
        double t = (double)i / (POINTS - 1), angle = FULL_TURN * turns * sqrt(t),
               r = 0.4 - step * turns * (1 - sqrt(t));
        points[i][0] = scroll ? r * cos(angle) : 2 * step * waves * (t - 0.5);
        points[i][1] = scroll ? r * sin(angle) : swing * sin(FULL_TURN * waves * t);
        points[i][2] = 0;
        points[i][3] = wall;
    }
    uint32_t tube = brio_solid_tube(m, (const double(*)[4])points, POINTS, false);
    return brio_solid_over(m, BRIO_CSG_FLAT, tube, half);
}
