/* The canonical order of the tetrahedra, in place, and the caller's names for their vertices.
 *
 * Every tetrahedron has its latest vertex (in insertion order) in slot 0, since that vertex created it. The three
 * others are turned so that the latest of them comes first, which leaves one arrangement of each orientation (an
 * infinite vertex stays last). Tetrahedra are sorted by their first three vertices, finite ones first: a counting sort
 * by the latest vertex, then a small sort in each bucket by the two after it, which no two tetrahedra of a bucket share
 * in this order. The order depends on the set of tetrahedra and the insertion order alone, not on the history or the
 * threads that made it. And a tetrahedron already lies near its place, nearer than in an order by the earliest vertex.
 *
 * Only one number a tetrahedron is added: its place is kept where its latest vertex was, which the place tells. The
 * array is permuted block by block: what belongs into a block is gathered aside, what else lives there moves to the
 * slots that this left free, and the block is written. The reads of a block are independent, which following cycles
 * would not be. */
#include "base/memory.h"
#include "triangulation/kernel.h"
#include <string.h>

enum { BLOCK = 1 << 13, TURN_SHIFT = 30, FEW = 48, AHEAD = 24 };

static const uint32_t PLACE_MASK = (UINT32_C(1) << TURN_SHIFT) - 1;

/* TURNED[r][i]: the slot whose entry comes to slot i; and back. */
static const uint8_t TURNED[3][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}};
static const uint8_t TURNED_BACK[3][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}};

/* Workspace: bucket b of tetrahedra holds places end[b - 1] to end[b]. */
typedef struct {
    brio_kernel *k;
    uint32_t *order; /* of each place: the tetrahedron that belongs there */
    uint32_t *end;
    size_t buckets, live;
    uint64_t *key; /* of the tetrahedra of one bucket, and their names */
    uint32_t *name;
    size_t key_capacity, name_capacity;
} sorter;

/* Buckets: finite tetrahedra by latest vertex, then infinite ones. */
static inline size_t bucket_of(const brio_kernel *k, const uint32_t *v) {
    return v[0] + (v[3] == k->t.infinite ? k->num_points + 2 : 0);
}

static void fill_buckets(sorter *s) {
    const brio_kernel *k = s->k;
    uint32_t sum = 0;
    for (size_t t = 0; t < k->t.count; t++)
        if (k->state[t] != TET_UNUSED) s->end[bucket_of(k, k->t.tet[t].vertex)]++;
    for (size_t b = 0; b < s->buckets; b++) {
        uint32_t c = s->end[b];
        s->end[b] = sum;
        sum += c;
    }
    for (size_t t = 0; t < k->t.count; t++)
        if (k->state[t] != TET_UNUSED) s->order[s->end[bucket_of(k, k->t.tet[t].vertex)]++] = (uint32_t)t;
}

/* How a tetrahedron is turned, and its key: the second and third vertex then. */
static inline uint64_t key_of(const uint32_t *v, uint32_t infinite, uint32_t *turn) {
    uint32_t a = v[1], b = v[2], c = v[3], r = 0;
    if (c != infinite) {
        r = b > a ? 1 : 0;
        r = c > (r ? b : a) ? 2 : r;
    }
    *turn = r;
    uint64_t second = r == 0 ? a : r == 1 ? b : c, third = r == 0 ? b : r == 1 ? c : a;
    return second << 32 | third;
}

static void sift_down(uint64_t *key, uint32_t *name, size_t root, size_t n) {
    uint64_t moved = key[root];
    uint32_t moved_name = name[root];
    for (size_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && key[child] < key[child + 1]) child++;
        if (moved >= key[child]) break;
        key[root] = key[child], name[root] = name[child];
    }
    key[root] = moved, name[root] = moved_name;
}

static void heap_sort(uint64_t *key, uint32_t *name, size_t n) {
    for (size_t i = n / 2; i-- > 0;) sift_down(key, name, i, n);
    for (size_t i = n; i-- > 1;) {
        uint64_t top = key[0];
        uint32_t top_name = name[0];
        key[0] = key[i], name[0] = name[i];
        key[i] = top, name[i] = top_name;
        sift_down(key, name, 0, i);
    }
}

/* out[rank of key[i]] = name[i], by counting the smaller keys: no branch depends on them. */
static void sort_few(const uint64_t *key, const uint32_t *name, size_t n, uint32_t *out) {
    for (size_t i = 0; i < n; i++) {
        size_t rank = 0;
        for (size_t j = 0; j < n; j++) rank += key[j] < key[i];
        out[rank] = name[i];
    }
}

