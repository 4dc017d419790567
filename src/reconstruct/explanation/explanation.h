/* What a method for surfaces tells of its samples: brio_explanation, while it is made. */
#ifndef BRIO_RECONSTRUCT_EXPLANATION_H
#define BRIO_RECONSTRUCT_EXPLANATION_H

#include "base/context.h"
#include "dual/pole_vectors.h"

/** An explanation that grows. */
typedef struct brio_explaining {
    brio_context *ctx;
    brio_explanation *e;
    int exponent;                                   /* lengths are the caller's times 2^-exponent */
    size_t vertices, tetrahedra, polygons, corners; /* so far */
    size_t vertex_room, point_room, tetrahedron_room[4], polygon_room[2], corner_room;
} brio_explaining;

/** Adds a vertex.   point  the caller's index, or UINT32_MAX. */
brio_status brio_explain_vertex(brio_explaining *x, const double place[3], uint32_t point);

/** Adds a corner to the polygon that comes next: vertex v. */
brio_status brio_explain_corner(brio_explaining *x, size_t v);

/** Ends the polygon of the corners added since the last one; leaves it out if they are fewer than three. */
brio_status brio_explain_polygon(brio_explaining *x, brio_explained_polygon kind);

/** Samples of a surface, as its method has them. */
typedef struct brio_explained {
    const brio_surface_options *options;
    const brio_triangulation *delaunay;
    const brio_pole_vectors *dual; /* of it, with its centres; NULL: found again */
    const double *points; /* of the triangulation, by 3: the samples, then points that only bound their cells */
    size_t num_points, num_samples;
    const uint32_t *order; /* #samples: the caller's index of each */
    int exponent;
    double theta;
    const float (*outside)[3]; /* #samples: the axes, or NULL: those of the poles */
    const uint8_t *label;      /* #T: of the tetrahedra (brio_label), or NULL */
    bool inverted;             /* inner ones are outside */
    const float *confidence;   /* #T, or NULL: not known */
    const uint32_t *faces;     /* #F by 3: the surface, or NULL */
    size_t num_faces;
    /** Writes the poles of sample s by other numbers, and adds polygons; NULL: the poles are those of the cell.
     *  pole  2 by 4, scaled.   side  2. */
    brio_status (*more)(void *user, brio_explaining *x, uint32_t s, double pole[8], int8_t side[2]);
    void *user;
} brio_explained;

/** Fills *options->explanation; does nothing without.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, BRIO_ERR_TOO_LARGE. */
brio_status brio_explain(brio_context *ctx, const brio_explained *samples);

#endif
