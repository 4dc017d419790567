/* Ways to spoil a set of tetrahedra, given by indices of points. Some leave it right. Each takes a set that is not empty. */
#ifndef BRIO_TESTS_MUTATE_TETS_H
#define BRIO_TESTS_MUTATE_TETS_H

#include "exact_answer.h"

enum { MOST_TETS = 600 };

typedef struct {
    size_t count;
    uint32_t v[MOST_TETS][4];
} tet_list;

/* What a mutation works on: points, dice, the set. */
typedef struct {
    const point_set *s;
    const exact_answer *a;
    dice *d;
    tet_list *t;
} patient;

static inline uint32_t *any_tet(const patient *p) {
    return p->t->v[below(p->d, (uint32_t)p->t->count)];
}

static inline uint32_t any_point(const patient *p) {
    return below(p->d, (uint32_t)p->s->n);
}

static inline void append_tet(const patient *p, uint32_t a, uint32_t b, uint32_t c, uint32_t e) {
    uint32_t v[4] = {a, b, c, e};
    if (p->t->count < MOST_TETS) memcpy(p->t->v[p->t->count++], v, sizeof v);
}

static inline void delete_tet(const patient *p, size_t i) {
    memmove(p->t->v[i], p->t->v[--p->t->count], sizeof *p->t->v);
}

static inline bool has_point(const uint32_t *v, uint32_t x) {
    return v[0] == x || v[1] == x || v[2] == x || v[3] == x;
}

/* --- vertices --- */

static inline void turn_over(const patient *p) {
    uint32_t *v = any_tet(p), i = below(p->d, 4), k = below(p->d, 4), swap = v[i];
    v[i] = v[k], v[k] = swap;
}

static inline void change_vertex(const patient *p) {
    any_tet(p)[below(p->d, 4)] = any_point(p);
}

static inline void swap_vertices_of_two(const patient *p) {
    uint32_t *v = &any_tet(p)[below(p->d, 4)], *w = &any_tet(p)[below(p->d, 4)], swap = *v;
    *v = *w, *w = swap;
}

static inline void vertex_out_of_range(const patient *p) {
    any_tet(p)[below(p->d, 4)] = one_in(p->d, 2) ? (uint32_t)p->s->n : UINT32_MAX;
}

/* A coincident point, or another one, takes a vertex' place: everywhere, or in half of its tetrahedra. */
static inline void rename_point(const patient *p) {
    uint32_t from = any_tet(p)[below(p->d, 4)], to = any_point(p), share = 1 + below(p->d, 2);
    for (uint32_t q = 0; q < p->s->n && from < p->s->n; q++)
        if (q != from && p->a->position[q] == p->a->position[from]) to = q;
    for (size_t i = 0; i < 4 * p->t->count; i++)
        if (p->t->v[i / 4][i % 4] == from && one_in(p->d, share)) p->t->v[i / 4][i % 4] = to;
}

/* --- whole tetrahedra --- */

static inline void drop_one(const patient *p) {
    delete_tet(p, below(p->d, (uint32_t)p->t->count));
}

static inline void repeat_one(const patient *p) {
    const uint32_t *v = any_tet(p);
    append_tet(p, v[0], v[1], v[2], v[3]);
}

static inline void overwrite_one(const patient *p) {
    memmove(any_tet(p), any_tet(p), sizeof *p->t->v);
}

static inline void add_any(const patient *p) {
    append_tet(p, any_point(p), any_point(p), any_point(p), any_point(p));
}

static inline void reorder(const patient *p) {
    uint32_t swap[4], *v = any_tet(p), *w = any_tet(p);
    memcpy(swap, v, sizeof swap);
    memmove(v, w, sizeof swap);
    memcpy(w, swap, sizeof swap);
}

/* --- flips --- */

