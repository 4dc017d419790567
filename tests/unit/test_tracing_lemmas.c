/* What makes tracing fast, by brute force: Delaunay edges that cross a facet of the Delaunay triangulation of a subset
 * have an end in its region [Choi 2003, lemma 7], so that a spanning subgraph of them crosses few facets (lemma 8). */
#include "harness.h"
#include "points.h"

enum { SIDE = 4, POINTS = SIDE * SIDE * SIDE, SETS = 36, SETS_OF_ALL_SEGMENTS = SHORT_TESTS ? 12 : SETS };

static brio_context *ctx;

typedef struct {
    double points[3 * POINTS];
    brio_triangulation *whole, *part; /* of all points, and of the first `first` */
    size_t first;
    uint8_t is_edge[POINTS][POINTS]; /* of the whole */
} nested;

static brio_triangulation *delaunay(const double *points, size_t n) {
    brio_triangulation *t = NULL;
    EXPECT(brio_delaunay(ctx, points, NULL, n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    return t;
}

static size_t num_facets(const brio_triangulation *t) {
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    return 4 * (s->tetrahedra + s->hull_facets);
}

/* A cubic lattice in any order: nothing but ties. */
static void lattice_points(uint64_t seed, size_t n, double *points) {
    double rows[3 * POINTS];
    size_t to[POINTS];
    for (size_t i = 0; i < n; i++) {
        rows[3 * i] = (double)(i % SIDE), rows[3 * i + 1] = (double)(i / SIDE % SIDE);
        rows[3 * i + 2] = (double)(i / SIDE / SIDE);
    }
    shuffle_points(seed, n, rows, points, to);
}

/* The pixels of a depth camera in any order: many in a plane or on a line. */
static void pixel_points(uint64_t seed, size_t n, double *points) {
    double rows[3 * POINTS];
    size_t to[POINTS];
    depth_points(seed, 2 * SIDE, rows);
    shuffle_points(seed, n, rows, points, to);
}

static nested *nested_new(uint64_t seed) {
    nested *s = calloc(1, sizeof *s);
    brio_rng rng = brio_rng_new(seed);
    void (*const makers[])(uint64_t, size_t, double *) = {uniform_points,   sphere_points,  torus_points,
                                                          clustered_points, lattice_points, pixel_points};
    makers[seed % 6](seed, POINTS, s->points);
    s->first = 5 + brio_rng_below(&rng, POINTS - 10);
    s->whole = delaunay(s->points, POINTS);
    s->part = delaunay(s->points, s->first);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(s->whole);
    for (size_t i = 0; i < brio_triangulation_stats(s->whole)->tetrahedra; i++)
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) s->is_edge[tet[i].vertex[a]][tet[i].vertex[b]] = a != b;
    return s;
}

static void nested_free(nested *s) {
    brio_triangulation_free(s->whole);
    brio_triangulation_free(s->part);
    free(s);
}

/* Whether the sphere of a tetrahedron of the part holds a point; that of an infinite one is the side of the hull facet
 * away from the points. */
static bool holds(const nested *s, uint32_t tet, size_t point) {
    const uint32_t *v = brio_triangulation_tetrahedra(s->part)[tet].vertex;
    const double *a = s->points + 3 * v[0], *b = s->points + 3 * v[1], *c = s->points + 3 * v[2];
    const double *p = s->points + 3 * point;
    if (v[0] == point || v[1] == point || v[2] == point || v[3] == point) return false;
    if (v[3] == BRIO_INFINITE) return brio_orient3d(a, b, c, p) > 0;
    return brio_insphere(a, b, c, s->points + 3 * v[3], p, NULL) > 0;
}

static bool in_region(const nested *s, uint32_t facet, size_t point) {
    uint32_t mate = brio_triangulation_tetrahedra(s->part)[facet / 4].mate[facet % 4];
    return holds(s, facet / 4, point) || holds(s, mate / 4, point);
}

/* Whether segment vw crosses the inside of a facet, which is finite. */
static bool crosses(const nested *s, uint32_t facet, size_t v, size_t w) {
    const uint32_t *t = brio_triangulation_tetrahedra(s->part)[facet / 4].vertex;
    const double *q[3], *p = s->points + 3 * v, *r = s->points + 3 * w;
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t name = t[(facet + 1 + i) % 4];
        if (name == v || name == w) return false;
        q[i] = s->points + 3 * name;
    }
    if (brio_orient3d(q[0], q[1], q[2], p) * brio_orient3d(q[0], q[1], q[2], r) >= 0) return false;
    int side = brio_orient3d(p, r, q[0], q[1]);
    return side && side == brio_orient3d(p, r, q[1], q[2]) && side == brio_orient3d(p, r, q[2], q[0]);
}

