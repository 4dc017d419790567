/* The canonical order of the tetrahedra in scratch files: by partitions, reading and writing in sequence.
 *
 * The order is that of canonical_order.c, by one thread, for arrays that do not fit in memory. The tetrahedra are read
 * once and appended, already turned, to partitions by their latest vertex; a partition fits in memory. Each is then read
 * and sorted, which tells the places; and once all places are known it is read again, its facets are renamed, and it is
 * written where it belongs. Only the places and turns, 5 bytes a tetrahedron, are met in another order: that of the
 * neighbours of a partition, which are near in space and so near in the file.
 *
 * A partition is a list of chunks, which lie in one file in the order in which they were filled: nothing has to be
 * counted beforehand, and a partition of any size has room.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988 (the distribution
 * sort). */
#include "base/memory.h"
#include "triangulation/canonical_turn.h"
#include "triangulation/kernel.h"

enum { CHUNK = 512, RANGES = 256, PARTITIONS = 2 * RANGES };

/* A tetrahedron, turned but not renamed, and the slot where the insertion left it. */
typedef struct {
    brio_tetrahedron tet;
    uint32_t slot;
} entry;

/* The tetrahedra whose latest vertices are in a range: finite ones, or infinite ones. */
typedef struct {
    entry *last; /* the chunk that is being filled, in memory */
    size_t count, begin;
} partition;

typedef struct {
    brio_kernel *k;
    size_t live, range;         /* vertices of a partition */
    partition part[PARTITIONS]; /* finite ones first */
    entry *chunks;              /* the full ones */
    uint16_t *owner;            /* of each full chunk: its partition */
    size_t num_chunks, chunk_capacity, owner_capacity;
    uint32_t *place; /* of each slot; its turn is its state */
    entry *entries;  /* of the partition at hand */
    brio_tetrahedron *sorted;
    uint32_t *end, *order, *name; /* of its buckets; of its entries, by bucket */
    uint64_t *key;
    size_t capacity; /* of entries, and so of the others */
} distribution;

/* --- distribution --- */

static brio_status flush_chunk(distribution *d, size_t p) {
    brio_context *ctx = d->k->ctx;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(ctx, d->chunks, d->chunk_capacity, (d->num_chunks + 1) * CHUNK));
    BRIO_TRY(BRIO_RESERVE(ctx, d->owner, d->owner_capacity, d->num_chunks + 1));
    d->owner[d->num_chunks] = (uint16_t)p;
    size_t bytes = CHUNK * sizeof(entry);
    status = brio_block_write(ctx, d->chunks, d->num_chunks++ * bytes, d->part[p].last, bytes);
done:
    return status;
}

static brio_status append(distribution *d, const brio_tetrahedron *t, uint32_t slot) {
    brio_kernel *k = d->k;
    uint8_t turn;
    brio_turn_key(t->vertex, k->t.infinite, &turn);
    const uint8_t *from = BRIO_TURNED[turn];
    size_t p = t->vertex[from[0]] / d->range + (t->vertex[3] == k->t.infinite ? RANGES : 0);
    partition *part = &d->part[p];
    if (!part->last) {
        brio_status status = BRIO_ALLOC(k->ctx, part->last, CHUNK);
        if (status != BRIO_OK) return status;
    }
    entry *e = &part->last[part->count++ % CHUNK];
    for (int i = 0; i < 4; i++) e->tet.vertex[i] = t->vertex[from[i]], e->tet.mate[i] = t->mate[from[i]];
    e->slot = slot;
    k->state[slot] = turn;
    return part->count % CHUNK ? BRIO_OK : flush_chunk(d, p);
}

static brio_status distribute(distribution *d) {
    brio_kernel *k = d->k;
    enum { AT_ONCE = 8192 };
    brio_tetrahedron *some = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(k->ctx, some, AT_ONCE));
    for (size_t begin = 0; begin < k->t.count; begin += AT_ONCE) {
        if (begin + 2 * AT_ONCE < k->t.count)
            brio_block_expect(k->t.tet, (begin + AT_ONCE) * sizeof *some, AT_ONCE * sizeof *some);
        size_t n = k->t.count - begin < AT_ONCE ? k->t.count - begin : AT_ONCE;
        BRIO_TRY(brio_block_read(k->ctx, k->t.tet, begin * sizeof *some, some, n * sizeof *some));
        for (size_t i = 0; i < n; i++)
            if (k->state[begin + i] != TET_UNUSED) BRIO_TRY(append(d, &some[i], (uint32_t)(begin + i)));
    }
    for (size_t p = 0, begin = 0; p < PARTITIONS; begin += d->part[p++].count) d->part[p].begin = begin;
done:
    brio_release(k->ctx, some);
    return status;
}

/* --- one partition --- */

static brio_status reserve_entries(distribution *d, size_t n) {
    brio_context *ctx = d->k->ctx;
    brio_status status = BRIO_OK;
    if (n <= d->capacity) return BRIO_OK;
    BRIO_TRY(BRIO_RESIZE(ctx, d->entries, n));
    BRIO_TRY(BRIO_RESIZE(ctx, d->sorted, n));
    BRIO_TRY(BRIO_RESIZE(ctx, d->order, n));
    BRIO_TRY(BRIO_RESIZE(ctx, d->name, n));
    BRIO_TRY(BRIO_RESIZE(ctx, d->key, n));
    d->capacity = n;
done:
    return status;
}

