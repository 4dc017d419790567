/* Alpha shapes of all points, tile after tile.
 *
 * A slab (cells.h) has the whole stars of its points, so it knows all of a simplex that has one of these: the
 * tetrahedra at a facet, the facets round an edge, the edges at a vertex. Its points are numbered in the order of the
 * input. Then a simplex counts in the slab of its vertex of least index, once in all slabs, and its value has the bits
 * that one process computes (src/alpha).
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "alpha/alpha_complex.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "tiles/cells.h"
#include "triangulation/tetrahedra.h"
#include <math.h>
#include <string.h>

typedef struct {
    brio_tiles *t;
    double alpha, greatest; /* greatest: of the values of vertices, without sign */
    brio_tile_faces_fn take;
    void *user;
    brio_tiles_alpha_stats stats;
    /* of the tile */
    uint32_t (*face)[3]; /* rows of the tile */
    size_t num_faces, face_capacity;
    uint8_t *shared; /* of each row: faces at it are listed by other tiles */
    /* of the slab */
    uint32_t *order, *number;
    double *points, *weights;
    uint8_t *own;
    size_t capacity[5];
} alpha_run;

/* --- a slab --- */

static int compare_names(uint32_t i, uint32_t j, const void *user) {
    const brio_slabs *s = user;
    uint64_t a = s->points[s->row[i]].name, b = s->points[s->row[j]].name;
    return (a > b) - (a < b);
}

/* Numbers the points of a slab in the order of the input, and the vertices of its tetrahedra by that. */
static brio_status order_points(alpha_run *r, const brio_slabs *s, brio_alpha_input *in) {
    const brio_cell_complex *c = &s->complex;
    brio_context *ctx = r->t->ctx;
    size_t n = c->num_points;
    BRIO_FORWARD(BRIO_RESERVE(ctx, r->order, r->capacity[0], n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, r->number, r->capacity[1], n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, r->points, r->capacity[2], 3 * n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, r->own, r->capacity[3], n + 1));
    if (c->weights) BRIO_FORWARD(BRIO_RESERVE(ctx, r->weights, r->capacity[4], n + 1));
    for (size_t i = 0; i < n; i++) r->order[i] = (uint32_t)i;
    BRIO_FORWARD(brio_sort_many_indices(ctx, r->order, n, compare_names, s));
    for (size_t i = 0; i < n; i++) {
        size_t from = r->order[i];
        r->number[from] = (uint32_t)i;
        r->own[i] = from < c->num_sites;
        memcpy(r->points + 3 * i, c->points + 3 * from, 3 * sizeof *r->points);
        if (c->weights) r->weights[i] = c->weights[from];
    }
    for (size_t i = 0; i < c->count; i++)
        for (int k = 0; k < 4; k++)
            if (s->tet[i].vertex[k] != BRIO_INFINITE) s->tet[i].vertex[k] = r->number[s->tet[i].vertex[k]];
    *in = (brio_alpha_input){.tet = s->tet,
                             .num_finite = c->num_finite,
                             .count = c->count,
                             .points = r->points,
                             .weights = c->weights ? r->weights : NULL,
                             .num_points = n,
                             .own = r->own};
    return brio_look(ctx, n + c->count);
}

/* Adds the simplices that count. */
static void count_simplices(alpha_run *r, const brio_alpha_complex *c) {
    uint64_t singular[4] = {0};
    for (size_t k = 0; k < 4; k++)
        for (size_t i = 0; i < c->counts[k]; i++) {
            if (!r->own[c->simplices[k][i * (k + 1)]]) continue; /* its least vertex */
            bool is_in = c->values[k][i] <= r->alpha, is_solid = c->solid[k][i] <= r->alpha;
            r->stats.counts[k]++;
            singular[k] += is_in && !is_solid;
            r->stats.tetrahedra += k == 3 && is_in;
            r->stats.uncovered += k == 0 && !is_solid;
        }
    r->stats.singular_vertices += singular[0];
    r->stats.singular_edges += singular[1];
    r->stats.singular_facets += singular[2];
    r->greatest = fmax(r->greatest, brio_greatest(c->values[0], c->counts[0]));
}

/* Lists a face of the boundary if it is the slab's, and marks own vertices whose faces another tile has, too.
 * v  numbers of its vertices, seen counterclockwise from outside. */
static brio_status take_face(alpha_run *r, const brio_slabs *s, const uint32_t v[3]) {
    uint32_t row[3], least = v[0] < v[1] ? v[0] : v[1];
    least = least < v[2] ? least : v[2];
    for (int k = 0; k < 3; k++) row[k] = s->row[r->order[v[k]]];
    bool elsewhere = s->row[r->order[least]] >= s->num_own;
    for (int k = 0; k < 3; k++)
        if (elsewhere || row[k] >= s->num_own) r->shared[row[k]] = 1;
    if (!r->own[least]) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(r->t->ctx, r->face, r->face_capacity, r->num_faces + 1));
    memcpy(r->face[r->num_faces++], row, sizeof row);
    return BRIO_OK;
}

