/* Circumcentres and orthocentres with an error bound. */
#ifndef BRIO_PREDICATES_CIRCUMCENTRE_H
#define BRIO_PREDICATES_CIRCUMCENTRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Centre of the sphere through four records, or of their orthosphere: the point of equal power distance to all four.
 *  The same bits for every order of the four. *error bounds the error of each coordinate (see brio_circumcentre). False
 *  for a flat tetrahedron, or a centre that doubles cannot hold. */
bool brio_centre(const double *a, const double *b, const double *c, const double *d, bool weighted, double centre[3],
                 double *error);

enum { BRIO_CENTRE_BATCH = 64 };

/** Tetrahedra whose centres are wanted, at most BRIO_CENTRE_BATCH of them. */
typedef struct {
    const double *points, *weights; /* rows of three; of each point, or NULL */
    const uint32_t (*vertex)[4];    /* #count by 4: points */
    size_t count;
    double *centre; /* #count by 3: the result; NaN in the first coordinate where brio_centre is false */
} brio_centre_batch;

/** The same bits as brio_centre's, sooner. */
void brio_centres(const brio_centre_batch *b);

/** In vector registers, on processors that have them; bits of the tetrahedra that are left to brio_centre. */
uint64_t brio_centres_avx2(const brio_centre_batch *b);
uint64_t brio_centres_avx512(const brio_centre_batch *b);

enum { BRIO_CENTRES = 4 };

/** at  NaN in the first coordinate where there is none that doubles can hold.
 *  square  of its distance to the four records.   error  bounds that of each coordinate; infinite where there is none. */
typedef struct {
    double at[3], square, error;
} brio_rough_centre;

/** Several centres without weights, each of its four records of coordinates at most 1, to 2^-30 of its distance to the
 *  lexicographically first record, plus one rounding. The bits of each depend on nothing but its set of records. */
void brio_rough_centres(const double *const p[BRIO_CENTRES][4], brio_rough_centre *centre);

#endif
