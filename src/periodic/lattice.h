/* A lattice of translations, and positions on a grid on which all translates are doubles.
 *
 * I1  The vectors `basis` are reduced: basis[i] is the sum of change[i][j] used[j], and `change` has the determinant 1
 *     or -1. Vectors from `rank` on complete the basis and are no translations.
 * I2  A coordinate k with unit[k] > 0 is a multiple of unit[k] in every vector and every position, and stays below 2^53
 *     unit[k] in all translates by at most MOST_SHIFT of the domain: so sums of these are exact. A coordinate with
 *     unit[k] = 0 is 0 in all vectors, and positions keep it as it was given.
 * I3  `basis` are multiples of GRAIN unit[k]. So halves, quarters and eighths of vectors are
 *     multiples of the unit, and points of crystals at such fractions stay there exactly.
 * I4  The domain is the set of positions whose coordinates in the basis are in [0, 1) for i < rank. Each position has
 *     exactly one translate in it. */
#ifndef BRIO_PERIODIC_LATTICE_H
#define BRIO_PERIODIC_LATTICE_H

#include "base/context.h"

enum { BRIO_LATTICE_MOST_SHIFT = 4, BRIO_LATTICE_GRAIN = 8 };

typedef struct brio_lattice {
    int rank;
    int axis[3];          /* #rank: which of the caller's vectors */
    double given[3][3];   /* #rank, as the caller gave them; completed to three vectors */
    double near[3][3];    /* #rank, reduced: sums of given vectors, rounded once; completed to three vectors */
    double basis[3][3];   /* `near` on the grid: I1 */
    int64_t change[3][3]; /* I1 */
    double used[3][3];    /* #rank: what the caller's vectors are then, rounded to doubles where they are long */
    double given_dual[3][3], near_dual[3][3], dual[3][3]; /* dual[i] . basis[j] is 1 for i = j, else 0 */
    double unit[3];                                       /* I2 */
    double origin[3]; /* the lexicographically least point: points are rounded relative to it */
    double corner[3]; /* on the grid: positions are relative to origin + corner */
    double range[3];  /* #rank: two points of one tetrahedron differ by at most this in each coordinate of the basis */
    double volume;    /* of the cell of `used`: a volume, an area or a length */
    double moved;     /* the largest move of a coordinate of a vector */
} brio_lattice;

/** A point's translate in the domain. */
typedef struct brio_home {
    double x[3];
    int64_t shift[3]; /* #rank: the position is that of the caller's point + the sum of shift[j] used[j] */
    double moved;     /* the largest move of a coordinate */
} brio_home;

/** Makes the lattice of the vectors of a cell that repeat, and the grid.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (vectors that are no numbers, that span no cell, or are too skewed). */
brio_status brio_lattice_new(brio_context *ctx, const brio_periodic_options *options, const double *points,
                             size_t num_points, brio_lattice *lattice);

/** Finds the translate of a point in the domain.   Returns false if it is more than 2^26 cells away. */
bool brio_lattice_home(const brio_lattice *lattice, const double *point, brio_home *home);

/** Returns how far points may reach in coordinate k with the grid that there is; 0 where nothing is rounded. */
double brio_lattice_size(const brio_lattice *lattice, int k);

/** Returns whether a position in the domain is no farther than half of what the grid is made for, less the vectors:
 *  then any origin among such positions gives the same grid. */
bool brio_lattice_reaches(const brio_lattice *lattice, const double *x);

/** Writes the position of which x is the translate in the domain, by `shift` of the vectors that were given, in the
 *  caller's space: rounded to doubles once. Its coordinates in the vectors that were given are those of x in the basis.
 *  So another lattice, of these vectors and of any such position as origin, brings it to the same place of the grid,
 *  if doubles there are finer than the grid: within 8 longest vectors of the space's origin. */
void brio_lattice_given(const brio_lattice *lattice, const double *x, const int32_t shift[3], double *out);

/** Writes a position moved by shift[i] basis[i]: exact (I2). */
static inline void brio_lattice_move(const brio_lattice *l, const double *x, const int32_t *shift, double *out) {
    for (int k = 0; k < 3; k++) {
        double sum = x[k];
        for (int i = 0; i < l->rank; i++) sum += shift[i] * l->basis[i][k];
        out[k] = sum;
    }
}

/** Returns coordinate i of a position in the basis. */
static inline double brio_lattice_share(const brio_lattice *l, int i, const double *x) {
    return l->dual[i][0] * x[0] + l->dual[i][1] * x[1] + l->dual[i][2] * x[2];
}

/** Returns coordinate k of a position in the caller's space. */
static inline double brio_lattice_shown(const brio_lattice *l, double x, int k) {
    return (x + l->corner[k]) + l->origin[k];
}

#endif
