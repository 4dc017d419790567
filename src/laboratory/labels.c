/* Labelings of poles that spread labels breadth first. A wrong label spreads as far as a right one, so they serve for
 * comparison, and for samples that are known to be dense.
 *
 * The naive labeling starts from all certain poles. The theoretical one starts from one sample of the hull, whose
 * farther pole is outer; on a dense sample of a smooth closed surface every pole is reached and every label is right.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.3; appendix B.3 (lemmata 56 and
 *           57).
 * Differs from the paper: poles on the hull of the regular triangulation are certain, too; certain poles stay outer,
 *                         whatever label reaches them; the greedy labeling labels the poles that are not reached. */
#include "laboratory/laboratory.h"
#include "base/memory.h"

/* Spreads labels breadth first along the edges to poles without a label. A certain pole becomes outer. Any other pole
 * takes the label of the pole that reaches it, or the opposite label if the weight of the edge is negative.
 * queue  #poles, workspace: the first `size` entries are the labeled poles to start from. */
static void spread(const brio_pole_graph *g, const uint8_t *certain, uint8_t *label, uint32_t *queue, size_t size) {
    for (size_t next = 0; next < size; next++) {
        uint32_t p = queue[next];
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
            brio_signed_edge to = g->edge[e];
            if (label[to.node] != BRIO_LABEL_NONE) continue;
            label[to.node] = certain[to.node] ? BRIO_LABEL_OUTER
                             : to.weight < 0  ? brio_other_label(label[p])
                                              : label[p];
            queue[size++] = to.node;
        }
    }
}

/* Returns the first pole whose tetrahedron has a bounding point, or #poles. The samples of that pole are on the hull or
 * see out of it. */
static size_t seed_pole(const brio_pole_graph *g) {
    size_t p = 0;
    while (p < g->diagram->poles->count && !g->diagram->poles->bounding[p]) p++;
    return p;
}

/* Lists the poles that labels spread from, which are outer. Returns their number. */
static size_t outer_poles(const brio_pole_graph *g, bool one, const uint8_t *certain, uint8_t *label, uint32_t *queue) {
    size_t n = g->diagram->poles->count, size = 0, seed = seed_pole(g);
    for (size_t p = 0; p < n; p++)
        if (one ? p == seed : certain[p]) label[p] = BRIO_LABEL_OUTER, queue[size++] = (uint32_t)p;
    return size;
}

/* Labels by spreading from one pole, or from all certain ones. */
static brio_status label_breadth_first(brio_laboratory *lab, bool one, const brio_pole_graph *g, uint8_t *label,
                                       brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    uint8_t *certain = NULL;
    uint32_t *queue = NULL;
    size_t n = g->diagram->poles->count, *unreached = &lab->trial.stats.unreached;
    BRIO_TRY(BRIO_ALLOC(g->ctx, certain, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, queue, n));
    brio_label_certain(g, certain);
    spread(g, certain, label, queue, outer_poles(g, one, certain, label, queue));
    *unreached = 0;
    for (size_t p = 0; p < n; p++) *unreached += label[p] == BRIO_LABEL_NONE;
    if (*unreached) BRIO_TRY(brio_label_greedy(g, label, stats));
done:
    brio_release(g->ctx, certain);
    brio_release(g->ctx, queue);
    return status;
}

brio_status brio_label_naive(void *user, const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    return label_breadth_first(user, false, g, label, stats);
}

brio_status brio_label_theoretical(void *user, const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    return label_breadth_first(user, true, g, label, stats);
}
