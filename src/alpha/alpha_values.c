/* The filtration values of the alpha complex: of every tetrahedron, facet, edge and vertex of a triangulation.
 *
 *   1. A tetrahedron has the squared radius of its orthosphere.
 *   2. A facet or an edge is Gabriel when no vertex is strictly inside its smallest orthosphere, decided exactly. Its
 *      value is then the squared radius of that sphere, and otherwise the least value of the simplices that it is a
 *      facet of. It suffices to test the vertices of its link: the smallest orthosphere's centre is in the dual of the
 *      simplex when it is on the right side of each face of the dual, and each face belongs to a vertex of the link.
 *   3. A vertex of weight w has the value -w or, with weights, the least value of its edges if a neighbour hides it at
 *      -w.
 * A value is never greater than one of the simplices that the simplex is a facet of: where rounding would make it so,
 * it becomes equal.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994.
 *           Edelsbrunner. The union of balls and its dual shape. DCG 1995. */
#include "alpha/alpha_complex.h"
#include "alpha/simplex_values.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/versioned.h"
#include "triangulation/ring.h"
#include "triangulation/view.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    CHUNK = 1 << 11,
    TETS_A_THREAD = 1 << 12,
    SLICE = 1 << 17 /* simplices between two looks at cancelling; chosen */
};

/* Where a simplex was found: the tetrahedron and the slots of an edge, or a facet handle. */
typedef struct {
    uint32_t tet;
    uint8_t i, j;
} edge_place;

typedef struct {
    brio_context *ctx;
    brio_tetrahedra t; /* without records */
    size_t num_finite, num_points;
    const uint8_t *own; /* #points, or NULL for all: brio_alpha_input */
    brio_records records;
    double *of_facet;       /* 4 #T: the value of each facet, at the handles of its finite tetrahedra */
    const uint32_t *facet;  /* #facets: one handle each */
    const edge_place *edge; /* #edges */
    brio_alpha_complex *out;
} evaluation;

static bool is_finite(const evaluation *e, uint32_t handle) {
    assert(brio_has_tet(&e->t, brio_tet_of(handle)));
    return brio_tet_of(handle) < e->num_finite;
}

static bool is_own(const evaluation *e, uint32_t point) {
    return !e->own || e->own[point];
}

static double own_value(const evaluation *e, const uint32_t *vertex, int count) {
    return brio_own_value(&e->records, vertex, count);
}

static bool is_inside(const evaluation *e, const uint32_t *vertex, int count, uint32_t other) {
    return brio_is_inside(&e->records, vertex, count, other);
}

/* --- tetrahedra --- */

static void find_tetrahedra(void *user, size_t begin, size_t end, int thread) {
    const evaluation *e = user;
    (void)thread;
    for (size_t t = begin; t < end; t++) {
        uint32_t *vertex = e->out->simplices[3] + 4 * t;
        brio_put_simplex(e->t.tet[t].vertex, 4, vertex);
        e->out->values[3][t] = own_value(e, vertex, 4);
        e->out->solid[3][t] = e->out->values[3][t];
        e->out->gabriel[3][t] = 1;
    }
}

/* --- facets --- */

static void find_facet(const evaluation *e, size_t f) {
    const uint32_t h = e->facet[f], side[2] = {h, *brio_mate(&e->t, h)};
    uint32_t *vertex = e->out->simplices[2] + 3 * f, seen[3];
    for (int k = 0; k < 3; k++) seen[k] = e->t.tet[brio_tet_of(h)].vertex[BRIO_FACET[brio_slot_of(h)][k]];
    brio_put_simplex(seen, 3, vertex);
    assert(is_finite(e, h)); /* finite tetrahedra come first, and h is the lower handle */
    double value = INFINITY;
    bool gabriel = true;
    for (int s = 0; s < 2; s++) {
        if (!is_finite(e, side[s])) continue;
        value = fmin(value, e->out->values[3][brio_tet_of(side[s])]);
        gabriel = gabriel && !is_inside(e, vertex, 3, brio_apex(&e->t, side[s]));
    }
    e->out->solid[2][f] = value;
    if (gabriel) value = fmin(value, own_value(e, vertex, 3));
    for (int s = 0; s < 2; s++)
        if (is_finite(e, side[s])) e->of_facet[side[s]] = value;
    e->out->values[2][f] = value;
    e->out->gabriel[2][f] = gabriel;
}