/* The next run of chunks of a partition from *begin on, which becomes its beginning: its length, or 0. */
static size_t next_run(const distribution *d, size_t p, size_t *begin) {
    size_t c = *begin;
    while (c < d->num_chunks && d->owner[c] != p) c++;
    *begin = c;
    while (c < d->num_chunks && d->owner[c] == p) c++;
    return c - *begin;
}

static void expect_partition(const distribution *d, size_t p) {
    size_t bytes = CHUNK * sizeof(entry);
    for (size_t c = 0, run; (run = next_run(d, p, &c)) > 0; c += run)
        brio_block_expect(d->chunks, c * bytes, run * bytes);
}

static brio_status read_partition(distribution *d, size_t p) {
    brio_context *ctx = d->k->ctx;
    const partition *part = &d->part[p];
    brio_status status = BRIO_OK;
    size_t n = 0, bytes = CHUNK * sizeof(entry);
    BRIO_TRY(reserve_entries(d, part->count));
    if (p + 1 < PARTITIONS) expect_partition(d, p + 1);
    for (size_t c = 0, run; (run = next_run(d, p, &c)) > 0; c += run) {
        BRIO_TRY(brio_block_read(ctx, d->chunks, c * bytes, &d->entries[n], run * bytes));
        n += run * CHUNK;
    }
    if (n < part->count) memcpy(&d->entries[n], part->last, (part->count - n) * sizeof(entry));
done:
    return status;
}

/* Lists the entries at hand by their latest vertices; bucket b ends at end[b]. */
static void fill_buckets(distribution *d, size_t p) {
    size_t n = d->part[p].count, first = p % RANGES * d->range;
    memset(d->end, 0, d->range * sizeof *d->end);
    for (size_t i = 0; i < n; i++) d->end[d->entries[i].tet.vertex[0] - first]++;
    uint32_t sum = 0;
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
    brio_status status = read_partition(d, p);
    if (status != BRIO_OK) return status;
    fill_buckets(d, p);
    for (size_t i = 0; i < d->part[p].count; i++) {
        const uint32_t *v = d->entries[d->name[i]].tet.vertex;
        d->key[i] = (uint64_t)v[1] << 32 | v[2];
    }
    for (size_t b = 0, begin = 0; b < d->range; begin = d->end[b++])
        brio_sort_names(d->key + begin, d->name + begin, d->end[b] - begin, d->order + begin);
    for (size_t i = 0; i < d->part[p].count; i++)
        d->place[d->entries[d->order[i]].slot] = (uint32_t)(d->part[p].begin + i);
    return BRIO_OK;
}

/* --- renaming --- */

static inline void rename_one(const distribution *d, const brio_tetrahedron *old, brio_tetrahedron *out) {
    const brio_kernel *k = d->k;
    for (int i = 0; i < 4; i++) {
        uint32_t other = brio_tet_of(old->mate[i]), v = old->vertex[i];
        out->mate[i] = brio_facet_of(d->place[other], BRIO_BACK[k->state[other]][brio_slot_of(old->mate[i])]);
        out->vertex[i] = v == k->t.infinite ? BRIO_INFINITE : k->caller[v];
    }
}

/* The places and turns of all neighbours of the entries at hand. */
static void expect_neighbours(distribution *d, size_t n) {
    brio_read_ahead *r = &d->k->read_ahead;
    for (size_t i = 0; i < n; i++, r->now++)
        for (int f = 0; f < 4; f++) {
            uint32_t other = brio_tet_of(d->entries[i].tet.mate[f]);
            brio_expect(r, &d->place[other]);
            brio_expect(r, &d->k->state[other]);
        }
}

static brio_status write_partition(distribution *d, size_t p, brio_tetrahedron *out) {
    const partition *part = &d->part[p];
    if (!part->count) return BRIO_OK;
    brio_status status = read_partition(d, p);
    if (status != BRIO_OK) return status;
    expect_neighbours(d, part->count);
    for (size_t i = 0; i < part->count; i++)
        rename_one(d, &d->entries[i].tet, &d->sorted[d->place[d->entries[i].slot] - part->begin]);
    return brio_block_write(d->k->ctx, out, part->begin * sizeof *out, d->sorted, part->count * sizeof *out);
}

static void distribution_free(distribution *d) {
    brio_context *ctx = d->k->ctx;
    for (size_t p = 0; p < PARTITIONS; p++) brio_release(ctx, d->part[p].last);
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

brio_status brio_kernel_sort_files(brio_kernel *k) {
    distribution d = {.k = k, .live = k->t.count - k->num_unused, .range = (k->num_points + 2) / RANGES + 1};
    brio_status status = BRIO_OK;
    BRIO_TRY(distribute(&d));
    brio_release(k->ctx, k->t.tet);
    k->t.tet = NULL;
    BRIO_TRY(BRIO_ALLOC(k->ctx, d.place, k->t.count));
    BRIO_TRY(BRIO_ALLOC(k->ctx, d.end, d.range));
    for (size_t p = 0; p < PARTITIONS; p++) BRIO_TRY(sort_partition(&d, p));
    BRIO_TRY(BRIO_ALLOC(k->ctx, k->t.tet, d.live));
    for (size_t p = 0; p < PARTITIONS; p++) BRIO_TRY(write_partition(&d, p, k->t.tet));
    k->t.count = k->capacity = d.live;
    k->num_unused = 0;
    k->stats.tetrahedra = d.part[RANGES].begin;
    k->stats.hull_facets = d.live - k->stats.tetrahedra;
    brio_release(k->ctx, k->state);
    k->state = NULL;
done:
    distribution_free(&d);
    return status;
}
