/* Machined solids that turn: shafts, gears, screws, cranks. */
#include "testdata/solid_edges.h"
#include "testdata/solid_families.h"
#include <math.h>

static const double FULL_TURN = 6.28318530717958648;

/* --- shafts --- */

/* Adds steps, cones and grooves to a profile, from z = -half to half. */
static uint32_t stepped_profile(brio_solid_maker *m, double half, double *least, double *most) {
    uint32_t lathe = brio_csg_add(m->tree, BRIO_CSG_LATHE, NULL, 0);
    int steps = brio_solid_pick(m, 2, 6);
    double z = -half, r = brio_solid_uniform(m, 0.05, 0.2);
    *least = *most = r;
    brio_csg_point(m->tree, lathe, -1, z, 0, 0);
    for (int i = 0; i < steps; i++) {
        double end = -half + 2 * half * (i + 1) / steps,
               slope = brio_solid_chance(m, 0.25) ? brio_solid_uniform(m, -0.05, 0.05) : 0;
        double width = brio_solid_size(m), deep = brio_solid_size(m), s = fmax(r + slope, 0.03);
        brio_csg_point(m->tree, lathe, r, z, 0, 0);
        if (slope == 0 && width < 0.5 * (end - z) && deep < 0.4 * r && brio_solid_chance(m, 0.3)) { /* a groove */
            double middle = 0.5 * (z + end), bottom = r - fmax(0.5 * deep, m->spacing);
            brio_csg_point(m->tree, lathe, r, middle - 0.5 * width, 0, 0);
            brio_csg_point(m->tree, lathe, bottom, middle - 0.5 * width, 0, 0);
            brio_csg_point(m->tree, lathe, bottom, middle + 0.5 * width, 0, 0);
            brio_csg_point(m->tree, lathe, r, middle + 0.5 * width, 0, 0);
            *least = fmin(*least, bottom);
        }
        brio_csg_point(m->tree, lathe, s, end, 0, 0);
        *least = fmin(*least, s);
        *most = fmax(*most, s);
        z = end;
        r = brio_solid_uniform(m, 0.05, 0.2);
    }
    brio_csg_point(m->tree, lathe, -1, half, 0, 0);
    return lathe;
}

uint32_t brio_solid_shaft(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double half = brio_solid_uniform(m, 0.2, 0.45), least, most;
    brio_solid_join(m, part.body, stepped_profile(m, half, &least, &most));
    double bore = brio_solid_hole(m, least - 1.8 * m->spacing), cross = brio_solid_hole(m, 0.5 * least);
    double up = brio_solid_uniform(m, -0.7, 0.7) * half, key = brio_solid_size(m),
           flat = brio_solid_uniform(m, 0.6, 0.9);
    int holes = brio_solid_pick(m, 0, 3);
    if (brio_solid_chance(m, 0.6)) {
        double shift = brio_solid_chance(m, 0.5) ? brio_solid_uniform(m, 0.4, 1.6) * half : 0;
        brio_solid_join(m, part.root,
                        brio_solid_move(m, brio_solid_cylinder(m, bore, 1), 0, 0, shift ? 1 - half + shift : 0));
    }
    for (int i = 0; i < holes; i++) {
        uint32_t hole = brio_solid_spin(m, brio_solid_axis(m, brio_solid_cylinder(m, cross, 0.5), 0), 1.5 * i);
        brio_solid_join(m, part.root, brio_solid_move(m, hole, 0, 0, fmod(up + 0.3 * half * i, half)));
    }
    if (brio_solid_chance(m, 0.4)) { /* a keyway */
        uint32_t slot = brio_solid_box(m, 0.5 * key, 0.5 * key, 0.3 * half);
        brio_solid_join(m, part.root, brio_solid_move(m, slot, most, 0, half));
    }
    if (brio_solid_chance(m, 0.4)) { /* flats */
        uint32_t cut = brio_solid_move(m, brio_solid_box(m, 0.5, 0.5, 0.3 * half), 0.5 + flat * most, 0, -half);
        brio_solid_join(m, part.root, brio_solid_over(m, BRIO_CSG_MIRROR, cut, 0));
    }
    return part.root;
}

/* --- gears --- */

