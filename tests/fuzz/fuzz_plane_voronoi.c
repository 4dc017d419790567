/* Voronoi and power diagrams of the plane against fractions of integers: where the vertices are, which triangles share one,
 * and what goes round each region; and of any finite doubles, as arrays that hang together. */
#include "plane_input.h"

enum { MOST = 20 };

__extension__ typedef __int128 wide;

/* A point x/d, y/d with d > 0. */
typedef struct {
    int64_t x, y, d;
} fraction;

/* The centre of the circle that is orthogonal to three weighted points. */
static fraction centre_of(const plane_set *s, const uint32_t *v) {
    const plane_site *a = &s->p[v[0]], *b = &s->p[v[1]], *c = &s->p[v[2]];
    int64_t ux = b->x - a->x, uy = b->y - a->y, vx = c->x - a->x, vy = c->y - a->y;
    int64_t p = ux * ux + uy * uy - b->w + a->w, q = vx * vx + vy * vy - c->w + a->w, d = 2 * (ux * vy - uy * vx);
    return (fraction){a->x * d + p * vy - q * uy, a->y * d + q * ux - p * vx, d};
}

static bool is_same(fraction a, fraction b) {
    return a.x * b.d == b.x * a.d && a.y * b.d == b.y * a.d;
}

/* The sign of the turn at b. */
static int turn_of(fraction a, fraction b, fraction c) {
    wide ux = b.x * a.d - a.x * b.d, uy = b.y * a.d - a.y * b.d, vx = c.x * b.d - b.x * c.d;
    wide vy = c.y * b.d - b.y * c.d, turn = ux * vy - uy * vx;
    return (turn > 0) - (turn < 0);
}

static bool is_near(double x, int64_t n, int64_t d) {
    long double right = (long double)n / (long double)d;
    return fabsl((long double)x - right) <= 0x1p-40L * (fabsl(right) + 100);
}

static void expect_vertices(const plane_set *s, const brio_triangulation2 *t, const brio_diagram2 *d) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    for (size_t i = 0; i < d->num_triangles; i++) {
        fraction own = centre_of(s, triangle[i].vertex);
        const double *x = d->vertices + 2 * (size_t)d->triangle_vertex[i];
        FUZZ_EXPECT(is_near(x[0], own.x, own.d) && is_near(x[1], own.y, own.d), "triangle %zu: %.17g %.17g", i, x[0],
                    x[1]);
        for (size_t k = 0; k < i; k++)
            FUZZ_EXPECT((d->triangle_vertex[i] == d->triangle_vertex[k]) ==
                            is_same(own, centre_of(s, triangle[k].vertex)),
                        "triangles %zu and %zu", k, i);
    }
}

/* A triangle whose centre is a vertex of the diagram. */
static fraction place_of(const plane_set *s, const brio_triangulation2 *t, const brio_diagram2 *d, uint32_t vertex) {
    size_t i = 0;
    while (i < d->num_triangles && d->triangle_vertex[i] != vertex) i++;
    FUZZ_EXPECT(i < d->num_triangles, "vertex %u is of no triangle", vertex);
    return centre_of(s, brio_triangulation2_triangles(t)[i].vertex);
}

static bool has_item(const brio_diagram2 *d, uint32_t p, uint32_t item) {
    for (uint64_t i = d->offsets[p]; i < d->offsets[p + 1]; i++)
        if (d->items[i] == item) return true;
    return false;
}

