/* Neighbourhoods of vertices as arrays and as walks, against brute force. */
#include "harness.h"
#include "points.h"

enum { N = 150 };

static bool has_vertex(const brio_tetrahedron *tet, uint32_t v) {
    return tet->vertex[0] == v || tet->vertex[1] == v || tet->vertex[2] == v || tet->vertex[3] == v;
}

static void expect_lists(const brio_triangulation *t, const brio_incidences *tets, const brio_incidences *neighbours,
                         const uint32_t *first) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    size_t finite = brio_triangulation_stats(t)->tetrahedra;
    for (uint32_t p = 0; p < N; p++) {
        bool near[N] = {false};
        uint64_t at = tets->offsets[p], next = neighbours->offsets[p];
        for (size_t i = 0; i < finite; i++) {
            if (!has_vertex(&tet[i], p)) continue;
            EXPECT(at < tets->offsets[p + 1] && tets->items[at] == i);
            at++;
            for (int k = 0; k < 4; k++) near[tet[i].vertex[k]] = tet[i].vertex[k] != p;
        }
        EXPECT(at == tets->offsets[p + 1]);
        EXPECT(first[p] == (at == tets->offsets[p] ? BRIO_INFINITE : tets->items[tets->offsets[p]]));
        for (uint32_t v = 0; v < N; v++)
            if (near[v]) EXPECT(next < neighbours->offsets[p + 1] && neighbours->items[next++] == v);
        EXPECT(next == neighbours->offsets[p + 1]);
    }
}

static void expect_walks(const brio_triangulation *t, const uint32_t *first) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    size_t all = s->tetrahedra + s->hull_facets;
    for (uint32_t p = 0; p < N; p++) {
        uint32_t star[1024];
        size_t right = 0;
        if (first[p] == BRIO_INFINITE) continue;
        for (size_t i = 0; i < all; i++) right += has_vertex(&tet[i], p);
        size_t count = brio_vertex_star(tet, p, first[p], star, 1024);
        EXPECT(count == right, "%zu, %zu", count, right);
        for (size_t i = 0; i < count; i++) EXPECT(has_vertex(&tet[star[i]], p));
        EXPECT(brio_vertex_star(tet, p, first[p], star, right - 1) == right);
    }
    for (uint32_t i = 0; i < all; i++)
        for (int j = 0; j < 12; j++) {
            int a = j / 3, b = j % 3 + (j % 3 >= a);
            size_t right = 0, count = 0;
            uint32_t u = tet[i].vertex[a], v = tet[i].vertex[b];
            brio_edge_walk walk = brio_edge_walk_begin(tet, i, a, b);
            for (size_t k = 0; k < all; k++) right += has_vertex(&tet[k], u) && has_vertex(&tet[k], v);
            do {
                EXPECT(has_vertex(&tet[walk.tetrahedron], u) && has_vertex(&tet[walk.tetrahedron], v));
                count++;
            } while (brio_edge_walk_next(&walk) && count <= right);
            EXPECT(count == right, "%zu, %zu", count, right);
        }
}

static void expect_edges(const brio_incidences *neighbours, const brio_edges *edges) {
    size_t n = 0;
    for (uint32_t p = 0; p < N; p++)
        for (uint64_t i = neighbours->offsets[p]; i < neighbours->offsets[p + 1]; i++) {
            if (neighbours->items[i] < p) continue;
            EXPECT(n < edges->count && edges->ends[2 * n] == p && edges->ends[2 * n + 1] == neighbours->items[i]);
            n++;
        }
    EXPECT(n == edges->count);
}

static void check(const double *p, const double *w) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_incidences tets, neighbours;
    brio_edges edges;
    uint32_t first[N];
    EXPECT(brio_delaunay(ctx, p, w, N, NULL, &t) == BRIO_OK);
    brio_triangulation_vertex_tetrahedra(t, first);
    EXPECT(brio_triangulation_incident_tetrahedra(ctx, t, &tets) == BRIO_OK);
    EXPECT(brio_triangulation_neighbours(ctx, t, &neighbours) == BRIO_OK);
    EXPECT(brio_triangulation_edges(ctx, t, &edges) == BRIO_OK);
    expect_lists(t, &tets, &neighbours, first);
    expect_walks(t, first);
    expect_edges(&neighbours, &edges);
    brio_incidences_free(&tets);
    brio_incidences_free(&neighbours);
    brio_edges_free(&edges);
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void grids_weighted_and_flat_points(void) {
    double p[3 * N], w[N];
    uniform_points(1, N, p);
    check(p, NULL);
    integer_points(2, N, 5, p);
    integer_weights(2, N, 4, w);
    check(p, NULL);
    check(p, w);
    for (int i = 0; i < 3 * N; i += 3) p[i] = 1;
    check(p, NULL);
}

/* The lists of many vertices are made a group at a time: no edge is lost or added between two groups. */
static void as_many_edges_as_euler_has(void) {
    enum { MANY = 150000 };
    brio_context *ctx = new_context();
    double *p = malloc(3 * MANY * sizeof *p);
    brio_triangulation *t;
    brio_edges edges;
    uniform_points(3, MANY, p);
    EXPECT(brio_delaunay(ctx, p, NULL, MANY, NULL, &t) == BRIO_OK);
    EXPECT(brio_triangulation_edges(ctx, t, &edges) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    size_t facets = (4 * s->tetrahedra + s->hull_facets) / 2;
    EXPECT(edges.count == s->vertices + facets - s->tetrahedra - 1, "%zu edges", edges.count);
    for (size_t i = 1; i < edges.count; i++) {
        const uint32_t *a = edges.ends + 2 * i - 2, *b = a + 2;
        EXPECT(b[0] < b[1] && b[1] < MANY && (a[0] < b[0] || (a[0] == b[0] && a[1] < b[1])), "edge %zu", i);
    }
    brio_edges_free(&edges);
    brio_triangulation_free(t);
    free(p);
    brio_context_free(ctx);
}

SUITE(test_incidences) {
    RUN(as_many_edges_as_euler_has);
    RUN(grids_weighted_and_flat_points);
    return harness_end();
}
