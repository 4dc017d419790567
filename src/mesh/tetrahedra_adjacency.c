/* Finds the neighbours and the edges of tetrahedra from their corners alone.
 *
 * Facets are put in a bucket for their least vertex, and tetrahedra in a bucket for each of their vertices. A bucket is
 * small, so that sorting what is in it is cheap. */
#include "mesh/tetrahedra_adjacency.h"
#include "base/memory.h"
#include "base/sort.h"
#include <string.h>

enum { REPORT = 1 << 16 /* vertices between two reports of progress; chosen */ };

#define MOST_TETRAHEDRA ((size_t)1 << 30)

const uint8_t brio_facet_corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* --- buckets --- */

/* Items by vertex: those of vertex v are items[offsets[v]] to items[offsets[v + 1] - 1]. An item is a corner 4*t + i,
 * which also names the facet opposite to it. */
typedef struct {
    uint32_t *offsets, *items;
    uint64_t *keys; /* room for the items of any vertex, to be sorted */
} buckets;

typedef uint32_t (*vertex_of_item)(const brio_mesh *m, uint32_t item);

static uint32_t own_vertex(const brio_mesh *m, uint32_t corner) {
    return m->tetrahedra[corner];
}

static void facet_vertices(const brio_mesh *m, uint32_t facet, uint32_t v[3]) {
    for (int k = 0; k < 3; k++) v[k] = m->tetrahedra[(facet & ~3u) + brio_facet_corners[facet & 3][k]];
}

static uint32_t least_vertex(const brio_mesh *m, uint32_t facet) {
    uint32_t v[3];
    facet_vertices(m, facet, v);
    uint32_t least = v[0] < v[1] ? v[0] : v[1];
    return least < v[2] ? least : v[2];
}

static brio_status fill_buckets(brio_context *ctx, const brio_mesh *m, vertex_of_item vertex, buckets *b) {
    size_t n = m->num_vertices, items = 4 * m->num_tetrahedra, largest = 0;
    BRIO_EXPECT(ctx, m->num_tetrahedra < MOST_TETRAHEDRA, BRIO_ERR_TOO_LARGE,
                "%zu tetrahedra, the neighbours of less than 2^30 can be found", m->num_tetrahedra);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, b->offsets, n + 2));
    BRIO_FORWARD(BRIO_ALLOC(ctx, b->items, items));
    /* the count of vertex v stands at v + 2, its next free place at v + 1, and in the end its bucket's begin at v */
    for (uint32_t i = 0; i < items; i++) b->offsets[vertex(m, i) + 2]++;
    for (size_t v = 0; v < n; v++) {
        if (b->offsets[v + 2] > largest) largest = b->offsets[v + 2];
        b->offsets[v + 2] += b->offsets[v + 1];
    }
    for (uint32_t i = 0; i < items; i++) b->items[b->offsets[vertex(m, i) + 1]++] = i;
    return BRIO_ALLOC(ctx, b->keys, 3 * largest);
}

static void free_buckets(brio_context *ctx, buckets *b) {
    brio_release(ctx, b->offsets);
    brio_release(ctx, b->items);
    brio_release(ctx, b->keys);
}

static brio_status report(brio_context *ctx, const brio_mesh *m, size_t v) {
    return v % REPORT ? BRIO_OK : brio_progress(ctx, "neighbours", (double)v / (double)m->num_vertices);
}

/* --- neighbours --- */

/* Finds the two greater vertices of a facet. */
static void greater_vertices(const brio_mesh *m, uint32_t facet, uint32_t least, uint32_t *middle, uint32_t *greatest) {
    uint32_t v[3];
    facet_vertices(m, facet, v);
    int i = v[0] == least ? 0 : v[1] == least ? 1 : 2;
    uint32_t a = v[(i + 1) % 3], b = v[(i + 2) % 3];
    *middle = a < b ? a : b;
    *greatest = a < b ? b : a;
}

/* Joins the facets in keys[0] to keys[n - 1], which have the two least vertices in common. A key is the facet's
 * greatest vertex, then its place among the items. */
static brio_status join_run(brio_context *ctx, const brio_mesh *m, const uint32_t *items, uint64_t *keys, size_t n,
                            uint32_t *neighbours) {
    brio_sort_keys(keys, n);
    for (size_t i = 0; i + 1 < n; i++) {
        if (keys[i] >> 32 != keys[i + 1] >> 32) continue;
        uint32_t f = items[(uint32_t)keys[i]], g = items[(uint32_t)keys[i + 1]];
        bool third = i + 2 < n && keys[i + 2] >> 32 == keys[i] >> 32;
        uint32_t v[3];
        facet_vertices(m, f, v);
        BRIO_EXPECT(ctx, !third, BRIO_ERR_ARGUMENT,
                    "the triangle %u %u %u is a facet of three tetrahedra or more, such as %u and %u", v[0], v[1], v[2],
                    f / 4, g / 4);
        neighbours[f] = g / 4;
        neighbours[g] = f / 4;
        i++;
    }
    return BRIO_OK;
}

