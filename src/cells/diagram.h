/* The Voronoi (power) diagram as the cells are read from it: the tetrahedra with their centres, the tetrahedra that
 * share a centre exactly, and the tetrahedra of each vertex.
 *
 * I1  Row t of `centre` is the centre of tetrahedron t and its place, a brio_place. It is NaN for infinite tetrahedra
 *     and for centres that doubles cannot hold, and then the place is BRIO_PLACE_FAR.
 * I2  Where `same` is not NULL, same[t] is the least of the listed tetrahedra that share the centre of t and are joined
 *     with t across facets. Rows of such tetrahedra are equal up to rounding. For infinite tetrahedra the outward
 *     normal of the hull facet takes the place of the centre. Where `same` is NULL, no two tetrahedra share a centre.
 * I3  The tetrahedra of a vertex ascend.
 * I4  Row r of `ranked` is the point order[r], and rank[order[r]] = r. The order follows the array of tetrahedra: what
 *     is near in space is near in memory.
 * I5  All of this is found for the listed tetrahedra, those with a vertex that is wanted, and for their vertices. Stars
 *     of vertices that are not wanted may lack tetrahedra. */
#ifndef BRIO_CELLS_DIAGRAM_H
#define BRIO_CELLS_DIAGRAM_H

#include "cells/polyhedron.h"
#include "triangulation/tetrahedra.h"
#include <assert.h>

typedef struct brio_region {
    size_t num_planes;     /* 0: no region, nothing is clipped */
    double (*plane)[4];    /* unit outward normal n and offset d: inside is n . x <= d. Wall i is neighbour -1 - i. */
    double (*given)[4];    /* normals and offsets as the caller gave them, before origin and scale */
    double *terms;         /* the sum of the absolute terms of each plane[3], which bounds its rounding */
    brio_polyhedron shape; /* the polytope, relative to 0; its vertices know three of their walls */
    bool box;              /* whether the region is a box: then low and high are its corners */
    double low[3], high[3];
    double middle[3]; /* of the polytope's bounding box */
    double reach;     /* the longest side of that box */
    double volume;
} brio_region;

/** Makes the region.
 *  planes         num_planes by 4, finite: normal and offset; normals are not 0 and need not be unit vectors.
 *  origin, scale  positions are taken relative to the origin, then multiplied by the scale.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the half-spaces bound no polytope, or an empty one),
 *  BRIO_ERR_NO_MEMORY. The region is freed with brio_region_free in any case. */
brio_status brio_region_new(brio_context *ctx, const double *planes, size_t num_planes, const double origin[3],
                            double scale, brio_region *region);
void brio_region_free(brio_region *region);

/** Returns whether a point is over plane i. */
bool brio_region_is_over(const brio_region *region, size_t i, const double *x);

/** Where a centre is. */
typedef enum brio_place {
    BRIO_PLACE_INSIDE = 0,  /* in the region, or there is no region */
    BRIO_PLACE_OUTSIDE = 1, /* outside the region */
    BRIO_PLACE_FAR = 2,     /* so far outside that rounding would show, or at infinity */
} brio_place;

/** Returns where a finite centre is, NaN included. */
brio_place brio_place_of(const brio_region *region, const double *centre);

typedef struct brio_diagram {
    brio_context *ctx;
    /* given; lengths are scaled by a power of two, see scale */
    const double *points, *weights; /* as the caller gave them */
    const double *at;               /* #P by 3: the points, relative to the origin and scaled */
    const double *square;           /* #P: the weights, scaled; NULL without weights */
    size_t num_points;              /* the caller's; the triangulation can have up to three more (cells.c) */
    size_t num_sites;               /* points before it have cells; others are translates of them (brio_cell_complex) */
    double origin[3];               /* each difference points - origin is exact */
    double scale;                   /* a power of two: at = scale * (points - origin) */
    bool flat;                      /* the points have dimension 2 or less: centres say nothing */
    const uint8_t *wanted;          /* of each point whether its cell is to be computed; NULL: all are */
    brio_tetrahedra t;
    size_t num_finite;
    /* made by brio_diagram_fill */
    double (*centre)[4]; /* of each tetrahedron, infinite ones included: I1 */
    uint32_t *same;      /* I2 */
    size_t num_vertices;
    uint32_t *order, *rank;         /* #vertices: points; #P: I4, UINT32_MAX for points that are no vertices */
    double *ranked, *ranked_square; /* #vertices by 3; #vertices, NULL without weights: I4 */
    uint32_t *listed;               /* I5, finite ones first; NULL: all tetrahedra are listed */
    size_t num_listed;
    uint64_t *begin; /* #P + 4 and one: tetrahedra star[begin[v]] to star[begin[v] + size[v] - 1] */
    uint32_t *size;  /* the number of tetrahedra of each point; 0 for points that are no vertices */
    uint32_t *star;
} brio_diagram;

