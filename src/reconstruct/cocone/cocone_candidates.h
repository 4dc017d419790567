/* The co-cone test: which Delaunay triangles may belong to the surface. */
#ifndef BRIO_RECONSTRUCT_COCONE_CANDIDATES_H
#define BRIO_RECONSTRUCT_COCONE_CANDIDATES_H

#include "dual/pole_vectors.h"

/** What the co-cones make of a Delaunay triangulation. */
typedef struct {
    const brio_pole_vectors *dual;
    const uint8_t *boundary; /* #P: 1 for samples that take no part in the test; or NULL */
    uint8_t *candidates;     /* #T: bit i tells whether facet i is a candidate; set on both sides of a facet */
} brio_cocones;

/** Keeps dual; what it holds is to be freed on failure too. Finds no candidates yet. */
brio_status brio_cocones_new(brio_context *ctx, const brio_pole_vectors *dual, brio_cocones *out);
void brio_cocones_free(brio_context *ctx, brio_cocones *c);

/** Finds the candidates, once: the facets whose dual Voronoi edge meets the co-cone of each of their samples that take
 *  part or, where none does, of each of their samples.   count  receives the number of candidates. */
void brio_cocones_select(brio_context *ctx, brio_cocones *c, size_t *count);

/** Whether the Voronoi edge of facet `slot` of a tetrahedron meets the co-cone of its sample v: unless both ends lie in
 *  one cone. (A cone is convex, so the edge then stays in it; between the two cones it crosses the co-cone.) */
static inline bool brio_meets_cocone(const brio_cocones *c, uint32_t facet, uint32_t v) {
    const brio_tetrahedron *tet = c->dual->t.tet;
    uint32_t here = brio_tet_of(facet), there = brio_tet_of(*brio_mate(&c->dual->t, facet));
    int a = brio_side_of(c->dual, here, brio_slot_of_vertex(tet[here].vertex, v));
    int b = brio_side_of(c->dual, there, brio_slot_of_vertex(tet[there].vertex, v));
    return a != b || a == BRIO_SIDE_COCONE;
}

/** Whether all samples of a facet are boundary samples. */
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

/** Takes a facet out of the candidates. */
static inline void brio_drop_candidate(const brio_cocones *c, uint32_t facet) {
    uint32_t mate = *brio_mate(&c->dual->t, facet);
    c->candidates[brio_tet_of(facet)] &= (uint8_t) ~(1 << brio_slot_of(facet));
    c->candidates[brio_tet_of(mate)] &= (uint8_t) ~(1 << brio_slot_of(mate));
}

#endif
