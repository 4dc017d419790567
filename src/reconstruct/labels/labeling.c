/* What the labelings share: the certain poles, the energy of labels, spreading labels breadth first. */
#include "reconstruct/labels/labeling.h"
#include "base/team.h"
#include <math.h>
#include <string.h>

/* Both chosen. */
enum { PARTS = 256, POLES_A_THREAD = 2048 };

void brio_label_certain(const brio_pole_graph *g, uint8_t *certain) {
    memcpy(certain, g->diagram->poles->bounding, g->diagram->poles->count);
    for (size_t tet = g->diagram->num_finite; tet < g->diagram->power.count; tet++)
        for (int i = 0; i < 3; i++) certain[g->diagram->power.tet[tet].vertex[i]] = 1;
}

/* --- energy --- */

/* Sums |weight| over the violated edges from pole p to poles of higher number, so that each edge counts once. */
static double violated_at(const brio_pole_graph *g, const uint8_t *label, size_t p) {
    double sum = 0;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        if (g->edge[e].pole > p && brio_label_violates(label, (uint32_t)p, g->edge[e]))
            sum += fabs((double)g->edge[e].weight);
    return sum;
}

typedef struct {
    const brio_pole_graph *g;
    const uint8_t *label;
    double part[PARTS];
} energy;

static void sum_parts(void *user, size_t begin, size_t end, int thread) {
    energy *e = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        size_t to = brio_part(e->g->diagram->poles->count, (int)i + 1, PARTS);
        double sum = 0;
        for (size_t p = brio_part(e->g->diagram->poles->count, (int)i, PARTS); p < to; p++)
            sum += violated_at(e->g, e->label, p);
        e->part[i] = sum;
    }
}

/* Sums in PARTS parts for every number of threads, so that the rounding does not depend on the threads. */
double brio_label_energy(const brio_pole_graph *g, const uint8_t *label) {
    energy e = {.g = g, .label = label};
    double sum = 0;
    brio_for_chunks(g->ctx, brio_threads(g->ctx, g->diagram->poles->count, POLES_A_THREAD), PARTS, 1, sum_parts, &e);
    for (int i = 0; i < PARTS; i++) sum += e.part[i];
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