/** Computes what the struct lists as made.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_diagram_fill(brio_diagram *d, const brio_region *region);
void brio_diagram_free(brio_diagram *d);

/* The steps of brio_diagram_fill, in their order: diagram.c, centres.c, ties.c, centres.c, stars.c. */

/** Lists tetrahedra: I5. */
brio_status brio_diagram_list(brio_diagram *d);
/** Orders the vertices: I4. */
brio_status brio_diagram_order_vertices(brio_diagram *d);
/** Computes the centres. The fourth number of a row is a bound of the error of each coordinate. */
brio_status brio_diagram_find_centres(brio_diagram *d);
/** Finds the tetrahedra that share a centre. */
brio_status brio_diagram_unite_ties(brio_diagram *d);
/** Replaces the fourth number of each row by its place. */
brio_status brio_diagram_find_places(brio_diagram *d, const brio_region *region);
brio_status brio_diagram_gather_stars(brio_diagram *d);

/** Returns number i of the listed tetrahedra. */
static inline uint32_t brio_listed(const brio_diagram *d, size_t i) {
    assert(i < d->num_listed);
    return d->listed ? d->listed[i] : (uint32_t)i;
}

/** Returns whether a tetrahedron is listed. */
static inline bool brio_is_listed(const brio_diagram *d, uint32_t t) {
    const uint32_t *v = d->t.tet[t].vertex;
    if (!d->wanted) return true;
    return d->wanted[v[0]] || d->wanted[v[1]] || d->wanted[v[2]] || (t < d->num_finite && d->wanted[v[3]]);
}

/** Returns the tetrahedron that speaks for all that share the centre of t. */
static inline uint32_t brio_same_centre(const brio_diagram *d, uint32_t t) {
    assert(!d->same || (d->same[t] <= t && d->same[d->same[t]] == d->same[t])); /* I2 */
    return d->same ? d->same[t] : t;
}

/* --- cells of a complex that is no triangulation of all its points: of a space that repeats --- */

/** What all points are together. The origin and the scale come from it, so that cells of some points are computed
 *  as those of all. */
typedef struct brio_cell_frame {
    double low[3], high[3]; /* 0 without points */
    double weight;          /* the greatest absolute one */
} brio_cell_frame;

/** All tetrahedra that have a site for a vertex, finite ones first. Mates across facets that have one are right; the
 *  others are the facet itself. For a sweep (sweep.h): one tetrahedron of each class of translates, and `more` of them,
 *  so that all that have a site for a vertex are there. */
typedef struct brio_cell_complex {
    brio_tetrahedron
        *tet; /* NULL: points of dimension 2 or less, triangulated here; the sites' neighbours are all there */
    size_t num_finite, count;
    const uint32_t (*more)[4];
    size_t num_more;
    const uint32_t *owner; /* #points - #sites: of which site each other point is a translate; NULL: of none */
    /** Makes the complex of which no sweep is made, for the cells that a sweep leaves: sets tet, num_finite and count.
     *  Points stay.   wanted  #points: whose cells are wanted.   NULL: this is it. */
    brio_status (*whole)(void *user, const uint8_t *wanted, struct brio_cell_complex *whole);
    void *user;
    const double *points, *weights; /* #P by 3; #P, or NULL */
    size_t num_points, num_sites;   /* the first points are the sites */
    const brio_cell_frame *frame;   /* of more points than these, or NULL */
} brio_cell_complex;

/** Returns whether cells with these options come from a sweep, where points have dimension 3. */
bool brio_cells_are_swept(const brio_cells_options *options);

/** Computes the cells of the sites, as brio_voronoi_cells does. Neighbours are indices of points.
 *  options  all fields are known.   out  as brio_voronoi_cells; NULL before. */
brio_status brio_cells_of_complex(brio_context *ctx, const brio_cell_complex *complex,
                                  const brio_cells_options *options, brio_cells **out);

#endif