/* Takes the facets between inside and outside that have a point of the slab. */
static brio_status take_faces(alpha_run *r, const brio_slabs *s, const brio_alpha_complex *c) {
    static const uint8_t FROM_OUTSIDE[3] = {0, 2, 1};
    for (size_t i = 0; i < c->counts[3]; i++) {
        BRIO_FORWARD(brio_look(r->t->ctx, 1));
        if (c->values[3][i] > r->alpha) continue;
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->tet[i].mate[k]), v[3];
            if (other < c->counts[3] && c->values[3][other] <= r->alpha) continue;
            bool known = false;
            for (int n = 0; n < 3; n++) {
                v[n] = s->tet[i].vertex[BRIO_FACET[k][FROM_OUTSIDE[n]]];
                known |= r->own[v[n]];
            }
            if (known) BRIO_FORWARD(take_face(r, s, v));
        }
    }
    return BRIO_OK;
}

static brio_status run_slab(alpha_run *r, brio_slabs *s, size_t slab) {
    brio_alpha_input in;
    brio_alpha_complex complex = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_slabs_take(s, slab, false));
    if (!s->complex.num_sites) goto done;
    BRIO_TRY(order_points(r, s, &in));
    BRIO_TRY(brio_alpha_of_stars(r->t->ctx, &in, &complex));
    count_simplices(r, &complex);
    status = take_faces(r, s, &complex);
done:
    brio_alpha_complex_free(&complex);
    return status;
}

/* --- a tile --- */

/* The faces of a tile for the caller. */
typedef struct {
    double *points;
    uint64_t *index;
    uint8_t *shared;
} face_vertices;

static int compare_rows(uint32_t i, uint32_t j, const void *user) {
    const brio_set_point *p = user;
    return (p[i].name > p[j].name) - (p[i].name < p[j].name);
}

/* Lists the rows that faces use, in the order of the input: that of the halo depends on threads. */
static brio_status list_rows(const alpha_run *r, const brio_slabs *s, uint32_t **listed, size_t *count) {
    uint32_t *met = s->local; /* no slab is at work: all are UINT32_MAX */
    *count = 0;
    for (size_t f = 0; f < r->num_faces; f++)
        for (int k = 0; k < 3; k++) {
            *count += met[r->face[f][k]] == UINT32_MAX;
            met[r->face[f][k]] = 0;
        }
    BRIO_FORWARD(BRIO_ALLOC(r->t->ctx, *listed, *count + 1));
    *count = 0;
    for (size_t row = 0; row < s->num_rows; row++)
        if (met[row] != UINT32_MAX) (*listed)[(*count)++] = (uint32_t)row;
    return brio_sort_many_indices(r->t->ctx, *listed, *count, compare_rows, s->points);
}

/* Numbers the vertices of the faces in the order of the input. */
static brio_status number_rows(alpha_run *r, const brio_slabs *s, face_vertices *v, size_t *count) {
    brio_context *ctx = r->t->ctx;
    uint32_t *listed = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(list_rows(r, s, &listed, count));
    BRIO_TRY(BRIO_ALLOC(ctx, v->points, 3 * *count + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, v->index, *count + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, v->shared, *count + 1));
    for (size_t i = 0; i < *count; i++) {
        uint32_t row = listed[i];
        memcpy(v->points + 3 * i, s->points[row].record, 3 * sizeof *v->points);
        v->index[i] = s->points[row].name;
        v->shared[i] = r->shared[row];
        s->local[row] = (uint32_t)i;
    }
    for (size_t f = 0; f < r->num_faces; f++)
        for (int k = 0; k < 3; k++) r->face[f][k] = s->local[r->face[f][k]];
    status = brio_look(ctx, *count + r->num_faces);
done:
    brio_release(ctx, listed);
    return status;
}

static int compare_faces(uint32_t i, uint32_t j, const void *user) {
    const uint32_t *a = (const uint32_t *)user + 3 * (size_t)i, *b = (const uint32_t *)user + 3 * (size_t)j;
    int k = 0;
    while (k < 2 && a[k] == b[k]) k++;
    return (a[k] > b[k]) - (a[k] < b[k]);
}

/* Sorts faces, each from its least vertex on. Their order in slabs depends on threads. */
static brio_status sort_faces(alpha_run *r) {
    brio_context *ctx = r->t->ctx;
    uint32_t *order = NULL, (*sorted)[3] = NULL;
    brio_status status = BRIO_OK;
    size_t n = r->num_faces;
    BRIO_TRY(BRIO_ALLOC(ctx, order, n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, sorted, n + 1));
    for (size_t f = 0; f < n; f++) {
        uint32_t *v = r->face[f], turned[3];
        int first = 0;
        for (int k = 1; k < 3; k++)
            if (v[k] < v[first]) first = k;
        for (int k = 0; k < 3; k++) turned[k] = v[(first + k) % 3];
        memcpy(v, turned, sizeof turned);
        order[f] = (uint32_t)f;
    }
    BRIO_TRY(brio_sort_many_indices(ctx, order, n, compare_faces, r->face));
    for (size_t f = 0; f < n; f++) memcpy(sorted[f], r->face[order[f]], sizeof *sorted);
    brio_release(ctx, r->face);
    r->face = sorted;
    r->face_capacity = n + 1;
    sorted = NULL;
done:
    brio_release(ctx, order);
    brio_release(ctx, sorted);
    return status;
}

