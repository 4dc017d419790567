/* The tetrahedra that hold a query. */
#ifndef BRIO_LOCATE_HOLDER_H
#define BRIO_LOCATE_HOLDER_H

#include "locate/queries.h"

/** A tetrahedron that holds a query, and where in it the query lies. */
typedef struct {
    uint32_t tet; /* a finite tetrahedron whose closure holds the query; BRIO_INFINITE outside the hull */
    unsigned
        zeros; /* bit i: the query is in the plane of the facet opposite to vertex i. One bit: on the facet. Two: on
                       the edge that these facets share. Three: at a vertex. */
} brio_holder;

/** Locates the queries of a row, exactly. Which of several holders is found depends on the querent. */
void brio_find_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]);

/** Returns the tetrahedron of lowest index that holds the query; BRIO_INFINITE for a query outside the hull. */
uint32_t brio_lowest_holder(const brio_locator *l, const brio_holder *h);

/** Locates queries in the tetrahedra of lowest index that hold them. So the result does not depend on the querent. */
void brio_find_lowest_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]);

/** Returns whether the query is on the boundary of the hull.   h  not outside, and not at a vertex. */
bool brio_holder_on_hull(const brio_locator *l, const brio_holder *h);

#endif