/* Joins the facets whose least vertex is v. */
static brio_status join_bucket(brio_context *ctx, const brio_mesh *m, const buckets *b, uint32_t v,
                               uint32_t *neighbours) {
    const uint32_t *items = b->items + b->offsets[v];
    size_t n = b->offsets[v + 1] - b->offsets[v];
    uint32_t middle, greatest;
    for (uint32_t i = 0; i < n; i++) {
        greater_vertices(m, items[i], v, &middle, &greatest);
        b->keys[i] = (uint64_t)middle << 32 | i;
    }
    brio_sort_keys(b->keys, n);
    for (size_t i = 0, end; i < n; i = end) {
        uint64_t common = b->keys[i] >> 32;
        for (end = i; end < n && b->keys[end] >> 32 == common; end++) {
            greater_vertices(m, items[(uint32_t)b->keys[end]], v, &middle, &greatest);
            b->keys[end] = (uint64_t)greatest << 32 | (uint32_t)b->keys[end];
        }
        BRIO_FORWARD(join_run(ctx, m, items, b->keys + i, end - i, neighbours));
    }
    return BRIO_OK;
}

brio_status brio_tetrahedra_neighbours(brio_context *ctx, const brio_mesh *mesh, uint32_t **neighbours) {
    brio_status status = BRIO_OK;
    buckets b = {NULL, NULL, NULL};
    BRIO_TRY(BRIO_ALLOC(ctx, *neighbours, 4 * mesh->num_tetrahedra));
    memset(*neighbours, 0xff, 4 * mesh->num_tetrahedra * sizeof **neighbours);
    BRIO_TRY(fill_buckets(ctx, mesh, least_vertex, &b));
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        BRIO_TRY(report(ctx, mesh, v));
        BRIO_TRY(brio_look(ctx, b.offsets[v + 1] - b.offsets[v]));
        BRIO_TRY(join_bucket(ctx, mesh, &b, v, *neighbours));
    }
done:
    free_buckets(ctx, &b);
    if (status != BRIO_OK) {
        brio_release(ctx, *neighbours);
        *neighbours = NULL;
    }
    return status;
}

/* --- edges --- */

/* Collects the edges to greater vertices at vertex v as keys: the vertex, then 0 if the edge is on the hull. Returns
 * their number. */
static size_t edges_at(const brio_mesh *m, const uint32_t *neighbours, const buckets *b, uint32_t v) {
    size_t count = 0;
    for (size_t i = b->offsets[v]; i < b->offsets[v + 1]; i++) {
        const uint32_t corner = b->items[i], own = corner & 3, *t = m->tetrahedra + (corner & ~3u);
        const uint32_t *mate = neighbours + (corner & ~3u);
        for (uint32_t k = 0; k < 4; k++) {
            if (t[k] <= v) continue;
            bool inside = true;
            for (uint32_t f = 0; f < 4; f++) inside &= f == own || f == k || mate[f] != BRIO_INFINITE;
            b->keys[count++] = (uint64_t)t[k] << 32 | inside;
        }
    }
    return count;
}

brio_status brio_tetrahedra_edges_find(brio_context *ctx, const brio_mesh *mesh, const uint32_t *neighbours,
                                       brio_tetrahedra_edges *out) {
    brio_status status = BRIO_OK;
    buckets b = {NULL, NULL, NULL};
    *out = (brio_tetrahedra_edges){.ends = NULL};
    BRIO_TRY(fill_buckets(ctx, mesh, own_vertex, &b));
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        BRIO_TRY(report(ctx, mesh, v));
        BRIO_TRY(brio_look(ctx, b.offsets[v + 1] - b.offsets[v]));
        size_t count = edges_at(mesh, neighbours, &b, v);
        brio_sort_keys(b.keys, count);
        BRIO_TRY(BRIO_RESERVE(ctx, out->ends, out->ends_capacity, 2 * (out->count + count)));
        BRIO_TRY(BRIO_RESERVE(ctx, out->hull, out->hull_capacity, out->count + count));
        for (size_t i = 0; i < count; i++) {
            if (i && b.keys[i] >> 32 == b.keys[i - 1] >> 32) continue;
            out->ends[2 * out->count] = v;
            out->ends[2 * out->count + 1] = (uint32_t)(b.keys[i] >> 32);
            out->hull[out->count++] = !(b.keys[i] & 1);
        }
    }
done:
    free_buckets(ctx, &b);
    return status;
}

void brio_tetrahedra_edges_free(brio_context *ctx, brio_tetrahedra_edges *edges) {
    brio_release(ctx, edges->ends);
    brio_release(ctx, edges->hull);
    *edges = (brio_tetrahedra_edges){.ends = NULL};
}