static void find_facets(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    for (size_t f = begin; f < end; f++) find_facet(user, f);
}

/* --- edges --- */

/* What is known of an edge after some of its tetrahedra. */
typedef struct {
    const uint32_t *vertex;
    double value, solid;
    bool gabriel;
} edge_star;

/* Takes the two facets of tetrahedron `tet` at an edge, and their apexes, into account. */
static void meet_tetrahedron(const evaluation *e, uint32_t tet, edge_star *star) {
    const uint32_t *v = e->t.tet[tet].vertex;
    if (tet >= e->num_finite) return;
    star->solid = fmin(star->solid, e->out->values[3][tet]);
    for (int i = 0; i < 4; i++) {
        if (v[i] == star->vertex[0] || v[i] == star->vertex[1]) continue;
        star->value = fmin(star->value, e->of_facet[brio_facet_of(tet, i)]);
        star->gabriel = star->gabriel && !is_inside(e, star->vertex, 2, v[i]);
    }
}

static void find_edge(const evaluation *e, size_t n) {
    const edge_place *at = &e->edge[n];
    const uint32_t *v = e->t.tet[at->tet].vertex, seen[2] = {v[at->i], v[at->j]};
    uint32_t *vertex = e->out->simplices[1] + 2 * n;
    brio_put_simplex(seen, 2, vertex);
    assert(at->tet < e->num_finite && at->i < at->j && at->j < 4);
    edge_star star = {vertex, INFINITY, INFINITY, true};
    meet_tetrahedron(e, at->tet, &star);
    brio_ring ring = brio_ring_second(&e->t, at->tet, at->i, at->j);
    do meet_tetrahedron(e, ring.tet, &star);
    while (brio_ring_next(&ring));
    if (star.gabriel) star.value = fmin(star.value, own_value(e, vertex, 2));
    e->out->values[1][n] = star.value;
    e->out->solid[1][n] = star.solid;
    e->out->gabriel[1][n] = star.gabriel;
}

static void find_edges(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    for (size_t n = begin; n < end; n++) find_edge(user, n);
}

/* --- which simplices there are --- */

/* Returns whether a facet has a point whose tetrahedra are all there. */
static bool has_own(const evaluation *e, uint32_t h) {
    const uint32_t *v = e->t.tet[brio_tet_of(h)].vertex;
    const uint8_t *slot = BRIO_FACET[brio_slot_of(h)];
    return is_own(e, v[slot[0]]) || is_own(e, v[slot[1]]) || is_own(e, v[slot[2]]);
}

/* Lists one handle of each finite facet: the lower one, or the one in the finite tetrahedron. */
static brio_status list_facets(const evaluation *e, uint32_t **out, size_t *count) {
    *count = 0;
    brio_status status = BRIO_ALLOC(e->ctx, *out, 2 * e->num_finite + 2 * (e->t.count - e->num_finite));
    if (status != BRIO_OK) return status;
    for (uint32_t h = 0; h < 4 * e->num_finite; h++) {
        uint32_t mate = *brio_mate(&e->t, h);
        if (h < mate && has_own(e, h)) (*out)[(*count)++] = h; /* finite tetrahedra come first */
        if (h % BRIO_LOOK_EVERY == 0) BRIO_TRY(brio_look(e->ctx, BRIO_LOOK_EVERY));
    }
done:
    return status;
}

/* Lists each finite edge once, in its first tetrahedron. */
static brio_status list_edges(const evaluation *e, edge_place **out, size_t *count) {
    size_t capacity = 0;
    *count = 0;
    for (uint32_t tet = 0; tet < e->num_finite; tet++) {
        if (tet % SLICE == 0)
            BRIO_FORWARD(brio_progress(e->ctx, "values", 0.1 + 0.1 * ((double)tet / (double)e->num_finite)));
        BRIO_FORWARD(BRIO_RESERVE(e->ctx, *out, capacity, *count + 6));
        for (uint8_t i = 0; i < 4; i++)
            for (uint8_t j = (uint8_t)(i + 1); j < 4; j++)
                if ((is_own(e, e->t.tet[tet].vertex[i]) || is_own(e, e->t.tet[tet].vertex[j])) &&
                    brio_ring_size(&e->t, tet, i, j) > 0)
                    (*out)[(*count)++] = (edge_place){tet, i, j};
    }
    return BRIO_OK;
}