static brio_status give_faces(alpha_run *r, const brio_slabs *s) {
    brio_context *ctx = r->t->ctx;
    brio_faces_part part = {.size = sizeof part, .num_faces = r->num_faces};
    face_vertices v = {0};
    brio_status status = BRIO_OK;
    r->stats.faces += r->num_faces;
    if (!r->take || !r->num_faces) return BRIO_OK;
    BRIO_REQUIRE(ctx, r->num_faces < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu faces of tile %u: take more tiles",
                 r->num_faces, s->tile);
    BRIO_TRY(number_rows(r, s, &v, &part.num_vertices));
    BRIO_TRY(sort_faces(r));
    part.points = v.points, part.index = v.index, part.shared = v.shared;
    part.faces = (const uint32_t(*)[3])r->face;
    BRIO_REQUIRE(ctx, !r->take(&part, s->tile, r->user), BRIO_ERR_CANCELLED,
                 "alpha shape: the caller's function ended the run");
done:
    brio_release(ctx, v.points);
    brio_release(ctx, v.index);
    brio_release(ctx, v.shared);
    return status;
}

static brio_status run_tile(alpha_run *r, const brio_halo_reader *halo, uint32_t tile, brio_bar bar, uint64_t *done) {
    brio_slabs s;
    brio_status status = BRIO_OK;
    double all = (double)(r->t->stats.vertices + 1);
    r->num_faces = 0;
    BRIO_TRY(brio_slabs_open(r->t, tile, halo, &s));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->t->ctx, r->shared, s.num_rows + 1));
    for (size_t slab = 0; slab < s.count; slab++) {
        uint64_t next = *done + r->t->tile[tile].vertices / s.count;
        brio_progress_part(r->t->ctx, bar, (double)*done / all, (double)next / all);
        BRIO_TRY(run_slab(r, &s, slab));
        *done = next;
    }
    status = give_faces(r, &s);
done:
    brio_release(r->t->ctx, r->shared);
    r->shared = NULL;
    brio_slabs_free(&s);
    return status;
}

/* --- the public function --- */

static brio_status check_call(brio_context *ctx, const brio_tiles *t, double alpha) {
    BRIO_EXPECT(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_EXPECT(ctx, t->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(ctx, t->stars, BRIO_ERR_ARGUMENT, "the tiles have no stars: brio_tiles_options asks for them");
    BRIO_EXPECT(ctx, !isnan(alpha), BRIO_ERR_ARGUMENT, "alpha is NaN");
    BRIO_EXPECT(ctx, t->stats.dimension == 3, BRIO_ERR_NO_ANSWER,
                "%llu vertices (%llu points are hidden) of dimension %d have no tetrahedra, so no alpha complex",
                (unsigned long long)t->stats.vertices, (unsigned long long)t->stats.hidden, t->stats.dimension);
    return BRIO_OK;
}

static brio_status run_all(alpha_run *r) {
    brio_context *ctx = r->t->ctx;
    const brio_halo_reader halo = brio_tile_own_halo(r->t);
    brio_bar bar = brio_progress_bar(ctx);
    brio_status status = BRIO_OK;
    uint64_t done = 0;
    for (uint32_t i = 0; i < r->t->num_tiles; i++)
        if (r->t->tile[i].points) BRIO_TRY(run_tile(r, &halo, i, bar, &done));
    BRIO_REQUIRE(ctx, r->stats.tetrahedra > 0, BRIO_BECAUSE(ctx, NO_VALUE, BRIO_ERR_NO_ANSWER),
                 "no tetrahedron has a value of at most alpha = %g", r->alpha);
    status = brio_refuse_small_alpha(ctx, r->greatest, r->alpha);
done:
    brio_progress_part(ctx, bar, 0, 1);
    return status;
}

brio_status brio_tiles_alpha(brio_context *ctx, brio_tiles *t, double alpha, brio_tile_faces_fn take, void *user,
                             brio_tiles_alpha_stats *stats) {
    BRIO_DOOR;
    alpha_run r = {.t = t, .alpha = alpha, .take = take, .user = user, .stats = {.size = sizeof r.stats}};
    BRIO_FORWARD(BRIO_CHECK_RESULT(ctx, brio_tiles_alpha_stats, stats));
    BRIO_FORWARD(check_call(ctx, t, alpha));
    brio_status status = run_all(&r);
    brio_release(ctx, r.face);
    brio_release(ctx, r.order);
    brio_release(ctx, r.number);
    brio_release(ctx, r.points);
    brio_release(ctx, r.weights);
    brio_release(ctx, r.own);
    BRIO_GIVE(brio_tiles_alpha_stats, stats, &r.stats);
    return status;
}