/* Returns a tooth that points along x, as a trapezoid from radius `root` to `tip`. */
static uint32_t tooth(brio_solid_maker *m, double root, double tip, double foot, double head, double half) {
    uint32_t prism = brio_csg_add(m->tree, BRIO_CSG_PRISM, &half, 1);
    double inner = 0.9 * root;
    brio_csg_point(m->tree, prism, inner, -foot, 0, 0);
    brio_csg_point(m->tree, prism, root, -foot, 0, 0);
    brio_csg_point(m->tree, prism, 0.5 * (root + tip), -0.5 * (foot + head) - 0.06 * foot, 0, 0);
    brio_csg_point(m->tree, prism, tip, -head, 0, 0);
    brio_csg_point(m->tree, prism, tip, head, 0, 0);
    brio_csg_point(m->tree, prism, 0.5 * (root + tip), 0.5 * (foot + head) + 0.06 * foot, 0, 0);
    brio_csg_point(m->tree, prism, root, foot, 0, 0);
    brio_csg_point(m->tree, prism, inner, foot, 0, 0);
    return prism;
}

static uint32_t toothed_disc(brio_solid_maker *m, double tip, double half) {
    uint32_t both = brio_solid_combine(m, BRIO_CSG_UNION, BRIO_BLEND_SHARP, 0);
    double width = fmax(brio_solid_size(m), 1.8 * m->spacing), twist = brio_solid_chance(m, 0.3) ? 0.5 / tip : 0;
    double most = FULL_TURN * tip / (2.4 * width), count = fmin(fmax(floor(most), 6), 40);
    double pitch = FULL_TURN * tip / count, root = tip - fmin(0.9 * pitch / 2 * 1.2, 0.35 * tip);
    uint32_t teeth = brio_solid_over(m, BRIO_CSG_RING, tooth(m, root, tip, 0.3 * pitch, 0.17 * pitch, 2), count);
    if (twist > 0) {
        const double v[2] = {twist, 1.15};
        teeth = brio_csg_over(m->tree, BRIO_CSG_TWIST, teeth, v, 2);
    }
    uint32_t slab = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SHARP, 0);
    brio_solid_join(m, slab, teeth);
    brio_solid_join(m, slab, brio_solid_box(m, 1, 1, half));
    brio_solid_join(m, both, brio_solid_cylinder(m, root, half));
    brio_solid_join(m, both, slab);
    return both;
}

uint32_t brio_solid_gear(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    double tip = brio_solid_uniform(m, 0.2, 0.4), half = brio_solid_uniform(m, 0.02, 0.12),
           hub = tip * brio_solid_uniform(m, 0.25, 0.45);
    double tall = half + brio_solid_uniform(m, 0, 0.1), bore = brio_solid_hole(m, 0.6 * hub),
           web = 0.5 * brio_solid_size(m);
    double key = brio_solid_hole(m, 0.5 * bore), second = tip * brio_solid_uniform(m, 0.4, 0.6);
    brio_solid_join(m, part.body, toothed_disc(m, tip, half));
    brio_solid_join(m, part.body, brio_solid_cylinder(m, hub, tall));
    if (brio_solid_chance(m, 0.3)) /* a pinion on the same axis */
        brio_solid_join(m, part.body, brio_solid_move(m, toothed_disc(m, second, half), 0, 0, 1.9 * half));
    if (brio_solid_chance(m, 0.4) && web < 0.7 * half) { /* recesses on both sides */
        uint32_t ring = brio_solid_combine(m, BRIO_CSG_CUT, BRIO_BLEND_SHARP, 0), both;
        brio_solid_join(m, ring, brio_solid_cylinder(m, 0.68 * tip, 0.2));
        brio_solid_join(m, ring, brio_solid_cylinder(m, 1.15 * hub, 1));
        both = brio_solid_axis(m, brio_solid_move(m, ring, 0, 0, 0.2 + web), 0);
        both = brio_solid_over(m, BRIO_CSG_MIRROR, both, 0);
        brio_solid_join(m, part.root, brio_solid_axis(m, both, 1));
    }
    if (brio_solid_chance(m, 0.5))
        brio_solid_join(m, part.root,
                        brio_solid_bolt_ring(m, 0.5 * (hub + 0.68 * tip), 0.5 * (0.68 * tip - hub), half));
    brio_solid_join(m, part.root, brio_solid_cylinder(m, bore, 1));
    if (brio_solid_chance(m, 0.5))
        brio_solid_join(m, part.root, brio_solid_move(m, brio_solid_box(m, key, key, 1), bore, 0, 0));
    return part.root;
}

/* --- screws --- */

