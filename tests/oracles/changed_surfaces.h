/* Surfaces of samples that are changed, by every method, with the options that a user finds.
 *
 * The same faces, by the positions of their corners and to the last bit, for samples in another order, scaled by a power of
 * two, and with three threads. For duplicates, samples moved by whole numbers, exchanged axes and reflections, nothing is promised
 * but that the surface is one: what came out is counted. */
#ifndef BRIO_TESTS_CHANGED_SURFACES_H
#define BRIO_TESTS_CHANGED_SURFACES_H

#include "changed_triangulations.h"

enum { MOST_SAMPLES_CHANGED = 2 * MOST_SET };

typedef enum { LABELED, POWER_CRUST, COCONE, TIGHT_COCONE, SUPER_COCONE, OFFSET_OUT, POWER_SHAPE, METHODS } method;

static const char *const METHOD_NAMES[METHODS] = {"labeled Delaunay", "power crust", "co-cone",    "tight co-cone",
                                                  "super co-cone",    "offset",      "power shape"};

/* What a run says: a number for its faces, and its topology. faces is 0 for a refusal. */
typedef struct {
    brio_status status;
    uint64_t number;
    size_t faces, components;
    int64_t genus;
    int closed, manifold, oriented;
} surface_answer;

/* --- samples: of a sphere, a torus or a cube, dense or sparse; multiples of 2^-10, so that whole numbers are added exactly --- */

static inline void sample_shape(dice *d, int shape, double *p) {
    double u = 6.283185307179586 * (double)(roll(d) >> 11) * 0x1p-53, v = (double)(roll(d) >> 11) * 0x1p-53;
    double z = 2 * v - 1, r = sqrt(1 - z * z), t = 6.283185307179586 * v;
    if (shape == 0) p[0] = r * cos(u), p[1] = r * sin(u), p[2] = z;
    if (shape == 1) p[0] = (1 + 0.4 * cos(t)) * cos(u), p[1] = (1 + 0.4 * cos(t)) * sin(u), p[2] = 0.4 * sin(t);
    if (shape == 2) {
        uint32_t axis = below(d, 3);
        for (uint32_t k = 0; k < 3; k++) p[k] = (double)below(d, 65) / 64;
        p[axis] = (double)below(d, 2);
    }
    if (shape == 3)
        for (uint32_t k = 0; k < 3; k++) p[k] = (double)below(d, 5);
    for (uint32_t k = 0; k < 3; k++) p[k] = rint(p[k] * 1024) / 1024;
}

static inline void draw_samples(dice *d, changed_set *s) {
    int shape = (int)below(d, 4);
    s->dimension = 3, s->n = 4 + below(d, one_in(d, 2) ? 60 : MOST_SET - 4), s->weighted = false, s->integers = true;
    for (size_t i = 0; i < s->n; i++) {
        sample_shape(d, shape, s->x + 3 * i);
        s->w[i] = 0, s->from[i] = (uint32_t)i;
    }
}

/* --- methods --- */

static inline brio_status run_cocone(brio_context *ctx, method how, const changed_set *s, brio_mesh **m) {
    brio_surface_options o = {.method = how == TIGHT_COCONE ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE};
    o.pieces = how == SUPER_COCONE ? 3 : 0;
    return brio_surface(ctx, s->x, s->n, &o, m, NULL);
}

/* unit: of length, which distances are multiples of. */
static inline brio_status run_method(brio_context *ctx, method how, const changed_set *s, double unit, brio_mesh **m) {
    const brio_surface_options closed = {.holes = BRIO_HOLES_CLOSED},
                               crust = {.method = BRIO_SURFACE_POWER_CRUST, .polygons = 1},
                               offset = {.method = BRIO_SURFACE_OFFSET, .polygons = 1, .distance = 0.0625 * unit};
    brio_mesh *shape = NULL;
    brio_status status;
    *m = NULL;
    switch (how) {
    case LABELED:
        return brio_surface(ctx, s->x, s->n, &closed, m, NULL);
    case POWER_CRUST:
        return brio_surface(ctx, s->x, s->n, &crust, m, NULL);
    case OFFSET_OUT:
        return brio_surface(ctx, s->x, s->n, &offset, m, NULL);
    case POWER_SHAPE:
        status = brio_power_shape(ctx, s->x, s->n, NULL, &shape, m, NULL);
        brio_mesh_free(shape);
        return status;
    default:
        return run_cocone(ctx, how, s, m);
    }
}

/* --- faces as a number, whatever their order, the vertices' order, and the corner that comes first --- */

static inline uint64_t stir(uint64_t x) {
    x = (x ^ x >> 31) * UINT64_C(0x9e3779b97f4a7c15);
    return x ^ x >> 29;
}

