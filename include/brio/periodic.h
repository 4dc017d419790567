/* brio/periodic.h: triangulations and Voronoi cells of points in space that repeats. */
#ifndef BRIO_PERIODIC_H
#define BRIO_PERIODIC_H

#include "cells.h"
#include "shapes.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A translate of a point: its position is that of the point + shift[0] a + shift[1] b + shift[2] c. Here a, b, c are
 *  the vectors of the cell as they were used (brio_periodic_stats). Directions that do not repeat have shifts of 0. */
typedef struct brio_image {
    uint32_t point;
    int32_t shift[3];
} brio_image;

typedef struct brio_periodic_options {
    size_t size;
    const double *cell; /* 3 by 3: the vectors a, b, c; those that do not repeat are not read */
    uint64_t seed;      /* as in brio_delaunay_options; only the order of the result depends on it */
    double halo;        /* translates within this number of spacings are triangulated at once; others are looked for
                      where they are needed. 0: the usual 2.5. Only the order of the result depends on it */
    int open[3];        /* 1 for a direction that does not repeat */
    int reserved_int;   /* 0 */
    double reach;       /* with fewer than three directions, the grid is made for points that reach at least this far.
                      0: as far as these do, and the longest vector. So sets of points can have one grid */
    int weighted;       /* of brio_dynamic_periodic_new alone: 1 if later points will have weights */
    int reserved_more;  /* 0 */
} brio_periodic_options;

/** Facts of a periodic triangulation. */
typedef struct brio_periodic_stats {
    size_t size;
    size_t points, vertices, duplicates, hidden;
    int directions;      /* that repeat: 1 to 3 */
    int dimension;       /* of the affine hull of all translates: 1 to 3 */
    size_t tetrahedra;   /* finite ones of the result, one of each class of translates */
    size_t hull_facets;  /* infinite ones; 0 with three directions */
    size_t images;       /* translates that the result names */
    double cell[9];      /* the vectors a, b, c as they were used; those that do not repeat are 0 */
    double cell_volume;  /* of the vectors that repeat: a volume, an area or a length */
    double cell_moved;   /* the largest move of a coordinate of a vector when the cell was put on its grid */
    double moved;        /* the same of the points, relative to each other and to the cell */
    size_t triangulated; /* points and translates that were triangulated, all rounds together */
    size_t completed;    /* points whose surroundings were not known at once */
    int rounds;          /* of triangulation */
    double seconds;
} brio_periodic_stats;

typedef struct brio_periodic brio_periodic;

/** Builds the Delaunay triangulation of points that repeat or, with weights, the regular triangulation: that of the
 *  infinite set of all translates of the points by sums of the vectors of the cell. It repeats, too; the result has one
 *  tetrahedron of each class of translates.
 *  Every cell has a result: of one point, thin ones, and skewed ones, whose lattice is reduced first. Points may lie
 *  outside the cell.
 *  Grid: sums of doubles are no doubles. So vectors and points are put on a grid first, on which all translates that
 *  matter are exact. In each coordinate it is finer than 2^-47 of the longest vector of the reduced lattice, or of how
 *  far the points reach where fewer than three directions repeat. For vectors it is 8 times as coarse. The result is
 *  exact for these, ties included (decision 018). Points at halves, quarters and eighths of the cell stay there, as do
 *  coordinates in which no vector of the cell goes anywhere.
 *  The result does not depend on the order of the points, on the number of threads, on which translate of a point is
 *  given, or on the origin: as long as these change positions by multiples of the grid, or by what rounding to doubles
 *  adds to such multiples; where there are no ties, by any rounding.
 *  points, weights, num_points  as brio_delaunay.
 *  options  with the cell.   out  owned by the caller, freed with brio_periodic_free; NULL on error.
 *  Cost: as brio_delaunay for the points and the translates in a margin of 2.5 spacings.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no direction repeats; the vectors span nothing, are too skewed, or not between
 *  about 1e-100 and 1e100 long; a point is more than 2^26 cells away), and as brio_delaunay.
 *  Based on: [Caroli Teillaud 2016] for triangulations of closed Euclidean manifolds; [Devillers Teillaud 2011] for
 *  ties. */
BRIO_API brio_status brio_delaunay_periodic(brio_context *ctx, const double *points, const double *weights,
                                            size_t num_points, const brio_periodic_options *options,
                                            brio_periodic **out);

/** Frees a periodic triangulation; NULL is accepted. */
BRIO_API void brio_periodic_free(brio_periodic *t);

