/* Circumcentres and orthocentres. The circumcentre is the centre of the sphere through four points. The orthocentre of
 * four weighted points is the point with equal power distances to all four. */
#ifndef BRIO_PREDICATES_CIRCUMCENTRE_H
#define BRIO_PREDICATES_CIRCUMCENTRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BRIO_CENTRE_BATCH = 64 };

/** Tetrahedra whose centres are to be computed. */
typedef struct {
    const double *points, *weights; /* #P by 3; #P, or NULL */
    const uint32_t (*vertex)[4];    /* #count by 4: indices of points */
    size_t count;                   /* at most BRIO_CENTRE_BATCH */
} brio_centre_batch;

/** Computes the centres of a batch. The error is at most 2^-44 of the centre's distance from the points, plus the
 *  rounding of the coordinates to doubles. The bits of a centre depend only on the set of its points.
 *  centre  #count by 3: the result; NaN in the first coordinate for a flat tetrahedron and for a centre that doubles
 *          cannot hold.
 *  error   #count, or NULL: bounds the error of each coordinate (see brio_circumcentre); unset where the centre is
 *  NaN. */
void brio_centres(const brio_centre_batch *b, double *centre, double *error);

/** Computes the same, but the error is at most 2^-30 of the centre's distance from the points, plus the rounding. This
 *  is faster where tetrahedra are nearly flat. `error` is wanted. */
void brio_near_centres(const brio_centre_batch *b, double *centre, double *error);

/** Computes centres faster than brio_centres, without weights, for coordinates of at most 1. The error is at most 2^-30
 *  of the centre's distance from the points, plus one rounding.
 *  centre  #count by 4: the centre and its squared distance from the points. NaN in the first coordinate and in the
 *          squared distance where brio_centres gives NaN. */
void brio_rough_centres(const brio_centre_batch *b, double *centre);

/** The accuracy that an engine must reach, and the arrays that it fills. */
typedef struct {
    double relative; /* the error allowed, divided by the largest coordinate of the offset from the first point */
    double *centre;  /* #count by stride: row n is the centre of tetrahedron n */
    size_t stride;   /* doubles in a row of centre */
    double *error;   /* #count, or NULL: the error bounds */
} brio_centre_goal;

/** Functions that compute centres in the lanes of vector registers. Each function solves tetrahedra of the batch whose
 *  bits are set in `some`, and returns the bits of the tetrahedra that it leaves unsolved. */
typedef struct {
    uint64_t (*find)(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal);
    /** Writes rows as brio_rough_centres; may leave tetrahedra that `find` solves. */
    uint64_t (*find_roughly)(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal);
} brio_centre_engine;

/** The engines of the instruction sets. */
extern const brio_centre_engine brio_centres_plain, brio_centres_avx2, brio_centres_avx512;

#endif
