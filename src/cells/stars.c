/* The tetrahedra of each vertex, and the vertices in an order that follows the array of tetrahedra.
 *
 * The tetrahedra of a triangulation are sorted by their latest vertex along the insertion order, which follows a curve
 * through space. The vertices are taken in the order in which they begin a tetrahedron. So the tetrahedra of successive
 * vertices are near each other in memory. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "cells/diagram.h"

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

/* Counts the tetrahedra [from, to) at each of their vertices. */
static void count_some(void *user, size_t from, size_t to, int thread) {
    const star_filling *s = user;
    (void)thread;
    for (size_t t = from; t < to; t++)
        for (int i = 0; i < (t < s->d->num_finite ? 4 : 3); i++)
            count_one(&s->d->size[s->d->t.tet[t].vertex[i]], s->threads);
}

static void fill_some(void *user, size_t from, size_t to, int thread) {
    const star_filling *s = user;
    (void)thread;
    for (size_t t = from; t < to; t++)
        for (int i = 0; i < (t < s->d->num_finite ? 4 : 3); i++) {
            uint32_t v = s->d->t.tet[t].vertex[i];
            s->d->star[s->d->begin[v] + count_one(&s->filled[v], s->threads)] = (uint32_t)t;
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

/* Takes vertex v, unless it was taken: its star begins where the last one ends. */
static inline void take_vertex(brio_diagram *d, uint32_t v, uint64_t *next) {
    if (d->begin[v] != UINT64_MAX) return;
    d->begin[v] = *next;
    *next += d->size[v];
    d->order[d->num_vertices++] = v;
}

/* Orders the vertices: those that come first in a tetrahedron, then the others. */
static void order_vertices(brio_diagram *d, size_t rows) {
    uint64_t next = 0;
    for (size_t v = 0; v < rows; v++) d->begin[v] = UINT64_MAX;
    for (size_t t = 0; t < d->num_finite; t++) take_vertex(d, d->t.tet[t].vertex[0], &next);
    for (size_t v = 0; v < rows; v++)
        if (d->size[v] > 0) take_vertex(d, (uint32_t)v, &next);
}

brio_status brio_diagram_gather_stars(brio_diagram *d) {
    brio_status status = BRIO_OK;
    size_t rows = d->num_points + (d->flat ? 3 : 0), entries = 4 * d->num_finite + 3 * (d->t.count - d->num_finite);
    star_filling s = {.d = d, .threads = brio_threads(d->ctx, d->t.count, TETRAHEDRA_A_THREAD)};
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, d->size, rows));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->begin, rows));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->order, rows));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->star, entries));
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, s.filled, rows));
    brio_for(d->ctx, s.threads, d->t.count, count_some, &s);
    order_vertices(d, rows);
    brio_for(d->ctx, s.threads, d->t.count, fill_some, &s);
    if (s.threads > 1)
        brio_for(d->ctx, brio_threads(d->ctx, d->num_vertices, VERTICES_A_THREAD), d->num_vertices, sort_some, &s);
done:
    brio_release(d->ctx, s.filled);
    return status;
}
