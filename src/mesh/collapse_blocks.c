/* One pass of collapses over blocks of vertices.
 *
 * Each vertex belongs to one block. An edge is tried if all neighbours of both its ends belong to the block of the
 * ends. Then all triangles at its ends have their corners in the block, so a try reads and writes nothing of another
 * block: the blocks are independent, and their threads need no locks. A collapse keeps that: the neighbours of the
 * vertex that is left were neighbours of the two ends.
 *
 * In a block a heap holds the edges in the order of their errors. An entry is out of date when its edge's error has
 * changed since the entry was made; edges that stop to exist, or whose tries failed, have the error INFINITY. */
#include "base/memory.h"
#include "base/team.h"
#include "mesh/collapse.h"
#include <math.h>
#include <string.h>

enum { TRIES_A_REPORT = 1 << 10 }; /* a guarded try takes tens of microseconds */

/* An error and the half-edge that names the edge; as numbers the entries have the order of the errors, ties that of
 * the half-edges. */
typedef uint64_t entry;

#define HEAP_ITEM              entry
#define HEAP_ABOVE(a, b, user) ((a) < (b))
#define HEAP_DOWN              entry_down
#define HEAP_UP                entry_up
#include "base/heap.h"

/* What one thread owns. */
typedef struct {
    entry *heap;
    size_t size, capacity;
    size_t collapses;
} worker;

typedef struct {
    brio_collapse_mesh *m;
    const brio_collapse_pass *pass;
    uint32_t *block; /* #V: the block of a vertex */
    worker *workers;
    brio_status (*report)(void *user);
    void *user;
    brio_status status;
} blocks;

static uint32_t bits_of(float error) {
    uint32_t bits;
    memcpy(&bits, &error, sizeof bits);
    return bits;
}

/* Offers the edge that h names to the heap, if its error is within the limit and both its ends are inside the block. */
static brio_status offer(const blocks *b, worker *w, uint32_t h) {
    brio_collapse_mesh *m = b->m;
    uint8_t marks = m->marks[m->vertex[h]] & m->marks[brio_collapse_end(m, h)];
    if (!(m->error[h] <= b->pass->limit) || !(marks & BRIO_COLLAPSE_INSIDE)) return BRIO_OK;
    brio_status status = BRIO_RESERVE(m->ctx, w->heap, w->capacity, w->size + 1);
    if (status == BRIO_OK) entry_up(w->heap, w->size++, (entry)bits_of(m->error[h]) << 32 | h, NULL);
    return status;
}

/* Takes the edge of least error off the heap. Returns its half-edge, or BRIO_COLLAPSE_NONE when no edge is left. */
static uint32_t take(const blocks *b, worker *w) {
    while (w->size) {
        entry top = w->heap[0], last = w->heap[--w->size];
        if (w->size) entry_down(w->heap, 0, w->size, last, NULL);
        if (bits_of(b->m->error[(uint32_t)top]) == top >> 32) return (uint32_t)top;
    }
    return BRIO_COLLAPSE_NONE;
}

/* Returns whether all neighbours of v, which is not on the boundary, belong to its block. */
static bool is_inside(const blocks *b, uint32_t v) {
    const brio_collapse_mesh *m = b->m;
    uint32_t h = m->half_edge[v], g = h;
    do
        if (b->block[brio_collapse_end(m, g)] != b->block[v]) return false;
    while ((g = brio_collapse_turn(m, g)) != h);
    return true;
}

static void mark_inside(const blocks *b, size_t begin, size_t end) {
    brio_collapse_mesh *m = b->m;
    for (size_t i = begin; i < end; i++) {
        uint32_t v = b->pass->list[i];
        bool inside = !(m->marks[v] & BRIO_COLLAPSE_BOUNDARY) && is_inside(b, v);
        m->marks[v] = (uint8_t)((m->marks[v] & ~BRIO_COLLAPSE_INSIDE) | (inside ? BRIO_COLLAPSE_INSIDE : 0));
    }
}

