/* The canonical order of the tetrahedra in scratch files: by partitions, reading and writing in sequence.
 *
 * The order is that of canonical_order.c, by one thread, for arrays that do not fit in memory. The tetrahedra are read
 * once and appended, already turned, to partitions by their latest vertex; a partition fits in memory. Each is then
 * read and sorted, which tells the places; and once all places are known it is read again, its facets are renamed, and
 * it is written where it belongs. Only the places and turns, 5 bytes a tetrahedron, are met in another order: that of
 * the neighbours of a partition, which are near in space and so near in the file.
 *
 * A partition is a list of chunks, which lie in one file in the order in which they were filled: nothing has to be
 * counted beforehand, and a partition of any size has room. There are as many partitions as a quarter of the memory
 * asks for, and no more, since the fewer there are the longer are the chunks, which are read one by one.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988 (the distribution
 * sort). */
#include "triangulation/canonical_order.h"
#include "base/memory.h"
#include "base/read_ahead.h"
#include "triangulation/canonical_turn.h"
#include <assert.h>

/* A tetrahedron, turned but not renamed, and the slot where the insertion left it. */
typedef struct {
    brio_tetrahedron tet;
    uint32_t slot;
} entry;

enum {
    ALIGNED = 1024,    /* 1024 entries, or tetrahedra, fill whole pages */
    LEAST_RANGES = 8,  /* for finite tetrahedra, and as many for infinite ones */
    MOST_RANGES = 256, /* the same */
    MOST_CHUNK = 16    /* times ALIGNED */
};

/* The tetrahedra whose latest vertices are in a range: finite ones, or infinite ones. */
typedef struct {
    entry *last; /* the chunk that is being filled, in memory */
    size_t count, begin;
} partition;

typedef struct {
    brio_store *store;
    brio_read_ahead *read_ahead;
    size_t live;
    size_t ranges, range;            /* of latest vertices; vertices in each */
    size_t chunk;                    /* entries in each */
    size_t most;                     /* entries of the largest partition, whole chunks */
    bool in_memory;                  /* whether that fits in memory, as it should */
    partition part[2 * MOST_RANGES]; /* finite ones first */
    entry *last;                     /* the chunks that are being filled, side by side */
    entry *chunks;                   /* the full ones */
    uint16_t *owner;                 /* of each full chunk: its partition */
    size_t num_chunks, chunk_capacity, owner_capacity;
    uint32_t *place; /* of each slot; its turn is its state */
    entry *entries;  /* of the partition at hand */
    brio_tetrahedron *sorted;
    size_t carried;               /* tetrahedra at the front of `sorted`: too few to fill a page */
    uint32_t *end, *order, *name; /* of its buckets; of its entries, by bucket */
    uint64_t *key;
} distribution;

/* --- distribution --- */

/* Bytes for a partition, and for the chunks that are being filled. */
static size_t budget(const brio_context *ctx) {
    enum { LEAST = 1 << 20, MOST = 1 << 28 };
    size_t quarter = brio_memory_limit(ctx) / 4;
    return quarter < LEAST ? LEAST : quarter > MOST ? MOST : quarter;
}

static size_t between(size_t least, size_t x, size_t most) {
    return x < least ? least : x > most ? most : x;
}

static void choose_partitions(distribution *d) {
    size_t bytes = budget(d->store->ctx), chunks = bytes / (ALIGNED * sizeof(entry));
    size_t each = sizeof *d->entries + sizeof *d->sorted + sizeof *d->order + sizeof *d->name + sizeof *d->key;
    d->ranges = between(LEAST_RANGES, d->live * each / bytes + 1, chunks / 2 < MOST_RANGES ? chunks / 2 : MOST_RANGES);
    assert(0 < d->ranges && d->ranges <= MOST_RANGES);
    d->range = (d->store->num_points + 2) / d->ranges + 1;
    d->chunk = between(1, chunks / (2 * d->ranges), MOST_CHUNK) * ALIGNED;
}

/* Reports progress of one of three passes, which take about equally long. */
static brio_status tell_progress(const distribution *d, int pass, size_t done, size_t all) {
    return brio_progress(d->store->ctx, "sort", (pass + (double)done / (double)all) / 3);
}

