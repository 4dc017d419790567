/* Alpha complexes and shapes: values rise from a simplex to those that contain it, the order is a filtration, and the shape
 * is closed, manifold, and as large as its tetrahedra. */
#include "points_input.h"
#include "surface_oracle.h"

enum { MOST = 14 };

/* The number of a simplex of dimension k, given by ascending vertices. */
static size_t find_simplex(const brio_alpha_complex *c, int k, const uint32_t *v) {
    size_t corners = (size_t)k + 1;
    for (size_t i = 0; i < c->counts[k]; i++)
        if (!memcmp(c->simplices[k] + corners * i, v, corners * sizeof *v))
            return (size_t)(c->values[k] - c->values[0]) + i;
    FUZZ_EXPECT(0, "a face of dimension %d is missing", k);
    return 0;
}

/* Every facet of every simplex is there, has no greater value, and comes first. */
static void expect_filtration(brio_context *ctx, const brio_alpha_complex *c) {
    size_t count = c->counts[0] + c->counts[1] + c->counts[2] + c->counts[3];
    uint32_t *order = malloc(count * sizeof *order), *place = malloc(count * sizeof *place);
    FUZZ_EXPECT(brio_alpha_order(ctx, c, order) == BRIO_OK, "%s", brio_message(ctx));
    memset(place, 0xff, count * sizeof *place);
    for (size_t i = 0; i < count; i++) {
        FUZZ_EXPECT(order[i] < count && place[order[i]] == UINT32_MAX, "%zu", i);
        place[order[i]] = (uint32_t)i;
    }
    for (int k = 1; k < 4; k++)
        for (size_t i = 0; i < c->counts[k]; i++) {
            size_t corners = (size_t)k + 1, self = (size_t)(c->values[k] - c->values[0]) + i;
            const uint32_t *v = c->simplices[k] + corners * i;
            for (size_t left = 0; left < corners; left++) {
                uint32_t face[3];
                for (size_t j = 0, n = 0; j < corners; j++)
                    if (j != left) face[n++] = v[j];
                size_t other = find_simplex(c, k - 1, face);
                FUZZ_EXPECT(c->values[0][other] <= c->values[0][self] && place[other] < place[self], "dimension %d", k);
                FUZZ_EXPECT(c->solid[0][other] <= c->solid[0][self] || k < 3, "dimension %d", k);
            }
        }
    free(order);
    free(place);
}

static void expect_shape(brio_context *ctx, const site_set *s, const double *points, const brio_alpha_complex *c,
                         double alpha) {
    brio_alpha_shape_stats stats = {0};
    brio_mesh *m;
    int64_t volume = 0;
    size_t in = 0;
    for (size_t i = 0; i < c->counts[3]; i++)
        if (c->values[3][i] <= alpha) volume += llabs(volume_at(s, c->simplices[3] + 4 * i)), in++;
    brio_status status = brio_alpha_shape(ctx, points, c, alpha, &m, &stats);
    FUZZ_EXPECT(status == (in ? BRIO_OK : BRIO_ERR_NO_ANSWER), "%s", brio_message(ctx));
    if (!m) return;
    expect_surface(ctx, m, true, "alpha shape");
    brio_certificate certificate = {0};
    FUZZ_EXPECT(brio_mesh_certificate(ctx, m, &certificate) == BRIO_OK);
    FUZZ_EXPECT(fabs(6 * certificate.volume - (double)volume) < 1e-6, "volume %g, not %g", certificate.volume,
                (double)volume / 6);
    FUZZ_EXPECT(stats.tetrahedra == in && stats.vertices + stats.split == m->num_vertices);
    brio_certificate_free(&certificate);
    brio_mesh_free(m);
}

static void expect_complex(brio_context *ctx, fuzz_input *in, const site_set *s, const double *points,
                           const brio_alpha_complex *c) {
    double alpha = 0;
    expect_filtration(ctx, c);
    FUZZ_EXPECT(brio_alpha_auto(ctx, c, &alpha) == BRIO_OK, "%s", brio_message(ctx));
    expect_shape(ctx, s, points, c, alpha);
    for (int i = 0; i < 3; i++) expect_shape(ctx, s, points, c, c->values[3][fuzz_below(in, c->counts[3])]);
    expect_shape(ctx, s, points, c, -1e9);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    site_set s;
    double points[3 * MOST], weights[MOST];
    brio_triangulation *t;
    brio_alpha_complex c = {0};
    fuzz_sites(&in, MOST, &s);
    for (size_t i = 0; i < s.n; i++) {
        for (size_t k = 0; k < 3; k++) points[3 * i + k] = (double)s.p[i].x[k];
        weights[i] = (double)s.p[i].w;
    }
    const double *w = s.weighted ? weights : NULL;
    FUZZ_EXPECT(brio_delaunay(ctx, points, w, s.n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    brio_status status = brio_alpha_values(ctx, t, points, w, s.n, &c);
    FUZZ_EXPECT(status == (s.hull_volume ? BRIO_OK : BRIO_ERR_NO_ANSWER), "%s", brio_message(ctx));
    if (status == BRIO_OK) expect_complex(ctx, &in, &s, points, &c);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    fuzz_end();
    return 0;
}