/* Whether a handle names a finite facet, and is the lower of its two. */
static bool is_named_here(const nested *s, uint32_t facet) {
    const brio_tetrahedron *t = brio_triangulation_tetrahedra(s->part) + facet / 4;
    bool infinite = t->vertex[3] == BRIO_INFINITE && facet % 4 != 3;
    return !infinite && facet < t->mate[facet % 4];
}

static void lemma_7_an_end_of_a_crossing_edge_is_in_the_region(void) {
    size_t crossings = 0, outside = 0;
    for (uint64_t seed = 0; seed < SETS_OF_ALL_SEGMENTS; seed++) {
        nested *s = nested_new(seed);
        for (uint32_t f = 0; f < num_facets(s->part); f++)
            for (size_t v = 0; is_named_here(s, f) && v < POINTS; v++)
                for (size_t w = v + 1; w < POINTS; w++) {
                    if (!crosses(s, f, v, w)) continue;
                    bool inside = in_region(s, f, v) || in_region(s, f, w);
                    if (s->is_edge[v][w]) EXPECT(inside, "set %d, facet %u, edge %zu %zu", (int)seed, f, v, w);
                    crossings += s->is_edge[v][w];
                    outside += !inside;
                }
        nested_free(s);
    }
    fprintf(stderr, "       %zu crossings; %zu of segments that are no Delaunay edges have no end in the region\n",
            crossings, outside);
    EXPECT(crossings > 1000 && outside > 100);
}

/* A spanning tree of Delaunay edges, shortest first. Returns its greatest degree. */
static unsigned spanning_tree(const nested *s, size_t (*tree)[2]) {
    bool in[POINTS] = {true};
    unsigned degree[POINTS] = {0}, most = 0;
    for (size_t i = 0; i < POINTS - 1; i++) {
        double best = INFINITY;
        for (size_t v = 0; v < POINTS; v++)
            for (size_t w = 0; in[v] && w < POINTS; w++) {
                if (in[w] || !s->is_edge[v][w]) continue;
                const double *p = s->points + 3 * v, *q = s->points + 3 * w;
                double d = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
                if (d >= best) continue;
                best = d;
                tree[i][0] = v, tree[i][1] = w;
            }
        in[tree[i][1]] = true;
        for (int end = 0; end < 2; end++)
            if (++degree[tree[i][end]] > most) most = degree[tree[i][end]];
    }
    return most;
}

static void lemma_8_crossings_are_bounded_by_conflicts(void) {
    size_t all = 0;
    for (uint64_t seed = 0; seed < SETS; seed++) {
        nested *s = nested_new(seed);
        size_t tree[POINTS - 1][2], crossings = 0, conflicts = 0;
        unsigned degree = spanning_tree(s, tree);
        for (uint32_t f = 0; f < num_facets(s->part); f++)
            for (size_t i = 0; is_named_here(s, f) && i < POINTS - 1; i++)
                crossings += crosses(s, f, tree[i][0], tree[i][1]);
        for (uint32_t t = 0; t < num_facets(s->part) / 4; t++)
            for (size_t v = 0; v < POINTS; v++) conflicts += holds(s, t, v);
        EXPECT(degree <= 12 && crossings <= 4 * degree * conflicts, "%zu crossings, %zu conflicts", crossings,
               conflicts);
        all += crossings;
        nested_free(s);
    }
    EXPECT(all > 200, "%zu crossings", all);
}

SUITE(test_tracing_lemmas) {
    ctx = new_context();
    if (!ctx) return HARNESS_SKIP;
    brio_context_set_threads(ctx, 1);
    RUN(lemma_7_an_end_of_a_crossing_edge_is_in_the_region);
    RUN(lemma_8_crossings_are_bounded_by_conflicts);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
