/* Evidence of scanners and normals: it decides what points alone cannot, wrong parts of it lose, and none changes nothing. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "same_faces.h"
#include "surface_calls.h"
#include <math.h>
#include <string.h>

enum { MANY = 3000 };

/* A room seen from inside: points on the walls of a box, with normals into the room. */
static double room[3 * MANY], inwards[3 * MANY];

static void make_room(void) {
    const double size[3] = {5, 4, 3};
    brio_rng rng = brio_rng_new(7);
    for (size_t p = 0; p < MANY; p++) {
        size_t wall = p % 6, axis = wall % 3;
        for (size_t k = 0; k < 3; k++) {
            room[3 * p + k] = k == axis ? (wall < 3 ? 0 : size[k]) : size[k] * brio_rng_double(&rng);
            inwards[3 * p + k] = k != axis ? 0 : wall < 3 ? 1 : -1;
        }
    }
}

/* Turns about so many normals of 100 over. */
static void flip(unsigned percent, double *normals) {
    brio_rng rng = brio_rng_new(11);
    memcpy(normals, inwards, sizeof inwards);
    for (size_t p = 0; p < MANY; p++) {
        bool turn = brio_rng_double(&rng) * 100 < percent;
        for (size_t k = 0; k < 3 && turn; k++) normals[3 * p + k] = -normals[3 * p + k];
    }
}

/* Makes the surface of the room and returns its volume: negative if its faces look inwards. */
static double volume_of(brio_context *ctx, const brio_evidence *e, brio_surface_stats *s) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_options o = LABELED_OPTIONS;
    o.evidence = e;
    EXPECT(make_labeled(ctx, room, MANY, &o, &mesh, NULL, s) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.manifold && c.oriented && c.closed, "closed %d", c.closed);
    double volume = c.volume;
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return volume;
}

static void a_room_looks_inwards(void) {
    static const double middle[3] = {2.5, 2, 1.5};
    brio_context *ctx = new_context();
    brio_surface_stats s = {0};
    brio_evidence normals = {0}, scanner = normals;
    normals.normals = inwards;
    scanner.origins = middle, scanner.num_origins = 1;
    EXPECT(volume_of(ctx, NULL, &s) > 57 && s.evidence == 0 && s.told == 0);
    EXPECT(volume_of(ctx, &normals, &s) < -57 && s.evidence == BRIO_EVIDENCE_NORMALS && s.agreement > 0.99);
    EXPECT(volume_of(ctx, &scanner, &s) < -57 && s.evidence == BRIO_EVIDENCE_ORIGINS && s.agreement > 0.99);
    EXPECT(s.told > MANY * 9 / 10);
    brio_context_free(ctx);
}

