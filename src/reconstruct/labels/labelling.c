/* What the labellings share: which poles are certain, the energy of labels, spreading breadth first. */
#include "reconstruct/labels/labelling.h"
#include "base/parallel.h"
#include <math.h>
#include <string.h>

void brio_label_certain(const brio_pole_graph *g, uint8_t *certain) {
    memcpy(certain, g->poles->bounding, g->poles->count);
    for (size_t tet = g->num_finite; tet < g->power.count; tet++)
        for (int i = 0; i < 3; i++) certain[g->power.tet[tet].vertex[i]] = 1;
}

/* --- energy --- */

/* Both ends see an edge; it counts at the lower one. */
static double violated_at(const brio_pole_graph *g, const uint8_t *label, size_t p) {
    double sum = 0;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        if (g->edge[e].pole > p && brio_label_violates(label, (uint32_t)p, g->edge[e]))
            sum += fabs((double)g->edge[e].weight);
    return sum;
}

/* Summed in parts that do not depend on the number of threads, nor then does the rounding. */
double brio_label_energy(const brio_pole_graph *g, const uint8_t *label) {
    enum { PARTS = 256 };
    double part[PARTS] = {0}, sum = 0;
    BRIO_OMP(parallel for schedule(dynamic, 1) num_threads(brio_context_threads(g->ctx)))
    for (int i = 0; i < PARTS; i++) {
        size_t end = brio_part(g->poles->count, i + 1, PARTS);
        for (size_t p = brio_part(g->poles->count, i, PARTS); p < end; p++) part[i] += violated_at(g, label, p);
    }
    for (int i = 0; i < PARTS; i++) sum += part[i];
    return sum;
}

/* --- spreading --- */

void brio_label_spread(const brio_pole_graph *g, const uint8_t *certain, uint8_t *label, uint32_t *queue, size_t size) {
    for (size_t next = 0; next < size; next++) {
        uint32_t p = queue[next];
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
            brio_pole_edge to = g->edge[e];
            if (label[to.pole] != BRIO_LABEL_NONE) continue;
            label[to.pole] = certain[to.pole] ? BRIO_LABEL_OUTER
                             : to.weight < 0  ? brio_other_label(label[p])
                                              : label[p];
            queue[size++] = to.pole;
        }
    }
}
