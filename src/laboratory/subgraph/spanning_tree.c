/* Spanning trees of a graph: breadth-first, and minimum by length.
 *
 * The minimum spanning tree takes the edges by length, shortest first, and keeps each edge that joins two trees. A
 * union-find holds the trees. A radix sort sorts the edges, so the union-find is the only part above linear time, by
 * at most a logarithm.
 *
 * Based on: Kruskal. On the shortest spanning subtree of a graph and the traveling salesman problem. Proceedings of
 * the American Mathematical Society 1956. */
#include "base/scale.h"
#include "base/sort.h"
#include "mesh/edge_rings.h"
#include "laboratory/subgraph/spanning_subgraph.h"
#include "base/memory.h"
#include "base/union_find.h"
#include <math.h>

brio_status brio_mesh_edges(brio_context *ctx, const brio_mesh *mesh, brio_edges *out) {
    brio_status status = BRIO_OK;
    const uint64_t *offsets = mesh->face_offsets;
    const uint32_t *v = mesh->face_vertices;
    uint32_t *ring = NULL;
    size_t count = 0;
    *out = (brio_edges){.context = ctx};
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(brio_edge_rings(ctx, mesh, &ring));
    /* the last half-edge of each edge has ring[h] <= h; it represents the edge */
    for (size_t h = 0, end = mesh->num_faces ? offsets[mesh->num_faces] : 0; h < end; h++) count += ring[h] <= h;
    BRIO_TRY(BRIO_ALLOC(ctx, out->ends, 2 * count));
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
            uint32_t end = v[h + 1 < offsets[f + 1] ? h + 1 : offsets[f]];
            if (ring[h] > h || v[h] == end) continue; /* a corner repeated makes no edge */
            out->ends[2 * out->count] = v[h];
            out->ends[2 * out->count++ + 1] = end;
        }
done:
    brio_release(ctx, ring);
    return status;
}

static brio_status check_edges(brio_context *ctx, const brio_edges *edges, size_t num_vertices) {
    BRIO_EXPECT(ctx, edges->count < UINT32_MAX / 2 && num_vertices <= UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "%zu edges of %zu vertices are more than 32-bit indices can name", edges->count, num_vertices);
    for (size_t i = 0; i < 2 * edges->count; i++)
        BRIO_EXPECT(ctx, edges->ends[i] < num_vertices, BRIO_ERR_ARGUMENT, "edge %zu: vertex %u of %zu vertices", i / 2,
                    edges->ends[i], num_vertices);
    return BRIO_OK;
}

/* Allocates a forest: fewer edges than vertices, and at most the edges of the graph. */
static brio_status start_forest(brio_context *ctx, const brio_edges *edges, size_t num_vertices, brio_edges *out) {
    size_t most = edges->count < num_vertices ? edges->count : num_vertices;
    *out = (brio_edges){.context = ctx};
    return BRIO_ALLOC(ctx, out->ends, 2 * most);
}

static void add_edge(brio_edges *edges, uint32_t a, uint32_t b) {
    edges->ends[2 * edges->count] = a;
    edges->ends[2 * edges->count++ + 1] = b;
}

/* --- breadth first --- */

/* Lists the neighbours of all vertices; the neighbours of v are at start[v] to start[v + 1] - 1.   start  #V + 2,
 * zeroed.   neighbours  2 #edges. */
static void list_neighbours(const brio_edges *edges, size_t num_vertices, uint32_t *start, uint32_t *neighbours) {
    for (size_t i = 0; i < 2 * edges->count; i++) start[edges->ends[i] + 2]++;
    for (size_t v = 0; v < num_vertices; v++) start[v + 2] += start[v + 1];
    for (size_t i = 0; i < 2 * edges->count; i++) neighbours[start[edges->ends[i] + 1]++] = edges->ends[i ^ 1];
}

/* Adds the breadth-first tree from root. The edges already found are the queue: their children are searched in
 * order. */