static void a_co_cone_looks_inwards(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_options o = COCONE_OPTIONS;
    brio_evidence e = {0};
    e.normals = inwards;
    o.evidence = &e;
    EXPECT(make_cocone(ctx, room, MANY, &o, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK && c.volume < -55, "%g", c.volume);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    o.pieces = 2;
    EXPECT(make_cocone(ctx, room, MANY, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT);
    brio_context_free(ctx);
}

static void wrong_normals_lose_to_the_rest(void) {
    static double normals[3 * MANY];
    brio_context *ctx = new_context();
    brio_surface_stats s = {0};
    brio_evidence e = {0};
    e.normals = normals;
    flip(10, normals);
    EXPECT(volume_of(ctx, &e, &s) < -57 && s.agreement > 0.87 && s.agreement < 0.93, "%g", s.agreement);
    flip(25, normals);
    EXPECT(volume_of(ctx, &e, &s) < -57 && s.agreement > 0.70 && s.agreement < 0.80, "%g", s.agreement);
    brio_context_free(ctx);
}

static void normals_drawn_by_lot_change_nothing(void) {
    static double normals[3 * MANY];
    brio_context *ctx = new_context();
    brio_surface_stats s = {0};
    brio_evidence e = {0};
    e.normals = normals;
    double without = volume_of(ctx, NULL, &s);
    flip(50, normals);
    EXPECT(volume_of(ctx, &e, &s) == without && s.evidence == 0 && s.told == 0);
    memset(normals, 0, sizeof normals); /* nothing is known */
    EXPECT(volume_of(ctx, &e, &s) > 57 && s.evidence == 0);
    brio_context_free(ctx);
}

/* As those that were once turned over as a whole, or wall by wall, by a program that spreads signs from point to point: each
 * agrees with its neighbours. Alone they are believed. */
static void normals_that_contradict_the_scanner_lose(void) {
    static const double middle[3] = {2.5, 2, 1.5};
    static double normals[3 * MANY];
    brio_context *ctx = new_context();
    brio_surface_stats s = {0};
    brio_evidence e = {0};
    e.normals = normals, e.origins = middle, e.num_origins = 1;
    for (size_t half = 0; half < 2; half++) {
        for (size_t i = 0; i < 3 * MANY; i++) normals[i] = half && i / 3 % 6 < 3 ? inwards[i] : -inwards[i];
        EXPECT(volume_of(ctx, &e, &s) < -57 && s.evidence == BRIO_EVIDENCE_ORIGINS, "%u", s.evidence);
        EXPECT(s.agreement > 0.99 && s.origins_agreement > 0.99 && s.origins > MANY * 9 / 10 && s.normals == s.origins);
        EXPECT(fabs(s.normals_agreement - 0.5 * (double)half) < 0.02, "%g", s.normals_agreement);
    }
    flip(10, normals);
    EXPECT(volume_of(ctx, &e, &s) < -57 && s.evidence == (BRIO_EVIDENCE_NORMALS | BRIO_EVIDENCE_ORIGINS));
    EXPECT(fabs(s.agreement - 0.95) < 0.02 && fabs(s.normals_agreement - 0.9) < 0.02, "%g", s.agreement);
    brio_context_free(ctx);
}

static void places_by_table_by_point_and_alone_are_the_same(void) {
    static const double places[6] = {100, 100, 100, 2.5, 2, 1.5};
    static double each[3 * MANY];
    static uint32_t of[MANY];
    brio_context *ctx = new_context();
    brio_surface_stats s = {0};
    brio_evidence table = {0}, alone = table, by_point = table;
    for (size_t p = 0; p < MANY; p++) {
        of[p] = 1;
        memcpy(each + 3 * p, places + 3, 3 * sizeof *each);
    }
    table.origins = places, table.num_origins = 2, table.origin_of = of;
    alone.origins = places + 3, alone.num_origins = 1;
    by_point.origins = each, by_point.num_origins = MANY;
    double volume = volume_of(ctx, &table, &s);
    EXPECT(volume < -57 && volume_of(ctx, &alone, &s) == volume && volume_of(ctx, &by_point, &s) == volume);
    for (size_t p = 0; p < MANY; p++) of[p] = UINT32_MAX;
    EXPECT(volume_of(ctx, &table, &s) > 57 && s.evidence == 0);
    brio_surface_options o = LABELED_OPTIONS;
    brio_mesh *mesh;
    table.origin_of = NULL; /* two places for many points */
    o.evidence = &table;
    EXPECT(make_labeled(ctx, room, MANY, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    brio_context_free(ctx);
}

/* Returns the share of the area of faces that are no bridges which looks towards a place. */
static double share_towards(const brio_mesh *m, const double *place) {
    const brio_property *bridge = brio_mesh_face_property(m, "bridge");
    double all = 0, towards = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        double u[3], v[3], to[3];
        const double *a = m->vertices + 3 * (size_t)m->face_vertices[3 * f],
                     *b = m->vertices + 3 * (size_t)m->face_vertices[3 * f + 1],
                     *c = m->vertices + 3 * (size_t)m->face_vertices[3 * f + 2];
        for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], to[k] = place[k] - a[k];
        const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        double area = brio_property_value(bridge, f) > 0 ? 0 : sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        all += area;
        towards += n[0] * to[0] + n[1] * to[1] + n[2] * to[2] > 0 ? area : 0;
    }
    return towards / all;
}

/* What scanners saw of a room, half a ball, and a dome on ground is closed on request, and looks towards them. */
static void closed_surfaces_keep_to_evidence(void) {
    static double half[3 * MANY], scene[6 * MANY];
    const double places[3][3] = {{2.5, 2, 1.5}, {0, 0, 60}, {0, 0, 6}};
    const double *points[] = {room, half, scene};
    const size_t counts[] = {MANY, MANY, 2 * MANY};
    brio_context *ctx = new_context();
    brio_rng rng = brio_rng_new(5);
    make_room();
    sphere_points(9, MANY, half);
    for (size_t p = 0; p < MANY; p++) half[3 * p + 2] = fabs(half[3 * p + 2]);
    for (size_t p = 0; p < 2 * MANY; p++) {
        double *q = scene + 3 * p;
        q[0] = 6 * brio_rng_double(&rng) - 3, q[1] = 6 * brio_rng_double(&rng) - 3;
        q[2] = sqrt(fmax(0, 1 - q[0] * q[0] - q[1] * q[1])) + 0.01 * sin(9 * q[0]);
    }
    for (int i = 0; i < 3; i++) {
        const brio_evidence e = {.origins = places[i], .num_origins = 1};
        const brio_surface_options o = {.holes = BRIO_HOLES_CLOSED, .evidence = &e};
        brio_surface_stats s = {0};
        brio_certificate c = {0};
        brio_mesh *mesh;
        EXPECT(brio_surface(ctx, points[i], counts[i], &o, &mesh, &s) == BRIO_OK);
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.closed && c.manifold && c.oriented && s.evidence == BRIO_EVIDENCE_ORIGINS, "scan %d", i);
        EXPECT(share_towards(mesh, places[i]) > (i == 1 ? 0.9 : 0.95), "scan %d: %g", i,
               share_towards(mesh, places[i]));
        EXPECT(s.agreement > 0.9, "scan %d: %g", i, s.agreement);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static brio_status make_surface(brio_context *ctx) {
    brio_mesh *mesh;
    brio_surface_options o = LABELED_OPTIONS;
    brio_evidence e = {0};
    e.normals = inwards;
    o.evidence = &e;
    brio_status status = make_labeled(ctx, room, 300, &o, &mesh, NULL, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(make_surface);
}

SUITE(test_sample_evidence) {
    make_room();
    RUN(a_room_looks_inwards);
    RUN(a_co_cone_looks_inwards);
    RUN(wrong_normals_lose_to_the_rest);
    RUN(normals_drawn_by_lot_change_nothing);
    RUN(normals_that_contradict_the_scanner_lose);
    RUN(places_by_table_by_point_and_alone_are_the_same);
    RUN(closed_surfaces_keep_to_evidence);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
