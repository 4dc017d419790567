/* brio/queries.h: what can be asked of a triangulation: location, nearest vertices, interpolation, neighbourhoods.
 *
 * A triangulation keeps no points. A locator is made of a triangulation and its points, and keeps copies of both in a
 * form that queries read fast. Queries are arrays of positions; answers stand in the order of the queries. Answers are
 * exact, and the same for every number of threads and every order of the queries.
 */
#ifndef BRIO_QUERIES_H
#define BRIO_QUERIES_H

#include "triangulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_locator brio_locator;

/** Makes a locator. It needs neither the triangulation nor the points afterwards; its answers are indices of them.
 *  points, weights, num_points  as they were given to brio_delaunay.
 *  out  owned by the caller, freed with brio_locator_free; NULL on error. Several threads, each with a context of its
 *       own, may query one locator.
 *  Memory: 32 bytes a tetrahedron, 41 a vertex, 8 more a vertex with weights: about 260 bytes a vertex for evenly
 *  spread points. Before the tetrahedra are copied, 60 bytes a vertex and 32 a point. Of points in a plane or on a
 *  line, up to the rounding of their coordinates, also a brio_locator2; meanwhile 130 bytes a point more.
 *  Cost: O(n log n).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the points are not those of the triangulation), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_locator_new(brio_context *ctx, const brio_triangulation *t, const double *points,
                                      const double *weights, size_t num_points, brio_locator **out);

/** Frees a locator; NULL is accepted. */
BRIO_API void brio_locator_free(brio_locator *locator);

/* The functions that answer queries take `queries`, #Q by 3, finite. From 32 queries on they are sorted along a
 * space-filling curve first, with 16 bytes of workspace a query, for 2^20 queries at most. They return BRIO_OK,
 * BRIO_ERR_NOT_FINITE (the message names the first such query), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and what their
 * descriptions say. */

/** Finds the tetrahedron that holds each query: the finite one of lowest index whose closure holds it. So a query on a
 *  facet, on an edge or at a vertex belongs to the first of the tetrahedra that share it.
 *  tetrahedra  #Q: indices of brio_triangulation_tetrahedra; none, which is UINT32_MAX as BRIO_INFINITE is, for a query
 *              strictly outside the convex hull, and for every query if the points have dimension 2 or less. Queries on
 *              the hull's boundary are inside.
 *  Cost: one walk; for a query on an edge, O(tetrahedra at that edge).
 *  Based on: [Devillers Pion Teillaud 2002]. */
BRIO_API brio_status brio_locator_tetrahedra(brio_context *ctx, const brio_locator *locator, const double *queries,
                                             size_t num_queries, uint32_t *tetrahedra);

/** Finds the `count` vertices nearest to each query, in ascending order of their distance; weights do not count. Among
 *  vertices at equal distances the lexicographically first ones are taken, and come first. Works in every dimension.
 *  count     at least 1.
 *  vertices  #Q by count: indices of points that are vertices, BRIO_INFINITE where there are fewer vertices.
 *  Returns also BRIO_ERR_ARGUMENT (count is 0), BRIO_ERR_TOO_LARGE (count is over 2^32 - 1). Each thread
 *  takes room for `count` vertices, or all if these are fewer.
 *  Based on: [Friedman Bentley Finkel 1977]. */
BRIO_API brio_status brio_locator_nearest(brio_context *ctx, const brio_locator *locator, const double *queries,
                                          size_t num_queries, size_t count, uint32_t *vertices);

/** Finds the vertex of least power distance |x - p|^2 - w from each query x: the vertex in whose power cell the query
 *  lies. Ties are lexicographic. Without weights it is the nearest vertex. Works in every dimension.
 *  vertices  #Q: indices of points that are vertices; BRIO_INFINITE if there are no points. */
BRIO_API brio_status brio_locator_least_power(brio_context *ctx, const brio_locator *locator, const double *queries,
                                              size_t num_queries, uint32_t *vertices);

typedef enum brio_interpolation_method {
    BRIO_INTERPOLATION_NATURAL = 0, /* natural neighbours: smooth except at the points [Sibson 1981] */
    BRIO_INTERPOLATION_LINEAR = 1,  /* barycentric, in the tetrahedron that holds the query */
    BRIO_INTERPOLATION_END
} brio_interpolation_method;

/** What to interpolate, and how. */
typedef struct brio_interpolation {
    size_t size;
    brio_interpolation_method method;
    int reserved_int;
    const double *values; /* #P by components: row i at point i. Rows of points that are no vertices do not count. */
    size_t components;    /* numbers a row; 0: 1 */
} brio_interpolation;

/** Interpolates values at the vertices, at each query. Both methods reproduce the values at the vertices exactly, and
 *  linear functions up to rounding. NATURAL weighs the natural neighbours of the query x by the volumes that the
 *  Voronoi cell of x would take from their cells. On the hull's boundary, and where rounding drowns these volumes very
 *  near it, NATURAL takes the values of LINEAR. LINEAR takes the tetrahedron that brio_locator_tetrahedra names.
 *  Points in a plane or on a line, up to the rounding of their coordinates (brio_plane_fit), are interpolated there, as
 *  by brio_locator2_interpolate: queries are projected to it.
 *  options  NULL has no values, which is an error unless there are no points.
 *  results  #Q by components: NaN for queries outside the hull, and for every query if there are no points.
 *  Cost: LINEAR as brio_locator_tetrahedra; NATURAL some microseconds a query, as the insertion of a point. In a plane,
 *  16 bytes a query.
 *  Returns also BRIO_ERR_ARGUMENT (options out of range, no values, NATURAL of a triangulation with weights), and
 *  BRIO_ERR_NO_ANSWER if all points are at one position.
 *  Based on: [Sibson 1980], [Sibson 1981], [Ledoux Gold 2005]. */
