/* Organic solids made of tubes: corals, knots, tangles, snails, linked rings. */
#include "testdata/solid_families.h"
#include "base/vector.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;

/* Returns half the thickness of a tube: at least `least`, from thin to fat. */
static double tube_radius(brio_solid_maker *m, double least) {
    double half = 0.5 * brio_solid_size(m);
    return fmax(half, least);
}

/* --- corals --- */

typedef struct {
    double p[3], d[3], r;
} sprout;

/* Joins a bent branch that starts at `from`; moves `from` to its end. */
static void grow(brio_solid_maker *m, uint32_t body, sprout *from, double length, double taper) {
    enum { POINTS = 10 };
    double points[POINTS][4], bend[3], strength = brio_solid_uniform(m, 0, 0.3), r = from->r;
    brio_solid_direction(m, bend);
    for (int i = 0; i < POINTS; i++) {
        double norm = 0;
        for (int k = 0; k < 3; k++) points[i][k] = from->p[k];
        points[i][3] = r * (1 - (1 - taper) * i / (POINTS - 1));
        if (i == POINTS - 1) break;
        for (int k = 0; k < 3; k++) from->d[k] += strength * bend[k], norm += from->d[k] * from->d[k];
        for (int k = 0; k < 3; k++) {
            from->d[k] /= sqrt(norm);
            from->p[k] += length / (POINTS - 1) * from->d[k];
        }
    }
    from->r = r * taper;
    brio_solid_join(m, body, brio_solid_tube(m, (const double(*)[4])points, POINTS, false));
}

uint32_t brio_solid_coral(brio_solid_maker *m) {
    enum { MOST = 40 };
    sprout list[MOST] = {{{0, 0, -0.4}, {0, 0, 1}, 0}};
    double reach = brio_solid_spacings(m, 1, 5), least = 0.75 * m->spacing, length = brio_solid_uniform(m, 0.15, 0.25);
    double taper = brio_solid_uniform(m, 0.65, 0.9), spread = brio_solid_uniform(m, 0.4, 0.9);
    uint32_t body = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, reach);
    int count = 1, wanted = brio_solid_pick(m, 5, MOST - 3);
    list[0].r = brio_solid_uniform(m, 0.03, 0.08);
    for (int i = 0; i < count; i++) {
        double shrink = pow(list[i].r / list[0].r, 0.5), d[3];
        grow(m, body, &list[i], length * shrink, taper);
        int children = brio_solid_pick(m, 2, 3);
        for (int c = 0; c < children && count < wanted; c++) {
            if (list[i].r * 0.85 < least) break;
            brio_solid_direction(m, d);
            list[count] = list[i];
            list[count].r *= 0.85;
            for (int k = 0; k < 3; k++) list[count].d[k] = (1 - spread) * list[i].d[k] + spread * d[k];
            count++;
        }
    }
    if (brio_solid_chance(m, 0.5))
        brio_solid_join(m, body, brio_solid_move(m, brio_solid_ellipsoid(m, 0.15, 0.15, 0.06), 0, 0, -0.42));
    return body;
}

/* --- knots --- */

/* Returns a closed curve: torus knot (p, q), or random waves. */
uint32_t brio_solid_knot(brio_solid_maker *m) {
    enum { POINTS = 180, WAVES = 3 };
    double points[POINTS][4], a[WAVES][3], phase[WAVES][3], r = tube_radius(m, 0.012);
    int p = brio_solid_pick(m, 2, 3), q = p == 2 ? 2 * brio_solid_pick(m, 1, 3) + 1 : brio_solid_pick(m, 4, 5);
    bool torus = brio_solid_chance(m, 0.6);
    double small = brio_solid_uniform(m, 0.08, 0.15), uneven = brio_solid_uniform(m, 0, 0.35);
    for (int w = 0; w < WAVES; w++)
        for (int k = 0; k < 3; k++) {
            a[w][k] = brio_solid_uniform(m, -1, 1) * 0.36 / (w + 1);
            phase[w][k] = brio_solid_uniform(m, 0, FULL_TURN);
        }
    for (int i = 0; i < POINTS; i++) {
        double t = FULL_TURN * i / POINTS, ring = 0.27 + small * cos(q * t);
        const double knot[3] = {ring * cos(p * t), ring * sin(p * t), small * sin(q * t)};
        for (int k = 0; k < 3; k++) {
            points[i][k] = torus ? knot[k] : 0;
            for (int w = 0; w < WAVES && !torus; w++) points[i][k] += a[w][k] * sin((w + 1) * t + phase[w][k]);
        }
        points[i][3] = r * (1 + uneven * sin(t + phase[0][0]));
    }
    return brio_solid_tube(m, (const double(*)[4])points, POINTS, true);
}