static brio_status flush_chunk(distribution *d, size_t p) {
    brio_context *ctx = d->store->ctx;
    brio_status status = BRIO_OK;
    bool first = !d->chunks;
    BRIO_TRY(BRIO_RESERVE(ctx, d->chunks, d->chunk_capacity, (d->num_chunks + 1) * d->chunk));
    if (first) brio_block_direct(d->chunks, true);
    BRIO_TRY(BRIO_RESERVE(ctx, d->owner, d->owner_capacity, d->num_chunks + 1));
    assert(p <= UINT16_MAX && d->num_chunks < d->owner_capacity);
    d->owner[d->num_chunks] = (uint16_t)p;
    size_t bytes = d->chunk * sizeof(entry);
    status = brio_block_write(ctx, d->chunks, d->num_chunks++ * bytes, d->part[p].last, bytes);
done:
    return status;
}

static brio_status append(distribution *d, const brio_tetrahedron *t, uint32_t slot) {
    brio_store *store = d->store;
    uint8_t turn;
    brio_turn_key(t->vertex, store->t.infinite, &turn);
    const uint8_t *from = BRIO_TURNED[turn];
    size_t p = t->vertex[from[0]] / d->range + (t->vertex[3] == store->t.infinite ? d->ranges : 0);
    assert(p < 2 * d->ranges);
    partition *part = &d->part[p];
    entry *e = &part->last[part->count++ % d->chunk];
    for (int i = 0; i < 4; i++) e->tet.vertex[i] = t->vertex[from[i]], e->tet.mate[i] = t->mate[from[i]];
    e->slot = slot;
    store->state[slot] = turn;
    return part->count % d->chunk ? BRIO_OK : flush_chunk(d, p);
}

/* Writes the chunks that are not full, and tells where partitions begin. */
static brio_status flush_all(distribution *d) {
    for (size_t p = 0, begin = 0; p < 2 * d->ranges; begin += d->part[p++].count) {
        partition *part = &d->part[p];
        size_t rest = part->count % d->chunk, whole = part->count - rest + (rest ? d->chunk : 0);
        if (rest) BRIO_FORWARD(flush_chunk(d, p));
        part->begin = begin;
        if (whole > d->most) d->most = whole;
    }
    return BRIO_OK;
}

static brio_status distribute(distribution *d) {
    brio_store *store = d->store;
    enum { AT_ONCE = 1 << 15 };
    brio_tetrahedron *some = NULL;
    brio_status status = BRIO_OK;
    size_t in_use = 0;
    BRIO_TRY(BRIO_ALLOC_IN_MEMORY(store->ctx, some, AT_ONCE));
    BRIO_TRY(BRIO_ALLOC_IN_MEMORY(store->ctx, d->last, 2 * d->ranges * d->chunk));
    for (size_t p = 0; p < 2 * d->ranges; p++) d->part[p].last = d->last + p * d->chunk;
    brio_block_direct(store->t.tet, true);
    brio_expect_sequence(store->state);
    for (size_t begin = 0; begin < store->t.count; begin += AT_ONCE) {
        size_t n = store->t.count - begin < AT_ONCE ? store->t.count - begin : AT_ONCE;
        BRIO_TRY(tell_progress(d, 0, begin, store->t.count));
        BRIO_TRY(brio_block_read(store->ctx, store->t.tet, begin * sizeof *some, some, n * sizeof *some));
        for (size_t i = 0; i < n; i++) {
            if (store->state[begin + i] == TET_UNUSED) continue;
            BRIO_TRY(append(d, &some[i], (uint32_t)(begin + i)));
            in_use++;
        }
    }
    BRIO_REQUIRE(store->ctx, in_use == d->live, BRIO_ERR_INTERNAL, "%zu slots are in use instead of %zu", in_use,
                 d->live);
    brio_expect_random(store->state);
    status = flush_all(d);
done:
    brio_release(store->ctx, some);
    brio_release(store->ctx, d->last);
    d->last = NULL;
    return status;
}

