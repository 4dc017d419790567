/* The canonical order of the tetrahedra, in place.
 *
 * Every tetrahedron has its latest vertex (in insertion order) in slot 0, since that vertex created it. The three
 * others are turned so that the latest of them comes first, which leaves one arrangement of each orientation (an
 * infinite vertex stays last). Tetrahedra are sorted by these vertices, finite ones first: a counting sort by the
 * latest vertex, then a small sort in each bucket. The order depends on the set of tetrahedra and the insertion order
 * alone, not on the history or the threads that made it. And a tetrahedron already lies near its place, nearer than in
 * an order by the earliest vertex, which takes 5 to 12 % longer in all.
 *
 * The arrays are permuted block by block: what belongs into a block is gathered aside, what else lives there moves to
 * the places that this left free, and the block is written. The reads of a block are independent, which following
 * cycles would not be. Two numbers a tetrahedron are added, no second copy. */
#include "base/memory.h"
#include "triangulation/kernel.h"
#include <string.h>

enum { BLOCK = 1 << 14, TURN_SHIFT = 30, SMALL = 24, AHEAD = 32 };

static const uint32_t PLACE_MASK = (UINT32_C(1) << TURN_SHIFT) - 1, NOWHERE = UINT32_MAX;

/* Three vertices of a tetrahedron after its first, as they will stand. */
typedef struct {
    uint32_t v[3];
    uint32_t tet; /* and the turn that brings them so, in the bits from TURN_SHIFT on */
} sort_key;

/* TURNED[r][i]: the slot whose entry comes to slot i; and back. */
static const uint8_t TURNED[3][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}};
static const uint8_t TURNED_BACK[3][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}};

static sort_key key_of(const brio_kernel *k, uint32_t tet) {
    const uint32_t *v = k->t.vertex + 4 * (size_t)tet;
    uint32_t turn = v[2] > v[1] ? 1 : 0;
    turn = v[3] > v[turn + 1] ? 2 : turn;
    if (v[3] == k->t.infinite) turn = 0;
    const uint8_t *from = TURNED[turn];
    return (sort_key){{v[from[1]], v[from[2]], v[from[3]]}, tet | turn << TURN_SHIFT};
}

static inline bool before(const sort_key *a, const sort_key *b) {
    if (a->v[0] != b->v[0]) return a->v[0] < b->v[0];
    if (a->v[1] != b->v[1]) return a->v[1] < b->v[1];
    return a->v[2] < b->v[2];
}

static void insertion_sort(sort_key *a, size_t n) {
    for (size_t i = 1; i < n; i++) {
        sort_key moved = a[i];
        size_t j = i;
        for (; j > 0 && before(&moved, &a[j - 1]); j--) a[j] = a[j - 1];
        a[j] = moved;
    }
}

static void sift_down(sort_key *a, size_t root, size_t n) {
    sort_key moved = a[root];
    for (size_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && before(&a[child], &a[child + 1])) child++;
        if (!before(&moved, &a[child])) break;
        a[root] = a[child];
    }
    a[root] = moved;
}

static void heap_sort(sort_key *a, size_t n) {
    for (size_t i = n / 2; i-- > 0;) sift_down(a, i, n);
    for (size_t i = n; i-- > 1;) {
        sort_key top = a[0];
        a[0] = a[i], a[i] = top;
        sift_down(a, 0, i);
    }
}

/* Sorts one bucket of tetrahedra, and notes their turns in it. */
static brio_status sort_bucket(brio_kernel *k, uint32_t *tets, size_t n, sort_key **keys, size_t *capacity) {
    brio_status status = BRIO_RESERVE(k->ctx, *keys, *capacity, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) {
        __builtin_prefetch(k->t.vertex + 4 * (size_t)tets[i + AHEAD]); /* of a bucket to come; order has room for it */
        (*keys)[i] = key_of(k, tets[i]);
    }
    if (n <= SMALL)
        insertion_sort(*keys, n);
    else
        heap_sort(*keys, n);
    for (size_t i = 0; i < n; i++) tets[i] = (*keys)[i].tet;
    return BRIO_OK;
}

/* Buckets: finite tetrahedra by latest vertex, then infinite ones. */
static size_t bucket_of(const brio_kernel *k, const uint32_t *v) {
    return v[0] + (v[3] == k->t.infinite ? k->num_points + 2 : 0);
}

