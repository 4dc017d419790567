/* The neighbours of the cells of a sweep.
 *
 * Mates that share their centre are looked for by x of the centres; where it does not tell two apart, by the error
 * bounds of the centres. The cells about such mates are left. All other neighbours share a face.
 *
 * The tetrahedra of each rank are listed. Their vertices go through a table that remembers one of those that have the
 * same last bits, so that nearly all that were met before are dropped without a branch. What is left is put in order by
 * counting, for each, those of lesser x. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "cells/sweep.h"
#include "predicates/circumcentre.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* LANE: a multiple of what vector registers compare at once. TABLE: places in the table. MOST_MET: a star with more
 * vertices is sorted. AHEAD: tetrahedra are fetched this number of ranks before they are read. SLICE: tetrahedra
 * between two looks. All chosen. */
enum {
    LANE = 8,
    TABLE = 1 << 11,
    MOST_MET = 64,
    AHEAD = 2,
    TETRAHEDRA_A_THREAD = 1 << 14,
    RANKS_A_THREAD = 1 << 11,
    CHUNK = 1 << 10,
    SLICE = 1 << 20
};

/* --- ties --- */

/* Returns whether all vertices are sites. */
static inline bool is_inside(const brio_sweep *w, const uint32_t *id) {
    size_t n = w->task.num_sites;
    return id[0] < n && id[1] < n && id[2] < n && id[3] < n;
}

/* Returns the mean of coordinate k of the vertices of a facet: two mates have the same, up to a translation. */
static inline double corner_of(const brio_sweep *w, uint32_t t, int i, int k) {
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += w->ranked[3 * (size_t)w->id[t][BRIO_FACET[i][c]] + (size_t)k];
    return sum / 3;
}

typedef struct {
    brio_sweep *w;
    uint8_t *inside; /* of each finite tetrahedron: whether all its vertices are sites; or NULL: all */
    double least;    /* keys that differ by more belong to different centres */
} tie_search;

/* Returns whether error bounds allow the tetrahedron t and its mate u behind the facets i and j to share their centre.
 *  apart  whether the mate is a translate. */
static bool may_share(const tie_search *s, uint32_t t, int i, uint32_t u, int j, bool apart) {
    brio_sweep *w = s->w;
    uint32_t vertex[2][4];
    double centre[2][3], error[2], corner[2][3] = {{0}};
    memcpy(vertex[0], w->id[t], sizeof *vertex);
    memcpy(vertex[1], w->id[u], sizeof *vertex);
    brio_centres(&(brio_centre_batch){w->ranked, w->ranked_square, (const uint32_t(*)[4])vertex, 2}, centre[0], error);
    if (isnan(centre[0][0]) || isnan(centre[1][0])) return true;
    for (int k = 0; k < 3 && apart; k++) corner[0][k] = corner_of(w, t, i, k), corner[1][k] = corner_of(w, u, j, k);
    for (int k = 0; k < 3; k++) {
        double rounded = 0x1p-50 * (fabs(centre[0][k]) + fabs(centre[1][k]) + fabs(corner[0][k]) + fabs(corner[1][k]));
        double way = (centre[0][k] - corner[0][k]) - (centre[1][k] - corner[1][k]);
        if (fabs(way) > error[0] + error[1] + rounded) return false;
    }
    return true;
}

/* Returns whether all cells of a tetrahedron are left. */
static bool all_left(const brio_sweep *w, uint32_t t) {
    for (int i = 0; i < 4; i++) {
        uint32_t r = w->id[t][i];
        if (r >= w->task.num_sites || !__atomic_load_n(&w->left[r], __ATOMIC_RELAXED)) return false;
    }
    return true;
}

/* Looks at the mates of a tetrahedron one by one.   later  whether only at those of greater number. */
static void look_at(const tie_search *s, uint32_t t, bool later) {
    brio_sweep *w = s->w;
    const double *key = w->key;
    for (int i = 0; i < 4; i++) {
        uint32_t mate = w->task.tet[t].mate[i], u = mate >> 2;
        if ((later && u < t) || u == t || u >= w->task.num_finite) continue;
        bool apart = s->inside && !(s->inside[t] && s->inside[u]);
        double way = key[t] - key[u];
        if (apart) way -= corner_of(w, t, i, 0) - corner_of(w, u, (int)(mate & 3), 0);
        if (fabs(way) > s->least || (all_left(w, t) && all_left(w, u))) continue;
        if (!may_share(s, t, i, u, (int)(mate & 3), apart)) continue;
        brio_sweep_leave(w, w->id[t], 4);
        brio_sweep_leave(w, w->id[u], 4);
    }
}