/* The change undone: of a position of the changed surface. */
typedef struct {
    double scale, move[3];
    size_t turn;
    bool reflected;
} undoing;

static inline uint64_t number_of(const double *p, const undoing *u) {
    uint64_t number = 0;
    for (size_t k = 0; k < 3; k++) {
        double x = p[(k + u->turn) % 3] / u->scale - u->move[(k + u->turn) % 3] + 0.0;
        uint64_t bits;
        if (u->reflected) x = 0.0 - x;
        memcpy(&bits, &x, sizeof bits);
        number = stir(number + bits + 1);
    }
    return number;
}

/* The corners of a face with their neighbours on both sides. A reflection turns faces round. */
static inline uint64_t face_number(const brio_mesh *m, size_t face, const undoing *u) {
    const uint32_t *v = m->face_vertices + m->face_offsets[face];
    size_t corners = m->face_offsets[face + 1] - m->face_offsets[face];
    uint64_t sum = corners;
    for (size_t i = 0; i < corners; i++) {
        uint64_t before = number_of(m->vertices + 3 * (size_t)v[(i + corners - 1) % corners], u);
        uint64_t after = number_of(m->vertices + 3 * (size_t)v[(i + 1) % corners], u);
        uint64_t here = number_of(m->vertices + 3 * (size_t)v[i], u);
        sum += u->reflected ? stir(after + stir(here + stir(before))) : stir(before + stir(here + stir(after)));
    }
    return stir(sum);
}

static inline uint64_t faces_number(const brio_mesh *m, const undoing *u) {
    uint64_t sum = m->num_faces;
    for (size_t f = 0; f < m->num_faces; f++) sum += face_number(m, f, u);
    return sum;
}

static inline void find_surface(brio_context *ctx, method how, const changed_set *s, const undoing *u,
                                surface_answer *out) {
    brio_certificate c = {0};
    brio_mesh *m;
    memset(out, 0, sizeof *out);
    out->status = run_method(ctx, how, s, u->scale, &m);
    if (m && brio_mesh_certificate(ctx, m, &c) == BRIO_OK) {
        out->number = faces_number(m, u), out->faces = m->num_faces;
        out->components = c.components, out->genus = c.genus;
        out->closed = c.closed, out->manifold = c.manifold, out->oriented = c.oriented;
    }
    brio_certificate_free(&c);
    brio_mesh_free(m);
}

/* --- changes --- */

static inline undoing change_samples(dice *d, change how, const changed_set *s, changed_set *t) {
    undoing u = {.scale = 1};
    *t = *s;
    if (how == SHUFFLE || how == THREADS || how == SCALE) shuffle(d, s, t);
    if (how == DUPLICATE)
        for (uint32_t left = 1 + below(d, (uint32_t)s->n); left > 0; left--)
            copy_point(s, below(d, (uint32_t)s->n), t, t->n++);
    if (how == SCALE) u.scale = ldexp(1, (int)below(d, 40) - 20);
    if (how == MOVE)
        for (int k = 0; k < 3; k++) u.move[k] = (double)below(d, 2048) - 1024;
    if (how == EXCHANGE_AXES) u.turn = 1 + below(d, 2);
    u.reflected = how == NEGATE;
    for (size_t i = 0; i < t->n; i++)
        for (size_t k = 0; k < 3; k++) {
            double x = s->x[3 * t->from[i] + k];
            t->x[3 * i + (k + u.turn) % 3] = (u.reflected ? -x : x) * u.scale + u.move[(k + u.turn) % 3];
        }
    return u;
}

typedef struct {
    bool same_faces, same_topology, sound;
} surface_verdict;

static inline bool is_sound(method how, const surface_answer *a) {
    bool closed = how != COCONE && how != SUPER_COCONE;
    if (a->status) return a->status == BRIO_ERR_NO_ANSWER && a->faces == 0;
    return a->manifold && a->oriented && (a->closed || !closed);
}

static inline surface_verdict try_surface(brio_context *ctx, dice *d, method which, change how, changed_set *s) {
    static changed_set t;
    surface_answer a, b;
    undoing none = {.scale = 1};
    draw_samples(d, s);
    undoing u = change_samples(d, how, s, &t);
    find_surface(ctx, which, s, &none, &a);
    brio_context_set_threads(ctx, how == THREADS ? 3 : 1);
    find_surface(ctx, which, &t, &u, &b);
    brio_context_set_threads(ctx, 1);
    surface_verdict v = {.same_faces = a.status == b.status && a.number == b.number};
    v.same_topology =
        a.status == b.status && a.components == b.components && a.genus == b.genus && a.closed == b.closed;
    v.sound = is_sound(which, &a) && is_sound(which, &b);
    return v;
}

#endif
