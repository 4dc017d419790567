/* Triangulations of up to 12 points against brute force, in every order, by every location, in threads; moved and scaled
 * exactly; and with hidden points left. */
#include "brute_result.h"
#include "points_input.h"

enum { MOST = 12 };

/* With leave_hidden all is the same, but that hidden points have no representative. */
static void expect_left(brio_context *ctx, const site_set *s, const double *points, const double *weights,
                        trial_options o, const brio_triangulation *named) {
    brio_triangulation *left;
    const brio_delaunay_stats *a = &named->stats;
    o.leave_hidden = 1;
    FUZZ_EXPECT(trial_delaunay(ctx, points, weights, s->n, &o, &left, NULL) == BRIO_OK, "%s", brio_message(ctx));
    const brio_delaunay_stats *b = &left->stats;
    size_t tets = a->tetrahedra + a->hull_facets;
    FUZZ_EXPECT(a->vertices == b->vertices && a->duplicates == b->duplicates && a->hidden == b->hidden);
    FUZZ_EXPECT(tets == b->tetrahedra + b->hull_facets &&
                (!tets || !memcmp(named->tet, left->tet, tets * sizeof *left->tet)));
    for (size_t i = 0; i < s->n; i++) {
        uint32_t r = named->representative[i];
        uint32_t right = compare_sites(&s->p[i], &s->p[r]) ? BRIO_INFINITE : r;
        FUZZ_EXPECT(left->representative[i] == right, "point %zu: %u, not %u", i, left->representative[i], right);
    }
    FUZZ_EXPECT(brio_triangulation_check(ctx, left, points, weights, s->n) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(left);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    site_set s;
    double points[3 * MOST], weights[MOST];
    uint32_t edges[32];
    brio_triangulation *t;
    fuzz_sites(&in, MOST, &s);
    sites_as_doubles(&in, &s, points, weights);
    trial_options o = fuzz_options(&in, s.n, edges);
    brio_context_set_threads(ctx, fuzz_byte(&in) < 16 ? 3 : 1);
    const double *w = s.weighted ? weights : NULL;
    FUZZ_EXPECT(trial_delaunay(ctx, points, w, s.n, &o, &t, NULL) == BRIO_OK, "%s", brio_message(ctx));
    if (s.n)
        FUZZ_EXPECT(brute_accepts_result(&s, t), "order %d, location %d", (int)o.order, (int)o.locate);
    else
        FUZZ_EXPECT(t->stats.dimension == -1 && !t->stats.tetrahedra);
    FUZZ_EXPECT(brio_triangulation_check(ctx, t, points, w, s.n) == BRIO_OK, "%s", brio_message(ctx));
    if (s.weighted) expect_left(ctx, &s, points, w, o, t);
    brio_triangulation_free(t);
    fuzz_end();
    return 0;
}