static void look_at_some(void *user, size_t from, size_t to, int thread) {
    const tie_search *s = user;
    const brio_tetrahedron *tet = s->w->task.tet;
    const double *key = s->w->key;
    size_t finite = s->w->task.num_finite;
    (void)thread;
    for (size_t t = from; t < to; t++) {
        double x = key[t], least = s->least;
        const uint32_t *mate = tet[t].mate;
        if (s->inside && !s->inside[t]) {
            look_at(s, (uint32_t)t, false); /* also for its mates, which are not compared as they lie */
            continue;
        }
        bool close = false;
        for (int i = 0; i < 4; i++) {
            size_t u = mate[i] >> 2;
            if (u > t && u < finite) close |= !(fabs(x - key[u]) > least);
        }
        if (close) look_at(s, (uint32_t)t, true); /* few */
    }
}

static void find_inside(void *user, size_t from, size_t to, int thread) {
    const tie_search *s = user;
    (void)thread;
    for (size_t t = from; t < to; t++) s->inside[t] = is_inside(s->w, s->w->id[t]);
}

brio_status brio_sweep_find_ties(brio_sweep *w) {
    brio_status status = BRIO_OK;
    size_t n = w->task.num_finite;
    int threads = brio_threads(w->ctx, n, TETRAHEDRA_A_THREAD);
    tie_search s = {.w = w, .least = 4 * w->fine};
    if (w->task.num_rows > w->task.num_sites) {
        BRIO_TRY(BRIO_ALLOC(w->ctx, s.inside, n));
        BRIO_TRY(brio_for(w->ctx, threads, n, find_inside, &s));
    }
    BRIO_TRY(brio_for_chunks(w->ctx, threads, n, CHUNK, look_at_some, &s));
done:
    brio_release(w->ctx, s.inside);
    return status;
}

/* --- stars --- */

typedef struct {
    const brio_sweep *s;
    uint64_t *begin; /* of each rank and one: where its star begins in the list; at first where the next one goes */
    uint32_t *list;
    const uint64_t *first;
    int64_t *out;
    size_t slice; /* the first of SLICE tetrahedra that are listed */
    brio_status status;
} search;

/* Lists the tetrahedra of the slice at the ranks [from, to), which one thread owns: additions by several threads at
 * once would take longer than what each reads in vain. */
static void list_some(void *user, size_t from, size_t to, int thread) {
    const search *h = user;
    const brio_sweep *s = h->s;
    size_t end = s->num_tets - h->slice < SLICE ? s->num_tets : h->slice + SLICE;
    (void)thread;
    for (size_t t = h->slice; t < end; t++)
        for (int i = 0; i < 4; i++) {
            size_t r = s->id[t][i];
            if (r - from >= to - from || s->left[r]) continue;
            h->list[h->begin[r]++] = (uint32_t)t;
        }
}

/* Lists the tetrahedra of each rank: they ascend. */
static brio_status list_stars(search *h) {
    const brio_sweep *s = h->s;
    uint64_t next = 0;
    int threads = brio_threads(s->ctx, s->num_tets, TETRAHEDRA_A_THREAD);
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, h->begin, s->num_ranks + 1));
    for (size_t r = 0; r < s->num_ranks; r++) {
        h->begin[r] = next;
        next += s->left[r] ? 0 : s->size[r];
    }
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, h->list, next));
    for (; h->slice < s->num_tets; h->slice += SLICE)
        BRIO_FORWARD(brio_for_parts(s->ctx, threads, s->num_ranks, list_some, h));
    for (size_t r = s->num_ranks; r > 0; r--) h->begin[r] = h->begin[r - 1];
    h->begin[0] = 0;
    return BRIO_OK;
}

/* --- neighbours --- */

/* Compares positions; then ranks, for scaling can make 0 of distinct positions. */
static int compare_positions(uint32_t a, uint32_t b, const void *user) {
    const brio_sweep *s = user;
    const double *x = s->ranked + 3 * (size_t)a, *y = s->ranked + 3 * (size_t)b;
    for (int k = 0; k < 3; k++)
        if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
    return a < b ? -1 : a > b;
}

/* Writes the vertices of a star but rank r to `met`, once each unless two have one place in the table.
 *  met  room for 3 * size.   table  TABLE places, empty; so it is again afterwards. */
