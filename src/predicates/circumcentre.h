/* Circumcentres and orthocentres: the centre of the sphere through four points, or of their orthosphere, the point of
 * equal power distance to all four. */
#ifndef BRIO_PREDICATES_CIRCUMCENTRE_H
#define BRIO_PREDICATES_CIRCUMCENTRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BRIO_CENTRE_BATCH = 64 };

/** Tetrahedra whose centres are wanted, at most BRIO_CENTRE_BATCH of them. */
typedef struct {
    const double *points, *weights; /* rows of three; of each point, or NULL */
    const uint32_t (*vertex)[4];    /* #count by 4: points */
    size_t count;
} brio_centre_batch;

/** Finds the centres of a batch to an error of 2^-44 of their distances from the points, as far as doubles hold that. The
 *  bits of a centre depend on its set of points alone.
 *  centre  #count by 3: the result; NaN in the first coordinate for a flat tetrahedron, or a centre that doubles cannot
 *          hold.
 *  error   #count, or NULL: bounds the error of each coordinate (see brio_circumcentre); unset where there is no centre. */
void brio_centres(const brio_centre_batch *b, double *centre, double *error);

/** The same without weights, sooner, for coordinates of at most 1, to an error of 2^-30 of the distance and one rounding.
 *  centre  #count by 4: the place and its squared distance from the points; NaN in both where brio_centres has none. */
void brio_rough_centres(const brio_centre_batch *b, double *centre);

/** What an engine finds. */
typedef struct {
    double relative; /* the error allowed, as a share of the distance from the first point */
    double *centre;  /* row n: of tetrahedron n */
    size_t stride;   /* doubles a row of centre */
    double *error;   /* of each tetrahedron, or NULL */
} brio_centre_goal;

/** Centres in the lanes of vector registers. Each function solves the tetrahedra of the batch whose bits are set, and
 *  returns the bits of those that it leaves. */
typedef struct {
    uint64_t (*find)(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal);
    /** As brio_rough_centres; may leave tetrahedra that `find` solves. */
    uint64_t (*find_roughly)(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal);
} brio_centre_engine;

/** The versions of the instruction sets. */
extern const brio_centre_engine brio_centres_plain, brio_centres_avx2, brio_centres_avx512;

#endif
