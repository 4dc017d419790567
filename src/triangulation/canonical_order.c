/* The canonical order of the tetrahedra, in place, and the caller's names for their vertices.
 *
 * The vertices of every tetrahedron are turned by an even permutation: the latest (in the order of insertion) comes
 * first, then the latest of the others, which leaves one arrangement (an infinite vertex stays last). Tetrahedra are
 * sorted by their first three vertices, finite ones first: a counting sort by the latest vertex, then a small sort in
 * each bucket by the two after it, which no two tetrahedra of a bucket share in this order. The order depends on the
 * set of tetrahedra and the insertion order alone, not on the history or the threads that made it. And a tetrahedron
 * already lies near its place, nearer than in an order by the earliest vertex.
 *
 * The array is permuted in place, block by block: what belongs into a block is gathered aside with its facets and
 * vertices renamed, what else lives there moves to the slots that this left free, and the block is written. The reads
 * of a block are independent, which following cycles would not be. Two numbers a tetrahedron are added, no second copy.
 *
 * In scratch files it is done by partitions instead (canonical_files.c). */
#include "triangulation/canonical_order.h"
#include "base/memory.h"
#include "base/team.h"
#include "triangulation/canonical_turn.h"
#include <assert.h>
#include <string.h>

/* BLOCK: places of a thread, which fit its second-level cache with twice as many. STEPS, AHEAD: chosen. */
enum { BLOCK = 1 << 13, STEPS = 32, AHEAD = 24 };

static const uint32_t NOWHERE = UINT32_MAX;

/* The states while things move: the turn of the tetrahedron that was in the slot at the end of the insertion, and what
 * the slot holds now: still that one, another one, already turned, or nothing. */
enum { TURN = 15, SLOT_MOVED = 16, SLOT_FREE = 32 };

/* Workspace: bucket b of tetrahedra holds places end[b - 1] to end[b]. */
typedef struct {
    brio_store *store;
    uint32_t *order; /* of each place: the slot whose tetrahedron belongs there */
    uint32_t *place; /* of each tetrahedron by its slot in the insertion: its bucket, then its place */
    uint32_t *end;
    size_t buckets, live;
    int threads;
    brio_status status;
} sorter;

/* The tetrahedra of one bucket, in a thread's hands. */
typedef struct {
    uint64_t *key;
    uint32_t *name;
    size_t key_capacity, name_capacity;
} bucket;

/* --- places --- */

/* Returns the count of a bucket and adds 1 to it. */
static inline uint32_t count_one(const sorter *s, size_t b) {
    if (s->threads == 1) return s->end[b]++;
    return __atomic_fetch_add(&s->end[b], 1, __ATOMIC_RELAXED);
}

/* Sets `place` to the bucket of the tetrahedron in a slot: finite ones by latest vertex, then infinite ones. */
static inline void find_bucket(sorter *s, size_t slot) {
    const brio_store *store = s->store;
    const uint32_t *v = store->t.tet[slot].vertex;
    uint32_t infinite = store->t.infinite, first_infinite = (uint32_t)store->num_points + 2;
    if (store->state[slot] == TET_UNUSED) {
        s->place[slot] = NOWHERE;
        store->state[slot] = SLOT_FREE;
        return;
    }
    s->place[slot] = v[brio_latest_slot(v, infinite)] + (v[3] == infinite ? first_infinite : 0);
    assert(s->place[slot] < s->buckets);
    __builtin_prefetch(&s->end[s->place[slot]], 1);
}

/* Counts the tetrahedra of each bucket, those in the slots from `from` to `to`; the counters are fetched ahead, since
 * an atomic addition waits for its own. */
static void count_buckets(void *user, size_t from, size_t to, int thread) {
    sorter *s = user;
    (void)thread;
    for (size_t t = from; t < to + AHEAD; t++) {
        if (t < to) find_bucket(s, t);
        if (t >= from + AHEAD && s->place[t - AHEAD] != NOWHERE) count_one(s, s->place[t - AHEAD]);
    }
}

/* Lists the tetrahedra of each bucket, those in the slots from `from` to `to`. */
static void list_buckets(void *user, size_t from, size_t to, int thread) {
    const sorter *s = user;
    (void)thread;
    for (size_t t = from; t < to; t++) {
        size_t soon = t + AHEAD / 2, later = t + AHEAD;
        if (later < to && s->place[later] != NOWHERE) __builtin_prefetch(&s->end[s->place[later]], 1);
        if (soon < to && s->place[soon] != NOWHERE) {
            uint32_t end = __atomic_load_n(&s->end[s->place[soon]], __ATOMIC_RELAXED);
            __builtin_prefetch(&s->order[end], 1);
        }
        assert(s->place[t] == NOWHERE || __atomic_load_n(&s->end[s->place[t]], __ATOMIC_RELAXED) < s->live);
        if (s->place[t] != NOWHERE) s->order[count_one(s, s->place[t])] = (uint32_t)t;
    }
}

