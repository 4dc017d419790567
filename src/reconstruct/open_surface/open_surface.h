/* A closed surface, opened where the samples end. */
#ifndef BRIO_RECONSTRUCT_OPEN_SURFACE_H
#define BRIO_RECONSTRUCT_OPEN_SURFACE_H

#include "reconstruct/open_surface/hole_cut.h"

/** The samples that the surface goes through. */
typedef struct {
    brio_context *ctx;
    const double *points; /* #P by 3 */
    size_t num_points;
    const float (*outside)[3]; /* #P: unit vectors from the samples to the outside, or NULL */
    const float (*scanner)[3]; /* #P: unit vectors from the samples to their scanners, or zero; or NULL */
} brio_sample_points;

/** What of a surface the samples do not show. */
typedef struct {
    size_t holes;             /* left open */
    double proof;             /* how often the holes make up what proves that the surface is open */
    size_t bridges;           /* filled, though samples of a surface would hardly leave such gaps */
    double bridge_share;      /* of the area: that of the bridges */
    double largest_radius;    /* of the widest circle of the bridge of the largest area; 0 if there is none */
    double largest_centre[3]; /* the centroid of that circle's triangle */
    double far_share;         /* of the area: what is over five usual radii away from the samples of its triangle */
} brio_unseen;

/** What is known of each triangle that stays, for the caller to free (brio_release). */
typedef struct {
    uint8_t *bridge; /* whether it belongs to a bridge */
    float *size;     /* the radius of its circle, by the usual one; INFINITY if its corners are collinear */
} brio_triangle_facts;

/** Finds what of a manifold no sample shows, and removes the triangles that span holes that stay open. What is left
 *  is a manifold with boundary, maybe empty.
 *  faces      *num_faces by 3, read and written: Delaunay triangles of the points.
 *  rule       its radius is in spacings: the median distance from a vertex to its nearest neighbour.
 *  facts      receives what is known of the triangles that stay.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_open_surface(const brio_sample_points *points, const brio_hole_rule *rule, uint32_t *faces,
                              size_t *num_faces, brio_triangle_facts *facts, brio_unseen *unseen);

#endif
