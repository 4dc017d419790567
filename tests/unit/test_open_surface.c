/* Open surfaces: what holds of them without a known shape. */
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/open_surface/single_fans.h"

/* --- fans --- */

static size_t count_parts(const uint8_t *part, size_t n, uint8_t which) {
    size_t count = 0;
    for (size_t f = 0; f < n; f++) count += part[f] == which;
    return count;
}

/* Two fans that meet at sample 0, of two triangles and one: a surface that ends there from the start, as where the hull was
 * left out of it. */
static const double bow[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 0, 0, -1, -1, 0};
static const uint32_t bow_faces[] = {0, 4, 5, 0, 1, 2, 0, 2, 3};

static brio_status thin_bow(brio_context *ctx) {
    brio_status status = BRIO_OK;
    brio_triangle_net net = {.ctx = ctx};
    uint8_t part[3] = {BRIO_TRIANGLE_SEEN, BRIO_TRIANGLE_SEEN, BRIO_TRIANGLE_SEEN};
    BRIO_TRY(brio_triangle_net_new(ctx, bow, 6, bow_faces, 3, &net));
    BRIO_TRY(brio_keep_single_fans(&net, part));
    EXPECT(part[0] == BRIO_TRIANGLE_GONE && count_parts(part, 3, BRIO_TRIANGLE_SEEN) == 2, "the longer fan stays");
done:
    brio_triangle_net_free(&net);
    return status;
}

static void fans_of_a_surface_with_a_boundary_meet_at_no_sample(void) {
    brio_context *ctx = new_context();
    EXPECT(thin_bow(ctx) == BRIO_OK);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    expect_clean_failures(thin_bow);
}

SUITE(test_open_surface) {
    RUN(fans_of_a_surface_with_a_boundary_meet_at_no_sample);
    return harness_end();
}
