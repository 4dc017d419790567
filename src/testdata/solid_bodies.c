/* Organic solids that are bodies: creatures, busts, blobs. */
#include "testdata/solid_families.h"
#include <math.h>

/* Returns a smooth union that the parts of a body are joined to. */
static uint32_t body_new(brio_solid_maker *m) {
    double reach = brio_solid_spacings(m, 2, 8);
    return brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, reach);
}

static void limb(brio_solid_maker *m, uint32_t body, const double *a, const double *b, double r, double s) {
    brio_solid_join(m, body, brio_solid_capsule(m, a, b, r, s));
}

static void ball_at(brio_solid_maker *m, uint32_t body, double r, double x, double y, double z) {
    brio_solid_join(m, body, brio_solid_move(m, brio_solid_ball(m, r), x, y, z));
}

/* Makes a curl that starts at p in direction d, bends evenly and tapers from r to s. */
static void curl(brio_solid_maker *m, uint32_t body, const double *p, const double *d, double r, double s) {
    enum { POINTS = 19 };
    double points[POINTS][4], at[3] = {p[0], p[1], p[2]}, to[3] = {d[0], d[1], d[2]}, bend[3];
    double length = brio_solid_uniform(m, 0.1, 0.35), strength = brio_solid_uniform(m, 0, 0.25);
    brio_solid_direction(m, bend);
    for (int i = 0; i < POINTS; i++) {
        double t = (double)i / (POINTS - 1), norm = 0;
        for (int k = 0; k < 3; k++) points[i][k] = at[k];
        points[i][3] = r + (s - r) * t;
        for (int k = 0; k < 3; k++) to[k] += strength * bend[k], norm += to[k] * to[k];
        for (int k = 0; k < 3; k++) to[k] /= sqrt(norm), at[k] += length / (POINTS - 1) * to[k];
    }
    brio_solid_join(m, body, brio_solid_tube(m, (const double(*)[4])points, POINTS, false));
}

/* --- creatures --- */

/* Makes a flat ellipsoid that stands out from p along d: an ear, a fin or a wing. */
static void fin(brio_solid_maker *m, uint32_t body, const double *p, const double *d) {
    double thick = 0.5 * brio_solid_size(m), long_half = brio_solid_uniform(m, 0.05, 0.16);
    double wide = brio_solid_uniform(m, 0.03, 0.09);
    double centre[3] = {p[0] + 0.7 * long_half * d[0], p[1] + 0.7 * long_half * d[1], p[2] + 0.7 * long_half * d[2]};
    uint32_t flat = brio_solid_ellipsoid(m, fmax(wide, thick), fmin(thick, long_half), long_half);
    brio_solid_join(m, body, brio_solid_aim(m, flat, d, centre));
}

static void legs(brio_solid_maker *m, uint32_t side, double length, double height) {
    int pairs = brio_solid_pick(m, 1, 3);
    double thick = fmax(0.5 * brio_solid_size(m), 0.012), splay = brio_solid_uniform(m, 0.02, 0.14);
    double bend = brio_solid_uniform(m, -0.06, 0.06), foot = brio_solid_uniform(m, 0, 0.06);
    for (int i = 0; i < pairs; i++) {
        double y = pairs == 1 ? 0 : length * (1.6 * i / (pairs - 1) - 0.8);
        double hip[3] = {0.05, y, -0.3 * height}, knee[3] = {0.05 + splay, y + bend, -height - 0.06};
        double ankle[3] = {0.05 + splay, y, -height - 0.18}, toe[3] = {0.06 + splay, y + foot, -height - 0.18};
        limb(m, side, hip, knee, 1.6 * thick, thick);
        limb(m, side, knee, ankle, thick, 0.85 * thick);
        limb(m, side, ankle, toe, 0.9 * thick, thick);
    }
}

static void head(brio_solid_maker *m, uint32_t body, uint32_t side, double length, double height) {
    double up = brio_solid_uniform(m, 0, 0.2), r = brio_solid_uniform(m, 0.05, 0.09);
    double neck = brio_solid_uniform(m, 0.02, 0.06), snout = brio_solid_uniform(m, 0.02, 0.12);
    double from[3] = {0, 0.7 * length, 0.3 * height}, to[3] = {0, length + 0.1, 0.5 * height + up};
    double tip[3] = {0, to[1] + r + snout, to[2] - 0.02}, ear[3] = {0.7 * r, to[1], to[2] + 0.5 * r}, d[3];
    limb(m, body, from, to, 1.3 * neck, neck);
    limb(m, body, to, tip, r, brio_solid_uniform(m, 0.4, 0.8) * r);
    brio_solid_direction(m, d);
    d[0] = fabs(d[0]);
    d[2] = fabs(d[2]);
    if (brio_solid_chance(m, 0.6))
        fin(m, side, ear, d);
    else
        curl(m, side, ear, d, 0.6 * brio_solid_size(m) + 0.01, 0.9 * m->spacing);
}