/* Returns a bolt with a head, or a nut. */
uint32_t brio_solid_screw(brio_solid_maker *m) {
    double radius = brio_solid_uniform(m, 0.07, 0.18), pitch = brio_solid_spacings(m, 4, 12),
           half = brio_solid_uniform(m, 0.1, 0.3);
    double deep = fmin(brio_solid_uniform(m, 0.3, 0.6) * pitch, 0.35 * radius),
           head = brio_solid_uniform(m, 1.5, 2.2) * radius;
    double tall = brio_solid_uniform(m, 0.03, 0.1), v[4] = {radius, deep, pitch, half + 0.3};
    int corners = brio_solid_chance(m, 0.7) ? 6 : 4;
    bool nut = brio_solid_chance(m, 0.3);
    brio_solid_part part = brio_solid_part_new(m);
    uint32_t thread = brio_csg_add(m->tree, BRIO_CSG_THREAD, v, 4), prism;
    tall = nut ? half : tall;
    prism = brio_csg_add(m->tree, BRIO_CSG_PRISM, &tall, 1);
    for (int i = 0; i < corners; i++)
        brio_csg_point(m->tree, prism, head * cos(FULL_TURN * i / corners), head * sin(FULL_TURN * i / corners), 0, 0);
    brio_solid_join(m, part.body, prism);
    if (nut) {
        brio_solid_join(m, part.root, thread);
        return part.root;
    }
    uint32_t shank = brio_solid_combine(m, BRIO_CSG_COMMON, BRIO_BLEND_SHARP, 0);
    brio_solid_join(m, shank, brio_solid_move(m, thread, 0, 0, half));
    brio_solid_join(m, shank, brio_solid_move(m, brio_solid_cylinder(m, 2 * radius, half), 0, 0, half));
    brio_solid_join(m, part.body, shank);
    if (brio_solid_chance(m, 0.5)) { /* a socket or a slot */
        uint32_t socket = brio_solid_box(m, brio_solid_chance(m, 0.5) ? 1 : 0.4 * radius,
                                         fmin(0.4 * radius, 3 * m->spacing), 0.6 * tall);
        brio_solid_join(m, part.root, brio_solid_move(m, socket, 0, 0, -tall));
    }
    return part.root;
}

/* --- cranks --- */

/* Journals on one axis, pins beside it, webs between. */
uint32_t brio_solid_crank(brio_solid_maker *m) {
    brio_solid_part part = brio_solid_part_new(m);
    int throws = brio_solid_pick(m, 1, 4);
    double r = brio_solid_uniform(m, 0.03, 0.07), pin = brio_solid_uniform(m, 0.7, 1.1) * r,
           offset = brio_solid_uniform(m, 0.06, 0.14);
    double web = brio_solid_size(m), gap = brio_solid_size(m) + 2 * m->spacing, pitch = 0.8 / (throws + 0.5), z = -0.4;
    double bore = brio_solid_chance(m, 0.3) ? brio_solid_hole(m, 0.5 * pin) : 0;
    web = fmin(web, 0.25 * pitch);
    gap = fmin(gap, 0.4 * pitch);
    for (int i = 0; i <= throws; i++) {
        double last = i == throws ? 0.5 * pitch : pitch - gap - 2 * web,
               turn = FULL_TURN * i / (throws < 3 ? 2 : throws);
        brio_solid_join(m, part.body,
                        brio_solid_move(m, brio_solid_cylinder(m, r, 0.5 * last + 0.2 * web), 0, 0, z + 0.5 * last));
        z += last;
        if (i == throws) break;
        for (int side = 0; side < 2; side++) {
            const double a[3] = {0, 0, z + 0.5 * web + side * (web + gap)};
            uint32_t plate = brio_solid_move(m, brio_solid_box(m, 0.5 * offset + 1.3 * r, 1.4 * r, 0.5 * web),
                                             0.5 * offset, 0, a[2]);
            brio_solid_join(m, part.body, brio_solid_spin(m, plate, turn));
        }
        uint32_t bar =
            brio_solid_move(m, brio_solid_cylinder(m, pin, 0.5 * gap + 0.8 * web), offset, 0, z + web + 0.5 * gap);
        brio_solid_join(m, part.body, brio_solid_spin(m, bar, turn));
        z += 2 * web + gap;
    }
    if (bore > 0) brio_solid_join(m, part.root, brio_solid_move(m, brio_solid_cylinder(m, bore, 0.3), 0, 0, -0.5));
    return part.root;
}
