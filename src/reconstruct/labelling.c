/* What the labellings share: which poles are certain, the energy of labels, spreading breadth first. */
#include "reconstruct/labelling.h"
#include <string.h>

void brio_label_certain(const brio_pole_graph *g, uint8_t *certain) {
    memcpy(certain, g->poles->bounding, g->poles->count);
    for (size_t tet = g->num_finite; tet < g->power.count; tet++)
        for (int i = 0; i < 3; i++) certain[g->power.tet[tet].vertex[i]] = 1;
}

/* --- energy --- */

typedef struct {
    const uint8_t *label;
    uint32_t pole;
    double violated;
} sum;

/* Both poles of a sample see the edge between them; it counts once. */
static void add_opposite(uint32_t other, double weight, void *user) {
    sum *s = user;
    if (other > s->pole && s->label[other] == s->label[s->pole]) s->violated += weight;
}

double brio_label_energy(const brio_pole_graph *g, const uint8_t *label) {
    sum s = {.label = label};
    for (s.pole = 0; s.pole < g->poles->count; s.pole++) {
        brio_pole_graph_opposite(g, s.pole, add_opposite, &s);
        for (size_t e = g->first_edge[s.pole]; e < g->first_edge[s.pole + 1]; e++) {
            uint32_t other = g->edge_pole[e];
            if (other > s.pole && g->edge_weight[e] > 0 && label[other] != label[s.pole])
                s.violated += (double)g->edge_weight[e];
        }
    }
    return s.violated;
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

brio_status brio_label_finish(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats) {
    for (size_t p = 0; p < g->poles->count; p++) stats->unreached += label[p] == BRIO_LABEL_NONE;
    return stats->unreached ? brio_label_greedy(g, label, stats) : BRIO_OK;
}