/* Fills the heap with the edges of the vertices inside the block. */
static brio_status offer_all(const blocks *b, worker *w, size_t begin, size_t end) {
    const brio_collapse_mesh *m = b->m;
    w->size = 0;
    for (size_t i = begin; i < end; i++) {
        uint32_t v = b->pass->list[i], h = m->half_edge[v], g = h;
        if (!(m->marks[v] & BRIO_COLLAPSE_INSIDE)) continue;
        do BRIO_FORWARD(offer(b, w, g));
        while ((g = brio_collapse_turn(m, g)) != h);
    }
    return BRIO_OK;
}

/* Measures the edges round a vertex that is the result of a collapse, and offers them. */
static brio_status renew(const blocks *b, worker *w, uint32_t v) {
    uint32_t h = b->m->half_edge[v], g = h;
    do BRIO_FORWARD(offer(b, w, brio_collapse_measure(b->m, g)));
    while ((g = brio_collapse_turn(b->m, g)) != h);
    return BRIO_OK;
}

static size_t most_collapses(const blocks *b, const worker *w) {
    double most = floor(b->pass->share * (double)w->size);
    return most < (double)b->pass->most ? (size_t)most : b->pass->most;
}

/* Collapses the edges of one block. */
static brio_status collapse_block(blocks *b, size_t begin, size_t end, int thread) {
    worker *w = &b->workers[thread];
    uint32_t h;
    mark_inside(b, begin, end);
    BRIO_FORWARD(offer_all(b, w, begin, end));
    size_t most = most_collapses(b, w), collapses = 0;
    for (size_t tries = 0; collapses < most && (h = take(b, w)) != BRIO_COLLAPSE_NONE; tries++) {
        if (thread == 0 && tries % TRIES_A_REPORT == 0) BRIO_FORWARD(b->report(b->user));
        uint32_t left = brio_collapse_try(b->m, h);
        if (left == BRIO_COLLAPSE_NONE) {
            b->m->error[h] = INFINITY;
        } else {
            collapses++;
            BRIO_FORWARD(renew(b, w, left));
        }
    }
    w->collapses += collapses;
    return BRIO_OK;
}

static void collapse_part(void *user, size_t begin, size_t end, int thread) {
    blocks *b = user;
    for (size_t i = begin; i < end; i++) {
        size_t first = i * b->pass->block_size, last = first + b->pass->block_size;
        if (__atomic_load_n(&b->status, __ATOMIC_RELAXED) != BRIO_OK) return;
        brio_report(&b->status, collapse_block(b, first, last < b->pass->count ? last : b->pass->count, thread));
    }
}

static void name_blocks(void *user, size_t begin, size_t end, int thread) {
    const blocks *b = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) b->block[b->pass->list[i]] = (uint32_t)(i / b->pass->block_size);
}

brio_status brio_collapse_blocks(brio_collapse_mesh *m, const brio_collapse_pass *pass,
                                 brio_status (*report)(void *user), void *user, size_t *collapses) {
    brio_status status = BRIO_OK;
    size_t num_blocks = (pass->count + pass->block_size - 1) / pass->block_size;
    int threads = brio_threads(m->ctx, num_blocks, 2);
    blocks b = {.m = m, .pass = pass, .report = report, .user = user, .status = BRIO_OK};
    *collapses = 0;
    BRIO_TRY(BRIO_ALLOC(m->ctx, b.block, m->num_vertices));
    BRIO_TRY(BRIO_ALLOC_ZERO(m->ctx, b.workers, (size_t)threads));
    BRIO_TRY(brio_for(m->ctx, threads, pass->count, name_blocks, &b));
    BRIO_TRY(brio_for_chunks(m->ctx, threads, num_blocks, 1, collapse_part, &b));
    status = b.status;
    for (int t = 0; t < threads; t++) *collapses += b.workers[t].collapses;
done:
    for (int t = 0; b.workers && t < threads; t++) brio_release(m->ctx, b.workers[t].heap);
    brio_release(m->ctx, b.workers);
    brio_release(m->ctx, b.block);
    return status;
}