static brio_status fill_buckets(sorter *s) {
    size_t count = s->store->t.count;
    uint32_t sum = 0;
    BRIO_FORWARD(brio_for(s->store->ctx, s->threads, count, count_buckets, s));
    for (size_t b = 0; b < s->buckets; b++) {
        uint32_t c = s->end[b];
        s->end[b] = sum;
        sum += c;
    }
    BRIO_EXPECT(s->store->ctx, sum == s->live, BRIO_ERR_INTERNAL, "%u slots are in use instead of %zu", (unsigned)sum,
                s->live);
    return brio_for(s->store->ctx, s->threads, count, list_buckets, s);
}

/* Sorts the tetrahedra of the places [begin, end) and notes the place and the turn of each. */
static brio_status sort_bucket(sorter *s, bucket *b, size_t begin, size_t end) {
    assert(begin <= end && end <= s->live);
    size_t n = end - begin;
    const brio_tetrahedron *tets = s->store->t.tet;
    uint32_t *order = s->order + begin, infinite = s->store->t.infinite;
    brio_status status = BRIO_RESERVE(s->store->ctx, b->key, b->key_capacity, n);
    if (status == BRIO_OK) status = BRIO_RESERVE(s->store->ctx, b->name, b->name_capacity, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) {
        b->key[i] = brio_turn_key(tets[order[i]].vertex, infinite, &s->store->state[order[i]]);
        b->name[i] = order[i];
    }
    brio_sort_names(b->key, b->name, n, order);
    for (size_t i = 0; i < n; i++) s->place[order[i]] = (uint32_t)(begin + i);
    return BRIO_OK;
}

/* Sorts the buckets [from, to). */
static brio_status sort_some(sorter *s, size_t from, size_t to) {
    bucket b = {0};
    brio_status status = BRIO_OK;
    size_t last = to ? s->end[to - 1] : 0;
    for (size_t i = from, begin = from ? s->end[from - 1] : 0; i < to && status == BRIO_OK; begin = s->end[i++]) {
        for (size_t a = begin; a < s->end[i] && a + AHEAD < last; a++)
            __builtin_prefetch(&s->store->t.tet[s->order[a + AHEAD]]);
        status = sort_bucket(s, &b, begin, s->end[i]);
    }
    brio_release(s->store->ctx, b.key);
    brio_release(s->store->ctx, b.name);
    return status;
}

static void sort_chunk(void *user, size_t from, size_t to, int thread) {
    sorter *s = user;
    (void)thread;
    brio_report(&s->status, sort_some(s, from, to));
}

static brio_status sort_buckets(sorter *s) {
    enum {
        PARTS = 16,
        MOST = 1 << 14
    }; /* parts of a thread, since buckets are not alike, and buckets between two looks */
    size_t chunk = s->buckets / (size_t)(PARTS * s->threads) + 1;
    if (chunk > MOST) chunk = MOST;
    brio_report(&s->status, brio_for_chunks(s->store->ctx, s->threads, s->buckets, chunk, sort_chunk, s));
    return s->status;
}

/* --- moving --- */

/* Threads mark their own slots while others read the turns there. */
static inline unsigned load_state(const sorter *s, uint32_t slot) {
    return __atomic_load_n(&s->store->state[slot], __ATOMIC_RELAXED);
}
static inline void mark_slot(sorter *s, uint32_t slot, unsigned mark) {
    __atomic_store_n(&s->store->state[slot], (uint8_t)((load_state(s, slot) & TURN) | mark), __ATOMIC_RELAXED);
}

/* Returns the place of the tetrahedron in a slot. */
static inline uint32_t place_of(const sorter *s, uint32_t slot) {
    assert(!(load_state(s, slot) & SLOT_FREE));
    return load_state(s, slot) & SLOT_MOVED ? s->store->t.tet[slot].vertex[0] : s->place[slot];
}

/* Returns the permutation that turns the tetrahedron in a slot to the order in which it will stand. */
static inline const uint8_t *turn_of(const sorter *s, uint32_t slot) {
    unsigned state = load_state(s, slot);
    assert((state & TURN) < 12); /* bits 0 to 3: the turn; bit 4: moved; bit 5: free */
    return BRIO_TURNED[state & SLOT_MOVED ? 0 : state & TURN];
}

