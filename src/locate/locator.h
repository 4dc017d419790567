/* A finished triangulation in the form that queries read: its tetrahedra, and its vertices as records in the order of a
 * k-d tree.
 *
 * Vertices have places 0 to num_vertices - 1. The order of places is the tree (query/nearest_points.h): the middle
 * place of a range cuts the range. Vertices that are near in space have near places, so walks and searches touch few
 * pages.
 *
 * I1  tet[t] is tetrahedron t of the triangulation, with places for indices of points. No tetrahedron is renumbered.
 * I2  vertex_tet[v] is the finite tetrahedron of lowest index that has vertex v.
 * I3  Nothing changes after brio_locator_new: any number of threads may read a locator. */
#ifndef BRIO_LOCATE_LOCATOR_H
#define BRIO_LOCATE_LOCATOR_H

#include "triangulation/engine.h"

struct brio_locator {
    brio_context *ctx;
    size_t num_points; /* of the caller */
    size_t num_vertices;
    size_t num_finite; /* finite tetrahedra; 0 for inputs of dimension 2 or less */
    bool weighted;
    brio_tetrahedra t; /* `infinite` is BRIO_INFINITE; record[v] of place v */
    brio_record *record;
    uint32_t *name;         /* of each place: the caller's index */
    uint8_t *axis;          /* of each place that is the middle of a range: the axis along which it cuts */
    double *most;           /* of each such place: the greatest weight in its range; NULL without weights */
    uint32_t *vertex_tet;   /* of each place; NULL without tetrahedra */
    double low[3], high[3]; /* the box of the vertices */
    double scale;           /* a power of two that brings usual coordinates near 1, for rounded squares of distances */
    brio_filter filter;     /* for queries in that box: a thread works with its own copy */
    const brio_engine *engine;
    brio_plane_frame frame; /* of points in a plane up to rounding, and their locator there; else NULL */
    brio_locator2 *flat;
};

/** Returns whether x is in the box of the vertices, where the locator's filter holds. */
static inline bool brio_locator_boxes(const brio_locator *l, const double *x) {
    return x[0] >= l->low[0] && x[0] <= l->high[0] && x[1] >= l->low[1] && x[1] <= l->high[1] && x[2] >= l->low[2] &&
           x[2] <= l->high[2];
}

#endif
