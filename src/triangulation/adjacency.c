/* Adjacency of tetrahedra from their vertices alone.
 *
 * Simplices of one dimension are matched by their sorted vertices: a counting sort by the smallest vertex, then a small
 * sort in each bucket brings the two sides of a facet, or of a hull edge, next to each other. */
#include "triangulation/adjacency.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/sort.h"
#include <assert.h>
#include <string.h>

/* Writes the vertices of a handle in ascending order: three of a facet, or two of a hull edge (facet of an infinite
 * tetrahedron). */
static void sorted_vertices(const brio_tetrahedra *t, uint32_t handle, uint32_t v[3]) {
    const uint32_t *tet = t->tet[brio_tet_of(handle)].vertex;
    const uint8_t *f = BRIO_FACET[brio_slot_of(handle)];
    uint32_t a = tet[f[0]], b = tet[f[1]], c = tet[f[2]], swap;
    assert(brio_has_tet(t, brio_tet_of(handle)));
    if (a > b) swap = a, a = b, b = swap;
    if (b > c) swap = b, b = c, c = swap;
    if (a > b) swap = a, a = b, b = swap;
    v[0] = a, v[1] = b, v[2] = c;
}

static int compare_handles(uint32_t g, uint32_t h, const void *user) {
    uint32_t v[3], w[3];
    sorted_vertices(user, g, v);
    sorted_vertices(user, h, w);
    for (int i = 0; i < 3; i++)
        if (v[i] != w[i]) return v[i] < w[i] ? -1 : 1;
    return g < h ? -1 : g > h;
}

static bool same_vertices(const brio_tetrahedra *t, uint32_t g, uint32_t h) {
    uint32_t v[3], w[3];
    sorted_vertices(t, g, v);
    sorted_vertices(t, h, w);
    return v[0] == w[0] && v[1] == w[1] && v[2] == w[2];
}

/* Sorts handles by their vertices. */
static brio_status sort_handles(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, const uint32_t *handles,
                                size_t n, uint32_t *sorted) {
    size_t *end = NULL;
    brio_status status = BRIO_ALLOC_ZERO(ctx, end, num_points + 1);
    if (status != BRIO_OK) return status;
    uint32_t v[3];
    for (size_t i = 0; i < n; i++) {
        BRIO_TRY(brio_look(ctx, 1));
        sorted_vertices(t, handles[i], v), end[v[0]]++;
    }
    brio_counts_to_places(end, 1, num_points, 0);
    for (size_t i = 0; i < n; i++) {
        BRIO_TRY(brio_look(ctx, 1));
        sorted_vertices(t, handles[i], v), sorted[end[v[0]]++] = handles[i];
    }
    for (size_t b = 0, begin = 0; b < num_points; begin = end[b++]) {
        BRIO_TRY(brio_look(ctx, end[b] - begin));
        BRIO_TRY(brio_sort_many_indices(ctx, sorted + begin, end[b] - begin, compare_handles, t));
    }
done:
    brio_release(ctx, end);
    return status;
}

/* Makes equal neighbours in a sorted list mates; those without one go to the front of the list, *alone of them. */
static brio_status match(brio_context *ctx, brio_tetrahedra *t, uint32_t *sorted, size_t n, size_t *alone) {
    *alone = 0;
    for (size_t i = 0; i < n; i++) {
        bool pair = i + 1 < n && same_vertices(t, sorted[i], sorted[i + 1]);
        BRIO_FORWARD(brio_look(ctx, 1));
        if (!pair) {
            sorted[(*alone)++] = sorted[i];
            continue;
        }
        BRIO_EXPECT(ctx, i + 2 >= n || !same_vertices(t, sorted[i], sorted[i + 2]), BRIO_ERR_CHECK,
                    "tetrahedra %u, %u and %u share a facet", brio_tet_of(sorted[i]), brio_tet_of(sorted[i + 1]),
                    brio_tet_of(sorted[i + 2]));
        assert(*alone <= i); /* handles left alone are written behind those that are read */
        *brio_mate(t, sorted[i]) = sorted[i + 1];
        *brio_mate(t, sorted[i + 1]) = sorted[i];
        i++;
    }
    return BRIO_OK;
}