/* The number of items is that of the distinct centres round p, and every one of them is there. */
static void expect_items(const brio_triangulation2 *t, const brio_diagram2 *d, uint32_t p) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    const brio_delaunay2_stats *stats = brio_triangulation2_stats(t);
    uint64_t expected = 0;
    bool seen[2 * MOST] = {false}, hull = false;
    for (size_t i = 0; i < stats->triangles + stats->hull_edges; i++) {
        const uint32_t *v = triangle[i].vertex;
        if (v[0] != p && v[1] != p && v[2] != p) continue;
        hull |= i >= stats->triangles;
        if (i >= stats->triangles || seen[d->triangle_vertex[i]]) continue;
        seen[d->triangle_vertex[i]] = true, expected++;
        FUZZ_EXPECT(has_item(d, p, d->triangle_vertex[i]), "point %u lacks %u", p, d->triangle_vertex[i]);
    }
    expected += hull;
    FUZZ_EXPECT(d->offsets[p + 1] - d->offsets[p] == expected, "point %u: %llu items, not %llu", p,
                (unsigned long long)(d->offsets[p + 1] - d->offsets[p]), (unsigned long long)expected);
    FUZZ_EXPECT(!expected || (d->items[d->offsets[p]] == BRIO_INFINITE) == hull, "point %u", p);
}

/* Regions are convex, and their vertices go counterclockwise. */
static void expect_turns(const plane_set *s, const brio_triangulation2 *t, const brio_diagram2 *d, uint32_t p) {
    const uint32_t *item = d->items + d->offsets[p];
    size_t n = (size_t)(d->offsets[p + 1] - d->offsets[p]), hull = n && item[0] == BRIO_INFINITE;
    if (n < 3 + hull) return;
    for (size_t i = hull; i < n - (hull ? 2 : 0); i++)
        FUZZ_EXPECT(turn_of(place_of(s, t, d, item[i]), place_of(s, t, d, item[(i + 1) % n]),
                            place_of(s, t, d, item[(i + 2) % n])) > 0,
                    "point %u, item %zu", p, i);
}

/* What holds of any points. */
static void expect_arrays(const brio_triangulation2 *t, const brio_diagram2 *d, size_t n) {
    const uint32_t *representative = brio_triangulation2_representatives(t);
    bool flat = brio_triangulation2_stats(t)->dimension < 2;
    FUZZ_EXPECT(d->num_triangles == brio_triangulation2_stats(t)->triangles && d->num_points == n && !d->offsets[0]);
    FUZZ_EXPECT(d->num_vertices <= d->num_triangles);
    for (size_t i = 0; i < d->num_triangles; i++) FUZZ_EXPECT(d->triangle_vertex[i] < d->num_vertices, "%zu", i);
    for (uint32_t p = 0; p < n; p++) {
        for (uint64_t i = d->offsets[p]; i < d->offsets[p + 1]; i++)
            FUZZ_EXPECT(d->items[i] < d->num_vertices || (d->items[i] == BRIO_INFINITE && i == d->offsets[p]));
        if (flat || representative[p] != p) FUZZ_EXPECT(d->offsets[p] == d->offsets[p + 1], "point %u", p);
        if (!flat && representative[p] == p) expect_items(t, d, p);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    plane_set s;
    double points[2 * MOST], weights[MOST];
    brio_triangulation2 *t;
    brio_diagram2 *d;
    uint8_t mode = fuzz_byte(&in);
    bool plain = mode & 48;
    fuzz_plane_sites(&in, mode, MOST, &s);
    plane_sites_as_doubles(&s, points, weights);
    for (size_t i = 0; i < 2 * s.n && !plain; i++) points[i] = fuzz_double(&in);
    for (size_t i = 0; i < s.n && !plain; i++) weights[i] = fuzz_double(&in);
    const double *w = s.weighted ? weights : NULL;
    FUZZ_EXPECT(brio_delaunay2(ctx, points, w, s.n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_voronoi2(ctx, t, points, w, s.n, &d) == BRIO_OK, "%s", brio_message(ctx));
    expect_arrays(t, d, s.n);
    if (plain) expect_vertices(&s, t, d);
    for (uint32_t p = 0; plain && p < s.n; p++) expect_turns(&s, t, d, p);
    brio_diagram2_free(d);
    brio_triangulation2_free(t);
    fuzz_end();
    return 0;
}
