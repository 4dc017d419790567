/* Gaps between the faces chosen from the boundary of labeled tetrahedra. */
#ifndef BRIO_RECONSTRUCT_SURFACE_GAPS_H
#define BRIO_RECONSTRUCT_SURFACE_GAPS_H

#include "reconstruct/cocone/label_boundary.h"

/** The facets of the boundary between two labels, and which of them are faces. */
typedef struct {
    const brio_tet_labels *labels;
    const brio_cocones *cocones;   /* of the labels */
    const brio_pole_vectors *dual; /* of the cocones */
    const uint32_t *facets;        /* as brio_boundary_facets lists them */
    size_t num_facets;
    uint8_t *face; /* #T: bit i is 1 if facet i is a face */
} brio_face_choice;

/* Test, set and clear the bit of a facet. */
static inline bool brio_is_face(const brio_face_choice *c, uint32_t facet) {
    return c->face[brio_tet_of(facet)] >> brio_slot_of(facet) & 1;
}

static inline void brio_set_face(const brio_face_choice *c, uint32_t facet) {
    c->face[brio_tet_of(facet)] |= (uint8_t)(1 << brio_slot_of(facet));
}

static inline void brio_clear_face(const brio_face_choice *c, uint32_t facet) {
    c->face[brio_tet_of(facet)] &= (uint8_t) ~(1 << brio_slot_of(facet));
}

/** Returns corner k (0, 1, 2) of a facet, counterclockwise as seen from the facet's tetrahedron. */
static inline uint32_t brio_corner_of(const brio_face_choice *c, uint32_t facet, int k) {
    return c->dual->t.tet[brio_tet_of(facet)].vertex[BRIO_FACET[brio_slot_of(facet)][k]];
}

/** Makes faces of the facets in gaps that are no openings or, with `all`, of all finite facets. With boundary samples,
 *  first removes the faces that span openings.
 *  open  receives the facets that stay open, *num_open of them, owned by the caller (brio_release), on failure too;
 *        NULL if there are none.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_fill_gaps(brio_context *ctx, const brio_face_choice *c, bool all, uint32_t **open, size_t *num_open);

#endif
