/* A hash of a triangulation that depends on the points only.
 *
 * The name of a vertex is its rank among the vertices, in lexicographic order of positions. The hash of a tetrahedron
 * mixes the ascending ranks of its vertices to 64 bits. The hash of the triangulation is the sum of these, so no order
 * matters. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "triangulation/tetrahedra.h"
#include "triangulation/triangulation.h"
#include <assert.h>

static int compare_points(uint32_t p, uint32_t q, const void *points) {
    return brio_lexicographic((const double *)points + 3 * (size_t)p, (const double *)points + 3 * (size_t)q);
}

/* Sets rank[p] of each vertex p to its rank among the vertices. */
static brio_status lexicographic_ranks(brio_context *ctx, const brio_triangulation *t, const double *points,
                                       uint32_t *rank) {
    brio_status status = BRIO_OK;
    size_t n = 0;
    uint32_t *vertex = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, vertex, t->stats.vertices));
    for (size_t p = 0; p < t->stats.points; p++)
        if (t->representative[p] == p) vertex[n++] = (uint32_t)p;
    assert(n == t->stats.vertices);
    BRIO_TRY(brio_sort_rows(ctx, &(brio_row_order){points, 3, compare_points, points}, vertex, n));
    for (size_t i = 0; i < n; i++) {
        rank[vertex[i]] = (uint32_t)i;
        BRIO_TRY(brio_look(ctx, 1));
    }
done:
    brio_release(ctx, vertex);
    return status;
}

brio_status brio_triangulation_checksum(brio_context *ctx, const brio_triangulation *t, const double *points,
                                        uint64_t *checksum) {
    BRIO_DOOR;
    enum { EXPECTED = 1 << 14 }; /* tetrahedra whose ranks are read ahead */
    brio_status status = BRIO_OK;
    uint32_t *rank = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, rank, t->stats.points));
    BRIO_TRY(lexicographic_ranks(ctx, t, points, rank));
    uint64_t sum = brio_mix(t->stats.vertices);
    for (size_t tet = 0; tet < t->stats.tetrahedra; tet++) {
        uint64_t r[4];
        if (tet % EXPECTED == 0)
            brio_block_expect(t->tet, (tet + EXPECTED) * sizeof *t->tet, EXPECTED * sizeof *t->tet);
        for (int i = 0; i < 4; i++) r[i] = rank[t->tet[tet].vertex[i]];
        sum += brio_tetrahedron_hash(r);
        BRIO_TRY(brio_look(ctx, 1));
    }
    *checksum = sum;
done:
    brio_release(ctx, rank);
    return status;
}