/* Sorts the tetrahedra of the places [begin, end) and tells each its place and turn. */
static brio_status sort_bucket(sorter *s, size_t begin, size_t end) {
    size_t n = end - begin;
    brio_tetrahedron *tets = s->k->t.tet;
    uint32_t *order = s->order + begin, infinite = s->k->t.infinite;
    brio_status status = BRIO_RESERVE(s->k->ctx, s->key, s->key_capacity, n);
    if (status == BRIO_OK) status = BRIO_RESERVE(s->k->ctx, s->name, s->name_capacity, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) {
        uint32_t turn;
        __builtin_prefetch(&tets[order[i + AHEAD]]); /* of a bucket to come; order has room for it */
        s->key[i] = key_of(tets[order[i]].vertex, infinite, &turn);
        s->name[i] = order[i] | turn << TURN_SHIFT;
    }
    if (n <= FEW) {
        sort_few(s->key, s->name, n, order);
    } else {
        heap_sort(s->key, s->name, n);
        memcpy(order, s->name, n * sizeof *order);
    }
    for (size_t i = 0; i < n; i++) {
        uint32_t tet = order[i] & PLACE_MASK;
        tets[tet].vertex[0] = (uint32_t)(begin + i) | (order[i] & ~PLACE_MASK);
        order[i] = tet;
    }
    return BRIO_OK;
}

static brio_status sort_buckets(sorter *s) {
    brio_status status = BRIO_OK;
    for (size_t b = 0, begin = 0; b < s->buckets && status == BRIO_OK; begin = s->end[b++])
        status = sort_bucket(s, begin, s->end[b]);
    return status;
}

/* Turns each tetrahedron, and renames its facets and its vertices but the first. */
static void rename_all(sorter *s) {
    brio_kernel *k = s->k;
    brio_tetrahedron *tets = k->t.tet;
    for (size_t t = 0; t < k->t.count; t++) {
        if (k->state[t] == TET_UNUSED) continue;
        brio_tetrahedron old = tets[t], *tet = &tets[t];
        size_t later = t + 12 < k->t.count ? t + 12 : t;
        for (int i = 0; i < 4; i++) __builtin_prefetch(&tets[brio_tet_of(tets[later].mate[i])]);
        const uint8_t *from = TURNED[old.vertex[0] >> TURN_SHIFT];
        for (int i = 0; i < 4; i++) {
            uint32_t facet = old.mate[from[i]], other = tets[brio_tet_of(facet)].vertex[0];
            tet->mate[i] = brio_facet_of(other & PLACE_MASK, TURNED_BACK[other >> TURN_SHIFT][brio_slot_of(facet)]);
        }
        for (int i = 1; i < 4; i++) {
            uint32_t v = old.vertex[from[i]];
            tet->vertex[i] = v == k->t.infinite ? BRIO_INFINITE : k->caller[v];
        }
    }
}

/* --- moving --- */

/* Makes the tetrahedra at [begin, end) those that belong there. */
static void fill_block(sorter *s, size_t begin, size_t end, brio_tetrahedron *aside) {
    brio_tetrahedron *tets = s->k->t.tet;
    uint32_t *order = s->order;
    uint8_t *state = s->k->state;
    for (size_t i = begin; i < end; i++) {
        __builtin_prefetch(&tets[order[i + AHEAD]]);
        aside[i - begin] = tets[order[i]];
        state[order[i]] = TET_UNUSED;
    }
    size_t next = begin; /* of the block's own sources, those outside it are free now */
    for (size_t x = begin; x < end; x++) {
        if (state[x] == TET_UNUSED) continue;
        while (order[next] >= begin && order[next] < end) next++;
        uint32_t free_slot = order[next++];
        tets[free_slot] = tets[x];
        order[tets[x].vertex[0] & PLACE_MASK] = free_slot;
        state[free_slot] = TET_PLAIN;
        state[x] = TET_UNUSED;
    }
    memcpy(tets + begin, aside, (end - begin) * sizeof *tets);
}

/* Moves everything to its place, and gives back to each tetrahedron its first vertex, by the caller's name. */
static brio_status move_all(sorter *s) {
    brio_kernel *k = s->k;
    brio_tetrahedron *aside = NULL;
    size_t b = 0;
    brio_status status = BRIO_ALLOC(k->ctx, aside, BLOCK);
    if (status != BRIO_OK) return status;
    for (size_t begin = 0; begin < s->live; begin += BLOCK) {
        size_t end = begin + BLOCK < s->live ? begin + BLOCK : s->live;
        fill_block(s, begin, end, aside);
        for (size_t i = begin; i < end; i++) {
            while (s->end[b] <= i) b++;
            k->t.tet[i].vertex[0] = k->caller[b < k->num_points + 2 ? b : b - k->num_points - 2];
        }
    }
    brio_release(k->ctx, aside);
    return BRIO_OK;
}

brio_status brio_kernel_sort(brio_kernel *k) {
    sorter s = {.k = k, .buckets = 2 * (k->num_points + 2), .live = k->t.count - k->num_unused};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, s.order, s.live + AHEAD));
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, s.end, s.buckets));
    fill_buckets(&s);
    BRIO_TRY(sort_buckets(&s));
    rename_all(&s);
    BRIO_TRY(move_all(&s));
    k->t.count = k->capacity = s.live;
    k->num_unused = 0;
    k->stats.hull_facets = s.live - s.end[k->num_points + 1];
    k->stats.tetrahedra = s.live - k->stats.hull_facets;
    brio_release(k->ctx, k->state);
    k->state = NULL;
done:
    brio_release(k->ctx, s.order);
    brio_release(k->ctx, s.end);
    brio_release(k->ctx, s.key);
    brio_release(k->ctx, s.name);
    return status;
}
