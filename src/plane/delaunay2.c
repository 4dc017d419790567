/* Delaunay and regular triangulation of the plane: order the points, insert them one by one, number the result.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "plane/plane_insert.h"
#include "plane/plane_nearest.h"
#include "plane/plane_start.h"
#include "plane/plane_store.h"
#include "plane/triangulation2.h"
#include <assert.h>

/* --- points that are no vertices --- */

/* Gives each point that owns no cell the vertex that represents it.
 *
 * Without weights such a point is a duplicate, and insertion has named its vertex. With weights the point that hid it
 * may have been hidden later, and a vertex at its place may have come after it. So each such point is located in the
 * finished triangulation. A point at the place of a vertex is a duplicate; any other point is hidden, and descent finds
 * its vertex of least power distance. The apex of points on a line is skipped: the edges along the line suffice. */

typedef struct {
    brio_plane_store *store;
    brio_plane_view view;
    uint32_t *corner; /* a triangle of each vertex */
    uint32_t *hidden;
    size_t num_hidden;
} workspace;

/* Finds a triangle of each vertex. Overwrites slots without a triangle: they have no vertices. */
static void find_corners(workspace *w) {
    brio_plane_store *s = w->store;
    for (size_t i = 0; i < s->unused.count; i++)
        for (int k = 0; k < 3; k++) s->triangle[s->unused.item[i]].vertex[k] = s->infinite;
    for (size_t t = 0; t < s->count; t++)
        for (int k = 0; k < 3; k++) w->corner[s->triangle[t].vertex[k]] = (uint32_t)t;
}

static void represent_one(workspace *w, uint32_t p) {
    brio_plane_store *s = w->store;
    const double *x = s->record[p];
    uint32_t start = w->corner[brio_plane_alive(s, p)];
    uint32_t t = brio_plane_walk(&w->view, &s->filter, start, x, &s->stats.walk_steps);
    assert(t < s->count && start < s->count);
    const uint32_t *v = s->triangle[t].vertex;
    for (int i = 0; i < 3; i++)
        if (v[i] < s->num_points && brio_same_place(s->record[v[i]], x)) {
            s->representative[p] = v[i];
            s->stats.duplicates++;
            return;
        }
    brio_plane_nearest nearest = {&w->view, &s->filter, s->num_points, w->corner};
    s->representative[p] = brio_plane_nearest_vertex(&nearest, t, x);
    assert(s->representative[p] < s->num_points);
    w->hidden[w->num_hidden++] = p;
}

static int compare_places(uint32_t p, uint32_t q, const void *user) {
    const brio_plane_store *s = user;
    return brio_plane_lexicographic(&s->filter, s->record[p], s->record[q]);
}

/* Counts hidden points at one place once. */
static void count_hidden(workspace *w) {
    brio_plane_store *s = w->store;
    brio_sort_indices(w->hidden, w->num_hidden, compare_places, s);
    for (size_t i = 0; i < w->num_hidden; i++) {
        bool again = i > 0 && brio_same_place(s->record[w->hidden[i - 1]], s->record[w->hidden[i]]);
        if (again)
            s->stats.duplicates++;
        else
            s->stats.hidden++;
    }
}

static brio_status represent_weighted(brio_plane_store *s) {
    workspace w = {s, {s->triangle, (const brio_plane_record *)s->record, s->infinite}, NULL, NULL, 0};
    brio_status status = BRIO_OK;
    size_t not_vertices = 0;
    for (uint32_t p = 0; p < s->num_points; p++) not_vertices += s->representative[p] != p;
    if (!not_vertices) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(s->ctx, w.hidden, not_vertices));
    BRIO_TRY(BRIO_ALLOC(s->ctx, w.corner, s->num_points + 2));
    find_corners(&w);
    for (uint32_t p = 0; p < s->num_points; p++)
        if (s->representative[p] != p) represent_one(&w, p);
    count_hidden(&w);
done:
    brio_release(s->ctx, w.corner);
    brio_release(s->ctx, w.hidden);
    return status;
}

/* Represents points that are all at one place: the heaviest represents the others; among equal weights, the one with
 * the lowest index. */
static void represent_coincident(brio_plane_store *s) {
    uint32_t best = 0;
    for (uint32_t p = 1; p < s->num_points; p++) {
        double more = s->record[p][3] - s->record[best][3];
        if (more > 0 || (more == 0 && s->caller[p] < s->caller[best])) best = p;
    }
    for (uint32_t p = 0; p < s->num_points; p++) s->representative[p] = best;
    s->stats.duplicates = s->num_points - 1;
}