/* Copies the vertices, each tetrahedron made positive. */
static brio_status copy_positive(brio_context *ctx, const brio_record *r, size_t num_points,
                                 const brio_tetrahedron_list *from, brio_tetrahedron *to) {
    for (size_t tet = 0; tet < from->count; tet++) {
        uint32_t *v = to[tet].vertex;
        memcpy(v, from->vertices + from->stride * tet, 4 * sizeof *v);
        for (int i = 0; i < 4; i++)
            BRIO_EXPECT(ctx, v[i] < num_points, BRIO_ERR_CHECK, "tetrahedron %zu: no point %u", tet, v[i]);
        int sign = brio_orient3d(r[v[0]], r[v[1]], r[v[2]], r[v[3]]);
        BRIO_EXPECT(ctx, sign != 0, BRIO_ERR_CHECK, "tetrahedron %zu (%u %u %u %u) is flat", tet, v[0], v[1], v[2],
                    v[3]);
        if (sign < 0) {
            uint32_t swap = v[2];
            v[2] = v[3], v[3] = swap;
        }
    }
    return BRIO_OK;
}

/* Makes an infinite tetrahedron behind each hull facet.   edges  receives the handles of its three facets through the
 * infinite vertex. */
static void close_hull(brio_tetrahedra *t, size_t first, const uint32_t *hull, size_t num_hull, uint32_t *edges) {
    for (size_t i = 0; i < num_hull; i++) {
        uint32_t tet = (uint32_t)(first + i), *v = t->tet[tet].vertex;
        const uint32_t *inside = t->tet[brio_tet_of(hull[i])].vertex;
        const uint8_t *f = BRIO_FACET[brio_slot_of(hull[i])];
        v[0] = inside[f[0]], v[1] = inside[f[2]], v[2] = inside[f[1]], v[3] = BRIO_INFINITE;
        assert(brio_has_tet(t, tet));
        t->tet[tet].mate[3] = hull[i];
        *brio_mate(t, hull[i]) = brio_facet_of(tet, 3);
        for (int j = 0; j < 3; j++) edges[3 * i + (size_t)j] = brio_facet_of(tet, j);
    }
}

brio_status brio_adjacency_build(brio_context *ctx, const brio_record *record, size_t num_points,
                                 const brio_tetrahedron_list *tetrahedra, brio_tetrahedra *out) {
    brio_status status = BRIO_OK;
    size_t n = tetrahedra->count;
    brio_tetrahedra t = {.infinite = BRIO_INFINITE, .record = record};
    uint32_t *handles = NULL, *sorted = NULL, *edges = NULL;
    size_t num_hull = 0, alone = 0;
    BRIO_REQUIRE(ctx, n < UINT32_C(1) << 29, BRIO_ERR_TOO_LARGE, "%zu tetrahedra; at most 2^29 - 1", n);
    BRIO_TRY(BRIO_ALLOC(ctx, t.tet, n));
    t.count = n;
    BRIO_TRY(copy_positive(ctx, record, num_points, tetrahedra, t.tet));
    BRIO_TRY(BRIO_ALLOC(ctx, handles, 4 * n));
    BRIO_TRY(BRIO_ALLOC(ctx, sorted, 4 * n));
    for (size_t h = 0; h < 4 * n; h++) handles[h] = (uint32_t)h;
    BRIO_TRY(sort_handles(ctx, &t, num_points, handles, 4 * n, sorted));
    BRIO_TRY(match(ctx, &t, sorted, 4 * n, &num_hull));
    t.count = n + num_hull;
    BRIO_REQUIRE(ctx, t.count <= (size_t)1 << 30, BRIO_ERR_TOO_LARGE,
                 "%zu tetrahedra, infinite ones included; at most 2^30", t.count);
    BRIO_TRY(BRIO_RESIZE(ctx, t.tet, t.count));
    BRIO_TRY(BRIO_ALLOC(ctx, edges, 3 * num_hull));
    close_hull(&t, n, sorted, num_hull, edges);
    BRIO_TRY(BRIO_RESIZE(ctx, sorted, 3 * num_hull));
    BRIO_TRY(sort_handles(ctx, &t, num_points, edges, 3 * num_hull, sorted));
    BRIO_TRY(match(ctx, &t, sorted, 3 * num_hull, &alone));
    BRIO_REQUIRE(ctx, alone == 0, BRIO_ERR_CHECK, "the hull is open at facet %u of tetrahedron %u",
                 (unsigned)brio_slot_of(sorted[0]), brio_tet_of(sorted[0]));
    *out = t;
    t.tet = NULL;
done:
    brio_release(ctx, t.tet);
    brio_release(ctx, handles);
    brio_release(ctx, sorted);
    brio_release(ctx, edges);
    return status;
}
