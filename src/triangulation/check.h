/* Parts of the exact check; check.c says what they prove together. */
#ifndef BRIO_TRIANGULATION_CHECK_H
#define BRIO_TRIANGULATION_CHECK_H

#include "triangulation/tetrahedra.h"

/** One check under way. */
typedef struct {
    brio_context *ctx;
    brio_tetrahedra t; /* vertices are rows of t.record or BRIO_INFINITE */
    size_t num_points; /* records */
    bool weighted;
    brio_filter filter;
    bool canonical; /* no tie was found broken otherwise than by the symbolic perturbation */
} brio_judge;

brio_judge brio_judge_of(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, bool weighted);

/** Tests 1 to 6 of check.c, of the tetrahedra. Returns BRIO_OK, BRIO_ERR_CHECK, BRIO_ERR_CANCELLED. */
brio_status brio_check_tetrahedra(brio_judge *j);

/** Test 6 for one point: point p must not be inside the (ortho)sphere of finite tetrahedron tet. */
brio_status brio_check_sphere(brio_judge *j, size_t tet, uint32_t p);

/** Test 7 of check.c, of the points that are no vertex. The tetrahedra have passed tests 1 to 6.
 *  result  NULL, or what brio_triangulation_check is given: then also every representative and the counts of vertices,
 *          duplicates and hidden points must be right.
 *  Returns BRIO_OK, BRIO_ERR_CHECK, BRIO_ERR_NO_MEMORY. */
brio_status brio_check_points(brio_judge *j, const brio_triangulation *result);

/** Dimension of the affine hull of records, exact: -1 for none, to 3. */
int brio_dimension(const brio_record *record, size_t num_points);

/** Checks the representatives and counts of an input of dimension 2 or less, and that the result has no tetrahedra. */
brio_status brio_check_flat(brio_context *ctx, const brio_triangulation *t, const double *points,
                            const double *weights);

#endif