/* Gives each record that is no vertex the vertex that represents it. Sets the numbers of vertices, duplicates and
 * hidden
 *  points. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
static brio_status plane_represent(brio_plane_store *s) {
    brio_status status = BRIO_OK;
    if (s->dimension == 0)
        represent_coincident(s);
    else if (s->weighted && s->dimension > 0)
        status = represent_weighted(s);
    else
        for (uint32_t p = 0; p < s->num_points; p++) s->stats.duplicates += s->representative[p] != p;
    assert(s->stats.duplicates + s->stats.hidden <= s->num_points);
    s->stats.vertices = s->num_points - s->stats.duplicates - s->stats.hidden;
    return status;
}

/* --- the triangulation --- */

enum { PROGRESS_EVERY = 1 << 14 };

/* Inserts the records after those of the first triangle. */
static brio_status insert_all(brio_plane_store *s) {
    brio_status status = BRIO_OK;
    size_t n = s->num_points;
    if (s->dimension <= 0) return BRIO_OK;
    for (size_t p = (size_t)s->dimension + 1, end; p < n; p = end) {
        BRIO_TRY(brio_progress(s->ctx, "insert", (double)p / (double)n));
        end = n - p < PROGRESS_EVERY ? n : p + PROGRESS_EVERY;
        BRIO_TRY(brio_plane_insert(s, p, end));
    }
    status = brio_progress(s->ctx, "insert", 1);
done:
    return status;
}

/* --- result --- */

/* Moves a triangle to a free slot. */
static void move_triangle(brio_triangle *t, uint32_t from, uint32_t to) {
    assert(from != to);
    t[to] = t[from];
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t g = t[to].mate[i];
        t[brio_triangle_of(g)].mate[brio_edge_slot(g)] = brio_edge_of(to, i);
    }
}

static void swap_triangles(brio_triangle *t, uint32_t a, uint32_t b, uint32_t free) {
    move_triangle(t, a, free);
    move_triangle(t, b, a);
    move_triangle(t, free, b);
}

/* Moves the last triangles to the unused slots. Unused slots have been named by their vertices. */
static void fill_unused(brio_plane_store *s) {
    brio_triangle *t = s->triangle;
    for (size_t i = 0; i < s->unused.count; i++) t[s->unused.item[i]].vertex[0] = s->infinite;
    for (size_t i = 0; i < s->unused.count; i++) {
        uint32_t to = s->unused.item[i];
        while (s->count > 0 && t[s->count - 1].vertex[0] == s->infinite) s->count--;
        if (to < s->count) move_triangle(t, (uint32_t)--s->count, to);
    }
}

/* Brings finite triangles before infinite ones. Slot `count` is free: the capacity is never used up. */
static void separate(brio_plane_store *s) {
    brio_triangle *t = s->triangle;
    uint32_t low = 0, high = (uint32_t)s->count, infinite = s->infinite;
    for (;;) {
        while (low < high && t[low].vertex[2] != infinite) low++;
        while (low < high && t[high - 1].vertex[2] == infinite) high--;
        if (low == high) break;
        assert(s->count < s->capacity); /* slot `count` is free */
        swap_triangles(t, low, high - 1, (uint32_t)s->count);
    }
    s->stats.triangles = low;
    s->stats.hull_edges = s->count - low;
}

#ifndef NDEBUG
/* Returns whether mates are mates of each other, and finite triangles come first (I2, I3). */
static bool result_is_valid(const brio_plane_store *s) {
    for (size_t t = 0; t < s->count; t++)
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t g = s->triangle[t].mate[i];
            if ((s->triangle[t].vertex[i] == s->infinite) != (t >= s->stats.triangles && i == 2)) return false;
            if (brio_triangle_of(g) >= s->count) return false;
            if (s->triangle[brio_triangle_of(g)].mate[brio_edge_slot(g)] != brio_edge_of((uint32_t)t, i)) return false;
        }
    return true;
}
#endif

/* Orders the triangles and gives their vertices the caller's names. */
static void number_result(brio_plane_store *s) {
    if (s->dimension < 2) {
        s->count = 0;
        return;
    }
    fill_unused(s);
    separate(s);
    assert(s->count == 2 * s->stats.vertices - 2); /* Euler's relation, infinite triangles included */
    assert(result_is_valid(s));
    for (size_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) s->triangle[i].vertex[k] = s->caller[s->triangle[i].vertex[k]];
}

/* Lists the vertices of points on a line. */
static brio_status list_line(const brio_plane_store *s, brio_triangulation2 *t) {
    size_t count = 0;
    brio_status status = BRIO_ALLOC(s->ctx, t->line, s->stats.vertices);
    if (status != BRIO_OK) return status;
    for (uint32_t p = 0; p < s->num_points; p++)
        if (s->representative[p] == p) t->line[count++] = p;
    status = brio_sort_many_indices(s->ctx, t->line, count, compare_places, s);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < count; i++) t->line[i] = s->caller[t->line[i]];
    assert(count == s->stats.vertices);
    t->line_count = count;
    return BRIO_OK;
}