/* --- one partition --- */

/* Makes room for the largest partition: in memory, unless one vertex is the latest of very many tetrahedra. */
static brio_status reserve_entries(distribution *d) {
    brio_context *ctx = d->store->ctx;
    size_t n = d->most;
    d->in_memory = n * (sizeof *d->entries + sizeof *d->sorted) <= 2 * budget(ctx);
    brio_status (*room)(brio_context *, void *, size_t, size_t) = d->in_memory ? brio_in_memory : brio_resize_to;
    if (d->chunks) brio_block_direct(d->chunks, d->in_memory);
    BRIO_FORWARD(room(ctx, &d->entries, n, sizeof *d->entries));
    BRIO_FORWARD(room(ctx, &d->sorted, n + ALIGNED, sizeof *d->sorted));
    BRIO_FORWARD(room(ctx, &d->order, n, sizeof *d->order));
    BRIO_FORWARD(room(ctx, &d->name, n, sizeof *d->name));
    BRIO_FORWARD(room(ctx, &d->key, n, sizeof *d->key));
    return room(ctx, &d->end, d->range, sizeof *d->end);
}

/* Finds the next run of chunks of a partition from *begin on. Sets *begin to its beginning. Returns its length, or
 * 0. */
static size_t next_run(const distribution *d, size_t p, size_t *begin) {
    size_t c = *begin;
    while (c < d->num_chunks && d->owner[c] != p) c++;
    *begin = c;
    while (c < d->num_chunks && d->owner[c] == p) c++;
    return c - *begin;
}

static brio_status read_partition(distribution *d, size_t p) {
    size_t n = 0, bytes = d->chunk * sizeof(entry);
    for (size_t c = 0, run; (run = next_run(d, p, &c)) > 0; c += run, n += run * d->chunk)
        BRIO_FORWARD(brio_block_read(d->store->ctx, d->chunks, c * bytes, &d->entries[n], run * bytes));
    return BRIO_OK;
}

/* Lists the entries at hand by their latest vertices; bucket b ends at end[b]. */
static void fill_buckets(distribution *d, size_t p) {
    size_t n = d->part[p].count, first = p % d->ranges * d->range;
    memset(d->end, 0, d->range * sizeof *d->end);
    for (size_t i = 0; i < n; i++) d->end[d->entries[i].tet.vertex[0] - first]++;
    uint32_t sum = 0;
    assert(n <= d->most);
    for (size_t b = 0; b < d->range; b++) {
        uint32_t c = d->end[b];
        d->end[b] = sum;
        sum += c;
    }
    for (size_t i = 0; i < n; i++) d->name[d->end[d->entries[i].tet.vertex[0] - first]++] = (uint32_t)i;
}

/* Tells each slot of a partition its place. */
static brio_status sort_partition(distribution *d, size_t p) {
    if (!d->part[p].count) return BRIO_OK;
    brio_status status = tell_progress(d, 1, d->part[p].begin, d->live);
    if (status == BRIO_OK) status = read_partition(d, p);
    if (status != BRIO_OK) return status;
    fill_buckets(d, p);
    for (size_t i = 0; i < d->part[p].count; i++) {
        const uint32_t *v = d->entries[d->name[i]].tet.vertex;
        d->key[i] = (uint64_t)v[1] << 32 | v[2];
    }
    for (size_t b = 0, begin = 0; b < d->range; begin = d->end[b++])
        brio_sort_names(d->key + begin, d->name + begin, d->end[b] - begin, d->order + begin);
    for (size_t i = 0; i < d->part[p].count; i++) {
        uint32_t *place = &d->place[d->entries[d->order[i]].slot];
        brio_expect(d->read_ahead, place);
        *place = (uint32_t)(d->part[p].begin + i);
    }
    return BRIO_OK;
}

/* --- renaming --- */

static inline void rename_one(const distribution *d, const brio_tetrahedron *old, brio_tetrahedron *out) {
    const brio_store *store = d->store;
    for (int i = 0; i < 4; i++) {
        uint32_t other = brio_tet_of(old->mate[i]), v = old->vertex[i];
        out->mate[i] = brio_facet_of(d->place[other], BRIO_BACK[store->state[other]][brio_slot_of(old->mate[i])]);
        out->vertex[i] = v == store->t.infinite ? BRIO_INFINITE : store->caller[v];
    }
}