static size_t meet(const brio_sweep *s, const uint32_t *star, size_t size, uint32_t r, uint32_t *table, uint32_t *met) {
    size_t count = 0;
    table[r % TABLE] = r;
    for (size_t i = 0; i < size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = s->id[star[i]][k];
            met[count] = v;
            count += table[v % TABLE] != v && v != r;
            table[v % TABLE] = v;
        }
    for (size_t i = 0; i < count; i++) table[met[i] % TABLE] = UINT32_MAX;
    table[r % TABLE] = UINT32_MAX;
    return count;
}

/* Sorts what was met by positions, and drops what was met twice. */
static size_t sort_met(const brio_sweep *s, uint32_t *met, size_t n) {
    size_t count = 0;
    brio_sort_indices(met, n, compare_positions, s);
    for (size_t i = 0; i < n; i++)
        if (!count || met[i] != met[count - 1]) met[count++] = met[i];
    return count;
}

/* Writes n ranks that differ in x, rounded, to `sorted`, in the order of x. Returns false if two do not differ. */
static bool place_met(const brio_sweep *s, const uint32_t *met, size_t n, uint32_t *sorted) {
    float x[MOST_MET];
    uint64_t taken = 0;
    size_t full = (n + LANE - 1) / LANE * LANE;
    for (size_t i = 0; i < n; i++) x[i] = s->rounded[met[i]];
    for (size_t i = n; i < full; i++) x[i] = INFINITY;
    for (size_t i = 0; i < n; i++) {
        int place = 0;
        for (size_t j = 0; j < full; j++) place += x[j] < x[i]; /* several at once */
        taken |= UINT64_C(1) << place;
        sorted[place] = met[i];
    }
    return taken == UINT64_MAX >> (64 - n);
}

/* Finds the neighbours of a rank.   work  room for 3 * size + MOST_MET. */
static void find_neighbours(const search *h, uint32_t r, uint32_t *table, uint32_t *work) {
    const brio_sweep *s = h->s;
    const uint32_t *star = h->list + h->begin[r];
    uint32_t size = s->size[r], degree = brio_sweep_degree(s, r), *sorted = work + 3 * size;
    int64_t *out = h->out + h->first[s->order[r]];
    size_t n = meet(s, star, size, r, table, work);
    if (n != degree || n > MOST_MET || !place_met(s, work, n, sorted)) {
        n = sort_met(s, work, n);
        sorted = work;
    }
    assert(n == degree);
    for (size_t i = 0; i < n; i++) out[i] = s->order[sorted[i]];
}

static inline void fetch(const search *h, size_t r) {
    const brio_sweep *s = h->s;
    if (r + 1 < s->num_ranks) __builtin_prefetch(&h->first[s->order[r + 1]]);
    if (r >= s->num_ranks || s->left[r]) return;
    const char *out = (const char *)(h->out + h->first[s->order[r]]);
    __builtin_prefetch(out, 1), __builtin_prefetch(out + 64, 1);
    for (uint32_t i = 0; i < s->size[r]; i++) __builtin_prefetch(s->id[h->list[h->begin[r] + i]]);
}

static brio_status find_of_ranks(const search *h, size_t from, size_t to, uint32_t *table, uint32_t **work) {
    const brio_sweep *s = h->s;
    size_t capacity = 0;
    for (size_t r = from; r < to; r++) {
        fetch(h, r + AHEAD);
        if (s->left[r]) continue;
        BRIO_FORWARD(BRIO_RESERVE(s->ctx, *work, capacity, 3 * (size_t)s->size[r] + MOST_MET));
        find_neighbours(h, (uint32_t)r, table, *work);
    }
    return BRIO_OK;
}

static void find_some(void *user, size_t from, size_t to, int thread) {
    search *h = user;
    uint32_t table[TABLE], *work = NULL;
    (void)thread;
    memset(table, 0xff, sizeof table);
    brio_report(&h->status, find_of_ranks(h, from, to, table, &work));
    brio_release(h->s->ctx, work);
}

brio_status brio_sweep_neighbours(const brio_sweep *s, const uint64_t *first, int64_t *out) {
    brio_status status = BRIO_OK;
    search h = {.s = s, .first = first, .out = out};
    BRIO_TRY(list_stars(&h));
    BRIO_TRY(brio_for_chunks(s->ctx, brio_threads(s->ctx, s->num_ranks, RANKS_A_THREAD), s->num_ranks, CHUNK, find_some,
                             &h));
    status = h.status;
done:
    brio_release(s->ctx, h.begin);
    brio_release(s->ctx, h.list);
    return status;
}
