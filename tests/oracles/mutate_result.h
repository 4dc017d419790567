/* Ways to spoil a result, in place: tetrahedra and triangles with mates, representatives, counts. The views that the library
 * gives are of its own memory, which a test may write to. */
#ifndef BRIO_TESTS_MUTATE_RESULT_H
#define BRIO_TESTS_MUTATE_RESULT_H

#include "exact_answer.h"

enum { MOST_NUMBERS = 8192 };

/* Cells of d + 1 vertices and d + 1 mates; counts: points, vertices, duplicates, hidden, and of the cells of both kinds. */
typedef struct {
    dice *d;
    const point_set *s;
    const exact_answer *a;
    uint32_t *cell, *representative, dimension;
    size_t cells, *count[6];
    int *stated_dimension;
    uint32_t *line; /* of points on a line, else NULL */
    size_t line_length;
} result_view;

static inline uint32_t *cell_of(const result_view *r, size_t i) {
    return r->cell + 2 * (r->dimension + 1) * i;
}

static inline uint32_t *mate_of(const result_view *r, uint32_t handle) {
    return cell_of(r, handle / 4) + r->dimension + 1 + handle % 4;
}

static inline uint32_t any_handle(const result_view *r) {
    return 4 * below(r->d, (uint32_t)r->cells) + below(r->d, r->dimension + 1);
}

static inline uint32_t any_index(const result_view *r) {
    return one_in(r->d, 8) ? UINT32_MAX : below(r->d, (uint32_t)r->s->n + 1);
}

static inline bool is_handle(const result_view *r, uint32_t handle) {
    return handle / 4 < r->cells && handle % 4 <= r->dimension;
}

/* --- cells --- */

static inline void spoil_vertex(const result_view *r) {
    uint32_t h = any_handle(r);
    cell_of(r, h / 4)[h % 4] = any_index(r);
}

static inline void spoil_mate(const result_view *r) {
    *mate_of(r, any_handle(r)) = one_in(r->d, 4) ? any_index(r) : any_handle(r);
}

/* Two pairs of mates change partners. */
static inline void exchange_mates(const result_view *r) {
    uint32_t f = any_handle(r), g = any_handle(r), a = *mate_of(r, f), b = *mate_of(r, g);
    if (!is_handle(r, a) || !is_handle(r, b)) return;
    *mate_of(r, f) = b, *mate_of(r, b) = f;
    *mate_of(r, g) = a, *mate_of(r, a) = g;
}

/* Slots change places, with their mates: once is wrong, twice is right, unless the infinite vertex moved. */
static inline void turn_cell(const result_view *r) {
    uint32_t at = below(r->d, (uint32_t)r->cells), *v = cell_of(r, at);
    for (uint32_t n = 1 + below(r->d, 2); n > 0; n--) {
        uint32_t i = below(r->d, r->dimension + 1), k = (i + 1 + below(r->d, r->dimension)) % (r->dimension + 1);
        uint32_t x = v[i], y = *mate_of(r, 4 * at + i), z = *mate_of(r, 4 * at + k);
        if (!is_handle(r, y) || !is_handle(r, z)) return;
        v[i] = v[k], v[k] = x;
        *mate_of(r, 4 * at + i) = z, *mate_of(r, 4 * at + k) = y;
        *mate_of(r, z) = 4 * at + i, *mate_of(r, y) = 4 * at + k;
    }
}

/* Two cells change places, and their neighbours know it: right if both are finite, or both infinite. */
static inline void exchange_cells(const result_view *r) {
    uint32_t a = below(r->d, (uint32_t)r->cells), b = below(r->d, (uint32_t)r->cells), swap[8],
             size = 2 * r->dimension + 2;
    memcpy(swap, cell_of(r, a), size * sizeof *swap);
    memmove(cell_of(r, a), cell_of(r, b), size * sizeof *swap);
    memcpy(cell_of(r, b), swap, size * sizeof *swap);
    for (uint32_t i = 0; i < r->cells; i++)
        for (uint32_t k = 0; k <= r->dimension; k++) {
            uint32_t *g = mate_of(r, 4 * i + k), to = *g / 4 == a ? b : *g / 4 == b ? a : *g / 4;
            *g = 4 * to + *g % 4;
        }
}

