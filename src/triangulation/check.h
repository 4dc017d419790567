/* Parts of the exact check; check.c proves what they establish together. */
#ifndef BRIO_TRIANGULATION_CHECK_H
#define BRIO_TRIANGULATION_CHECK_H

#include "triangulation/tetrahedra.h"

/** A running check. */
typedef struct {
    brio_context *ctx;
    brio_tetrahedra t; /* vertices are rows of t.record or BRIO_INFINITE */
    size_t num_points; /* number of records */
    bool weighted;
    brio_filter filter;
    bool canonical; /* every tie found so far is broken as by the symbolic perturbation */
} brio_judge;

/** Runs test 6 on one point: point p must not be inside the (ortho)sphere of finite tetrahedron tet. */
brio_status brio_check_sphere(brio_judge *j, size_t tet, uint32_t p);

/** Runs test 7 of check.c on the points that are no vertex. The tetrahedra have passed tests 1 to 6.
 *  result  NULL, or the triangulation given to brio_triangulation_check; then all representatives and the counts of
 *  vertices, duplicates and hidden points must be right too.
 *  Returns BRIO_OK, BRIO_ERR_CHECK, BRIO_ERR_NO_MEMORY. */
brio_status brio_check_points(brio_judge *j, const brio_triangulation *result);

/** Returns the dimension of the affine hull of records, exact: 0 to 3, or -1 for no records. */
int brio_dimension(const brio_record *record, size_t num_points);

/** Checks the representatives and counts of an input of dimension 2 or less, and that the result has no tetrahedra. */
brio_status brio_check_flat(brio_context *ctx, const brio_triangulation *t, const double *points,
                            const double *weights);

#endif
