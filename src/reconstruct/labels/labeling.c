/* What the labelings share: the certain poles, spreading labels breadth first. */
#include "reconstruct/labels/labeling.h"
#include <string.h>

void brio_label_certain(const brio_pole_graph *g, uint8_t *certain) {
    memcpy(certain, g->diagram->poles->bounding, g->diagram->poles->count);
    for (size_t tet = g->diagram->num_finite; tet < g->diagram->power.count; tet++)
        for (int i = 0; i < 3; i++) certain[g->diagram->power.tet[tet].vertex[i]] = 1;
}

/* --- spreading --- */

void brio_label_spread(const brio_pole_graph *g, const uint8_t *certain, uint8_t *label, uint32_t *queue, size_t size) {
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
