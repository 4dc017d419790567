/* The Euclidean minimum spanning tree of points: the shortest edges of the Delaunay triangulation that join all points.
 *
 * Some minimum spanning tree consists of Delaunay edges, whatever the ties. They are taken by length, shortest first,
 * each that joins two trees [Kruskal 1956]. Lengths are compared exactly, and edges of one length by the positions of
 * their ends. The Delaunay triangulation is that of the points alone, so the tree is, too: the same for every order of
 * the points.
 *
 * A radix sort puts the edges in order by rounded lengths; only runs of nearly equal ones are compared exactly.
 *
 * Based on: Shamos, Hoey. Closest-point problems. FOCS 1975.
 *           Kruskal. On the shortest spanning subtree of a graph and the traveling salesman problem. Proc. AMS 1956. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/union_find.h"
#include "base/versioned.h"
#include "curve/samples_mesh.h"
#include "predicates/lengths.h"
#include "predicates/predicates.h"
#include <math.h>
#include <string.h>

/* Lengths nearer than this share of them may be equal: eight units of rounding and a reserve. */
static const double NEARLY = 1 + 0x1p-46;

typedef struct {
    brio_context *ctx;
    const double *points;
    size_t num_points;
    brio_edges edges; /* Delaunay edges, the lexicographically lesser end first */
    uint32_t *order;  /* of the edges */
    uint32_t *representative;
    uint64_t exact_calls;
    int dimension;
} tree;

static const double *end_of(const tree *t, uint32_t edge, int k) {
    return t->points + 3 * (size_t)t->edges.ends[2 * (size_t)edge + (size_t)k];
}

/* --- the edges --- */

static brio_status copy_representatives(tree *t, const uint32_t *from) {
    brio_status status = BRIO_ALLOC(t->ctx, t->representative, t->num_points);
    if (status == BRIO_OK) memcpy(t->representative, from, t->num_points * sizeof *from);
    return status;
}

/* Lists the edges of the triangles, each where it is met first. */
static void list_triangles(const brio_triangulation2 *t, brio_edges *out) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    size_t count = brio_triangulation2_stats(t)->triangles;
    for (size_t f = 0; f < count; f++)
        for (uint32_t i = 0; i < 3; i++) {
            if (4 * (uint32_t)f + i > triangle[f].mate[i]) continue;
            out->ends[2 * out->count] = triangle[f].vertex[(i + 1) % 3];
            out->ends[2 * out->count++ + 1] = triangle[f].vertex[(i + 2) % 3];
        }
}

static brio_status take_flat_edges(tree *t) {
    brio_status status = BRIO_OK;
    brio_triangulation2 *plane = NULL;
    size_t count;
    BRIO_TRY(brio_delaunay2_flat(t->ctx, t->points, NULL, t->num_points, NULL, &plane));
    const brio_delaunay2_stats *s = brio_triangulation2_stats(plane);
    const uint32_t *line = brio_triangulation2_line(plane, &count);
    BRIO_TRY(copy_representatives(t, brio_triangulation2_representatives(plane)));
    t->edges = (brio_edges){.context = t->ctx};
    BRIO_TRY(BRIO_ALLOC(t->ctx, t->edges.ends, 2 * (3 * s->triangles + count)));
    list_triangles(plane, &t->edges);
    for (size_t i = 0; i + 1 < count; i++) {
        t->edges.ends[2 * t->edges.count] = line[i];
        t->edges.ends[2 * t->edges.count++ + 1] = line[i + 1];
    }
done:
    brio_triangulation2_free(plane);
    return status;
}

static brio_status take_edges(tree *t) {
    brio_status status = BRIO_OK;
    brio_triangulation *space = NULL;
    BRIO_TRY(brio_delaunay(t->ctx, t->points, NULL, t->num_points, NULL, &space));
    t->dimension = brio_triangulation_stats(space)->dimension;
    if (t->dimension == 3) {
        BRIO_TRY(copy_representatives(t, brio_triangulation_representatives(space)));
        BRIO_TRY(brio_triangulation_edges(t->ctx, space, &t->edges));
    } else {
        brio_triangulation_free(space);
        space = NULL;
        BRIO_TRY(take_flat_edges(t));
    }
    BRIO_REQUIRE(t->ctx, t->edges.count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu edges; at most 2^32 - 2",
                 t->edges.count);
    for (uint32_t e = 0; e < t->edges.count; e++) {
        uint32_t *ends = t->edges.ends + 2 * (size_t)e, first = ends[0];
        if (brio_lexicographic(end_of(t, e, 0), end_of(t, e, 1)) <= 0) continue;
        ends[0] = ends[1], ends[1] = first;
    }
done:
    brio_triangulation_free(space);
    return status;
}

/* --- their order --- */

static int compare_edges(uint32_t a, uint32_t b, const void *user) {
    tree *t = (tree *)user;
    int sign =
        brio_compare_lengths(end_of(t, a, 0), end_of(t, a, 1), end_of(t, b, 0), end_of(t, b, 1), &t->exact_calls);
    for (int k = 0; k < 2 && !sign; k++) sign = brio_lexicographic(end_of(t, a, k), end_of(t, b, k));
    return sign;
}

