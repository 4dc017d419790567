/* A hash of a triangulation that depends on the points alone.
 *
 * Each vertex is known by its rank among the vertices in lexicographic order of positions; each tetrahedron by the ascending ranks
 * of its vertices, mixed to 64 bits; the hash is the sum of these, so that no order of anything matters. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "triangulation/triangulation.h"
#include <string.h>

/* Unsigned key whose order is that of the doubles; -0 is 0. */
static uint64_t ordered_key(double x) {
    uint64_t bits;
    x += 0.0;
    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

/* rank[p] of each vertex p among the vertices: three stable sorts, least significant coordinate first. */
static brio_status lexicographic_ranks(brio_context *ctx, const brio_triangulation *t, const double *points,
                                       uint32_t *rank) {
    brio_status status = BRIO_OK;
    size_t n = t->stats.vertices, filled = 0;
    uint32_t *vertex = NULL;
    uint64_t *key = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, vertex, n));
    BRIO_TRY(BRIO_ALLOC(ctx, key, n));
    for (size_t p = 0; p < t->stats.points; p++)
        if (t->representative[p] == p) vertex[filled++] = (uint32_t)p;
    for (size_t c = 3; c-- > 0;) {
        for (size_t i = 0; i < n; i++) key[i] = ordered_key(points[3 * (size_t)vertex[i] + c]);
        BRIO_TRY(brio_radix_sort(ctx, key, vertex, n, 64));
    }
    for (size_t i = 0; i < n; i++) rank[vertex[i]] = (uint32_t)i;
done:
    brio_release(ctx, vertex);
    brio_release(ctx, key);
    return status;
}

static uint64_t hash_of(uint32_t r[4]) {
    for (int i = 1; i < 4; i++)
        for (int j = i; j > 0 && r[j] < r[j - 1]; j--) {
            uint32_t swap = r[j];
            r[j] = r[j - 1], r[j - 1] = swap;
        }
    return brio_mix(brio_mix((uint64_t)r[0] << 32 | r[1]) + ((uint64_t)r[2] << 32 | r[3]));
}

brio_status brio_triangulation_checksum(brio_context *ctx, const brio_triangulation *t, const double *points,
                                        uint64_t *checksum) {
    brio_status status = BRIO_OK;
    uint32_t *rank = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, rank, t->stats.points));
    BRIO_TRY(lexicographic_ranks(ctx, t, points, rank));
    uint64_t sum = brio_mix(t->stats.vertices);
    for (size_t tet = 0; tet < t->stats.tetrahedra; tet++) {
        uint32_t r[4];
        for (int i = 0; i < 4; i++) r[i] = rank[t->vertex[4 * tet + (size_t)i]];
        sum += hash_of(r);
    }
    *checksum = sum;
done:
    brio_release(ctx, rank);
    return status;
}