static inline void join_edge(const result_view *r, uint32_t f, uint32_t g) {
    *mate_of(r, f) = g;
    if (is_handle(r, g)) *mate_of(r, g) = f;
}

/* In the plane, two triangles take the other diagonal, with right mates. */
static inline void flip_diagonal(const result_view *r) {
    uint32_t f = any_handle(r), g = *mate_of(r, f);
    if (r->dimension != 2 || !is_handle(r, g) || g / 4 == f / 4) return;
    uint32_t *v = cell_of(r, f / 4), *w = cell_of(r, g / 4), i = f % 4, k = g % 4;
    uint32_t p = v[i], q = v[(i + 1) % 3], s = v[(i + 2) % 3], x = w[k];
    uint32_t pq = v[3 + (i + 2) % 3], sp = v[3 + (i + 1) % 3], qx = w[3 + (k + 1) % 3], xs = w[3 + (k + 2) % 3];
    uint32_t one[3] = {p, q, x}, two[3] = {p, x, s};
    memcpy(v, one, sizeof one), memcpy(w, two, sizeof two);
    join_edge(r, f / 4 * 4, qx), join_edge(r, f / 4 * 4 + 2, pq);
    join_edge(r, g / 4 * 4, xs), join_edge(r, g / 4 * 4 + 1, sp);
    join_edge(r, f / 4 * 4 + 1, g / 4 * 4 + 2);
}

/* A point and another one, coincident if there is one, change roles everywhere. */
static inline void exchange_points(const result_view *r) {
    uint32_t p = below(r->d, (uint32_t)r->s->n), q = below(r->d, (uint32_t)r->s->n);
    for (uint32_t i = 0; i < r->s->n; i++)
        if (i != p && r->a->position[i] == r->a->position[p]) q = i;
    for (size_t i = 0; i < r->cells; i++)
        for (uint32_t k = 0; k <= r->dimension; k++) {
            uint32_t *v = &cell_of(r, i)[k];
            *v = *v == p ? q : *v == q ? p : *v;
        }
    for (size_t i = 0; i < r->s->n; i++) {
        uint32_t *v = &r->representative[i];
        *v = *v == p ? q : *v == q ? p : *v;
    }
}

/* --- what else a result says --- */

static inline void spoil_representative(const result_view *r) {
    r->representative[below(r->d, (uint32_t)r->s->n)] = any_index(r);
}

static inline void spoil_count(const result_view *r) {
    *r->count[1 + below(r->d, 3)] += one_in(r->d, 2) ? 1 : SIZE_MAX;
    if (one_in(r->d, 2)) *r->count[1 + below(r->d, 3)] += one_in(r->d, 2) ? 1 : SIZE_MAX;
}

static inline void spoil_dimension(const result_view *r) {
    *r->stated_dimension = (int)below(r->d, r->dimension + 2) - 1;
}

/* The last finite cell is not counted, or counted as infinite. */
static inline void spoil_kinds(const result_view *r) {
    if (*r->count[4] == 0) return;
    --*r->count[4];
    *r->count[5] += below(r->d, 2);
}

static inline void spoil_line(const result_view *r) {
    if (r->line) r->line[below(r->d, (uint32_t)r->line_length)] = any_index(r);
}

static void (*const RESULT_MUTATIONS[])(const result_view *) = {
    spoil_vertex,  spoil_mate,      exchange_mates,       turn_cell,   exchange_cells,  spoil_kinds, flip_diagonal,
    flip_diagonal, exchange_points, spoil_representative, spoil_count, spoil_dimension, spoil_line};
enum { RESULT_WAYS = sizeof RESULT_MUTATIONS / sizeof *RESULT_MUTATIONS, WAYS_OF_CELLS = 8 };

static inline void mutate_result(const result_view *r) {
    uint32_t from = r->cells ? 0 : WAYS_OF_CELLS;
    RESULT_MUTATIONS[from + below(r->d, RESULT_WAYS - from)](r);
}

#endif
