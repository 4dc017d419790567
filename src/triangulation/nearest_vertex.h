/* The vertex of least power distance. */
#ifndef BRIO_TRIANGULATION_NEAREST_VERTEX_H
#define BRIO_TRIANGULATION_NEAREST_VERTEX_H

#include "triangulation/star.h"

/** A memory of one vertex with a large star: within `radius` of `centre`, only the rivals can be nearer than the
 *  vertex itself. */
typedef struct {
    uint32_t vertex;
    double centre[3], radius;
    uint32_t *rival;
    size_t num_rivals, capacity;
} brio_nearest_memory;

enum { BRIO_NEAREST_MEMORIES = 64 };

typedef struct {
    brio_context *ctx;
    const brio_tetrahedra *t;
    size_t num_points;          /* vertices from num_points on are apexes of flat inputs, or the infinite vertex */
    const uint32_t *vertex_tet; /* a tetrahedron of each vertex */
    brio_star star;
    uint32_t *seen; /* of each vertex, the last look that compared it */
    uint32_t look;
    brio_nearest_memory memory[BRIO_NEAREST_MEMORIES];
} brio_nearest;

/** Makes the workspace of searches among the vertices of t. Keeps the pointers that it is given. */
brio_status brio_nearest_new(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, const uint32_t *vertex_tet,
                             brio_nearest *out);
void brio_nearest_free(brio_nearest *n);

/** Sets *best to the vertex of least power distance from x; ties are lexicographic. Starts from the vertices of
 *  tetrahedron tet, near x. Exact. Skips apexes of flat inputs: the edges of the flat triangulation suffice. */
brio_status brio_nearest_vertex(brio_nearest *n, uint32_t tet, const double *x, uint32_t *best);

#endif
