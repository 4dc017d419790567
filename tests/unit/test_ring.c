/* The ring round an edge against all tetrahedra that have the edge. */
#include "triangulation/ring.h"
#include "harness.h"
#include "points.h"
#include "triangulation/triangulation.h"

enum { MOST_POINTS = 70, MOST_RING = 512, SETS = 40 };

static double points[3 * MOST_POINTS], weights[MOST_POINTS];

/* Set `seed`: uniform points or points of a small lattice, every third set weighted. */
static brio_triangulation *triangulate(brio_context *ctx, uint64_t seed) {
    brio_triangulation *t = NULL;
    size_t n = 4 + seed * 13 % (MOST_POINTS - 3);
    if (seed % 2)
        integer_points(seed, n, 4, points);
    else
        uniform_points(seed, n, points);
    integer_weights(seed, n, 3, weights);
    EXPECT(brio_delaunay(ctx, points, seed % 3 ? NULL : weights, n, NULL, &t) == BRIO_OK);
    return t;
}

static brio_tetrahedra tetrahedra_of(const brio_triangulation *t) {
    return (brio_tetrahedra){
        .tet = t->tet, .count = t->stats.tetrahedra + t->stats.hull_facets, .infinite = BRIO_INFINITE};
}

/* --- oracle --- */

typedef struct {
    uint32_t tet[MOST_RING];
    size_t size;
} tet_list;

static bool has_vertex(const brio_tetrahedra *t, uint32_t tet, uint32_t v) {
    return brio_slot_of_vertex(t->tet[tet].vertex, v) < 4;
}

/* All tetrahedra that have both vertices, in ascending order. */
static void find_all(const brio_tetrahedra *t, uint32_t a, uint32_t b, tet_list *all) {
    all->size = 0;
    for (uint32_t tet = 0; tet < t->count; tet++)
        if (has_vertex(t, tet, a) && has_vertex(t, tet, b) && all->size < MOST_RING) all->tet[all->size++] = tet;
}

/* Whether c to d is a turn counterclockwise round the axis from a to b, seen from b, as far as doubles tell it; true
 * where a vertex is infinite. */
static bool turns_counterclockwise(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    if (a == BRIO_INFINITE || b == BRIO_INFINITE || c == BRIO_INFINITE || d == BRIO_INFINITE) return true;
    double u[3], v[3], w[3];
    for (size_t k = 0; k < 3; k++) {
        u[k] = points[3 * b + k] - points[3 * a + k];
        v[k] = points[3 * c + k] - points[3 * a + k];
        w[k] = points[3 * d + k] - points[3 * a + k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
               u[2] * (v[0] * w[1] - v[1] * w[0]) >
           -1e-12;
}

/* --- tests --- */

/* Walks round the edge from slot i to slot j of `tet`: each tetrahedron of `all` comes once, the next one starts where
 * the last one ended, and the ring closes. */
static void expect_ring(const brio_tetrahedra *t, uint32_t tet, int i, int j, const tet_list *all) {
    const uint32_t *v = t->tet[tet].vertex;
    uint32_t k = v[BRIO_EDGE[i][j][0]], before = v[BRIO_EDGE[i][j][1]];
    static uint8_t met[1 << 12];
    size_t size = 1, wrong = 0;
    EXPECT(t->count < sizeof met);
    memset(met, 0, sizeof met);
    met[tet] = 1;
    brio_ring r = brio_ring_second(t, tet, i, j), last;
    EXPECT(turns_counterclockwise(v[i], v[j], k, before));
    do {
        last = r;
        wrong += met[r.tet]++ > 0;
        wrong += !has_vertex(t, r.tet, v[i]) || !has_vertex(t, r.tet, v[j]);
        wrong += !has_vertex(t, r.tet, r.pivot) || !has_vertex(t, r.tet, r.apex) || r.pivot != before;
        wrong += !turns_counterclockwise(v[i], v[j], r.pivot, r.apex);
        before = r.apex;
        size++;
    } while (size < MOST_RING && brio_ring_next(&r));
    EXPECT(wrong == 0, "tetrahedron %u, edge %d %d", tet, i, j);
    EXPECT(before == k, "the ring closes: tetrahedron %u, edge %d %d", tet, i, j);
    EXPECT(size == all->size, "tetrahedron %u, edge %d %d: %zu of %zu", tet, i, j, size, all->size);
    EXPECT(r.tet == last.tet && r.pivot == last.pivot && r.apex == last.apex, "no step");
}

/* The first in memory leads and knows the size, the others do not. */
static void expect_leader(const brio_tetrahedra *t, uint32_t tet, int i, int j, const tet_list *all) {
    bool first = all->tet[0] == tet;
    const uint32_t *mate = t->tet[tet].mate;
    bool neighbours_are_later =
        brio_tet_of(mate[BRIO_EDGE[i][j][0]]) > tet && brio_tet_of(mate[BRIO_EDGE[i][j][1]]) > tet;
    EXPECT(brio_ring_size(t, tet, i, j) == (first ? all->size : 0), "tetrahedron %u, edge %d %d", tet, i, j);
    EXPECT(brio_ring_may_lead(t, tet, i, j) == neighbours_are_later, "tetrahedron %u, edge %d %d", tet, i, j);
    EXPECT(!first || brio_ring_may_lead(t, tet, i, j), "tetrahedron %u, edge %d %d", tet, i, j);
}

static void rings_are_all_tetrahedra_of_their_edge(void) {
    brio_context *ctx = new_context();
    size_t rings = 0;
    for (uint64_t seed = 0; seed < SETS; seed++) {
        brio_triangulation *result = triangulate(ctx, seed);
        brio_tetrahedra t = tetrahedra_of(result);
        for (uint32_t tet = 0; tet < t.count; tet++)
            for (int i = 0; i < 4; i++)
                for (int j = 0; j < 4; j++) {
                    tet_list all;
                    if (i == j) continue;
                    find_all(&t, t.tet[tet].vertex[i], t.tet[tet].vertex[j], &all);
                    expect_ring(&t, tet, i, j, &all);
                    expect_leader(&t, tet, i, j, &all);
                    rings += all.tet[0] == tet;
                }
        brio_triangulation_free(result);
    }
    EXPECT(rings > 2000, "%zu", rings);
    brio_context_free(ctx);
}

/* Each edge is found by one of its tetrahedra only. So the number of leaders satisfies Euler's relation of the
 * triangulated three-sphere, V - E + F - T = 0, where V counts the infinite vertex and F = 2 T. */
static void each_edge_is_found_once(void) {
    brio_context *ctx = new_context();
    for (uint64_t seed = 0; seed < SETS; seed++) {
        brio_triangulation *result = triangulate(ctx, seed);
        brio_tetrahedra t = tetrahedra_of(result);
        size_t edges = 0;
        for (uint32_t tet = 0; tet < t.count; tet++) {
            brio_ring_fetch(&t, tet);
            for (int i = 0; i < 4; i++)
                for (int j = i + 1; j < 4; j++) edges += brio_ring_size(&t, tet, i, j) > 0;
        }
        EXPECT(!t.count || result->stats.vertices + 1 + t.count == edges, "set %llu: %zu edges",
               (unsigned long long)seed, edges);
        brio_triangulation_free(result);
    }
    brio_context_free(ctx);
}

SUITE(test_ring) {
    RUN(rings_are_all_tetrahedra_of_their_edge);
    RUN(each_edge_is_found_once);
    return harness_end();
}
