/* The co-cone test: which Delaunay triangles may belong to the surface. */
#ifndef BRIO_RECONSTRUCT_COCONE_CANDIDATES_H
#define BRIO_RECONSTRUCT_COCONE_CANDIDATES_H

#include "dual/pole_vectors.h"

/** The candidates among the facets of a Delaunay triangulation. */
typedef struct {
    const brio_pole_vectors *dual;
    const uint8_t *boundary; /* #P: 1 for samples that do not vote on facets with other samples; or NULL */
    uint8_t *candidates;     /* #T: bit i is 1 if facet i is a candidate; set on both sides of a facet */
} brio_cocones;

/** Prepares co-cones without candidates.
 *  dual  kept: it must outlive the result.
 *  out   freed with brio_cocones_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_cocones_new(brio_context *ctx, const brio_pole_vectors *dual, brio_cocones *out);
void brio_cocones_free(brio_context *ctx, brio_cocones *c);

/** Finds the candidates; call once. A facet is a candidate if its dual Voronoi edge meets the co-cone of each of its
 *  samples that is no boundary sample. If all three are boundary samples, the edge must meet all three co-cones.
 *  count  receives the number of candidates. */
brio_status brio_cocones_select(brio_context *ctx, brio_cocones *c, size_t *count);

/** Returns whether the Voronoi edge of a facet meets the co-cone of its sample v. The edge misses the co-cone exactly
 *  if both its ends lie in the same cone of v: each cone is convex, and between the two cones the edge crosses the
 *  co-cone. */
static inline bool brio_meets_cocone(const brio_cocones *c, uint32_t facet, uint32_t v) {
    const brio_tetrahedron *tet = c->dual->t.tet;
    uint32_t here = brio_tet_of(facet), there = brio_tet_of(*brio_mate(&c->dual->t, facet));
    int a = brio_side_of(c->dual, here, brio_slot_of_vertex(tet[here].vertex, v));
    int b = brio_side_of(c->dual, there, brio_slot_of_vertex(tet[there].vertex, v));
    return a != b || a == BRIO_SIDE_COCONE;
}

/** Returns whether all samples of a facet are boundary samples. */
static inline bool brio_is_among_boundary(const brio_cocones *c, uint32_t facet) {
    const uint32_t *v = c->dual->t.tet[brio_tet_of(facet)].vertex;
    for (int k = 0; k < 3; k++) {
        uint32_t p = v[BRIO_FACET[brio_slot_of(facet)][k]];
        if (!c->boundary || (p != BRIO_INFINITE && !c->boundary[p])) return false;
    }
    return true;
}

static inline bool brio_is_candidate(const brio_cocones *c, uint32_t facet) {
    return c->candidates[brio_tet_of(facet)] >> brio_slot_of(facet) & 1;
}

/** Removes a facet and its mate from the candidates. */
static inline void brio_drop_candidate(const brio_cocones *c, uint32_t facet) {
    uint32_t mate = *brio_mate(&c->dual->t, facet);
    c->candidates[brio_tet_of(facet)] &= (uint8_t) ~(1 << brio_slot_of(facet));
    c->candidates[brio_tet_of(mate)] &= (uint8_t) ~(1 << brio_slot_of(mate));
}

#endif