/* order[i] = the tetrahedron that comes to place i, with its turn. */
static brio_status sort_into(brio_kernel *k, uint32_t *order) {
    size_t buckets = 2 * (k->num_points + 2), capacity = 0;
    uint32_t *end = NULL, sum = 0;
    sort_key *keys = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, end, buckets));
    for (size_t t = 0; t < k->t.count; t++)
        if (k->state[t] != TET_UNUSED) end[bucket_of(k, k->t.vertex + 4 * t)]++;
    for (size_t b = 0; b < buckets; b++) {
        uint32_t c = end[b];
        end[b] = sum;
        sum += c;
    }
    for (size_t t = 0; t < k->t.count; t++)
        if (k->state[t] != TET_UNUSED) order[end[bucket_of(k, k->t.vertex + 4 * t)]++] = (uint32_t)t;
    for (size_t b = 0, begin = 0; b < buckets; begin = end[b++])
        BRIO_TRY(sort_bucket(k, order + begin, end[b] - begin, &keys, &capacity));
done:
    brio_release(k->ctx, end);
    brio_release(k->ctx, keys);
    return status;
}

/* Renames and turns the facets of each tetrahedron; place[t] holds its place and turn. */
static void rename_facets(brio_tetrahedra *t, const uint32_t *place) {
    for (size_t tet = 0; tet < t->count; tet++) {
        if (place[tet] == NOWHERE) continue;
        const uint8_t *from = TURNED[place[tet] >> TURN_SHIFT];
        uint32_t *v = t->vertex + 4 * tet, *m = t->mate + 4 * tet, old_v[4], old_m[4];
        memcpy(old_v, v, sizeof old_v);
        memcpy(old_m, m, sizeof old_m);
        for (int i = 0; i < 4; i++) {
            uint32_t facet = old_m[from[i]], other = place[brio_tet_of(facet)];
            v[i] = old_v[from[i]];
            m[i] = brio_facet_of(other & PLACE_MASK, TURNED_BACK[other >> TURN_SHIFT][brio_slot_of(facet)]);
        }
    }
}

/* --- moving --- */

typedef struct {
    uint32_t v[4], m[4];
} entry;

static inline void take(const brio_tetrahedra *t, size_t tet, entry *e) {
    memcpy(e->v, t->vertex + 4 * tet, sizeof e->v);
    memcpy(e->m, t->mate + 4 * tet, sizeof e->m);
}

static inline void put(brio_tetrahedra *t, size_t tet, const entry *e) {
    memcpy(t->vertex + 4 * tet, e->v, sizeof e->v);
    memcpy(t->mate + 4 * tet, e->m, sizeof e->m);
}

/* Makes the tetrahedra in [begin, end) those of order[begin .. end); place[t] = where the one now at t belongs, NOWHERE
 * for none. */
static void fill_block(brio_tetrahedra *t, uint32_t *order, uint32_t *place, size_t begin, size_t end, entry *aside) {
    for (size_t i = begin; i < end; i++) {
        __builtin_prefetch(t->vertex + 4 * (size_t)order[i + AHEAD]);
        __builtin_prefetch(t->mate + 4 * (size_t)order[i + AHEAD]);
        take(t, order[i], &aside[i - begin]);
        place[order[i]] = NOWHERE;
    }
    size_t next = begin; /* of the block's own sources, those outside it are free now */
    for (size_t x = begin; x < end; x++) {
        if (place[x] == NOWHERE) continue;
        while (order[next] < end) next++;
        uint32_t free_slot = order[next++];
        entry moved;
        take(t, x, &moved);
        put(t, free_slot, &moved);
        place[free_slot] = place[x];
        order[place[x]] = free_slot;
        place[x] = NOWHERE;
    }
    for (size_t i = begin; i < end; i++) put(t, i, &aside[i - begin]);
}

brio_status brio_kernel_sort(brio_kernel *k) {
    uint32_t *order = NULL, *place = NULL;
    entry *aside = NULL;
    size_t live = k->t.count - k->num_unused;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, order, live + AHEAD));
    BRIO_TRY(BRIO_ALLOC(k->ctx, place, k->t.count));
    BRIO_TRY(BRIO_ALLOC(k->ctx, aside, BLOCK));
    BRIO_TRY(sort_into(k, order));
    brio_release(k->ctx, k->state);
    k->state = NULL;
    for (size_t t = 0; t < k->t.count; t++) place[t] = NOWHERE;
    for (size_t i = 0; i < live; i++) place[order[i] & PLACE_MASK] = (uint32_t)i | (order[i] & ~PLACE_MASK);
    rename_facets(&k->t, place);
    for (size_t i = 0; i < live; i++) order[i] &= PLACE_MASK;
    for (size_t t = 0; t < k->t.count; t++)
        if (place[t] != NOWHERE) place[t] &= PLACE_MASK;
    for (size_t begin = 0; begin < live; begin += BLOCK)
        fill_block(&k->t, order, place, begin, begin + BLOCK < live ? begin + BLOCK : live, aside);
    k->t.count = k->capacity = live;
    k->num_unused = 0;
done:
    brio_release(k->ctx, order);
    brio_release(k->ctx, place);
    brio_release(k->ctx, aside);
    return status;
}
