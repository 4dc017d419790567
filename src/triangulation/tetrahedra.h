/* The tetrahedra: the one data structure of the insertion (store.h), of the result and of the checks.
 *
 *   tet[t].vertex[i]   vertex i of tetrahedron t: the row of a record, or `infinite`
 *   tet[t].mate[i]     facet handle 4 u + j of the same triangle seen from the tetrahedron u on its other side
 *
 * I1  A finite tetrahedron is positive: det [b-a, c-a, d-a] > 0.
 * I2  The infinite vertex is only ever in slot 3, and (a, b, c, x) is positive for x strictly outside the hull facet
 *     abc.
 * I3  mate is an involution, and mates have the same three vertices.
 * I4  Between insertions the tetrahedra of a store are those of the perturbed regular triangulation of the points
 *     inserted so far.
 *
 * Not stored: a tetrahedron of each vertex, circumcentres, anything about facets or edges.
 *
 * Points are records of four doubles, x y z weight, in insertion order, so that neighbours in the order are neighbours
 * in memory. */
#ifndef BRIO_TRIANGULATION_TETRAHEDRA_H
#define BRIO_TRIANGULATION_TETRAHEDRA_H

#include "base/context.h"
#include "predicates/predicates.h"
#include <assert.h>

typedef double brio_record[4];

typedef struct {
    brio_tetrahedron *tet;
    size_t count;
    uint32_t infinite;
    const brio_record *record;
} brio_tetrahedra;

/* Makes a facet handle. bits 0 and 1: the slot opposite to the facet; bits 2 to 31: the tetrahedron, at most 2^30 of
 * them. */
static inline uint32_t brio_facet_of(uint32_t tet, int i) {
    assert(tet >> 30 == 0 && 0 <= i && i < 4);
    return 4 * tet + (uint32_t)i;
}
static inline uint32_t brio_tet_of(uint32_t facet) {
    return facet >> 2;
}
static inline int brio_slot_of(uint32_t facet) {
    return (int)(facet & 3);
}

/* Returns whether there is a tetrahedron, or a slot for one, of that number. In a parallel pass other threads hand out
 * slots meanwhile. */
static inline bool brio_has_tet(const brio_tetrahedra *t, uint32_t tet) {
    return tet < __atomic_load_n(&t->count, __ATOMIC_RELAXED);
}

/* Return the place of the mate of a facet (brio_mate), and the vertex opposite to a facet (brio_apex). */
static inline uint32_t *brio_mate(const brio_tetrahedra *t, uint32_t facet) {
    assert(brio_has_tet(t, brio_tet_of(facet)));
    return &t->tet[brio_tet_of(facet)].mate[brio_slot_of(facet)];
}
static inline uint32_t brio_apex(const brio_tetrahedra *t, uint32_t facet) {
    assert(brio_has_tet(t, brio_tet_of(facet)));
    return t->tet[brio_tet_of(facet)].vertex[brio_slot_of(facet)];
}

static inline bool brio_is_infinite(const brio_tetrahedra *t, uint32_t tet) {
    assert(brio_has_tet(t, tet));
    return t->tet[tet].vertex[3] == t->infinite;
}

/* FACET[i]: the other three slots such that (FACET[i], slot i) is an even permutation of the slots. */
static const uint8_t BRIO_FACET[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

/* EDGE[i][j] = k, l such that (i, j, k, l) is an even permutation: the directed edge that facets i and j share. */
static const uint8_t BRIO_EDGE[4][4][2] = {
    {{0, 0}, {2, 3}, {3, 1}, {1, 2}},
    {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
    {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
    {{2, 1}, {0, 2}, {1, 0}, {0, 0}},
};

/* Returns the slot of vertex v in a tetrahedron; 4 when the tetrahedron does not have v. */
static inline int brio_slot_of_vertex(const uint32_t v4[4], uint32_t v) {
    return v4[0] == v ? 0 : v4[1] == v ? 1 : v4[2] == v ? 2 : v4[3] == v ? 3 : 4;
}

/* Returns whether a point conflicts with a tetrahedron: inside its sphere, or strictly outside its hull facet; in the
 * plane of a hull facet the finite neighbour decides. Ties are broken, so that the answer is never on the border. */
static inline bool brio_in_conflict(const brio_tetrahedra *t, brio_filter *f, uint32_t tet, const double *p,
                                    const bool weighted) {
    assert(brio_has_tet(t, tet) && t->record);
    const uint32_t *v = t->tet[tet].vertex;
    if (v[3] == t->infinite) {
        int side = brio_orient3d_sign(f, t->record[v[0]], t->record[v[1]], t->record[v[2]], p);
        if (side) return side > 0;
        assert(brio_has_tet(t, brio_tet_of(t->tet[tet].mate[3])));
        v = t->tet[brio_tet_of(t->tet[tet].mate[3])].vertex;
        assert(v[3] != t->infinite); /* behind facet 3, the hull facet, is a finite tetrahedron (I2) */
    }
    assert(v[0] != t->infinite && v[1] != t->infinite && v[2] != t->infinite); /* I2 */
    return brio_conflict(f, t->record[v[0]], t->record[v[1]], t->record[v[2]], t->record[v[3]], p, weighted);
}

/* Returns what brio_in_conflict returns, by the last stages at once: for tests that stages 1 to 3 left open. */
bool brio_in_conflict_late(const brio_tetrahedra *t, brio_filter *f, uint32_t tet, const double *p, bool weighted);

#endif