/* Numbers the vertices in ascending order.   place  #P, zeroed; receives the number of each vertex that is own. */
static size_t number_vertices(const evaluation *e, uint32_t *place) {
    size_t count = 0;
    for (size_t t = 0; t < e->num_finite; t++)
        for (int i = 0; i < 4; i++) place[e->t.tet[t].vertex[i]] = 1;
    for (size_t p = 0; p < e->num_points; p++)
        if (!is_own(e, (uint32_t)p))
            place[p] = BRIO_INFINITE;
        else if (place[p])
            place[p] = (uint32_t)count++;
    return count;
}

/* --- all of it --- */

/* A loop of a slice of the simplices. */
typedef struct {
    evaluation *e;
    brio_part_fn body;
    size_t first;
} slice;

static void work_on_slice(void *user, size_t begin, size_t end, int thread) {
    const slice *s = user;
    s->body(s->e, s->first + begin, s->first + end, thread);
}

/* Finds values of n simplices, and reports progress between slices: the part from `from` to `to` of the bar. */
static brio_status find_all(evaluation *e, brio_part_fn body, size_t n, double from, double to) {
    int threads = brio_threads(e->ctx, e->num_finite, TETS_A_THREAD);
    for (size_t first = 0; first < n; first += SLICE) {
        slice s = {e, body, first};
        BRIO_FORWARD(brio_for_chunks(e->ctx, threads, n - first < SLICE ? n - first : SLICE, CHUNK, work_on_slice, &s));
        BRIO_FORWARD(brio_progress(e->ctx, "values", from + (to - from) * ((double)first / (double)n)));
    }
    return BRIO_OK;
}

static brio_status evaluate(evaluation *e, const uint32_t *place) {
    brio_alpha_complex *c = e->out;
    BRIO_FORWARD(find_all(e, find_tetrahedra, c->counts[3], 0.2, 0.4));
    BRIO_FORWARD(find_all(e, find_facets, c->counts[2], 0.4, 0.7));
    BRIO_FORWARD(find_all(e, find_edges, c->counts[1], 0.7, 1));
    for (size_t n = 0; n < 2 * c->counts[1]; n++) { /* every vertex has edges */
        uint32_t v = c->simplices[1][n];
        if (place[v] != BRIO_INFINITE) c->simplices[0][place[v]] = v;
    }
    return brio_find_vertex_values(e->ctx, c, &e->records, place);
}

static brio_status find_values(evaluation *e, const double *points, const double *weights) {
    brio_status status = BRIO_OK;
    uint32_t *facet = NULL, *place = NULL;
    edge_place *edge = NULL;
    size_t *counts = e->out->counts;
    BRIO_TRY(brio_records_take(e->ctx, points, 3, weights, e->num_points, &e->records));
    BRIO_TRY(BRIO_ALLOC(e->ctx, e->of_facet, 4 * e->num_finite));
    for (size_t h = 0; h < 4 * e->num_finite && e->own; h++) e->of_facet[h] = INFINITY;
    BRIO_TRY(BRIO_ALLOC_ZERO(e->ctx, place, e->num_points));
    BRIO_TRY(list_facets(e, &facet, &counts[2]));
    BRIO_TRY(list_edges(e, &edge, &counts[1]));
    BRIO_TRY(brio_progress(e->ctx, "values", 0.2));
    counts[0] = number_vertices(e, place);
    counts[3] = e->num_finite;
    e->facet = facet, e->edge = edge;
    assert(e->own || counts[0] + counts[2] == counts[1] + counts[3] + 1); /* Euler: a ball */
    BRIO_TRY(brio_alpha_room(e->ctx, e->out));
    BRIO_TRY(evaluate(e, place));
done:
    brio_release(e->ctx, facet);
    brio_release(e->ctx, edge);
    brio_release(e->ctx, place);
    brio_release(e->ctx, e->records.of);
    brio_release(e->ctx, e->of_facet);
    return status;
}

