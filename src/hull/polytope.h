/* A convex polytope that grows point by point: the convex hull of the records inserted so far, as triangles.
 *
 * I1  The triangles are a closed surface. A triangle (a, b, c) is seen counterclockwise from outside: orient3d(a, b, c,
 *     p) is positive for a point p beyond its plane.
 * I2  Edge i of a triangle runs from vertex i + 1 to vertex i + 2 (modulo 3). The handle 4 f + i names edge i of
 *     triangle f; mate[i] is the handle of the same edge in the triangle on its other side.
 * I3  No triangle has area 0. Triangles may lie in one plane, and a vertex may be inside a facet or an edge of the
 *     polytope: hull_faces.c finds the facets.
 * I4  At positions that several records share, the vertex is the first record that was inserted. */
#ifndef BRIO_HULL_POLYTOPE_H
#define BRIO_HULL_POLYTOPE_H

#include "base/context.h"
#include "predicates/predicates.h"
#include <assert.h>

typedef struct {
    uint32_t vertex[3], mate[3];
    uint32_t mark; /* the record for which the triangle was last found visible; for the insertion only */
} brio_hull_triangle;

typedef struct {
    brio_hull_triangle *triangle;
    size_t count, capacity;
    uint32_t *same; /* #records: for a vertex, the record of the lowest index at its position */
    uint64_t created, destroyed, walk_steps, beyond_calls, exact_calls; /* as in brio_convex_hull_stats */
} brio_polytope;

/** Points of a hull. */
typedef struct {
    double (*record)[4];   /* #count + 1: x, y, z, 0; the last row is workspace of brio_polytope_build */
    const uint32_t *index; /* #count: the caller's indices */
    size_t count;
} brio_hull_records;

/** Finds records in general position: a first one, and then those that are farthest from the affine hull of the ones
 *  before. Exact: a dimension below 3 is that of all records.
 *  corner  receives dimension + 1 records.   Returns the dimension, -1 to 3. */
int brio_general_position(brio_filter *f, const double (*record)[4], size_t num_records, uint32_t corner[4]);

/** Builds the convex hull of records of dimension 3, in their order.   seed  of the walk's choices.
 *  corner    what brio_general_position found.
 *  out       without triangles if the rounded centroid of the corners is not strictly inside them.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_polytope_build(brio_context *ctx, const brio_hull_records *records, const uint32_t corner[4],
                                uint64_t seed, brio_polytope *out);

/** Builds the same hull from the Delaunay triangulation of the records; for hulls that are too flat for the other
 *  function. */
brio_status brio_polytope_by_delaunay(brio_context *ctx, const brio_hull_records *records, brio_polytope *out);

/** Frees what a polytope owns. */
void brio_polytope_free(brio_context *ctx, brio_polytope *p);

static inline uint32_t brio_hull_next(uint32_t handle) {
    assert((handle & 3) < 3); /* I2 */
    return (handle & 3) == 2 ? handle - 2 : handle + 1;
}

/** Returns the vertex where an edge begins. */
static inline uint32_t brio_hull_origin(const brio_polytope *p, uint32_t handle) {
    assert(handle >> 2 < p->count && (handle & 3) < 3); /* I2 */
    return p->triangle[handle >> 2].vertex[((handle & 3) + 1) % 3];
}

/** Returns the vertex of the triangle that is not on the edge. */
static inline uint32_t brio_hull_apex(const brio_polytope *p, uint32_t handle) {
    assert(handle >> 2 < p->count && (handle & 3) < 3); /* I2 */
    return p->triangle[handle >> 2].vertex[handle & 3];
}

#endif
