/* Naive labeling of poles: labels spread breadth first from the certain poles. A wrong label spreads as far as a right
 * one, so this labeling serves for comparison, and for samples that are known to be dense.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.3.
 * Differs from the paper: poles on the hull of the regular triangulation are certain, too; the greedy labeling labels
 *                         the poles that are not reached. */
#include "base/memory.h"
#include "reconstruct/labels/labeling.h"

brio_status brio_label_naive(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    uint8_t *certain = NULL;
    uint32_t *queue = NULL;
    size_t n = g->diagram->poles->count, size = 0;
    BRIO_TRY(BRIO_ALLOC(g->ctx, certain, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, queue, n));
    brio_label_certain(g, certain);
    for (size_t p = 0; p < n; p++)
        if (certain[p]) label[p] = BRIO_LABEL_OUTER, queue[size++] = (uint32_t)p;
    brio_label_spread(g, certain, label, queue, size);
    BRIO_TRY(brio_label_finish(g, label, stats));
done:
    brio_release(g->ctx, certain);
    brio_release(g->ctx, queue);
    return status;
}