/* The tetrahedra that have all of the `count` points x; returns their number, at most 5. */
static inline size_t tets_with(const patient *p, const uint32_t *x, size_t count, size_t *found) {
    size_t n = 0;
    for (size_t i = 0; i < p->t->count && n < 5; i++) {
        bool all = true;
        for (size_t k = 0; k < count; k++) all = all && has_point(p->t->v[i], x[k]);
        if (all) found[n++] = i;
    }
    return n;
}

static inline void delete_some(const patient *p, const size_t *found, size_t n) {
    while (n > 0) delete_tet(p, found[--n]); /* rising: the last one first */
}

/* The points of `found` tetrahedra besides the `count` points x; at most 4. */
static inline size_t other_points(const patient *p, const size_t *found, size_t n, const uint32_t *x, size_t count,
                                  uint32_t *out) {
    size_t m = 0;
    for (uint32_t q = 0; q < p->s->n && m < 4; q++) {
        bool in = false;
        for (size_t i = 0; i < n; i++) in = in || has_point(p->t->v[found[i]], q);
        for (size_t k = 0; k < count; k++) in = in && q != x[k];
        if (in) out[m++] = q;
    }
    return m;
}

/* Two tetrahedra at a facet become three at an edge; or two others, where the facet has an edge on the hull. */
static inline void flip_facet(const patient *p) {
    const uint32_t *v = any_tet(p);
    uint32_t x[3] = {v[0], v[1], v[2]}, tip[4], least = below(p->d, 4) ? 0 : 1;
    size_t found[5], n = tets_with(p, x, 3, found);
    if (n != 2 || other_points(p, found, n, x, 3, tip) != 2) return;
    delete_some(p, found, n);
    for (uint32_t k = least; k < 3; k++) append_tet(p, x[k], x[(k + 1) % 3], tip[0], tip[1]);
}

/* Three tetrahedra at an edge become two at a facet. */
static inline void flip_edge(const patient *p) {
    const uint32_t *v = any_tet(p);
    uint32_t i = below(p->d, 4), x[2] = {v[i], v[(i + 1 + below(p->d, 3)) % 4]}, ring[4];
    size_t found[5], n = tets_with(p, x, 2, found);
    if (n != 3 || other_points(p, found, n, x, 2, ring) != 3) return;
    delete_some(p, found, n);
    append_tet(p, ring[0], ring[1], ring[2], x[0]);
    append_tet(p, ring[0], ring[1], ring[2], x[1]);
}

/* A tetrahedron is divided at a point. */
static inline void flip_in(const patient *p) {
    uint32_t at = below(p->d, (uint32_t)p->t->count), x = any_point(p), v[4];
    memcpy(v, p->t->v[at], sizeof v);
    delete_tet(p, at);
    for (int i = 0; i < 4; i++) append_tet(p, v[(i + 1) % 4], v[(i + 2) % 4], v[(i + 3) % 4], x);
}

/* The four tetrahedra at a vertex become one. */
static inline void flip_out(const patient *p) {
    uint32_t x = any_tet(p)[below(p->d, 4)], link[4];
    size_t found[5], n = tets_with(p, &x, 1, found);
    if (n != 4 || other_points(p, found, n, &x, 1, link) != 4) return;
    delete_some(p, found, n);
    append_tet(p, link[0], link[1], link[2], link[3]);
}

static void (*const TET_MUTATIONS[])(const patient *) = {turn_over,
                                                         change_vertex,
                                                         swap_vertices_of_two,
                                                         vertex_out_of_range,
                                                         rename_point,
                                                         drop_one,
                                                         repeat_one,
                                                         overwrite_one,
                                                         add_any,
                                                         reorder,
                                                         flip_facet,
                                                         flip_facet,
                                                         flip_facet,
                                                         flip_edge,
                                                         flip_edge,
                                                         flip_in,
                                                         flip_out};

static inline void mutate_tets(const patient *p) {
    if (p->t->count) TET_MUTATIONS[below(p->d, sizeof TET_MUTATIONS / sizeof *TET_MUTATIONS)](p);
}

#endif
