/* Theoretical labeling of poles: labels spread breadth first from one sample of the hull, whose farther pole is outer.
 * On a dense sample of a smooth closed surface every pole is reached and every label is right.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, appendix B.3 (lemmata 56 and 57).
 * Differs from the paper: certain poles stay outer, whatever label reaches them; the greedy labeling labels the poles
 *                         that are not reached. */
#include "base/memory.h"
#include "reconstruct/labels/labeling.h"

/* Returns the first pole whose tetrahedron has a bounding point, or #poles. The samples of that pole are on the hull or
 * see out of it. */
static size_t seed_pole(const brio_pole_graph *g) {
    size_t p = 0;
    while (p < g->diagram->poles->count && !g->diagram->poles->bounding[p]) p++;
    return p;
}

brio_status brio_label_theoretical(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    uint8_t *certain = NULL;
    uint32_t *queue = NULL;
    size_t n = g->diagram->poles->count, seed = seed_pole(g);
    BRIO_TRY(BRIO_ALLOC(g->ctx, certain, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, queue, n));
    brio_label_certain(g, certain);
    if (seed < n) {
        label[seed] = BRIO_LABEL_OUTER;
        queue[0] = (uint32_t)seed;
        brio_label_spread(g, certain, label, queue, 1);
    }
    BRIO_TRY(brio_label_finish(g, label, stats));
done:
    brio_release(g->ctx, certain);
    brio_release(g->ctx, queue);
    return status;
}
