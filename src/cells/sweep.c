/* The sweep: ranks, volumes, and which cells are left. See sweep.h, and shares.h for the volumes.
 *
 * A slice of tetrahedra at a time: first the shares of each tetrahedron and vertex, then the sums, where a thread adds
 * to the ranks that it owns. A vertex takes its shares in the order of the tetrahedra, for every number of threads. The
 * shares of a tetrahedron add up to it, so errors cancel in the sum of the volumes. */
#include "cells/sweep.h"
#include "base/memory.h"
#include "base/team.h"
#include "cells/shares.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* SLICE, chosen: batches a thread and slice, whose shares fit the second-level cache. SLICES: between progress. AHEAD:
 * ranks are fetched this number of tetrahedra before they are read. */
enum {
    SLICE = 64,
    SLICES = 64,
    BATCHES_A_THREAD = 256,
    ROWS_A_THREAD = 1 << 14,
    BATCH = BRIO_CENTRE_BATCH,
    AHEAD = 16
};

/* Chosen: a thousandth of what users compare to. The bound is generous: errors are 1e-15 of ordinary cells. */
static const double MOST_ERROR = 0x1p-36;

/* Returns whether the volume of a rank is known well enough. A sum of n shares is off by at most n u times their sizes,
 * and a bound is at least 40 u times the size of its share. Half of each bound is for this sum (share_lanes.h), so that
 * those of more than 20 shares are too small. */
static bool is_known(const brio_sweep *s, size_t r) {
    return s->sum[r][1] * fmax(1, 0.5 + s->size[r] / 40.0) < MOST_ERROR * s->sum[r][0];
}

/* Frees what only the neighbours need. */
static void free_tetrahedra(brio_sweep *s) {
    brio_release(s->ctx, s->id);
    brio_release(s->ctx, s->ranked);
    brio_release(s->ctx, s->ranked_square);
    brio_release(s->ctx, s->rounded);
    brio_release(s->ctx, s->key);
    s->id = NULL;
    s->rounded = NULL;
    s->ranked = s->ranked_square = s->key = NULL;
}

void brio_sweep_free(brio_sweep *s) {
    if (!s->ctx) return;
    brio_release(s->ctx, s->rank);
    brio_release(s->ctx, s->order);
    brio_release(s->ctx, s->left);
    brio_release(s->ctx, s->sum);
    brio_release(s->ctx, s->size);
    free_tetrahedra(s);
    *s = (brio_sweep){0};
}

/* --- ranks --- */

static inline const uint32_t *vertices_of(const brio_sweep *s, size_t n) {
    return n < s->task.num_finite ? s->task.tet[n].vertex : s->task.more[n - s->task.num_finite];
}

static brio_status rank_rows(brio_sweep *s) {
    const brio_sweep_task *t = &s->task;
    uint32_t site = 0, other = (uint32_t)t->num_sites;
    for (size_t p = 0; p < t->num_rows; p++) s->rank[p] = UINT32_MAX;
    for (size_t n = 0; n < s->num_tets; n++) {
        const uint32_t *v = vertices_of(s, n), *later = vertices_of(s, n + AHEAD < s->num_tets ? n + AHEAD : n);
        for (int i = 0; i < 4; i++) __builtin_prefetch(&s->rank[later[i]], 1);
        BRIO_FORWARD(brio_look(s->ctx, 1));
        for (int i = 0; i < 4; i++) {
            uint32_t r = s->rank[v[i]];
            assert(v[i] < t->num_rows);
            if (r == UINT32_MAX) {
                r = v[i] < t->num_sites ? site++ : other++;
                s->rank[v[i]] = r;
                s->order[r] = v[i];
            }
            s->id[n][i] = r;
        }
    }
    s->num_ranks = site;
    return BRIO_OK;
}

static void copy_rows(void *user, size_t from, size_t to, int thread) {
    const brio_sweep *s = user;
    (void)thread;
    for (size_t p = from; p < to; p++) {
        uint32_t r = s->rank[p];
        if (r == UINT32_MAX) continue;
        memcpy(s->ranked + 3 * (size_t)r, s->task.at + 3 * p, 3 * sizeof *s->ranked);
        if (s->rounded) s->rounded[r] = (float)s->task.at[3 * p];
        if (s->ranked_square) s->ranked_square[r] = s->task.square[p];
    }
}

/* --- shares --- */

typedef struct {
    brio_sweep *s;
    double (*share)[4], *bound; /* of the tetrahedra of the slice */
    size_t first, count;        /* the slice, in tetrahedra */
} slice;

void brio_sweep_leave(brio_sweep *s, const uint32_t *id, int count) {
    for (int i = 0; i < count; i++) {
        uint32_t r = id[i];
        if (r >= s->task.num_sites) {
            if (!s->task.owner) continue; /* its cell is another part's */
            r = s->rank[s->task.owner[s->order[r] - s->task.num_sites]];
        }
        __atomic_store_n(&s->left[r], 1, __ATOMIC_RELAXED);
    }
}

