/* The result behind the public handle. */
#ifndef BRIO_TRIANGULATION_TRIANGULATION_H
#define BRIO_TRIANGULATION_TRIANGULATION_H

#include "base/rng.h"
#include "order/order.h"

struct brio_triangulation {
    brio_context *ctx;
    brio_tetrahedron *tet;    /* finite ones first; vertices are the caller's indices or BRIO_INFINITE */
    uint32_t *representative; /* of each point of the caller */
    bool leaves_hidden;       /* hidden points and their duplicates have BRIO_INFINITE for a representative */
    brio_delaunay_stats stats;
    uint64_t points_hash; /* base/points_hash.h */
};

/** Checks the options of brio_delaunay for num_points points, and lets an experiment begin.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT. */
brio_status brio_delaunay_begin(brio_context *ctx, size_t num_points, const brio_delaunay_options *options);

/** Makes what brio_delaunay makes, but its tetrahedra come in an order that depends on the threads, finite and infinite
 *  ones mixed, and their mates mean nothing. Each is turned as in the canonical order, a sixth of whose time this
 *  saves.   options  complete.
 *  Returns what brio_delaunay returns. */
brio_status brio_delaunay_any_order(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                    const brio_delaunay_options *options, brio_triangulation **out);

/** Returns the hash of a tetrahedron, of which the checksum is the sum.   rank  of its vertices. */
static inline uint64_t brio_tetrahedron_hash(const uint64_t rank[4]) {
    uint64_t a = rank[0], b = rank[1], c = rank[2], d = rank[3];
    /* a network sorts them without a branch, which would be foreseen half of the time only */
    uint64_t ab = a < b ? a : b, ba = a < b ? b : a, cd = c < d ? c : d, dc = c < d ? d : c;
    uint64_t least = ab < cd ? ab : cd, x = ab < cd ? cd : ab, y = ba < dc ? ba : dc, most = ba < dc ? dc : ba;
    uint64_t second = x < y ? x : y, third = x < y ? y : x;
    return brio_mix(brio_mix(least << 32 ^ second) + (third << 32 ^ most));
}

/** The triangulation of points of dimension 3 whose tetrahedra somebody else finds, and writes in any order: what
 *  brio_delaunay makes of these points, with a seed and defaults, equal in every byte of its tetrahedra and
 *  representatives, without inserting a point. */
typedef struct brio_adoption brio_adoption;

/** Orders the points, and makes room for their tetrahedra.
 *  seed   of brio_delaunay, on which the order of its tetrahedra depends; 0: the default.
 *  count  of the perturbed regular triangulation, infinite ones included.
 *  Returns what brio_delaunay returns. */
brio_status brio_adoption_begin(brio_context *ctx, const brio_input *input, uint64_t seed, size_t count,
                                brio_adoption **out);
/** Returns room for `count` tetrahedra, to be written: their vertices are records, or the infinite one in slot 3. */
brio_tetrahedron *brio_adoption_tetrahedra(const brio_adoption *a);
/** Return the record of each point; the infinite vertex. */
const uint32_t *brio_adoption_records(const brio_adoption *a);
uint32_t brio_adoption_infinite(const brio_adoption *a);
/** Makes the triangulation of the tetrahedra that were written. Call it once; free the adoption in any case.
 *  vertex_of  of a vertex: itself; of a duplicate: its vertex; of others: any vertex. NULL: all points are vertices.
 *  Returns what brio_delaunay returns. */
brio_status brio_adoption_end(brio_context *ctx, brio_adoption *a, const uint32_t *vertex_of, brio_triangulation **out);
void brio_adoption_free(brio_context *ctx, brio_adoption *a);

/** Who makes the triangulations of a context, where one process in one memory is not to do it. A context has at most
 *  one, for the time of a call. */
typedef struct brio_triangulator {
    void *user;
    /** Makes what brio_delaunay makes of points without weights. What its statistics say of the way there may differ.
     *  points  num_points by 3, finite.   seed  of brio_delaunay.   Returns what brio_delaunay returns. */
    brio_status (*make)(void *user, brio_context *ctx, const double *points, size_t num_points, uint64_t seed,
                        brio_triangulation **out);
} brio_triangulator;

/** Triangulates points by the context's triangulator, or by brio_delaunay where it has none.
 *  seed  of brio_delaunay.   Returns what brio_delaunay returns. */
brio_status brio_triangulate(brio_context *ctx, const double *points, size_t num_points, uint64_t seed,
                             brio_triangulation **out);

#endif