/* --- tangles: loops that start and end on a core --- */

static void loop(brio_solid_maker *m, uint32_t body, double core, double r) {
    enum { POINTS = 28 };
    double points[POINTS][4], a[3], b[3], c[3], reach = brio_solid_uniform(m, 0.2, 0.55);
    brio_solid_direction(m, a);
    brio_solid_direction(m, b);
    for (int k = 0; k < 3; k++) c[k] = reach * (a[k] + b[k]) + 0.2 * a[k];
    for (int i = 0; i < POINTS; i++) { /* a cubic from core * a to core * b */
        double t = (double)i / (POINTS - 1), s = 1 - t;
        for (int k = 0; k < 3; k++)
            points[i][k] = s * s * s * 0.6 * core * a[k] + 3 * s * s * t * (c[k] + 0.3 * a[k]) +
                           3 * s * t * t * (c[k] + 0.3 * b[k]) + t * t * t * 0.6 * core * b[k];
        points[i][3] = r;
    }
    brio_solid_join(m, body, brio_solid_tube(m, (const double(*)[4])points, POINTS, false));
}

uint32_t brio_solid_tangle(brio_solid_maker *m) {
    double reach = brio_solid_spacings(m, 1, 5), core = brio_solid_uniform(m, 0.08, 0.2);
    double x = brio_solid_uniform(m, 0.6, 1.2), y = brio_solid_uniform(m, 0.6, 1.2);
    uint32_t body = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, reach);
    int loops = brio_solid_pick(m, 1, 9);
    brio_solid_join(m, body, brio_solid_ellipsoid(m, core, core * x, core * y));
    for (int i = 0; i < loops; i++) loop(m, body, core * fmin(1, fmin(x, y)), tube_radius(m, 0.008));
    return body;
}

/* --- snails: spirals whose turns touch or nearly touch --- */

uint32_t brio_solid_snail(brio_solid_maker *m) {
    enum { POINTS = 169 };
    double points[POINTS][4], turns = brio_solid_uniform(m, 1.5, 4), rise = brio_solid_uniform(m, 0, 0.5);
    double growth = log(brio_solid_uniform(m, 3, 9)), gap = brio_solid_uniform(m, 0.55, 1.15);
    double last = 0.3, ratio = exp(-growth / turns);
    double fat = gap * 0.5 * last * (1 - ratio) / (1 + ratio) * 1.6;
    for (int i = 0; i < POINTS; i++) {
        double t = (double)i / (POINTS - 1), size = exp(growth * (t - 1)), angle = FULL_TURN * turns * t;
        points[i][0] = last * size * cos(angle);
        points[i][1] = last * size * sin(angle);
        points[i][2] = -rise * size;
        points[i][3] = fmax(fat * size, 0.8 * m->spacing);
    }
    uint32_t tube = brio_solid_tube(m, (const double(*)[4])points, POINTS, false);
    if (!brio_solid_chance(m, 0.5)) return tube;
    double wall = brio_solid_size(m), reach = brio_solid_spacings(m, 1, 3);
    uint32_t cut = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SMOOTH, reach); /* a mouth */
    const double *end = points[POINTS - 1];
    brio_solid_join(m, cut, tube);
    brio_solid_join(
        m, cut,
        brio_solid_move(m, brio_solid_ball(m, fmax(fat - wall, 0.3 * fat)), end[0], end[1] + 0.5 * fat, end[2]));
    return cut;
}

/* --- rings --- */

/* Rings in a row: linked ones are components, touching ones handles. */
uint32_t brio_solid_rings(brio_solid_maker *m) {
    bool chain = brio_solid_chance(m, 0.5);
    int count = brio_solid_pick(m, 2, chain ? 3 : 6);
    double r = tube_radius(m, 0.012), reach = brio_solid_spacings(m, 1, 5), x = 0, major = 0;
    uint32_t body = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SMOOTH, chain ? 0 : reach);
    if (chain) m->parts = count;
    for (int i = 0; i < count; i++) {
        double next = brio_solid_uniform(m, 0.09, 0.2), lean = brio_solid_uniform(m, -0.3, 0.3);
        next = fmax(next, 3 * r + 1.5 * m->spacing);
        x += i == 0 ? 0 : chain ? major + next - 3.2 * r - m->spacing : major + next - 0.5 * r;
        major = next;
        uint32_t ring = brio_solid_torus(m, major, r);
        if (chain && i % 2) ring = brio_solid_axis(m, ring, 1);
        brio_solid_join(m, body, brio_solid_move(m, chain ? brio_solid_spin(m, ring, lean) : ring, x - 0.3, 0, 0));
    }
    return body;
}