static brio_status triangulation_new(brio_plane_store *s, brio_triangulation2 **out) {
    brio_triangulation2 *t = NULL;
    brio_status status = BRIO_OK;
    s->stats.dimension = s->dimension;
    s->stats.exact_calls = s->filter.unsettled;
    BRIO_TRY(BRIO_RESIZE(s->ctx, s->triangle, s->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, t, 1));
    t->ctx = s->ctx;
    if (s->dimension == 1) BRIO_TRY(list_line(s, t));
    brio_release(s->ctx, s->record); /* the room for the representatives */
    s->record = NULL;
    BRIO_TRY(BRIO_ALLOC(s->ctx, t->representative, s->num_points));
    for (size_t p = 0; p < s->num_points; p++) {
        assert(s->representative[s->representative[p]] == s->representative[p]); /* I6: a vertex */
        t->representative[s->caller[p]] = s->caller[s->representative[p]];
    }
    t->triangle = s->triangle;
    t->stats = s->stats;
    t->points_hash = s->points_hash;
    s->triangle = NULL;
    *out = t;
    t = NULL;
done:
    brio_triangulation2_free(t);
    return status;
}

static brio_status construct(brio_context *ctx, brio_plane_input *input, const brio_delaunay2_options *options,
                             double start, brio_triangulation2 **out) {
    brio_plane_store *s = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_plane_store_new(ctx, input, options, &s));
    double ordered = brio_seconds();
    s->stats.order_seconds = ordered - start;
    brio_plane_start(s);
    BRIO_TRY(insert_all(s));
    BRIO_TRY(plane_represent(s));
    number_result(s);
    s->stats.insert_seconds = brio_seconds() - ordered;
    BRIO_TRY(triangulation_new(s, out));
done:
    brio_plane_store_free(s);
    return status;
}

/* Triangulates points of two or three coordinates. */
static brio_status triangulate(brio_context *ctx, const brio_plane_input *given, const brio_delaunay2_options *options,
                               brio_triangulation2 **out) {
    brio_status status = BRIO_OK;
    brio_delaunay2_options o = {0};
    brio_plane_input input = {.own = NULL};
    size_t n = given->count;
    *out = NULL;
    brio_keep_begin(ctx);
    BRIO_TRY(BRIO_TAKE(ctx, brio_delaunay2_options, options, &o));
    if (!o.seed) o.seed = BRIO_SEED;
    BRIO_REQUIRE(ctx, n < (UINT32_C(1) << 29) - 16, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^29 - 17", n);
    BRIO_REQUIRE(ctx, o.round_ratio >= 0 && o.round_ratio < 1, BRIO_ERR_ARGUMENT,
                 "round ratio %g is not between 0 and 1", o.round_ratio);
    BRIO_REQUIRE(ctx, (unsigned)o.order < BRIO_ORDER_END, BRIO_ERR_ARGUMENT, "no insertion order %d", (int)o.order);
    double start = brio_seconds();
    BRIO_TRY(brio_plane_input_set(ctx, given->points, given->weights, n, given->coordinates, &input));
    BRIO_TRY(construct(ctx, &input, &o, start, out));
done:
    brio_plane_input_free(ctx, &input);
    brio_keep_end(ctx);
    return status;
}

brio_status brio_delaunay2(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                           const brio_delaunay2_options *options, brio_triangulation2 **out) {
    BRIO_DOOR;
    return triangulate(ctx, &(brio_plane_input){points, weights, num_points, 2, {0, 1, 2}, 0, NULL}, options, out);
}

brio_status brio_delaunay2_flat(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                const brio_delaunay2_options *options, brio_triangulation2 **out) {
    BRIO_DOOR;
    return triangulate(ctx, &(brio_plane_input){points, weights, num_points, 3, {0, 1, 2}, 0, NULL}, options, out);
}

void brio_triangulation2_free(brio_triangulation2 *t) {
    if (!t) return;
    brio_release(t->ctx, t->triangle);
    brio_release(t->ctx, t->representative);
    brio_release(t->ctx, t->line);
    brio_release(t->ctx, t);
}

const brio_delaunay2_stats *brio_triangulation2_stats(const brio_triangulation2 *t) {
    return &t->stats;
}
const brio_triangle *brio_triangulation2_triangles(const brio_triangulation2 *t) {
    return t->triangle;
}
const uint32_t *brio_triangulation2_representatives(const brio_triangulation2 *t) {
    return t->representative;
}
uint64_t brio_triangulation2_points_hash(const brio_triangulation2 *t) {
    return t->points_hash;
}
const uint32_t *brio_triangulation2_line(const brio_triangulation2 *t, size_t *count) {
    *count = t->line_count;
    return t->line;
}
