/* Triangulations of the plane against brute force; and of planes in space, and of any finite doubles, by the exact check. */
#include "plane_compare.h"
#include "plane_input.h"

enum { MOST = 16 };

static void sites(fuzz_input *in) {
    plane_set s = {.n = 0};
    uint8_t mode = fuzz_byte(in);
    fuzz_plane_sites(in, mode, MOST, &s);
    compare_with_brute(&s, mode);
    FUZZ_EXPECT(!harness_failures);
}

/* Any numbers, on a plane in space or not; a plane's result is what brio_delaunay says of the same points. */
static void flat(fuzz_input *in, brio_context *ctx) {
    double points[3 * MOST], weights[MOST], a = fuzz_byte(in) % 5 - 2.0, b = fuzz_byte(in) % 5 - 2.0;
    bool weighted = fuzz_flag(in), bent = fuzz_byte(in) == 0;
    size_t n = fuzz_below(in, MOST + 1);
    brio_triangulation2 *t;
    brio_triangulation *solid;
    for (size_t i = 0; i < n; i++) {
        double *p = points + 3 * i;
        p[0] = (double)(fuzz_byte(in) % 16), p[1] = (double)(fuzz_byte(in) % 16), p[2] = a * p[0] + b * p[1];
        if (bent) p[2] += fuzz_double(in);
        weights[i] = weighted ? (double)(fuzz_byte(in) % 16) : 0;
    }
    const double *w = weighted ? weights : NULL;
    FUZZ_EXPECT(brio_delaunay(ctx, points, w, n, NULL, &solid) == BRIO_OK, "%s", brio_message(ctx));
    int dimension = brio_triangulation_stats(solid)->dimension;
    brio_status status = brio_delaunay2_flat(ctx, points, w, n, NULL, &t);
    FUZZ_EXPECT(status == (dimension == 3 ? BRIO_ERR_NO_ANSWER : BRIO_OK), "dimension %d: %s", dimension,
                brio_message(ctx));
    for (size_t i = 0; t && i < n; i++)
        FUZZ_EXPECT(brio_triangulation2_representatives(t)[i] == brio_triangulation_representatives(solid)[i],
                    "point %zu", i);
    if (t) FUZZ_EXPECT(brio_triangulation2_check(ctx, t, points, w, n) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation2_free(t);
    brio_triangulation_free(solid);
}

static void any_numbers(fuzz_input *in, brio_context *ctx) {
    double points[2 * MOST], weights[MOST];
    bool weighted = fuzz_flag(in);
    size_t n = fuzz_below(in, MOST + 1);
    brio_triangulation2 *t;
    for (size_t i = 0; i < 2 * n; i++) points[i] = fuzz_double(in);
    for (size_t i = 0; i < n; i++) weights[i] = weighted ? fuzz_double(in) : 0;
    const double *w = weighted ? weights : NULL;
    FUZZ_EXPECT(brio_delaunay2(ctx, points, w, n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_triangulation2_check(ctx, t, points, w, n) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation2_free(t);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    switch (fuzz_byte(&in) % 4) {
    case 0:
    case 1:
        sites(&in);
        break;
    case 2:
        flat(&in, ctx);
        break;
    default:
        any_numbers(&in, ctx);
    }
    fuzz_end();
    return 0;
}
