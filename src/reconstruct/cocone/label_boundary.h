/* Walking on the boundary between outer and inner tetrahedra. */
#ifndef BRIO_RECONSTRUCT_LABEL_BOUNDARY_H
#define BRIO_RECONSTRUCT_LABEL_BOUNDARY_H

#include "base/sort.h"
#include "reconstruct/cocone/tetrahedron_labels.h"

/** A list of facet handles. */
typedef struct {
    uint32_t *facet;
    size_t count;
} brio_facets;

/** Lists the facets between outer and inner tetrahedra in ascending order. Each facet is the handle in its outer
 *  tetrahedron.
 *  out  receives the list; out->facet is owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_boundary_facets(brio_context *ctx, const brio_tet_labels *labels, brio_facets *out);

/** Returns whether a facet separates two labels. */
static inline bool brio_is_boundary(const brio_tet_labels *labels, uint32_t facet) {
    uint32_t mate = *brio_mate(&labels->dual->t, facet);
    return labels->label[brio_tet_of(facet)] != labels->label[brio_tet_of(mate)];
}

/** Returns the slot that is neither `but` nor that of vertex a or b. The slots of a tetrahedron sum to 6. */
static inline int brio_last_slot(const uint32_t v[4], uint32_t a, uint32_t b, int but) {
    int others = 0; /* no branches: a processor could not predict them */
    for (int k = 1; k < 4; k++) others += k * ((v[k] == a) | (v[k] == b));
    return 6 - others - but;
}

/** Returns the next boundary facet round edge ab. The tetrahedra of `facet` and of the result have one label, and so
 *  have the tetrahedra between them. */
static inline uint32_t brio_next_round_edge(const brio_tet_labels *labels, uint32_t facet, uint32_t a, uint32_t b) {
    const brio_tetrahedra *t = &labels->dual->t;
    for (;;) {
        uint32_t tet = brio_tet_of(facet);
        facet = brio_facet_of(tet, brio_last_slot(t->tet[tet].vertex, a, b, brio_slot_of(facet)));
        if (brio_is_boundary(labels, facet)) return facet;
        facet = *brio_mate(t, facet);
    }
}

/** Returns the corner after v of a facet, counterclockwise as seen from the facet's tetrahedron. */
static inline uint32_t brio_corner_after(const brio_tetrahedra *t, uint32_t facet, uint32_t v) {
    const uint32_t *vertex = t->tet[brio_tet_of(facet)].vertex;
    const uint8_t *corner = BRIO_FACET[brio_slot_of(facet)];
    int k = vertex[corner[0]] == v ? 1 : vertex[corner[1]] == v ? 2 : 0;
    return vertex[corner[k]];
}

/** Returns the next boundary facet round vertex v, counterclockwise as seen from the facet's tetrahedron. */
static inline uint32_t brio_next_round_vertex(const brio_tet_labels *labels, uint32_t facet, uint32_t v) {
    const brio_tetrahedra *t = &labels->dual->t;
    uint32_t after = brio_corner_after(t, facet, v);
    return brio_next_round_edge(labels, facet, v, brio_corner_after(t, facet, after));
}

static inline int brio_compare_positions(uint32_t a, uint32_t b, const void *points) {
    return brio_lexicographic((const double *)points + 3 * (size_t)a, (const double *)points + 3 * (size_t)b);
}

/** Sorts samples by position, so that work in this order does not depend on the numbers of the samples. */
static inline void brio_sort_by_position(const double *points, uint32_t *samples, size_t n) {
    brio_sort_indices(samples, n, brio_compare_positions, points);
}

#endif