static void find_batch(const slice *c, size_t first, size_t count) {
    brio_sweep *s = c->s;
    const brio_region *region = s->task.region;
    size_t at = first - c->first;
    double centre[BATCH][3], error[BATCH];
    const uint32_t(*id)[4] = (const uint32_t(*)[4])s->id + first;
    brio_shares(
        &(brio_share_batch){s->ranked, s->ranked_square, id, count, centre, error, c->share + at, c->bound + at});
    for (size_t n = 0; n < count; n++) {
        if (region->num_planes && brio_place_of(region, centre[n]) != BRIO_PLACE_INSIDE) brio_sweep_leave(s, id[n], 4);
        if (s->key && first + n < s->task.num_finite) s->key[first + n] = error[n] <= s->fine ? centre[n][0] : NAN;
    }
}

static void find_some(void *user, size_t from, size_t to, int thread) {
    const slice *c = user;
    (void)thread;
    for (size_t n = from * BATCH; n < to * BATCH && n < c->count; n += BATCH)
        find_batch(c, c->first + n, c->count - n < BATCH ? c->count - n : BATCH);
}

/* Adds the shares of the slice at the ranks [from, to). */
static void add_some(void *user, size_t from, size_t to, int thread) {
    const slice *c = user;
    const uint32_t(*id)[4] = (const uint32_t(*)[4])c->s->id + c->first;
    double(*sum)[2] = c->s->sum;
    uint32_t *size = c->s->size;
    (void)thread;
    for (size_t n = 0; n < c->count; n++)
        for (int i = 0; i < 4; i++) {
            size_t r = id[n][i];
            if (r - from >= to - from) continue;
            sum[r][0] += c->share[n][i];
            sum[r][1] += c->bound[n];
            size[r]++;
        }
}

/* Returns the error that keys may have: a small part of how far the rows reach. */
static double fine_of(const brio_sweep *s) {
    double low = INFINITY, high = -INFINITY;
    for (size_t p = 0; p < s->task.num_rows; p++) {
        double x = s->task.at[3 * p];
        low = x < low ? x : low, high = x > high ? x : high;
    }
    return fmax((high - low) * 0x1p-40, fmax(fabs(low), fabs(high)) * 0x1p-48);
}

static brio_status add_shares(brio_sweep *s) {
    brio_status status = BRIO_OK;
    size_t batches = (s->num_tets + BATCH - 1) / BATCH, shown = 0;
    int threads = brio_threads(s->ctx, batches, BATCHES_A_THREAD);
    size_t size = (size_t)SLICE * BATCH * (size_t)threads;
    slice c = {.s = s};
    BRIO_TRY(BRIO_ALLOC(s->ctx, c.share, size));
    BRIO_TRY(BRIO_ALLOC(s->ctx, c.bound, size));
    for (; c.first < s->num_tets; c.first += size) {
        c.count = s->num_tets - c.first < size ? s->num_tets - c.first : size;
        BRIO_TRY(brio_for(s->ctx, threads, (c.count + BATCH - 1) / BATCH, find_some, &c));
        BRIO_TRY(brio_for_parts(s->ctx, threads, s->num_ranks, add_some, &c));
        if (c.first < shown) continue;
        BRIO_TRY(brio_progress(s->ctx, "cells", 0.1 + 0.3 * ((double)c.first / (double)s->num_tets)));
        shown += s->num_tets / SLICES;
    }
done:
    brio_release(s->ctx, c.share);
    brio_release(s->ctx, c.bound);
    return status;
}

/* --- all --- */

static void judge_some(void *user, size_t from, size_t to, int thread) {
    const brio_sweep *s = user;
    (void)thread;
    for (size_t r = from; r < to; r++)
        if (!is_known(s, r)) s->left[r] = 1;
}

brio_status brio_sweep_fill(brio_context *ctx, const brio_sweep_task *task, brio_sweep *s) {
    size_t rows = task->num_rows;
    *s = (brio_sweep){.ctx = ctx, .task = *task, .num_tets = task->num_finite + task->num_more};
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->rank, rows));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->order, rows));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->id, s->num_tets));
    BRIO_FORWARD(rank_rows(s));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->ranked, 3 * rows));
    if (task->square) BRIO_FORWARD(BRIO_ALLOC(ctx, s->ranked_square, rows));
    if (task->neighbours) BRIO_FORWARD(BRIO_ALLOC(ctx, s->rounded, rows));
    BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, rows, ROWS_A_THREAD), rows, copy_rows, s));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, s->left, s->num_ranks));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, s->sum, s->num_ranks));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, s->size, s->num_ranks));
    if (task->neighbours) BRIO_FORWARD(BRIO_ALLOC(ctx, s->key, task->num_finite));
    s->fine = fine_of(s);
    BRIO_FORWARD(add_shares(s));
    for (size_t n = task->num_finite; n < task->count; n++) {
        const uint32_t *v = task->tet[n].vertex;
        brio_sweep_leave(s, (const uint32_t[]){s->rank[v[0]], s->rank[v[1]], s->rank[v[2]]}, 3);
    }
    BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, s->num_ranks, ROWS_A_THREAD), s->num_ranks, judge_some, s));
    if (task->neighbours)
        BRIO_FORWARD(brio_sweep_find_ties(s));
    else
        free_tetrahedra(s);
    brio_release(ctx, s->key);
    s->key = NULL;
    for (size_t r = 0; r < s->num_ranks; r++) s->num_left += s->left[r];
    return brio_progress(ctx, "cells", 0.5);
}