/** Returns the facts of a periodic triangulation. The view is valid until it is freed, as are those below. */
BRIO_API const brio_periodic_stats *brio_periodic_facts(const brio_periodic *t);

/** Returns the translates that tetrahedra name, stats.images of them. Image i < #P is of point i: the translate that
 *  lies in the domain that the library chose. */
BRIO_API const brio_image *brio_periodic_images(const brio_periodic *t);

/** Returns the positions of the images, stats.images by 3. */
BRIO_API const double *brio_periodic_positions(const brio_periodic *t);

/** Returns the tetrahedra + hull_facets tetrahedra, finite ones first, as brio_triangulation_tetrahedra does; vertices
 *  are indices of images. Of each class there is the one whose lexicographically least vertex is an image i < #P. A
 *  mate is in the array, too: seen from there, the common facet is a translate of the facet that is seen from here. */
BRIO_API const brio_tetrahedron *brio_periodic_tetrahedra(const brio_periodic *t);

/** Returns #P translates: for each point, the vertex that represents it. A vertex represents itself, with the shift 0.
 *  A duplicate has the vertex at its position, and a hidden point the vertex of least power distance. */
BRIO_API const brio_image *brio_periodic_representatives(const brio_periodic *t);

/** Computes a hash of the set of tetrahedra, from how vertices lie to each other. It does not depend on the order of
 *  points or tetrahedra, the origin, or which translates were given. Scaling all by a power of two does not change
 *  it.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_periodic_checksum(brio_context *ctx, const brio_periodic *t, uint64_t *checksum);

/** Checks a periodic triangulation exactly, without the code that made it: tetrahedra are positive; mates share facets;
 *  no vertex behind a facet is in conflict, ties included; every point has a vertex that represents it. Space is
 *  covered once, so that no vertex at all is in conflict: where all directions repeat, by the sum of volumes; with
 *  fewer, by the hull, which is convex, lies along the directions and goes round once. Where points and translates have
 *  dimension 2 or less, there are no tetrahedra: that the dimension is right is checked then, and which points are
 *  vertices is not. That hidden points are hidden is not checked.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_periodic_check(brio_context *ctx, const brio_periodic *t);

/** Computes the Voronoi cells, or power cells, of the vertices, as brio_voronoi_cells does. Cells are those of the
 *  points where they are given: centroids and vertices are near them. Face f is shared with the translate of the point
 *  face_neighbours[f] by face_shifts[f]. A cell can have several faces with one point, also with itself.
 *  options  NULL for the defaults. `box` clips along coordinates in which no vector of the cell goes anywhere, the
 *           others are not read; `planes` must be none.
 *  out  owned by the caller, freed with brio_cells_free; NULL on error. volume_sum is that of the cell up to 1e-13. */
BRIO_API brio_status brio_periodic_cells(brio_context *ctx, const brio_periodic *t, const brio_cells_options *options,
                                         brio_cells **out);

/** The alpha complex of a periodic triangulation: one simplex of each class of translates. It owns all arrays. */
typedef struct brio_periodic_alpha {
    size_t size; /* of the struct in the library that runs */
    brio_context *context;
    brio_alpha_complex *complex; /* simplices name images, ascending in each; without a triangulation */
    size_t num_images;
    brio_image *images;            /* those of brio_periodic_images first */
    double *positions;             /* #images by 3 */
    const brio_periodic *periodic; /* this came later. Not owned; must outlive the complex */
} brio_periodic_alpha;

/** Finds the values of the simplices in the alpha filtration, as brio_alpha_values does. Of each class there is the
 *  simplex whose lexicographically least vertex is an image i < #P; tetrahedra come in the order of
 *  brio_periodic_tetrahedra. A face of a simplex is in the list, or a translate of it is. No value is greater than that
 *  of a coface, and translates have the same bits. The Euler characteristic, counts[0] - counts[1] + counts[2] -
 *  counts[3], is 0. brio_alpha_order takes the complex, and brio_write_filtration; but a program that reads
 *  such a file as a complex of its vertices does not know which images are translates of each other:
 *  brio_periodic_alpha_by_points makes the complex for that.
 *  out  owned by the caller, freed with brio_periodic_alpha_free; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (there are no tetrahedra), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Edelsbrunner Muecke 1994], [Edelsbrunner 1995]. */
BRIO_API brio_status brio_periodic_alpha_values(brio_context *ctx, const brio_periodic *t, brio_periodic_alpha **out);

/** Frees an alpha complex; NULL is accepted. */
BRIO_API void brio_periodic_alpha_free(brio_periodic_alpha *alpha);