/* Announces that the places and turns of all neighbours of the entries at hand will be read. */
static void expect_neighbours(distribution *d, size_t n) {
    brio_read_ahead *r = d->read_ahead;
    for (size_t i = 0; i < n; i++)
        for (int f = 0; f < 4; f++) {
            uint32_t other = brio_tet_of(d->entries[i].tet.mate[f]);
            brio_expect(r, &d->place[other]);
            brio_expect(r, &d->store->state[other]);
        }
}

/* Writes what is sorted as far as it fills pages; `end` is its last place. */
static brio_status write_pages(distribution *d, brio_tetrahedron *out, size_t end) {
    assert(d->carried <= end);
    size_t begin = end - d->carried, whole = d->carried / ALIGNED * ALIGNED;
    brio_status status = brio_block_write(d->store->ctx, out, begin * sizeof *out, d->sorted, whole * sizeof *out);
    d->carried -= whole;
    memmove(d->sorted, d->sorted + whole, d->carried * sizeof *out);
    return status;
}

static brio_status write_partition(distribution *d, size_t p, brio_tetrahedron *out) {
    const partition *part = &d->part[p];
    if (!part->count) return BRIO_OK;
    brio_status status = tell_progress(d, 2, part->begin, d->live);
    if (status == BRIO_OK) status = read_partition(d, p);
    if (status != BRIO_OK) return status;
    expect_neighbours(d, part->count);
    assert(d->carried < ALIGNED && d->carried <= part->begin);
    brio_tetrahedron *sorted = d->sorted + d->carried;
    for (size_t i = 0; i < part->count; i++)
        rename_one(d, &d->entries[i].tet, &sorted[d->place[d->entries[i].slot] - part->begin]);
    d->carried += part->count;
    return write_pages(d, out, part->begin + part->count);
}

static brio_status write_all(distribution *d, brio_tetrahedron *out) {
    brio_status status = BRIO_OK;
    brio_block_direct(out, d->in_memory);
    for (size_t p = 0; p < 2 * d->ranges; p++) BRIO_TRY(write_partition(d, p, out));
    brio_block_direct(out, false);
    status =
        brio_block_write(d->store->ctx, out, (d->live - d->carried) * sizeof *out, d->sorted, d->carried * sizeof *out);
done:
    return status;
}

static void distribution_free(distribution *d) {
    brio_context *ctx = d->store->ctx;
    brio_release(ctx, d->read_ahead);
    brio_release(ctx, d->last);
    brio_release(ctx, d->chunks);
    brio_release(ctx, d->owner);
    brio_release(ctx, d->place);
    brio_release(ctx, d->entries);
    brio_release(ctx, d->sorted);
    brio_release(ctx, d->end);
    brio_release(ctx, d->order);
    brio_release(ctx, d->name);
    brio_release(ctx, d->key);
}

brio_status brio_canonical_files(brio_store *store, size_t live, size_t *finite) {
    brio_context *ctx = store->ctx;
    distribution d = {.store = store, .live = live};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_IN_MEMORY(ctx, d.read_ahead, 1));
    brio_read_ahead_start(d.read_ahead, ctx);
    choose_partitions(&d);
    BRIO_TRY(distribute(&d));
    brio_release(ctx, store->t.tet);
    store->t.tet = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, d.place, store->t.count));
    BRIO_TRY(reserve_entries(&d));
    for (size_t p = 0; p < 2 * d.ranges; p++) BRIO_TRY(sort_partition(&d, p));
    BRIO_TRY(BRIO_ALLOC(ctx, store->t.tet, live));
    BRIO_TRY(write_all(&d, store->t.tet));
    store->t.count = store->capacity = live;
    *finite = d.part[d.ranges].begin;
    brio_release(ctx, store->state);
    store->state = NULL;
done:
    distribution_free(&d);
    return status;
}
