/* Triangulations of up to 12 points against brute force, in every order, by every location, in threads; moved and scaled
 * exactly. */
#include "brute_result.h"
#include "points_input.h"

enum { MOST = 12 };

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    site_set s;
    double points[3 * MOST], weights[MOST];
    uint32_t edges[32];
    brio_triangulation *t;
    fuzz_sites(&in, MOST, &s);
    sites_as_doubles(&in, &s, points, weights);
    brio_delaunay_options o = fuzz_options(&in, s.n, edges);
    brio_context_set_threads(ctx, fuzz_byte(&in) < 16 ? 3 : 1);
    const double *w = s.weighted ? weights : NULL;
    FUZZ_EXPECT(brio_delaunay(ctx, points, w, s.n, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
    if (s.n)
        FUZZ_EXPECT(brute_accepts_result(&s, t), "order %d, location %d", (int)o.order, (int)o.locate);
    else
        FUZZ_EXPECT(t->stats.dimension == -1 && !t->stats.tetrahedra);
    FUZZ_EXPECT(brio_triangulation_check(ctx, t, points, w, s.n) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    fuzz_end();
    return 0;
}
