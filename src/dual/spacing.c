/* The spacing of samples, from the shortest Delaunay edges. The Delaunay triangulation holds the edge from each sample
 * to its nearest sample, and edges that leave a smooth surface are longer than edges along it. */
#include "dual/spacing.h"
#include "base/memory.h"
#include "base/vector.h"
#include <math.h>

enum { NEAREST = 6 }; /* derived: the mean degree of a triangulated surface */

typedef struct {
    float square[NEAREST]; /* ascending */
    uint32_t sample[NEAREST];
    uint32_t count;
} neighbours;

static void offer(neighbours *n, uint32_t sample, float square) {
    if (n->count == NEAREST && !(square < n->square[NEAREST - 1])) return;
    for (uint32_t i = 0; i < n->count; i++)
        if (n->sample[i] == sample) return;
    uint32_t i = n->count < NEAREST ? n->count++ : NEAREST - 1;
    for (; i > 0 && n->square[i - 1] > square; i--) n->square[i] = n->square[i - 1], n->sample[i] = n->sample[i - 1];
    n->square[i] = square;
    n->sample[i] = sample;
}

static void offer_edge(neighbours *list, const double *points, uint32_t a, uint32_t b) {
    double square = brio_square_distance(points + 3 * (size_t)a, points + 3 * (size_t)b);
    offer(&list[a], b, (float)square);
    offer(&list[b], a, (float)square);
}

brio_status brio_sample_spacing(brio_context *ctx, const brio_triangulation *t, const double *points,
                                size_t num_samples, double *spacing) {
    brio_status status = BRIO_OK;
    neighbours *list = NULL;
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, list, num_samples));
    for (size_t i = 0; i < brio_triangulation_stats(t)->tetrahedra; i++)
        for (int j = 1; j < 4; j++)
            for (int k = 0; k < j; k++) {
                uint32_t a = tet[i].vertex[j], b = tet[i].vertex[k];
                if (a < num_samples && b < num_samples) offer_edge(list, points, a, b);
            }
    for (size_t s = 0; s < num_samples; s++) {
        double sum = 0;
        for (uint32_t i = 0; i < list[s].count; i++) sum += sqrt((double)list[s].square[i]);
        spacing[s] = list[s].count ? sum / list[s].count : 0;
    }
done:
    brio_release(ctx, list);
    return status;
}

void brio_pole_spacing(const brio_poles *poles, size_t num_samples, const double *of_sample, double *spacing) {
    for (size_t p = 0; p < poles->count; p++) spacing[p] = 0;
    for (size_t i = 0; i < 2 * num_samples; i++) {
        uint32_t p = poles->of_sample[i];
        if (p != BRIO_NO_POLE) spacing[p] = fmax(spacing[p], of_sample[i / 2]);
    }
}
