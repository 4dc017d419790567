/* Points of two sheets, one close behind the other: the walls of a cup are no noise.
 *
 * Where the walls of a thing are a spacing thick, the nearest points of a sample are on both of its sides, and they
 * scatter about a plane as noise does. But noise is most where the surface is, and between two sheets is nothing. Two
 * figures tell: how much of the variance of the heights two layers explain (of 24 points with Gaussian noise 0.68 +-
 * 0.05, with uniform noise 0.75, of two exact sheets 0.87 to 0.98), and how many heights are near 0 (of all: 0.23,
 * 0.18, and under 0.15 even where each sheet has a noise of 0.3 spacings and the other is one spacing away).
 *
 * Based on: Fisher. On grouping for maximum homogeneity. JASA 1958 (the cut of sorted numbers in two). */
#include "reconstruct/noise/two_layers.h"
#include <math.h>
#include <stdlib.h>

/* LEAST_POINTS, of each layer; a layer has at least one of PARTS parts of the points. Chosen. CENTRAL: as the header
 * says. */
enum { LEAST_POINTS = 2, PARTS = 5 };
static const double CENTRAL = 0.3;

/* Sorts by insertion: there are at most BRIO_MOST_NEAR. */
static void sort_heights(double *h, size_t count) {
    for (size_t i = 1; i < count; i++) {
        double x = h[i];
        size_t at = i;
        for (; at > 0 && h[at - 1] > x; at--) h[at] = h[at - 1];
        h[at] = x;
    }
}

static void find_cut(const double *sorted, size_t count, double variance, brio_two_layers *out) {
    size_t least = count / PARTS > LEAST_POINTS ? count / PARTS : LEAST_POINTS;
    double lower = 0, best = 0;
    for (size_t low = 1; low + least <= count; low++) {
        lower += sorted[low - 1];
        if (low < least) continue;
        /* the heights have the sum 0 */
        double between = lower * lower / ((double)low * (double)(count - low));
        if (!(between > best)) continue;
        best = between;
        out->cut = 0.5 * (sorted[low - 1] + sorted[low]);
    }
    out->share = variance > 0 ? best / variance : 0;
}

bool brio_split_layers(brio_neighbourhood *n, brio_two_layers *out) {
    double sorted[BRIO_MOST_NEAR], squares = 0;
    size_t central = 0;
    out->share = out->cut = out->central = out->spread = 0;
    if (!brio_plane_heights(n, out->height)) return false;
    for (size_t i = 0; i < n->count; i++) squares += out->height[i] * out->height[i], sorted[i] = out->height[i];
    double variance = squares / (double)n->count;
    out->spread = sqrt(variance);
    for (size_t i = 0; i < n->count; i++) central += fabs(out->height[i]) < CENTRAL * out->spread;
    out->central = (double)central / (double)n->count;
    sort_heights(sorted, n->count);
    if (n->count >= 2 * LEAST_POINTS) find_cut(sorted, n->count, variance, out);
    return true;
}
