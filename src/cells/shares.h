/* What a tetrahedron gives to the cells of its four vertices.
 *
 * The edge ij of the facet ijk borders the part of the cell of i that is nearest to the edge, the facet and the
 * tetrahedron: the orthoscheme from i over the centres of the edge, of the facet and of the tetrahedron. Its volume is
 * signed. Over all edges and facets these volumes add up to what the cell of i has of the tetrahedron, and over all
 * four vertices to the tetrahedron. Let n / 2 be the area vector of a facet, and o . n / |n| the height of the centre
 * over it. Then
 *     volume = s |ij|^2 D (o . n) / (6 |n|^2),
 * where s is the share of the edge that is i's, and D = (|ik|^2 + w_i - w_k) / 2 - s ij . ik. Without weights s is 1/2
 * and D is (ki . kj) / 2.
 *
 * I1  Whatever the error of the centre, the four shares add up to the tetrahedron: errors move volume between cells.
 *
 * Based on: Meyer, Desbrun, Schroeder, Barr. Discrete differential-geometry operators for triangulated 2-manifolds.
 *           2003 (the same in triangles, with cotangents).
 *           Aurenhammer. Power diagrams: properties, algorithms and applications. SIAM J. Computing 1987. */
#ifndef BRIO_CELLS_SHARES_H
#define BRIO_CELLS_SHARES_H

#include "predicates/circumcentre.h"

/** Tetrahedra, and where their shares go. */
typedef struct brio_share_batch {
    const double *points, *weights; /* #P by 3; #P, or NULL */
    const uint32_t (*vertex)[4];    /* #count by 4: indices of points */
    size_t count;                   /* at most BRIO_CENTRE_BATCH */
    double (*centre)[3];            /* #count: NaN in the first coordinate for those that doubles cannot hold */
    double *error;                  /* #count: bounds the error of each coordinate of the centre */
    double (*share)[4];             /* #count: what the cell of each vertex has of the tetrahedron */
    double *bound;                  /* #count: bounds the error of each share; NaN or infinite where nothing is known */
} brio_share_batch;

/** Computes centres, shares, and what bounds their errors. The bits do not depend on the instruction set, but on the
 *  order of the four vertices.
 *  Lengths and weights are scaled so that doubles hold sixth powers of the edges: tetrahedra with an edge beyond 2^-80
 *  or 2^80, or with a facet whose corners are on a line up to rounding, get infinite bounds.
 *  Cost: about 20 ns for a tetrahedron, more where its centre needs pairs of doubles. */
void brio_shares(const brio_share_batch *b);

/** Functions in the lanes of vector registers, for the tetrahedra whose bits are set in `some`. */
typedef struct {
    /** Finds all four; returns the bits of those whose centres need more than doubles, which it leaves. */
    uint64_t (*find)(const brio_share_batch *b, uint64_t some);
    /** Finds shares and bounds for given centres and errors. */
    void (*find_of_centres)(const brio_share_batch *b, uint64_t some);
} brio_share_engine;

/** The engines of the instruction sets. */
extern const brio_share_engine brio_shares_plain, brio_shares_avx2, brio_shares_avx512;

#endif
