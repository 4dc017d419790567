/* Sibson's coordinates of a query: the shares of its Voronoi cell that it would take from the cells of its natural
 * neighbours. */
#ifndef BRIO_LOCATE_NATURAL_H
#define BRIO_LOCATE_NATURAL_H

#include "locate/barycentric.h"
#include "locate/index_map.h"

/** A dual edge: the facet between two tetrahedra of the cavity, or on its border. */
typedef struct {
    uint32_t corner[3]; /* local vertices, such that (corner, apex of tetrahedron `from`) is positive */
    uint32_t from, to;  /* centres: of the tetrahedron that the facet is seen from, and behind it */
} brio_dual_edge;

/** What is known of an edge of the cavity: the facet between the Voronoi cells of its ends. */
typedef struct {
    uint32_t end[2]; /* local vertices, end[0] < end[1] */
    uint32_t origin; /* a centre on the facet */
    double area[3];  /* twice the vector area of the facet's part inside the query's cell */
} brio_dual_facet;

/** The workspace of one thread, and the coordinates that were computed last. Offsets are relative to the query and
 *  scaled. */
typedef struct {
    brio_context *ctx;
    brio_index_map tets, vertices, edges; /* to the arrays below */
    uint32_t *tet;                        /* the cavity: the tetrahedra whose spheres hold the query */
    uint32_t *place;                      /* of each local vertex; local vertex 0 is the query */
    uint32_t (*corner)[4];                /* of each centre: the local vertices of its tetrahedron */
    double (*offset)[3], (*centre)[3];    /* of local vertices; of centres */
    uint32_t *base;                       /* of each local vertex: a centre on its bisector with the query */
    double *share;                        /* of each local vertex: its coordinate; 0 for the query */
    brio_dual_edge *edge;
    brio_dual_facet *facet;
    size_t num_tets, num_vertices, num_centres, num_edges, num_facets;
    size_t tet_room, place_room, corner_room, offset_room, centre_room, base_room, share_room, edge_room, facet_room;
} brio_natural;

void brio_natural_free(brio_natural *n);

/** Computes the coordinates of x: share[1 .. num_vertices) of the vertices place[1 .. num_vertices). They are at least 0
 *  and sum to 1. Sets *found to false where doubles do not suffice, very near the hull.
 *  h  what brio_find_holders found: inside, not on the hull, not at a vertex. The locator has no weights.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_natural_coordinates(brio_natural *n, brio_querent *q, const brio_holder *h, const double *x,
                                     bool *found);

#endif
