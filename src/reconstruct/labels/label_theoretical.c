/* Theoretical labeling of poles: breadth first from one sample of the hull, whose far pole is outer and whose other
 * pole is inner. On a dense sample of a smooth closed surface every pole is reached and every label is right.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, appendix B.3 (lemmata 56 and 57).
 * Differs from the paper: the poles that are outer for good get no other label, whatever reaches them; what is not
 * reached is left to the greedy labeling. */
#include "base/memory.h"
#include "reconstruct/labels/labeling.h"

/* The first pole whose tetrahedron has a bounding point: that pole's samples are on the hull or see out of it. */
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
