/* brio/explanation.h: how a surface came to be at its samples: cells, poles, polar balls, co-cones, labels, and what
 * was taken of them. */
#ifndef BRIO_EXPLANATION_H
#define BRIO_EXPLANATION_H

#include "surface.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Kinds of polygons of an explanation. */
typedef enum brio_explained_polygon {
    BRIO_EXPLAINED_CELL = 0, /* a face of the sample's Voronoi cell */
    BRIO_EXPLAINED_TAKEN =
        1,                  /* POWER_CRUST: a face of the power cell of one of its poles, between an inner and an outer
                                 ball: the crust has it, unless it spans a hole */
    BRIO_EXPLAINED_LEFT = 2 /* POWER_CRUST: the same, between balls of one label: bounded ones */
} brio_explained_polygon;

/** How a surface came to be, sample by sample: what brio_surface had in its hands. #E samples are explained; of sample
 *  e the lists are items offsets[e] to offsets[e + 1] - 1, and numbers of vertices are rows of `vertices`. Lengths are
 *  those of the points. Samples of a power crust may share a pole: of a power cell with over 128 vertices only the
 *  faces are there that touch the cell of the sample's other pole, and no face with over 128 corners. The numbers do
 *  not depend on the order of the points, nor on threads. Later versions may append fields. */
struct brio_explanation {
    size_t size; /* of the struct in the library that runs */
    brio_context *context;
    brio_surface_method method;
    int reserved_int;
    double theta;       /* half the opening of the co-cones, radians */
    size_t all_samples; /* distinct positions in the triangulation */
    size_t num_samples; /* #E: all of these, or an even choice along a curve through space */
    uint32_t *point;    /* #E: the index of the sample's point */
    double *place;      /* #E by 3: where it is triangulated: at its point, unless points were smoothed before */
    double *axis;       /* #E by 3: of the co-cone, a unit vector; LABELED: outwards */
    double *pole;       /* #E by 2 by 4: centre and radius of the polar ball of the farther pole, and of the one on the
                           other side. A pole at infinity, or with a ball that doubles cannot hold, has a unit
                           direction and the radius infinity; where there is none, or it was discarded, all are NaN */
    int8_t *pole_side;  /* #E by 2: -1 inner, 1 outer, 0 not known */
    uint64_t *vertex_offsets; /* #E + 1 */
    double *vertices;         /* by 3: the sample, its neighbours, the vertices of polygons */
    uint32_t *vertex_point;   /* the index of the point; UINT32_MAX for vertices of polygons and for points that only
                                 bound the cells */
    uint64_t *tetrahedron_offsets; /* #E + 1 */
    uint32_t *tetrahedra; /* by 4, positive: the finite Delaunay tetrahedra of the sample, which is the first corner */
    int8_t *tetrahedron_side; /* -1 inner, 1 outer, 0 not known: POWER_CRUST labels balls */
    float
        *tetrahedron_confidence; /* LABELED: the probability of the label by the votes of the four samples alone, below
                                      1/2 where they were outvoted; others: NaN */
    uint8_t *tetrahedron_taken;  /* bit i: the surface has the facet opposite to corner i, i from 1 on */
    uint64_t *polygon_offsets;   /* #E + 1 */
    uint8_t *polygon_kind;       /* brio_explained_polygon */
    uint64_t *corner_offsets;    /* a polygon more than there are */
    uint32_t *corners; /* of the polygons. A face without end is cut at a length beyond its last vertices that is
                                      half the diagonal of the samples' box */
};

/** Frees an explanation; NULL is accepted. */
BRIO_API void brio_explanation_free(brio_explanation *explanation);

#ifdef __cplusplus
}
#endif
#endif