uint32_t brio_solid_creature(brio_solid_maker *m) {
    uint32_t body = body_new(m), side = body_new(m);
    double length = brio_solid_uniform(m, 0.14, 0.26), height = brio_solid_uniform(m, 0.06, 0.13);
    double width = brio_solid_uniform(m, 0.06, 0.12);
    const double rump[3] = {0, -0.8 * length, 0.02}, back[3] = {0, -0.8, 0.6};
    brio_solid_join(m, body, brio_solid_ellipsoid(m, width, length, height));
    double belly = brio_solid_uniform(m, 0.8, 1.2) * width, at = brio_solid_uniform(m, -0.5, 0.5) * length;
    ball_at(m, body, belly, 0, at, -0.2 * height);
    legs(m, side, length, height);
    head(m, body, side, length, height);
    double tail = 0.5 * brio_solid_size(m) + 0.008;
    curl(m, body, rump, back, fmax(tail, 0.02), fmax(0.6 * tail, m->spacing));
    if (brio_solid_chance(m, 0.4)) {
        const double shoulder[3] = {0.5 * width, 0, 0.7 * height}, out[3] = {0.8, 0, 0.6};
        fin(m, side, shoulder, out);
    }
    brio_solid_join(m, body, brio_solid_over(m, BRIO_CSG_MIRROR, side, 0));
    return body;
}

/* --- busts --- */

static void face(brio_solid_maker *m, uint32_t cut, uint32_t side_cut, double r) {
    double eye = brio_solid_uniform(m, 0.12, 0.25) * r, mouth = brio_solid_size(m);
    double depth = brio_solid_uniform(m, 0.85, 1.05) * r, apart = brio_solid_uniform(m, 0.3, 0.5) * r;
    double from[3] = {-0.35 * r, 0.95 * r, 0.12 - 0.45 * r}, to[3] = {0.35 * r, 0.95 * r, 0.12 - 0.4 * r};
    ball_at(m, side_cut, eye, apart, depth, 0.12 + 0.15 * r);
    limb(m, cut, from, to, fmin(0.5 * mouth, 0.2 * r), fmin(0.5 * mouth, 0.2 * r));
}

uint32_t brio_solid_bust(brio_solid_maker *m) {
    double reach = brio_solid_spacings(m, 1.5, 5), r = brio_solid_uniform(m, 0.14, 0.2);
    uint32_t body = body_new(m), side = body_new(m), side_cut = body_new(m);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, reach);
    double neck = brio_solid_uniform(m, 0.06, 0.1), tall = brio_solid_uniform(m, 1, 1.3),
           nose = 0.5 * brio_solid_size(m);
    const double chin[3] = {0, 0, 0.05}, chest[3] = {0, 0, -0.3}, shoulder[3] = {0.2, 0, -0.27};
    const double bridge[3] = {0, 0.85 * r, 0.14}, tip[3] = {0, 1.2 * r, 0.1}, ear[3] = {0.9 * r, 0, 0.12};
    const double out[3] = {0.8, -0.6, 0};
    brio_solid_join(m, body, brio_solid_move(m, brio_solid_ellipsoid(m, 0.85 * r, r, tall * r), 0, 0, 0.12));
    limb(m, body, chin, chest, neck, 1.2 * neck);
    limb(m, side, chest, shoulder, 0.1, brio_solid_uniform(m, 0.07, 0.1));
    limb(m, body, bridge, tip, fmax(nose, 0.012), fmax(nose, 0.015));
    if (brio_solid_chance(m, 0.7)) fin(m, side, ear, out);
    brio_solid_join(m, body, brio_solid_over(m, BRIO_CSG_MIRROR, side, 0));
    if (brio_solid_chance(m, 0.5)) { /* a base */
        double base = brio_solid_uniform(m, 0.12, 0.2), half = 0.5 * brio_solid_size(m);
        brio_solid_join(m, body, brio_solid_move(m, brio_solid_cylinder(m, base, half), 0, 0, -0.38));
    }
    brio_solid_join(m, cut, body);
    face(m, cut, side_cut, r);
    brio_solid_join(m, cut, brio_solid_over(m, BRIO_CSG_MIRROR, side_cut, 0));
    if (brio_solid_chance(m, 0.7)) {
        const double down[3] = {0, 0, -1};
        double level = brio_solid_uniform(m, 0.28, 0.36);
        return brio_solid_trim(m, cut, down, level, 0);
    }
    return cut;
}

/* --- blobs --- */

static uint32_t blob(brio_solid_maker *m) {
    double r = brio_solid_uniform(m, 0.06, 0.2), x = brio_solid_uniform(m, 0.4, 1.2);
    double y = brio_solid_uniform(m, 0.4, 1.2);
    switch (brio_solid_pick(m, 0, 3)) {
    case 0:
        return brio_solid_ball(m, r);
    case 1:
        return brio_solid_ellipsoid(m, r, x * r, y * r);
    case 2:
        return brio_solid_torus(m, 0.8 * r, fmax(0.25 * x * r, 0.01));
    default:
        return brio_solid_capsule(m, (const double[3]){-r, 0, 0}, (const double[3]){r, 0, 0}, 0.5 * x * r, 0.5 * y * r);
    }
}

