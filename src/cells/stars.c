/* The tetrahedra of each vertex: of all, or of those that are listed. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "cells/diagram.h"
#include <assert.h>

/* MOST_INSERTED, chosen: stars up to this size are sorted by insertion. */
enum { TETRAHEDRA_A_THREAD = 1 << 14, VERTICES_A_THREAD = 1 << 12, MOST_INSERTED = 64 };

typedef struct {
    brio_diagram *d;
    uint32_t *filled; /* the number of tetrahedra already in each star */
    int threads;
} star_filling;

/* Returns *count and adds 1 to it. */
static inline uint32_t count_one(uint32_t *count, int threads) {
    return threads == 1 ? (*count)++ : __atomic_fetch_add(count, 1, __ATOMIC_RELAXED);
}

/* Counts the listed tetrahedra [from, to) at each of their vertices. */
static void count_some(void *user, size_t from, size_t to, int thread) {
    const star_filling *s = user;
    (void)thread;
    for (size_t n = from; n < to; n++) {
        uint32_t t = brio_listed(s->d, n);
        for (int i = 0; i < (t < s->d->num_finite ? 4 : 3); i++)
            count_one(&s->d->size[s->d->t.tet[t].vertex[i]], s->threads);
    }
}

static void fill_some(void *user, size_t from, size_t to, int thread) {
    const star_filling *s = user;
    (void)thread;
    for (size_t n = from; n < to; n++) {
        uint32_t t = brio_listed(s->d, n);
        for (int i = 0; i < (t < s->d->num_finite ? 4 : 3); i++) {
            uint32_t v = s->d->t.tet[t].vertex[i];
            assert(__atomic_load_n(&s->filled[v], __ATOMIC_RELAXED) < s->d->size[v]);
            s->d->star[s->d->begin[v] + count_one(&s->filled[v], s->threads)] = t;
        }
    }
}

static int compare_numbers(uint32_t a, uint32_t b, const void *user) {
    (void)user;
    return a < b ? -1 : a > b;
}

/* Sorts stars, which several threads fill in any order: I3. Most are small and nearly sorted. */
static void sort_some(void *user, size_t from, size_t to, int thread) {
    const brio_diagram *d = ((star_filling *)user)->d;
    (void)thread;
    for (size_t n = from; n < to; n++) {
        uint32_t *star = d->star + d->begin[d->order[n]], size = d->size[d->order[n]];
        if (size > MOST_INSERTED) brio_sort_indices(star, size, compare_numbers, NULL);
        for (uint32_t i = 1; i < size && size <= MOST_INSERTED; i++) {
            uint32_t t = star[i], j = i;
            for (; j > 0 && star[j - 1] > t; j--) star[j] = star[j - 1];
            star[j] = t;
        }
    }
}

/* Lets the stars begin one after another, in the order of the vertices. Returns the sum of their sizes. */
static uint64_t begin_stars(brio_diagram *d) {
    uint64_t next = 0;
    for (size_t n = 0; n < d->num_vertices; n++) {
        d->begin[d->order[n]] = next;
        next += d->size[d->order[n]];
    }
    return next;
}

#ifndef NDEBUG
/* Returns whether the tetrahedra of each vertex ascend (I3). */
static bool stars_ascend(const brio_diagram *d) {
    for (size_t n = 0; n < d->num_vertices; n++) {
        const uint32_t *star = d->star + d->begin[d->order[n]];
        for (uint32_t i = 1; i < d->size[d->order[n]]; i++)
            if (star[i - 1] >= star[i]) return false;
    }
    return true;
}
#endif

brio_status brio_diagram_gather_stars(brio_diagram *d) {
    brio_status status = BRIO_OK;
    size_t rows = d->num_points + (d->flat ? 3 : 0);
    star_filling s = {.d = d, .threads = brio_threads(d->ctx, d->num_listed, TETRAHEDRA_A_THREAD)};
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, d->size, rows));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->begin, rows));
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, s.filled, rows));
    BRIO_TRY(brio_for(d->ctx, s.threads, d->num_listed, count_some, &s));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->star, begin_stars(d)));
    BRIO_TRY(brio_for(d->ctx, s.threads, d->num_listed, fill_some, &s));
    if (s.threads > 1)
        BRIO_TRY(
            brio_for(d->ctx, brio_threads(d->ctx, d->num_vertices, VERTICES_A_THREAD), d->num_vertices, sort_some, &s));
    assert(stars_ascend(d)); /* I3 */
done:
    brio_release(d->ctx, s.filled);
    return status;
}