static void search_from(uint32_t root, const uint32_t *start, const uint32_t *neighbours, uint8_t *seen,
                        brio_edges *out) {
    size_t head = out->count;
    uint32_t v = root;
    seen[root] = 1;
    for (;;) {
        for (uint32_t i = start[v]; i < start[v + 1]; i++) {
            if (seen[neighbours[i]]) continue;
            seen[neighbours[i]] = 1;
            add_edge(out, v, neighbours[i]);
        }
        if (head == out->count) return;
        v = out->ends[2 * head++ + 1];
    }
}

brio_status brio_breadth_first_tree(brio_context *ctx, const brio_edges *edges, size_t num_vertices, brio_edges *out) {
    brio_status status = BRIO_OK;
    uint32_t *start = NULL, *neighbours = NULL;
    uint8_t *seen = NULL;
    *out = (brio_edges){.context = ctx};
    BRIO_TRY(check_edges(ctx, edges, num_vertices));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, start, num_vertices + 2));
    BRIO_TRY(BRIO_ALLOC(ctx, neighbours, 2 * edges->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, seen, num_vertices));
    BRIO_TRY(start_forest(ctx, edges, num_vertices, out));
    list_neighbours(edges, num_vertices, start, neighbours);
    for (size_t v = 0; v < num_vertices; v++)
        if (!seen[v]) search_from((uint32_t)v, start, neighbours, seen, out);
    BRIO_TRY(BRIO_RESIZE(ctx, out->ends, 2 * out->count));
done:
    brio_release(ctx, start);
    brio_release(ctx, neighbours);
    brio_release(ctx, seen);
    if (status != BRIO_OK) brio_edges_free(out);
    return status;
}

/* --- minimum by length --- */

/* Returns the exponent of a power of two that scales the longest edge to about 1, so that squares neither overflow nor
 * underflow. */
static int scale_of(const brio_edges *edges, const double *points) {
    double longest = 0;
    for (size_t e = 0; e < edges->count; e++) {
        const double *a = points + 3 * (size_t)edges->ends[2 * e], *b = points + 3 * (size_t)edges->ends[2 * e + 1];
        for (int k = 0; k < 3; k++) longest = fmax(longest, fabs(a[k] / 2 - b[k] / 2));
    }
    return -brio_exponent(longest);
}

static double squared_length(const double *a, const double *b, int scale) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double d = ldexp(a[k] / 2 - b[k] / 2, scale);
        sum += d * d;
    }
    return sum;
}

static void join_by_length(const brio_edges *edges, const uint32_t *order, uint32_t *parent, brio_edges *out) {
    for (size_t i = 0; i < edges->count; i++) {
        const uint32_t *ends = edges->ends + 2 * (size_t)order[i];
        if (brio_find(parent, ends[0]) == brio_find(parent, ends[1])) continue;
        brio_unite(parent, ends[0], ends[1], true);
        add_edge(out, ends[0], ends[1]);
    }
}

brio_status brio_minimum_spanning_tree(brio_context *ctx, const brio_edges *edges, const double *points,
                                       size_t num_vertices, brio_edges *out) {
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    uint32_t *order = NULL, *parent = NULL;
    *out = (brio_edges){.context = ctx};
    BRIO_TRY(check_edges(ctx, edges, num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, keys, edges->count));
    BRIO_TRY(BRIO_ALLOC(ctx, order, edges->count));
    BRIO_TRY(BRIO_ALLOC(ctx, parent, num_vertices));
    BRIO_TRY(start_forest(ctx, edges, num_vertices, out));
    int scale = scale_of(edges, points);
    for (size_t e = 0; e < edges->count; e++) {
        const uint32_t *ends = edges->ends + 2 * e;
        keys[e] = brio_double_key(squared_length(points + 3 * (size_t)ends[0], points + 3 * (size_t)ends[1], scale));
        order[e] = (uint32_t)e;
    }
    BRIO_TRY(brio_radix_sort(ctx, keys, order, edges->count, 64));
    for (size_t v = 0; v < num_vertices; v++) parent[v] = (uint32_t)v;
    join_by_length(edges, order, parent, out);
    BRIO_TRY(BRIO_RESIZE(ctx, out->ends, 2 * out->count));
done:
    brio_release(ctx, keys);
    brio_release(ctx, order);
    brio_release(ctx, parent);
    if (status != BRIO_OK) brio_edges_free(out);
    return status;
}
