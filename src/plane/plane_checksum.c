/* A hash of a triangulation of the plane that depends on the points only, as triangulation/checksum.c has it for
 * tetrahedra. The hash of a triangle mixes the ascending lexicographic ranks of its vertices. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "plane/triangulation2.h"

typedef struct {
    const double *points;
    size_t coordinates;
} rows;

static int compare_rows(uint32_t p, uint32_t q, const void *user) {
    const rows *r = user;
    const double *a = r->points + r->coordinates * p, *b = r->points + r->coordinates * q;
    for (size_t k = 0; k < r->coordinates; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

/* Sets rank[p] of each vertex p to its rank among the vertices. */
static brio_status lexicographic_ranks(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                       uint32_t *rank) {
    brio_status status = BRIO_OK;
    rows r = {points, (size_t)t->stats.coordinates};
    size_t n = 0;
    uint32_t *vertex = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, vertex, t->stats.vertices));
    for (size_t p = 0; p < t->stats.points; p++)
        if (t->representative[p] == p) vertex[n++] = (uint32_t)p;
    BRIO_TRY(brio_sort_rows(ctx, &(brio_row_order){points, r.coordinates, compare_rows, &r}, vertex, n));
    for (size_t i = 0; i < n; i++) rank[vertex[i]] = (uint32_t)i;
done:
    brio_release(ctx, vertex);
    return status;
}

static uint64_t hash_of(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    uint32_t first = c < low ? c : low, last = c > high ? c : high;
    return brio_mix(brio_mix((uint64_t)first << 32 | (a ^ b ^ c ^ first ^ last)) + last);
}

brio_status brio_triangulation2_checksum(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                         uint64_t *checksum) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    uint32_t *rank = NULL;
    uint64_t sum = brio_mix(t->stats.vertices);
    BRIO_TRY(BRIO_ALLOC(ctx, rank, t->stats.points));
    BRIO_TRY(lexicographic_ranks(ctx, t, points, rank));
    for (size_t i = 0; i < t->stats.triangles; i++) {
        const uint32_t *v = t->triangle[i].vertex;
        sum += hash_of(rank[v[0]], rank[v[1]], rank[v[2]]);
    }
    *checksum = sum;
done:
    brio_release(ctx, rank);
    return status;
}