/* Drops the simplices whose first vertex is not own. The arrays of all dimensions are one, and stay so. */
static void keep_own(const evaluation *e) {
    brio_alpha_complex *c = e->out;
    size_t at = 0, corner = 0;
    for (size_t k = 0; k < 4; k++) {
        const uint32_t *from = c->simplices[k];
        const double *values = c->values[k], *solid = c->solid[k];
        const uint8_t *gabriel = c->gabriel[k];
        size_t count = c->counts[k];
        c->simplices[k] = c->simplices[0] + corner;
        c->values[k] = c->values[0] + at, c->solid[k] = c->solid[0] + at, c->gabriel[k] = c->gabriel[0] + at;
        c->counts[k] = 0;
        for (size_t n = 0; n < count; n++) {
            if (!is_own(e, from[n * (k + 1)])) continue;
            size_t to = c->counts[k]++;
            memmove(c->simplices[k] + to * (k + 1), from + n * (k + 1), (k + 1) * sizeof *from);
            c->values[k][to] = values[n], c->solid[k][to] = solid[n], c->gabriel[k][to] = gabriel[n];
        }
        at += c->counts[k];
        corner += c->counts[k] * (k + 1);
    }
    assert(c->counts[0] + c->counts[2] == c->counts[1] + c->counts[3]); /* Euler: space that repeats */
}

static evaluation evaluation_of(brio_context *ctx, const brio_alpha_input *in, brio_alpha_complex *out) {
    evaluation e = {.ctx = ctx, .num_finite = in->num_finite, .num_points = in->num_points, .own = in->own, .out = out};
    e.t = (brio_tetrahedra){.tet = in->tet, .count = in->count, .infinite = BRIO_INFINITE};
    return e;
}

brio_status brio_alpha_of_stars(brio_context *ctx, const brio_alpha_input *in, brio_alpha_complex *out) {
    *out = (brio_alpha_complex){.size = sizeof *out, .context = ctx};
    evaluation e = evaluation_of(ctx, in, out);
    brio_status status = find_values(&e, in->points, in->weights);
    if (status != BRIO_OK) brio_alpha_complex_free(out);
    return status;
}

brio_status brio_alpha_of_classes(brio_context *ctx, const brio_alpha_input *in, brio_alpha_complex *out) {
    BRIO_FORWARD(brio_alpha_of_stars(ctx, in, out));
    const evaluation e = evaluation_of(ctx, in, out);
    keep_own(&e);
    return BRIO_OK;
}

brio_status brio_alpha_values(brio_context *ctx, const brio_triangulation *t, const double *points,
                              const double *weights, size_t num_points, brio_alpha_complex *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    brio_alpha_complex mine = {.size = sizeof mine, .context = ctx, .triangulation = t};
    evaluation e = {.ctx = ctx, .num_finite = s->tetrahedra, .num_points = num_points};
    e.t = brio_tetrahedra_of(t);
    e.out = &mine;
    brio_status size = BRIO_CHECK_OWNER(ctx, brio_alpha_complex, out, triangulation2);
    if (size != BRIO_OK) return size;
    BRIO_REQUIRE(ctx, num_points == s->points, BRIO_ERR_ARGUMENT, "the triangulation has %zu points, not %zu",
                 s->points, num_points);
    BRIO_REQUIRE(ctx, s->dimension == 3, BRIO_ERR_NO_ANSWER,
                 "%zu vertices (%zu points are hidden) of dimension %d have no tetrahedra, so no alpha complex",
                 s->vertices, s->hidden, s->dimension);
    BRIO_TRY(find_values(&e, points, weights));
done:
    if (status != BRIO_OK) brio_alpha_complex_free(&mine);
    if (status != BRIO_OK) mine = (brio_alpha_complex){.size = sizeof mine};
    BRIO_GIVE(brio_alpha_complex, out, &mine);
    return status;
}

void brio_alpha_complex_free(brio_alpha_complex *c) {
    if (!c || !BRIO_OWNS(brio_alpha_complex, c, triangulation2) || !c->context) return;
    brio_release(c->context, c->simplices[0]);
    brio_release(c->context, c->values[0]);
    brio_release(c->context, c->solid[0]);
    brio_release(c->context, c->gabriel[0]);
    brio_alpha_complex empty = {.size = c->size};
    BRIO_GIVE(brio_alpha_complex, c, &empty);
}
