/* Convex hulls: closed, convex by exact predicates, with every point inside, every vertex extreme and, on grids, every plane
 * that brute force finds. */
#include "points_input.h"
#include "surface_oracle.h"

enum { MOST = 24 };

/* No point is outside a face, and a vertex is on every plane of its faces. */
static void expect_convex(const brio_mesh *m, const double *points, size_t n) {
    for (size_t f = 0; f < m->num_faces; f++) {
        const uint32_t *v = m->face_vertices + m->face_offsets[f];
        const double *a = m->vertices + 3 * (size_t)v[0], *b = m->vertices + 3 * (size_t)v[1],
                     *c = m->vertices + 3 * (size_t)v[2];
        for (size_t i = 0; i < n; i++)
            FUZZ_EXPECT(brio_orient3d(a, b, c, points + 3 * i) <= 0, "point %zu is outside face %zu", i, f);
    }
}

/* The planes of the hull, by brute force. */
static size_t count_planes(const site_set *s) {
    size_t planes = 0;
    for (size_t i = 0; i < s->n; i++)
        for (size_t j = i + 1; j < s->n; j++)
            for (size_t k = j + 1; k < s->n; k++) {
                if (!supporting_side(s, i, j, k)) continue;
                offset normal = cross(from_to(&s->p[i], &s->p[j]), from_to(&s->p[i], &s->p[k]));
                uint32_t in[BRUTE_POINTS];
                size_t count = 0;
                for (uint32_t m = 0; m < s->n; m++)
                    if (dot(normal, from_to(&s->p[i], &s->p[m])) == 0) in[count++] = m;
                planes += names_plane(s, in, i, j, k);
            }
    return planes;
}

static void expect_hull(brio_context *ctx, const double *points, size_t n, bool polygons, size_t planes) {
    brio_convex_hull_options o = {0};
    brio_convex_hull_stats stats = {0};
    uint32_t samples[MOST + 1];
    brio_mesh *m;
    o.polygons = polygons, o.samples = samples;
    FUZZ_EXPECT(brio_convex_hull(ctx, points, n, &o, &m, &stats) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(stats.vertices == m->num_vertices && stats.points == n);
    for (size_t v = 0; v < m->num_vertices; v++) {
        FUZZ_EXPECT(samples[v] < n && (!v || samples[v - 1] < samples[v]), "vertex %zu", v);
        FUZZ_EXPECT(!memcmp(m->vertices + 3 * v, points + 3 * (size_t)samples[v], 3 * sizeof *points), "vertex %zu", v);
    }
    if (stats.dimension == 3) {
        expect_surface(ctx, m, true, "hull");
        FUZZ_EXPECT(judge_surface(m).euler == 2 && count_used(m) == m->num_vertices);
        expect_convex(m, points, n);
        if (planes) FUZZ_EXPECT(stats.facets == planes, "%zu facets, %zu planes", stats.facets, planes);
        if (polygons) FUZZ_EXPECT(m->num_faces == stats.facets);
    }
    brio_mesh_free(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    double points[3 * MOST], weights[MOST];
    bool polygons = fuzz_flag(&in);
    if (fuzz_byte(&in) % 4) {
        site_set s;
        fuzz_sites(&in, MOST, &s);
        sites_as_doubles(&in, &s, points, weights);
        expect_hull(ctx, points, s.n, polygons, s.hull_volume ? count_planes(&s) : 0);
    } else {
        size_t n = fuzz_below(&in, MOST + 1);
        for (size_t i = 0; i < 3 * n; i++) points[i] = fuzz_double(&in);
        expect_hull(ctx, points, n, polygons, 0);
    }
    fuzz_end();
    return 0;
}