/* Writes the tetrahedron in a slot as it will stand, except its first vertex. */
static inline void rename_one(const sorter *s, uint32_t slot, brio_tetrahedron *out) {
    const brio_store *store = s->store;
    const brio_tetrahedron *old = &store->t.tet[slot];
    const uint8_t *from = turn_of(s, slot);
    for (int i = 0; i < 4; i++) {
        uint32_t facet = old->mate[from[i]], other = brio_tet_of(facet);
        assert(s->place[other] < s->live && (load_state(s, other) & TURN) < 12);
        out->mate[i] = brio_facet_of(s->place[other], BRIO_BACK[load_state(s, other) & TURN][brio_slot_of(facet)]);
    }
    for (int i = 1; i < 4; i++) {
        uint32_t v = old->vertex[from[i]];
        out->vertex[i] = v == store->t.infinite ? BRIO_INFINITE : store->caller[v];
    }
}

/* Turns a tetrahedron and moves it to another slot. There vertex[0] holds the place of the tetrahedron: the place
 * determines the bucket, and the bucket the vertex. */
static inline void move_one(sorter *s, uint32_t slot, uint32_t to) {
    const brio_tetrahedron *old = &s->store->t.tet[slot];
    brio_tetrahedron *new = &s->store->t.tet[to];
    const uint8_t *from = turn_of(s, slot);
    assert(load_state(s, to) & SLOT_FREE);
    uint32_t place = place_of(s, slot);
    for (int i = 0; i < 4; i++) new->vertex[i] = old->vertex[from[i]], new->mate[i] = old->mate[from[i]];
    new->vertex[0] = place;
    assert(place < s->live && s->order[place] == slot);
    s->order[place] = to;
    mark_slot(s, to, SLOT_MOVED);
    mark_slot(s, slot, SLOT_FREE);
}

/* What the threads share that fill a block: the tetrahedra aside, those that have to leave and the slots for them, and
 * how many of each the threads before one have found. */
typedef struct {
    sorter *sorter;
    size_t block; /* places in one */
    brio_tetrahedron *aside;
    uint32_t *leaving, *vacant;
    size_t *num_leaving, *num_vacant;
    brio_status stop; /* the callback asked to stop */
} mover;

/* Gathers the tetrahedra of the places [begin + from, begin + to) aside. */
static void gather(sorter *s, const mover *m, size_t begin, size_t from, size_t to) {
    const brio_tetrahedron *tets = s->store->t.tet;
    const uint32_t *order = s->order + begin;
    for (size_t i = from; i < to; i++) {
        if (i + AHEAD < to) {
            const brio_tetrahedron *later = &tets[order[i + AHEAD / 2]];
            __builtin_prefetch(&tets[order[i + AHEAD]]);
            for (int f = 0; f < 4; f++) __builtin_prefetch(&s->place[brio_tet_of(later->mate[f])]);
        }
        rename_one(s, order[i], &m->aside[i]);
    }
    for (size_t i = from; i < to; i++) mark_slot(s, order[i], SLOT_FREE);
}

/* Lists what has to leave the slots from `from` to `to` of the block, and what the places there left vacant elsewhere;
 * with counts only, just counts. */
static void list_moves(const mover *m, size_t begin, size_t end, const brio_member *member, bool counts_only) {
    const sorter *s = m->sorter;
    int thread = member->thread;
    size_t from = brio_part(end - begin, thread, member->threads);
    size_t to = brio_part(end - begin, thread + 1, member->threads);
    size_t leaving = counts_only ? 0 : m->num_leaving[thread], vacant = counts_only ? 0 : m->num_vacant[thread];
    for (size_t x = begin + from; x < begin + to; x++) {
        uint32_t source = s->order[x];
        bool stays = !(s->store->state[x] & SLOT_FREE), outside = source < begin || source >= end;
        if (!counts_only && stays) m->leaving[leaving] = (uint32_t)x;
        if (!counts_only && outside) m->vacant[vacant] = source;
        leaving += stays;
        vacant += outside;
    }
    if (counts_only) m->num_leaving[thread] = leaving, m->num_vacant[thread] = vacant;
}

/* Turns the threads' counts into where each thread begins. Returns how many tetrahedra are to be moved. */
static size_t add_up(const mover *m, int threads) {
    size_t leaving = 0, vacant = 0;
    for (int t = 0; t < threads; t++) {
        size_t l = m->num_leaving[t], v = m->num_vacant[t];
        m->num_leaving[t] = leaving, m->num_vacant[t] = vacant;
        leaving += l, vacant += v;
    }
    assert(leaving <= vacant && leaving <= m->block); /* each finds a slot outside of the block */
    return m->num_leaving[threads] = leaving;
}

