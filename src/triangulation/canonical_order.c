/* The canonical order of the tetrahedra, in place, and the caller's names for their vertices.
 *
 * Every tetrahedron has its latest vertex (in insertion order) in slot 0, since that vertex created it. The three
 * others are turned so that the latest of them comes first, which leaves one arrangement of each orientation (an
 * infinite vertex stays last). Tetrahedra are sorted by their first three vertices, finite ones first: a counting sort
 * by the latest vertex, then a small sort in each bucket by the two after it, which no two tetrahedra of a bucket share
 * in this order. The order depends on the set of tetrahedra and the insertion order alone, not on the history or the
 * threads that made it. And a tetrahedron already lies near its place, nearer than in an order by the earliest vertex.
 *
 * The array is permuted in place, block by block: what belongs into a block is gathered aside with its facets and
 * vertices renamed, what else lives there moves to the slots that this left free, and the block is written. The reads of
 * a block are independent, which following cycles would not be. Two numbers a tetrahedron are added, no second copy. */
#include "base/memory.h"
#include "triangulation/kernel.h"
#include <string.h>

enum { BLOCK = 1 << 13, TURN_SHIFT = 30, FEW = 48, AHEAD = 24 };

static const uint32_t PLACE_MASK = (UINT32_C(1) << TURN_SHIFT) - 1, NOWHERE = UINT32_MAX;

/* What a slot holds while things move, instead of the states of the insertion. */
enum { SLOT_FIRST = TET_PLAIN, SLOT_MOVED = TET_CAVITY, SLOT_FREE = TET_UNUSED };

/* TURNED[r][i]: the slot whose entry comes to slot i; and back. */
static const uint8_t TURNED[3][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}};
static const uint8_t TURNED_BACK[3][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}};

/* Workspace: bucket b of tetrahedra holds places end[b - 1] to end[b]. */
typedef struct {
    brio_kernel *k;
    uint32_t *order; /* of each place: the slot whose tetrahedron belongs there */
    uint32_t *place; /* of each tetrahedron by its slot in the insertion: its bucket, then its place and turn */
    uint32_t *end;
    size_t buckets, live;
    uint64_t *key; /* of the tetrahedra of one bucket, and their names */
    uint32_t *name;
    size_t key_capacity, name_capacity;
} sorter;

/* Buckets: finite tetrahedra by latest vertex, then infinite ones. */
static void fill_buckets(sorter *s) {
    const brio_kernel *k = s->k;
    uint32_t sum = 0, infinite = k->t.infinite, first_infinite = (uint32_t)k->num_points + 2;
    for (size_t t = 0; t < k->t.count; t++) {
        const uint32_t *v = k->t.tet[t].vertex;
        uint32_t b = v[0] + (v[3] == infinite ? first_infinite : 0);
        s->place[t] = k->state[t] == TET_UNUSED ? NOWHERE : b;
        s->end[b] += k->state[t] != TET_UNUSED;
    }
    for (size_t b = 0; b < s->buckets; b++) {
        uint32_t c = s->end[b];
        s->end[b] = sum;
        sum += c;
    }
    for (size_t t = 0; t < k->t.count; t++)
        if (s->place[t] != NOWHERE) s->order[s->end[s->place[t]]++] = (uint32_t)t;
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
    const brio_tetrahedron *tets = s->k->t.tet;
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
        s->place[tet] = (uint32_t)(begin + i) | (order[i] & ~PLACE_MASK);
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

/* --- moving --- */

/* Place and turn of the tetrahedron in a slot. */
static inline uint32_t place_of(const sorter *s, uint32_t slot) {
    return s->k->state[slot] == SLOT_MOVED ? s->k->t.tet[slot].vertex[0] : s->place[slot];
}

/* The tetrahedron in a slot as it will stand, but for its first vertex. */
static inline void rename_one(const sorter *s, uint32_t slot, brio_tetrahedron *out) {
    const brio_kernel *k = s->k;
    const brio_tetrahedron *old = &k->t.tet[slot];
    const uint8_t *from = TURNED[place_of(s, slot) >> TURN_SHIFT];
    for (int i = 0; i < 4; i++) {
        uint32_t facet = old->mate[from[i]], other = s->place[brio_tet_of(facet)];
        out->mate[i] = brio_facet_of(other & PLACE_MASK, TURNED_BACK[other >> TURN_SHIFT][brio_slot_of(facet)]);
    }
    for (int i = 1; i < 4; i++) {
        uint32_t v = old->vertex[from[i]];
        out->vertex[i] = v == k->t.infinite ? BRIO_INFINITE : k->caller[v];
    }
}

/* Makes the tetrahedra at [begin, end) those that belong there. A tetrahedron that has to leave the block for a free
 * slot takes its place along in vertex[0], which its place tells. */
static void fill_block(sorter *s, size_t begin, size_t end, brio_tetrahedron *aside) {
    brio_tetrahedron *tets = s->k->t.tet;
    uint32_t *order = s->order;
    uint8_t *state = s->k->state;
    for (size_t i = begin; i < end; i++) {
        const brio_tetrahedron *later = &tets[order[i + AHEAD / 2]];
        __builtin_prefetch(&tets[order[i + AHEAD]]);
        for (int f = 0; f < 4; f++) __builtin_prefetch(&s->place[brio_tet_of(later->mate[f])]);
        rename_one(s, order[i], &aside[i - begin]);
        state[order[i]] = SLOT_FREE;
    }
    size_t next = begin; /* of the block's own sources, those outside it are free now */
    for (size_t x = begin; x < end; x++) {
        size_t later = x + AHEAD < end ? x + AHEAD : x;
        if (state[later] != SLOT_FREE) __builtin_prefetch(&order[place_of(s, (uint32_t)later) & PLACE_MASK], 1);
        if (state[x] == SLOT_FREE) continue;
        while (order[next] >= begin && order[next] < end) next++;
        uint32_t free_slot = order[next++], place = place_of(s, (uint32_t)x);
        tets[free_slot] = tets[x];
        tets[free_slot].vertex[0] = place;
        order[place & PLACE_MASK] = free_slot;
        state[free_slot] = SLOT_MOVED;
        state[x] = SLOT_FREE;
    }
    memcpy(tets + begin, aside, (end - begin) * sizeof *tets);
}

/* Moves everything to its place, and gives each tetrahedron its first vertex. */
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
    BRIO_TRY(BRIO_ALLOC(k->ctx, s.place, k->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, s.end, s.buckets));
    fill_buckets(&s);
    BRIO_TRY(sort_buckets(&s));
    BRIO_TRY(move_all(&s));
    k->t.count = k->capacity = s.live;
    k->num_unused = 0;
    k->stats.hull_facets = s.live - s.end[k->num_points + 1];
    k->stats.tetrahedra = s.live - k->stats.hull_facets;
    brio_release(k->ctx, k->state);
    k->state = NULL;
done:
    brio_release(k->ctx, s.order);
    brio_release(k->ctx, s.place);
    brio_release(k->ctx, s.end);
    brio_release(k->ctx, s.key);
    brio_release(k->ctx, s.name);
    return status;
}
