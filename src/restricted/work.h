/* The pieces of a surface that the Voronoi cells of samples cut out of it, by incidences alone.
 *
 * A face is cut into convex polygons, one for each cell that it meets. Their corners are corners of the face, points
 * where an edge of the face meets the bisector of two samples, and points where the face meets the Voronoi edge of
 * three. Each is decided exactly (predicates/bisectors.h), so the lists below are those of one cell complex, whose
 * counts and joints tell the topology of every piece. No point is constructed. */
#ifndef BRIO_RESTRICTED_WORK_H
#define BRIO_RESTRICTED_WORK_H

#include "base/context.h"
#include "predicates/bisectors.h"

/** A face meets the Voronoi edge of three samples, in ascending order. */
typedef struct {
    uint32_t face, sample[3];
    int sign; /* 1: the triangle of the samples, in this order, has its normal on the side of the face's; else -1 */
} brio_crossing;

typedef struct {
    brio_context *ctx;
    const double *points;     /* the samples */
    const brio_mesh *surface; /* triangles, closed */
    const brio_tetrahedron *tet;
    brio_incidences tets, neighbours; /* of each sample that is a vertex */
    uint32_t first_sample;            /* one of these */

    size_t num_edges;
    uint32_t (*end)[2];     /* of each edge, the corners, the lower index first */
    uint32_t (*side)[2];    /* the two faces */
    uint32_t (*edge_of)[3]; /* of each face, the edge from corner i to the next */

    uint32_t *cell;  /* of each vertex of the surface, the nearest sample */
    uint64_t *first; /* of each edge, its first entry in `met`; then the end */
    uint32_t *met;   /* the cells that each edge meets, from its lower corner on */
    size_t met_capacity;
    brio_crossing *crossing;
    size_t num_crossings, crossing_capacity;
    uint64_t *piece; /* sample << 32 | face, of each polygon, by face, then by sample */
    size_t num_pieces, piece_capacity;
    brio_bisector_counts counts;
} brio_restriction;

/** Pairs the edges of the surface. BRIO_ERR_ARGUMENT where an edge has not two faces. */
brio_status brio_restriction_edges(brio_restriction *r);

/** Finds the cells of the vertices, then those along the edges, then the pieces and crossings of the faces. */
brio_status brio_restriction_cut(brio_restriction *r);

/** What the closed-ball test found. */
typedef struct {
    size_t cells, facets, edges;             /* of the Voronoi diagram that meet the surface */
    size_t bad_cells, bad_facets, bad_edges; /* those that meet it in no disk, in no arc, in more than one point */
} brio_ball_counts;

/** Counts which cells, facets and edges meet the surface in a closed ball.
 *  bad  #samples, or NULL: 1 for a sample whose cell, or a facet or edge of it, does not. */
brio_status brio_restriction_balls(brio_restriction *r, brio_ball_counts *counts, uint8_t *bad);

/** Sorts the crossings by their samples, then by face. */
brio_status brio_restriction_sort(brio_restriction *r);

#endif