/* Moves the leaving tetrahedra [from, to). */
static void leave_block(sorter *s, const mover *m, size_t from, size_t to) {
    for (size_t i = from; i < to; i++) {
        if (i + AHEAD < to) __builtin_prefetch(&s->order[place_of(s, m->leaving[i + AHEAD])], 1);
        move_one(s, m->leaving[i], m->vacant[i]);
    }
}

/* Writes what was gathered, each with its first vertex. */
static void write_block(sorter *s, const mover *m, size_t begin, size_t from, size_t to) {
    brio_store *store = s->store;
    size_t low = 0, high = s->buckets; /* to the bucket of the first place */
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (s->end[middle] <= begin + from)
            low = middle + 1;
        else
            high = middle;
    }
    for (size_t i = from, b = low; i < to; i++) {
        while (s->end[b] <= begin + i) b++;
        assert(b < s->buckets);
        store->t.tet[begin + i] = m->aside[i];
        store->t.tet[begin + i].vertex[0] = store->caller[b < store->num_points + 2 ? b : b - store->num_points - 2];
    }
}

/* Fills all blocks one after the other; every member does its part of each. */
static void move_blocks(void *user, const brio_member *member) {
    mover *m = user;
    sorter *s = m->sorter;
    int thread = member->thread, threads = member->threads;
    for (size_t begin = 0; begin < s->live && !m->stop; begin += m->block) {
        size_t end = begin + m->block < s->live ? begin + m->block : s->live;
        size_t from = brio_part(end - begin, thread, threads), to = brio_part(end - begin, thread + 1, threads);
        gather(s, m, begin, from, to);
        brio_barrier(member);
        list_moves(m, begin, end, member, true);
        brio_barrier(member);
        if (thread == 0) {
            add_up(m, threads);
            m->stop =
                brio_look(s->store->ctx, BRIO_LOOK_EVERY); /* every member reads it after the barriers that follow */
        }
        brio_barrier(member);
        list_moves(m, begin, end, member, false);
        brio_barrier(member);
        size_t moves = m->num_leaving[threads];
        leave_block(s, m, brio_part(moves, thread, threads), brio_part(moves, thread + 1, threads));
        brio_barrier(member);
        write_block(s, m, begin, from, to);
        brio_barrier(member);
    }
}

static brio_status move_all(sorter *s) {
    brio_context *ctx = s->store->ctx;
    brio_status status = BRIO_OK;
    size_t block = (size_t)BLOCK * (size_t)s->threads;
    if (s->threads > 1 && s->live / block > STEPS) block *= 2; /* threads wait for each other each time */
    mover m = {.sorter = s, .block = block};
    BRIO_TRY(BRIO_ALLOC(ctx, m.aside, block));
    BRIO_TRY(BRIO_ALLOC(ctx, m.leaving, block));
    BRIO_TRY(BRIO_ALLOC(ctx, m.vacant, block));
    BRIO_TRY(BRIO_ALLOC(ctx, m.num_leaving, (size_t)s->threads + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, m.num_vacant, (size_t)s->threads + 1));
    brio_run(ctx, s->threads, move_blocks, &m);
    status = m.stop;
done:
    brio_release(ctx, m.aside);
    brio_release(ctx, m.leaving);
    brio_release(ctx, m.vacant);
    brio_release(ctx, m.num_leaving);
    brio_release(ctx, m.num_vacant);
    return status;
}

brio_status brio_canonical_order(brio_store *store, size_t live, size_t *finite) {
    brio_context *ctx = store->ctx;
    if (ctx->scratch) return brio_canonical_files(store, live, finite);
    sorter s = {.store = store, .buckets = 2 * (store->num_points + 2), .live = live};
    s.threads = brio_threads(ctx, live, BLOCK);
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_store_fit(store));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.order, live + AHEAD));
    BRIO_TRY(BRIO_ALLOC(ctx, s.place, store->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.end, s.buckets));
    BRIO_TRY(brio_progress(ctx, "sort", 1)); /* the insertion owns the bar */
    BRIO_TRY(fill_buckets(&s));
    BRIO_TRY(brio_progress(ctx, "sort", 1));
    BRIO_TRY(sort_buckets(&s));
    BRIO_TRY(brio_progress(ctx, "sort", 1));
    BRIO_TRY(move_all(&s));
    assert(s.end[s.buckets - 1] == live);
    store->t.count = store->capacity = live;
    *finite = s.end[store->num_points + 1];
    brio_release(ctx, store->state);
    store->state = NULL;
done:
    brio_release(ctx, s.order);
    brio_release(ctx, s.place);
    brio_release(ctx, s.end);
    return status;
}
