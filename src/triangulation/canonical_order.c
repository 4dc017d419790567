/* The canonical order of the tetrahedra.
 *
 * Vertices of a tetrahedron are rotated so that the last in insertion order comes first and the latest of the others second,
 * which leaves one arrangement of each orientation (an infinite vertex stays last). Tetrahedra are sorted by these
 * vertices, finite ones first: a counting sort by the first vertex, then a small sort in each bucket. The order depends on the
 * set of tetrahedra and the insertion order alone, not on the history or the threads that made it. A tetrahedron was created by
 * its latest vertex, so it already lies near its place; sorting by the earliest vertex would cost 40 % of the whole
 * construction in cache misses. */
#include "base/memory.h"
#include "base/sort.h"
#include "triangulation/kernel.h"
#include <string.h>

/* --- vertices inside a tetrahedron --- */

static int latest_of(const uint32_t *v, int count) {
    int best = 0;
    for (int i = 1; i < count; i++)
        if (v[i] > v[best]) best = i;
    return best;
}

/* from[i] = the slot whose vertex comes to slot i; an even permutation. */
static void arrangement(const uint32_t v[4], uint32_t infinite, uint8_t from[4]) {
    bool is_infinite = v[3] == infinite;
    int a = latest_of(v, is_infinite ? 3 : 4);
    if (is_infinite) {
        for (int i = 0; i < 3; i++) from[i] = (uint8_t)((a + i) % 3);
        from[3] = 3;
        return;
    }
    /* the other three in an order that keeps the orientation */
    uint32_t rest[3];
    for (int i = 0; i < 3; i++) {
        int slot = (a + 1) & 3;
        const uint8_t *edge = BRIO_EDGE[a][slot];
        int order[3] = {slot, edge[0], edge[1]};
        rest[i] = v[order[i]];
        from[i + 1] = (uint8_t)order[i];
    }
    int b = latest_of(rest, 3);
    uint8_t turned[3] = {from[1 + b], from[1 + (b + 1) % 3], from[1 + (b + 2) % 3]};
    from[0] = (uint8_t)a;
    memcpy(from + 1, turned, 3);
}

/* Rearranges every tetrahedron and renames the facets its mates know it by. */
static void arrange_all(brio_kernel *k) {
    brio_tetrahedra *t = &k->t;
    for (size_t tet = 0; tet < t->count; tet++) {
        if (k->state[tet] == TET_UNUSED) continue;
        uint32_t *v = t->vertex + 4 * tet, *m = t->mate + 4 * tet, old_v[4], old_m[4];
        uint8_t from[4], to[4];
        arrangement(v, t->infinite, from);
        for (int i = 0; i < 4; i++) to[from[i]] = (uint8_t)i;
        memcpy(old_v, v, sizeof old_v);
        memcpy(old_m, m, sizeof old_m);
        for (int i = 0; i < 4; i++) {
            v[i] = old_v[from[i]];
            m[i] = old_m[from[i]];
        }
        for (int i = 0; i < 4; i++) t->mate[old_m[i]] = brio_facet_of((uint32_t)tet, to[i]);
    }
}

/* --- the order of the tetrahedra --- */

static int compare_tetrahedra(uint32_t s, uint32_t u, const void *user) {
    const uint32_t *v = (const uint32_t *)user + 4 * (size_t)s, *w = (const uint32_t *)user + 4 * (size_t)u;
    for (int i = 1; i < 4; i++)
        if (v[i] != w[i]) return v[i] < w[i] ? -1 : 1;
    return 0;
}

/* Buckets: finite tetrahedra by first vertex, infinite ones by first vertex, unused slots. */
static size_t bucket_of(const brio_kernel *k, size_t tet) {
    size_t vertices = k->num_points + 2;
    if (k->state[tet] == TET_UNUSED) return 2 * vertices;
    bool infinite = k->t.vertex[4 * tet + 3] == k->t.infinite;
    return k->t.vertex[4 * tet] + (infinite ? vertices : 0);
}

/* order[i] = the tetrahedron that comes to place i. */
static brio_status sort_into(brio_kernel *k, uint32_t *order) {
    size_t buckets = 2 * (k->num_points + 2) + 1;
    uint32_t *end = NULL;
    brio_status status = BRIO_ALLOC_ZERO(k->ctx, end, buckets);
    if (status != BRIO_OK) return status;
    for (size_t t = 0; t < k->t.count; t++) end[bucket_of(k, t)]++;
    uint32_t sum = 0;
    for (size_t b = 0; b < buckets; b++) {
        uint32_t c = end[b];
        end[b] = sum;
        sum += c;
    }
    for (size_t t = 0; t < k->t.count; t++) order[end[bucket_of(k, t)]++] = (uint32_t)t;
    for (size_t b = 0, begin = 0; b + 1 < buckets; begin = end[b++])
        brio_sort_indices(order + begin, end[b] - begin, compare_tetrahedra, k->t.vertex);
    brio_release(k->ctx, end);
    return BRIO_OK;
}

/* to[i] = the four entries of tetrahedron order[i]. Independent reads, which the processor overlaps; following the cycles of the
 * permutation in place is three times slower than the rest of the sort. */
static void gather(const uint32_t *from, const uint32_t *order, size_t n, uint32_t *to) {
    for (size_t i = 0; i < n; i++) memcpy(to + 4 * i, from + 4 * (size_t)order[i], 4 * sizeof *to);
}

/* Replaces one of the kernel's arrays by its entries in the new order. */
static brio_status permute(brio_kernel *k, uint32_t **array, const uint32_t *order, size_t n) {
    uint32_t *sorted = NULL;
    brio_status status = BRIO_ALLOC(k->ctx, sorted, 4 * n);
    if (status != BRIO_OK) return status;
    gather(*array, order, n, sorted);
    brio_release(k->ctx, *array);
    *array = sorted;
    return BRIO_OK;
}

brio_status brio_kernel_sort(brio_kernel *k) {
    uint32_t *order = NULL, *place = NULL;
    size_t live = k->t.count - k->num_unused;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(k->ctx, order, k->t.count));
    arrange_all(k);
    BRIO_TRY(sort_into(k, order));
    BRIO_TRY(permute(k, &k->t.vertex, order, live));
    BRIO_TRY(permute(k, &k->t.mate, order, live));
    BRIO_TRY(BRIO_ALLOC(k->ctx, place, k->t.count));
    for (size_t i = 0; i < live; i++) place[order[i]] = (uint32_t)i;
    for (size_t f = 0; f < 4 * live; f++)
        k->t.mate[f] = brio_facet_of(place[brio_tet_of(k->t.mate[f])], brio_slot_of(k->t.mate[f]));
    k->t.count = k->capacity = live;
    k->num_unused = 0;
done:
    brio_release(k->ctx, order);
    brio_release(k->ctx, place);
    return status;
}