static void scatter(brio_solid_maker *m, uint32_t node, uint32_t child, double radius) {
    double d[3], r = radius * cbrt(brio_rng_double(&m->rng));
    brio_solid_direction(m, d);
    brio_solid_join(m, node, brio_solid_move(m, brio_solid_tumble(m, child), r * d[0], r * d[1], r * d[2]));
}

uint32_t brio_solid_blobs(brio_solid_maker *m) {
    uint32_t body = body_new(m);
    double reach = brio_solid_spacings(m, 1, 6);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, reach);
    int count = brio_solid_pick(m, 3, 12), hollows = brio_solid_pick(m, 0, 4), drills = brio_solid_pick(m, 0, 3);
    for (int i = 0; i < count; i++) scatter(m, body, blob(m), 0.3);
    brio_solid_join(m, cut, body);
    for (int i = 0; i < hollows; i++) {
        double r = brio_solid_uniform(m, 0.04, 0.15);
        scatter(m, cut, brio_solid_ball(m, r), 0.4);
    }
    for (int i = 0; i < drills; i++) { /* holes through, or wells */
        double r = 0.5 * brio_solid_size(m);
        uint32_t drill = brio_solid_cylinder(m, r, 2);
        scatter(m, cut, brio_solid_chance(m, 0.5) ? drill : brio_solid_move(m, drill, 0, 0, 2), 0.15);
    }
    return cut;
}

/* --- hands: fingers side by side on a palm --- */

uint32_t brio_solid_hand(brio_solid_maker *m) {
    uint32_t body = body_new(m);
    int fingers = brio_solid_pick(m, 3, 6);
    double r = brio_solid_uniform(m, 0.02, 0.05), gap = fmin(brio_solid_size(m), 1.5 * r), pitch = 2 * r + gap;
    double wide = 0.5 * pitch * (fingers - 1), curve = brio_solid_uniform(m, 0, 0.25),
           thick = brio_solid_uniform(m, 1, 1.5) * r;
    brio_solid_join(m, body, brio_solid_ellipsoid(m, wide + r, thick, brio_solid_uniform(m, 0.12, 0.2)));
    for (int i = 0; i < fingers; i++) {
        double x = pitch * i - wide, length = brio_solid_uniform(m, 0.12, 0.3),
               bend = brio_solid_uniform(m, -0.03, 0.03);
        double from[3] = {x, 0, 0.05}, knuckle[3] = {x + 0.2 * bend, 0, 0.14 + 0.4 * length};
        double tip[3] = {x + bend, curve * length * 2, 0.14 + length};
        limb(m, body, from, knuckle, r, r);
        limb(m, body, knuckle, tip, r, 0.8 * r);
    }
    if (brio_solid_chance(m, 0.7)) { /* a thumb */
        const double base[3] = {wide, 0, -0.05}, end[3] = {wide + 0.12, 0.5 * curve, 0.08};
        limb(m, body, base, end, 1.2 * r, r);
    }
    const double top[3] = {0, 0, -0.05}, wrist[3] = {0, 0, -0.4};
    limb(m, body, top, wrist, 0.8 * thick + 0.3 * wide, thick + 0.2 * wide);
    return body;
}

/* --- flowers: thin petals round a cup --- */

uint32_t brio_solid_flower(brio_solid_maker *m) {
    uint32_t body = body_new(m);
    int petals = brio_solid_pick(m, 3, 9), rows = brio_solid_pick(m, 1, 2);
    double thick = fmax(0.5 * brio_solid_size(m), 0.8 * m->spacing), stalk = fmax(0.5 * brio_solid_size(m), 0.012);
    double core = brio_solid_uniform(m, 0.05, 0.1);
    brio_solid_join(m, body, brio_solid_ellipsoid(m, core, core, 0.7 * core));
    for (int row = 0; row < rows; row++) {
        double length = brio_solid_uniform(m, 0.1, 0.2), wide = brio_solid_uniform(m, 0.5, 1.2) * 3 * length / petals;
        double lean = brio_solid_uniform(m, -0.6, 0.9), reach = 0.8 * core + length;
        uint32_t petal = brio_solid_ellipsoid(m, length, fmax(wide, 1.2 * thick), fmin(thick, 0.5 * length));
        petal = brio_solid_axis(m, brio_solid_spin(m, brio_solid_axis(m, petal, 0), lean), 1); /* round the y axis */
        petal = brio_solid_move(m, petal, reach * cos(lean), 0, reach * sin(lean));
        brio_solid_join(m, body, brio_solid_over(m, BRIO_CSG_RING, petal, petals));
    }
    if (brio_solid_chance(m, 0.8)) {
        const double top[3] = {0, 0, 0}, foot[3] = {0, 0, -0.4};
        limb(m, body, top, foot, stalk, brio_solid_uniform(m, 1, 1.5) * stalk);
        brio_solid_join(m, body, brio_solid_move(m, brio_solid_ellipsoid(m, 0.1, 0.1, 0.04), 0, 0, -0.4));
    }
    return body;
}
