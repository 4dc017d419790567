/* Volumes and neighbours of cells by a sweep over the tetrahedra, without the polyhedra of the cells.
 *
 * I1  Ranks: those of sites come first, from 0 on, in the order in which the tetrahedra show them; those of other rows
 *     begin at num_sites. What is near in space is near in memory.
 * I2  A cell is left, to be computed from its star, if a tetrahedron of it is infinite or has its centre outside the
 *     region; if the bound of its volume's error is more than MOST_ERROR of the volume; or, where neighbours are asked
 *     for, if two tetrahedra of it that are mates may share their centre: then neighbours may share no face. */
#ifndef BRIO_CELLS_SWEEP_H
#define BRIO_CELLS_SWEEP_H

#include "cells/diagram.h"
#include <assert.h>

/** The tetrahedra of the sites. */
typedef struct brio_sweep_task {
    const brio_tetrahedron *tet; /* finite ones first; mates across facets, or the facet itself */
    size_t num_finite, count;
    const uint32_t (*more)[4]; /* further finite ones: translates of some of them, without mates; or NULL */
    size_t num_more;
    const double *at, *square; /* #rows by 3; #rows, or NULL: positions and weights */
    size_t num_rows, num_sites;
    const uint32_t *owner; /* #rows - num_sites: of which site each other row is a translate; NULL: of none */
    const brio_region *region;
    bool neighbours; /* whether neighbours are asked for */
} brio_sweep_task;

typedef struct brio_sweep {
    brio_context *ctx;
    brio_sweep_task task;
    size_t num_tets;  /* finite ones, and further ones */
    uint32_t *rank;   /* #rows: I1; UINT32_MAX for rows that are in no tetrahedron */
    uint32_t *order;  /* of each rank its row */
    size_t num_ranks; /* of sites */
    uint8_t *left;    /* of each rank of a site: I2 */
    size_t num_left;
    double (*sum)[2]; /* of each rank of a site: the volume, and a bound of its error */
    uint32_t *size;   /* of each rank of a site: the number of its tetrahedra */
    /* for the neighbours, or NULL */
    uint32_t (*id)[4];              /* of each tetrahedron: the ranks of its vertices */
    double *ranked, *ranked_square; /* of each rank: its position, its weight */
    float *rounded;                 /* of each rank: x of its position, rounded */
    double *key; /* of each finite one: x of its centre; NaN where it is not known well. NULL in a filled sweep */
    double fine; /* the error that keys may have */
} brio_sweep;

/** Fills a sweep.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED; freed with brio_sweep_free in any case. */
brio_status brio_sweep_fill(brio_context *ctx, const brio_sweep_task *task, brio_sweep *sweep);
void brio_sweep_free(brio_sweep *sweep);

/** Returns the number of neighbours of a rank that is not left: n tetrahedra about a vertex, on whose link they are
 *  triangles, have n / 2 + 2 other vertices. */
static inline uint32_t brio_sweep_degree(const brio_sweep *s, uint32_t r) {
    assert(!s->left[r] && s->size[r] >= 4 && s->size[r] % 2 == 0);
    return s->size[r] / 2 + 2;
}

/** Writes the neighbours of the ranks that are not left, as rows, in the lexicographic order of their positions.
 *  first  of each site where its neighbours begin in `out`.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_sweep_neighbours(const brio_sweep *s, const uint64_t *first, int64_t *out);

/* --- between the files of the sweep --- */

/** Marks the cells of some vertices as left.   id  their ranks. */
void brio_sweep_leave(brio_sweep *s, const uint32_t *id, int count);

/** Finds the cells whose neighbours may share no face: I2. */
brio_status brio_sweep_find_ties(brio_sweep *s);

#endif
