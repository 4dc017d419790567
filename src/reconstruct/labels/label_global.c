/* Global labeling of poles: seeks labels of low energy. The energy is the sum of |weight| over the edges that the
 * labels contradict, with the balanced weights of the graph of poles. It starts from the greedy labels, which
 * energy_descent.c improves. */
#include "base/memory.h"
#include "base/scale.h"
#include "reconstruct/labels/labeling.h"
#include <math.h>
#include <string.h>

/* All chosen: see brio_energy_descent. */
enum { PASSES = 5, FIRST_BITS = 8 };

/* Sets a pole to outer and certain if its centre is beyond the samples' bounding box by half its radius or more
 * (docs/decisions/008-balanced-weights.md). Five sixths of such a ball are outside the box, and a solid is inside the
 * convex hull of its surface. Balls less far outside may be inner balls that reach through an opening. The greedy
 * labeling does not get these certain poles: on sparse samples they misled it. */
static void settle_beyond_box(const brio_pole_graph *g, uint8_t *certain, uint8_t *label) {
    for (size_t k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t s = 0; s < g->diagram->num_samples; s++) {
            low = fmin(low, g->diagram->samples[3 * s + k]);
            high = fmax(high, g->diagram->samples[3 * s + k]);
        }
        for (size_t p = 0; p < g->diagram->poles->count; p++) {
            double x = g->diagram->poles->centre[3 * p + k], half = 0.5 * sqrt(g->diagram->poles->square[p]);
            if (x < low - half || x > high + half) certain[p] = 1, label[p] = BRIO_LABEL_OUTER;
        }
    }
}

brio_status brio_label_global(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    size_t n = g->diagram->poles->count;
    brio_signed_graph signs = brio_pole_signs(g);
    brio_energy_descent descent = {.first_bits = FIRST_BITS, .passes = PASSES, .from = 0.6};
    uint8_t *before = NULL, *certain = NULL;
    signs.exponent = brio_exponent(brio_greatest(signs.position, 3 * n));
    BRIO_TRY(brio_label_greedy(g, label, stats));
    BRIO_TRY(BRIO_ALLOC(g->ctx, certain, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, before, n));
    brio_label_certain(g, certain);
    settle_beyond_box(g, certain, label);
    BRIO_TRY(brio_label_energy(&signs, label, &stats->energy_greedy));
    memcpy(before, label, n);
    BRIO_TRY(brio_lower_energy(&signs, certain, &descent, label));
    stats->undecided = descent.undecided;
    for (size_t p = 0; p < n; p++) stats->toggled += label[p] != before[p];
done:
    brio_release(g->ctx, certain);
    brio_release(g->ctx, before);
    return status;
}