BRIO_API brio_status brio_locator_interpolate(brio_context *ctx, const brio_locator *locator, const double *queries,
                                              size_t num_queries, const brio_interpolation *options, double *results);

/** Writes for each point a finite tetrahedron that has it: the one of lowest index. BRIO_INFINITE for points that are
 *  no vertices, and for all points if their dimension is 2 or less.   tetrahedra  #P. */
BRIO_API void brio_triangulation_vertex_tetrahedra(const brio_triangulation *t, uint32_t *tetrahedra);

/** A list of numbers for each point: list p is items[offsets[p]] to items[offsets[p + 1] - 1]. */
typedef struct brio_incidences {
    size_t count;      /* lists: #P */
    uint64_t *offsets; /* #P + 1 */
    uint32_t *items;
    brio_context *context;
} brio_incidences;

/** Frees what the lists own and sets their fields to 0; NULL is accepted. */
BRIO_API void brio_incidences_free(brio_incidences *incidences);

/** Lists the finite tetrahedra at each point, in ascending order. The lists of points that are no vertices are empty.
 *  Memory: 8 bytes a point and 16 a tetrahedron.   out  freed with brio_incidences_free.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation_incident_tetrahedra(brio_context *ctx, const brio_triangulation *t,
                                                            brio_incidences *out);

/** Lists the vertices that share an edge with each point, in ascending order. The lists of points that are no vertices
 *  are empty; all are if the dimension is 2 or less.
 *  Memory: 8 bytes a point and 8 an edge; meanwhile, what brio_triangulation_incident_tetrahedra takes.
 *  out  freed with brio_incidences_free.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_neighbours(brio_context *ctx, const brio_triangulation *t,
                                                   brio_incidences *out);

/** Edges between vertices. */
typedef struct brio_edges {
    size_t count;
    uint32_t *ends; /* count by 2 */
    brio_context *context;
} brio_edges;

/** Frees what edges own and sets their fields to 0; NULL is accepted. */
BRIO_API void brio_edges_free(brio_edges *edges);

/** Lists the edges of a triangulation: every edge between two vertices once, as (a, b) with a < b, in lexicographic
 *  order. There are none if the dimension is 2 or less.   out  freed with brio_edges_free.
 *  Memory: as brio_triangulation_neighbours, which it calls, and 8 bytes an edge.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_edges(brio_context *ctx, const brio_triangulation *t, brio_edges *out);

/* Neighbourhoods without memory. `tetrahedra` is what brio_triangulation_tetrahedra returns. */

/** A walk through the ring of tetrahedra round an edge, infinite ones included. A step costs one read of a
 *  tetrahedron. */
typedef struct brio_edge_walk {
    const brio_tetrahedron *tetrahedra;
    uint32_t tetrahedron;        /* where the walk is */
    uint32_t pivot, apex, first; /* the next step goes through the facet opposite to vertex `pivot` */
} brio_edge_walk;

/** Begins in a tetrahedron, at the edge from its slot i to its slot j; the walk is counterclockwise seen from j. */
static inline brio_edge_walk brio_edge_walk_begin(const brio_tetrahedron *tetrahedra, uint32_t tetrahedron, int i,
                                                  int j) {
    static const unsigned char K[4][4] = {{0, 2, 3, 1}, {3, 0, 0, 2}, {1, 3, 0, 0}, {2, 0, 1, 0}};
    const uint32_t *v = tetrahedra[tetrahedron].vertex;
    brio_edge_walk walk = {tetrahedra, tetrahedron, v[K[i][j]], v[6 - i - j - K[i][j]], tetrahedron};
    return walk;
}

/** Goes on to the next tetrahedron. Returns 0, and is where it began, after the last one. */
static inline int brio_edge_walk_next(brio_edge_walk *walk) {
    const brio_tetrahedron *tet = &walk->tetrahedra[walk->tetrahedron];
    int slot =
        (tet->vertex[1] == walk->pivot) + 2 * (tet->vertex[2] == walk->pivot) + 3 * (tet->vertex[3] == walk->pivot);
    uint32_t mate = tet->mate[slot];
    walk->pivot = walk->apex;
    walk->tetrahedron = mate >> 2;
    walk->apex = walk->tetrahedra[mate >> 2].vertex[mate & 3];
    return walk->tetrahedron != walk->first;
}

/** Collects the tetrahedra round a vertex, infinite ones included, from one of them. Returns their number, or capacity
 *  + 1 if there are more than `capacity`.
 *  star  room for `capacity` tetrahedra.
 *  Cost: quadratic in the number, about 27 for most vertices; for many or large stars use
 *  brio_triangulation_incident_tetrahedra. */
static inline size_t brio_vertex_star(const brio_tetrahedron *tetrahedra, uint32_t vertex, uint32_t first,
                                      uint32_t *star, size_t capacity) {
    size_t count = 0;
    if (!capacity) return 1;
    star[count++] = first;
    for (size_t n = 0; n < count; n++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = tetrahedra[star[n]].mate[i] >> 2;
            size_t k = 0;
            if (tetrahedra[star[n]].vertex[i] == vertex) continue;
            while (k < count && star[k] != other) k++;
            if (k < count) continue;
            if (count == capacity) return capacity + 1;
            star[count++] = other;
        }
    return count;
}

#ifdef __cplusplus
}
#endif
#endif
