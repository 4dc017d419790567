/* What the labellings share: which poles are certain, the energy of labels, spreading breadth first. */
#include "reconstruct/labelling.h"
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
    for (size_t e = g->first_opposite[p]; e < g->first_opposite[p + 1]; e++)
        if (g->opposite_pole[e] > p && label[g->opposite_pole[e]] == label[p]) sum += g->opposite_weight[e];
    for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++)
        if (g->edge_pole[e] > p && (label[g->edge_pole[e]] == label[p]) == (g->edge_weight[e] < 0))
            sum += fabs((double)g->edge_weight[e]);
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

typedef struct {
    const uint8_t *certain;
    uint8_t *label, give;
    uint32_t *queue;
    size_t size;
} spread;

static void reach(uint32_t pole, double weight, void *user) {
    spread *s = user;
    (void)weight;
    if (s->label[pole] != BRIO_LABEL_NONE) return;
    s->label[pole] = s->certain[pole] ? BRIO_LABEL_OUTER : s->give;
    s->queue[s->size++] = pole;
}

void brio_label_spread(const brio_pole_graph *g, const uint8_t *certain, uint8_t *label, uint32_t *queue, size_t size) {
    spread s = {.certain = certain, .label = label, .queue = queue, .size = size};
    for (size_t next = 0; next < s.size; next++) {
        uint32_t p = queue[next];
        s.give = label[p];
        for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++) reach(g->edge_pole[e], 1, &s);
        s.give = label[p] == BRIO_LABEL_INNER ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER;
        brio_pole_graph_opposite(g, p, reach, &s);
    }
}