/* Returns the length, times a power of two, rounded. */
static double rounded_length(const tree *t, uint32_t e, int exponent) {
    const double *a = end_of(t, e, 0), *b = end_of(t, e, 1);
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = ldexp(a[k], -exponent) - ldexp(b[k], -exponent);
    return hypot(hypot(d[0], d[1]), d[2]);
}

static brio_status sort_edges(tree *t) {
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    double *length = NULL;
    size_t n = t->edges.count;
    int exponent = brio_exponent(brio_greatest(t->points, 3 * t->num_points));
    BRIO_TRY(BRIO_ALLOC(t->ctx, keys, n));
    BRIO_TRY(BRIO_ALLOC(t->ctx, length, n));
    BRIO_TRY(BRIO_ALLOC(t->ctx, t->order, n));
    for (size_t e = 0; e < n; e++) {
        length[e] = rounded_length(t, (uint32_t)e, exponent);
        keys[e] = brio_double_key(length[e]);
        t->order[e] = (uint32_t)e;
        BRIO_TRY(brio_look(t->ctx, 1));
    }
    BRIO_TRY(brio_radix_sort(t->ctx, keys, t->order, n, 64));
    for (size_t i = 0, end; i < n; i = end) {
        for (end = i + 1; end < n; end++)
            if (length[t->order[end]] > NEARLY * length[t->order[end - 1]] + 0x1p-1000) break;
        if (end > i + 1) BRIO_TRY(brio_sort_many_indices(t->ctx, t->order + i, end - i, compare_edges, t));
    }
done:
    brio_release(t->ctx, keys);
    brio_release(t->ctx, length);
    return status;
}

/* --- the tree --- */

/* Writes the edges of the tree to the front of the list `chosen`, as vertices of the mesh, and their number. */
static brio_status join_by_length(const tree *t, const uint32_t *vertex, uint32_t *parent, uint32_t *chosen,
                                  size_t *joined) {
    size_t count = 0;
    for (size_t i = 0; i < t->edges.count; i++) {
        const uint32_t *ends = t->edges.ends + 2 * (size_t)t->order[i];
        BRIO_FORWARD(brio_look(t->ctx, 1));
        if (brio_find(parent, ends[0]) == brio_find(parent, ends[1])) continue;
        brio_unite(parent, ends[0], ends[1], true);
        chosen[2 * count] = vertex[ends[0]];
        chosen[2 * count++ + 1] = vertex[ends[1]];
    }
    *joined = count;
    return BRIO_OK;
}

static brio_status make_mesh(const tree *t, brio_mesh **out) {
    brio_status status = BRIO_OK;
    uint32_t *vertex = NULL, *parent = NULL, *chosen = NULL;
    size_t count;
    BRIO_TRY(BRIO_ALLOC(t->ctx, vertex, t->num_points));
    BRIO_TRY(BRIO_ALLOC(t->ctx, parent, t->num_points));
    BRIO_TRY(BRIO_ALLOC(t->ctx, chosen, 2 * t->num_points));
    for (size_t i = 0; i < t->num_points; i++) {
        vertex[i] = t->representative[i] == i ? 0 : BRIO_INFINITE;
        parent[i] = (uint32_t)i;
    }
    BRIO_TRY(brio_samples_mesh(t->ctx, t->points, t->num_points, vertex, out));
    BRIO_TRY(join_by_length(t, vertex, parent, chosen, &count));
    BRIO_TRY(brio_mesh_set_edges(*out, chosen, count));
done:
    brio_release(t->ctx, vertex);
    brio_release(t->ctx, parent);
    brio_release(t->ctx, chosen);
    return status;
}

static double length_of(const brio_mesh *mesh) {
    double sum = 0;
    for (size_t e = 0; e < mesh->num_edges; e++) {
        const double *a = mesh->vertices + 3 * (size_t)mesh->edges[2 * e];
        const double *b = mesh->vertices + 3 * (size_t)mesh->edges[2 * e + 1];
        sum += hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
    }
    return sum;
}

brio_status brio_spanning_tree(brio_context *ctx, const double *points, size_t num_points, brio_mesh **out,
                               brio_spanning_tree_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    tree t = {.ctx = ctx, .points = points, .num_points = num_points};
    brio_spanning_tree_stats mine = {.points = num_points};
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_spanning_tree_stats, stats));
    double start = brio_seconds();
    BRIO_TRY(take_edges(&t));
    mine.delaunay_seconds = brio_seconds() - start;
    BRIO_TRY(sort_edges(&t));
    BRIO_TRY(make_mesh(&t, out));
    mine.vertices = (*out)->num_vertices;
    mine.edges = (*out)->num_edges;
    mine.length = length_of(*out);
    mine.dimension = t.dimension;
    mine.exact_calls = t.exact_calls;
    mine.tree_seconds = brio_seconds() - start - mine.delaunay_seconds;
    BRIO_GIVE(brio_spanning_tree_stats, stats, &mine);
done:
    brio_edges_free(&t.edges);
    brio_release(ctx, t.order);
    brio_release(ctx, t.representative);
    if (status != BRIO_OK) brio_mesh_free(*out), *out = NULL;
    return status;
}