/** Makes the complex whose simplices name points, ascending in each: what programs for persistent homology take. It is
 *  that of the torus if no two points are neighbours in two ways, as in cells of more than about a hundred points.
 *  out  zeros at first; freed with brio_alpha_complex_free.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (two simplices have the same points, or one has a point twice: repeat the cell),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_periodic_alpha_by_points(brio_context *ctx, const brio_periodic_alpha *alpha,
                                                   brio_alpha_complex *out);

/** Finds the least alpha at which the tetrahedra are one solid, joined across facets and to their translates, that has
 *  all vertices.   Errors as brio_alpha_auto. */
BRIO_API brio_status brio_periodic_alpha_auto(brio_context *ctx, const brio_periodic_alpha *complex, double *alpha);

/** Facts of an alpha shape in space that repeats. Each class of translates counts once. */
typedef struct brio_periodic_shape_stats {
    size_t size;
    double alpha;
    size_t tetrahedra; /* in the complex */
    size_t vertices;   /* points on the surface */
    size_t split;     /* vertices of the surface beyond these: where parts of the solid touch, each sheet has its own */
    size_t uncovered; /* vertices of the triangulation that are in no tetrahedron of the complex */
    size_t singular_vertices, singular_edges, singular_facets; /* in the complex, bounding no tetrahedron of it */
    size_t components;                                         /* of the surface */
    int64_t euler;                                             /* vertices - edges + faces of the surface */
    double area, volume;                                       /* of the surface; of the solid */
} brio_periodic_shape_stats;

/** Makes the boundary of an alpha shape in space that repeats: the facets between tetrahedra with values of at most
 *  alpha and others, one of each class. Triangles are seen counterclockwise from outside. As a surface that repeats it
 *  is closed and manifold: where parts of the solid touch in a vertex or an edge only, vertices are doubled. The mesh
 *  is cut open where the surface goes on at a translate. It has the properties "point", "shift_a", "shift_b" and
 *  "shift_c", which image a vertex is, and "sheet": vertices of one sheet are one vertex of the surface, and its
 *  translates.
 *  out    owned by the caller; without faces if the shape fills space.   stats  NULL, or receives what was found.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (alpha is NaN), BRIO_ERR_NO_ANSWER (no tetrahedron has a value of at most alpha,
 *  or alpha is closer to 0 than brio_alpha_auto finds one), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Edelsbrunner Muecke 1994]. */
BRIO_API brio_status brio_periodic_alpha_shape(brio_context *ctx, const brio_periodic_alpha *complex, double alpha,
                                               brio_mesh **out, brio_periodic_shape_stats *stats);

/** Answers queries of a periodic triangulation, which must outlive the locator. */
typedef struct brio_periodic_locator brio_periodic_locator;

/** Makes a locator.   out  owned by the caller, freed with brio_periodic_locator_free; NULL on error.
 *  Cost: a sort of the vertices; about 60 bytes for each.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_periodic_locator_new(brio_context *ctx, const brio_periodic *t, brio_periodic_locator **out);
/** Frees a locator; NULL is accepted. */
BRIO_API void brio_periodic_locator_free(brio_periodic_locator *locator);

/** Finds the tetrahedron that holds each query. Queries are put on the grid as points are, and may lie in any cell;
 *  then all is exact. A query on a facet, on an edge or at a vertex belongs to one of the tetrahedra there.
 *  queries  #Q by 3, finite.
 *  tetrahedra  #Q: `point` is an index of brio_periodic_tetrahedra, and the translate of that tetrahedron by `shift`
 *              holds the query. BRIO_INFINITE with a shift of 0 for a query strictly outside, where fewer than three
 *              directions repeat, and for all queries if there are no tetrahedra.
 *  Cost: the nearest vertex and a short walk, in threads.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE, BRIO_ERR_ARGUMENT (a query is more than 2^26 cells away),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Edelsbrunner 1990b], [Devillers Pion Teillaud 2002]. */
BRIO_API brio_status brio_periodic_locator_tetrahedra(brio_context *ctx, const brio_periodic_locator *locator,
                                                      const double *queries, size_t num_queries,
                                                      brio_image *tetrahedra);

/** Finds the vertex of least power distance from each query; without weights, the nearest. Among equals it is the
 *  lexicographically first translate.   vertices  #Q: a point, and the translate of it that is the nearest.
 *  Errors as above. */
BRIO_API brio_status brio_periodic_locator_least_power(brio_context *ctx, const brio_periodic_locator *locator,
                                                       const double *queries, size_t num_queries, brio_image *vertices);

#ifdef __cplusplus
}
#endif
#endif
