/* Results of the library held against the exact answer: all that they say. Every function returns NULL, or what is wrong. */
#ifndef BRIO_TESTS_COMPARE_EXACT_H
#define BRIO_TESTS_COMPARE_EXACT_H

#include "exact_answer.h"

enum { INFINITE_BIT = 1 << MOST_POINTS };

/* Tetrahedra or triangles as plain numbers: d + 1 vertices, then d + 1 mates. Finite ones come first. */
typedef struct {
    const point_set *s;
    const exact_answer *a;
    const uint32_t *cell;
    size_t finite, infinite;
    uint32_t d;
} cells_view;

static inline const uint32_t *cell_at(const cells_view *c, size_t i) {
    return c->cell + 2 * (c->d + 1) * i;
}

/* --- simplices as masks --- */

/** The mask of `count` vertices and the sign of their permutation from ascending order; 0 if one is no heaviest point of a
 *  position, or comes twice. */
static inline mask mask_of(const cells_view *c, const uint32_t *v, uint32_t count, int *sign) {
    mask m = 0;
    *sign = 1;
    for (uint32_t i = 0; i < count; i++) {
        mask bit = INFINITE_BIT;
        if (v[i] != BRIO_INFINITE) {
            if (v[i] >= c->s->n || c->a->heaviest[c->a->position[v[i]]] != v[i]) return 0;
            bit = 1u << c->a->position[v[i]];
        }
        if (m & bit) return 0;
        if (__builtin_popcount(m & ~(bit - 1)) % 2) *sign = -*sign;
        m |= bit;
    }
    return m;
}

static inline mask facet_mask(const cells_view *c, size_t i, uint32_t apex) {
    int sign;
    uint32_t facet[3], n = 0;
    for (uint32_t k = 0; k <= c->d; k++)
        if (k != apex) facet[n++] = cell_at(c, i)[k];
    return mask_of(c, facet, n, &sign);
}

static inline size_t simplices_with(const exact_answer *a, mask facet) {
    size_t n = 0;
    for (size_t i = 0; i < a->count; i++) n += (a->simplex[i] & facet) == facet;
    return n;
}

/* --- cells --- */

static inline const char *compare_finite(const cells_view *c) {
    static bool wanted[MASKS];
    if (c->finite != c->a->count) return "another number of simplices";
    memset(wanted, 0, sizeof wanted);
    for (size_t i = 0; i < c->finite; i++) wanted[c->a->simplex[i]] = true;
    for (size_t i = 0; i < c->finite; i++) {
        int sign;
        mask m = mask_of(c, cell_at(c, i), c->d + 1, &sign);
        if (m >= MASKS || !wanted[m]) return "a simplex that is none";
        if (sign * volume_sign[m] < 0) return "a simplex of negative orientation";
        wanted[m] = false;
    }
    return NULL;
}

static inline const char *compare_infinite(const cells_view *c) {
    size_t facets = 0;
    for (size_t i = 0; i < c->finite; i++)
        for (uint32_t k = 0; k <= c->d; k++) facets += simplices_with(c->a, facet_mask(c, i, k)) == 1;
    if (facets != c->infinite) return "another number of hull facets";
    for (size_t i = c->finite; i < c->finite + c->infinite; i++) {
        int sign;
        const uint32_t *v = cell_at(c, i);
        mask on, m = mask_of(c, v, c->d, &sign);
        if (v[c->d] != BRIO_INFINITE || m == 0 || m >= MASKS) return "an infinite simplex that is none";
        if (simplices_with(c->a, m) != 1) return "a hull facet that is none";
        if (sign * supports(m, c->a->positions, &on) != -1) return "a hull facet seen from inside";
        for (size_t j = c->finite; j < i; j++)
            if (facet_mask(c, j, c->d) == m) return "a hull facet twice";
    }
    return NULL;
}

static inline const char *compare_mates(const cells_view *c) {
    size_t cells = c->finite + c->infinite;
    for (size_t i = 0; i < cells; i++)
        for (uint32_t k = 0; k <= c->d; k++) {
            uint32_t g = cell_at(c, i)[c->d + 1 + k], other = g / 4, slot = g % 4;
            if (other >= cells || slot > c->d || other == i) return "a mate out of range";
            if (cell_at(c, other)[c->d + 1 + slot] != 4 * i + k) return "mates that do not know each other";
            if (facet_mask(c, other, slot) != facet_mask(c, i, k)) return "mates with different facets";
        }
    return NULL;
}

static inline const char *compare_cells(const cells_view *c) {
    const char *wrong = compare_finite(c);
    if (!wrong) wrong = compare_infinite(c);
    return wrong ? wrong : compare_mates(c);
}

/* --- counts and representatives --- */

/* points, vertices, duplicates, hidden, as a result has them. */
static inline const char *compare_counts(const point_set *s, const exact_answer *a, const size_t *count) {
    size_t vertices = (size_t)__builtin_popcount(a->vertices);
    bool right = count[0] == s->n && count[1] == vertices && count[2] == s->n - a->positions &&
                 count[3] == a->positions - vertices;
    return right ? NULL : "another number of vertices, duplicates or hidden points";
}

static inline const char *compare_representatives(const point_set *s, const exact_answer *a, const uint32_t *found,
                                                  bool hidden_left) {
    for (size_t i = 0; i < s->n; i++) {
        bool hidden = !(a->vertices >> a->position[i] & 1);
        if (found[i] != (hidden && hidden_left ? BRIO_INFINITE : a->representative[i])) return "another representative";
    }
    return NULL;
}

static inline const char *compare_solid(const point_set *s, const exact_answer *a, const brio_triangulation *t,
                                        bool hidden_left) {
    const brio_delaunay_stats *f = brio_triangulation_stats(t);
    size_t count[] = {f->points, f->vertices, f->duplicates, f->hidden};
    if (f->dimension != a->dimension) return "another dimension";
    const char *wrong = compare_counts(s, a, count);
    if (!wrong) wrong = compare_representatives(s, a, brio_triangulation_representatives(t), hidden_left);
    if (a->dimension < 3) return wrong || !(f->tetrahedra + f->hull_facets) ? wrong : "tetrahedra of a flat input";
    cells_view c = {s, a, brio_triangulation_tetrahedra(t)->vertex, f->tetrahedra, f->hull_facets, 3};
    return wrong ? wrong : compare_cells(&c);
}

/* Points on a line: each vertex with the next, lexicographically. */
static inline const char *compare_line(const exact_answer *a, const brio_triangulation2 *t) {
    size_t count, n = 0;
    const uint32_t *line = brio_triangulation2_line(t, &count);
    if (count != (a->dimension == 1 ? (size_t)__builtin_popcount(a->vertices) : 0)) return "a line of another length";
    for (uint32_t r = 0; count && r < a->positions; r++)
        if (a->vertices >> r & 1 && line[n++] != a->heaviest[r]) return "another vertex of the line";
    return NULL;
}

static inline const char *compare_plane(const point_set *s, const exact_answer *a, const brio_triangulation2 *t) {
    const brio_delaunay2_stats *f = brio_triangulation2_stats(t);
    size_t count[] = {f->points, f->vertices, f->duplicates, f->hidden};
    if (f->dimension != a->dimension) return "another dimension";
    const char *wrong = compare_counts(s, a, count);
    if (!wrong) wrong = compare_representatives(s, a, brio_triangulation2_representatives(t), false);
    if (!wrong) wrong = compare_line(a, t);
    if (a->dimension < 2) return wrong || !(f->triangles + f->hull_edges) ? wrong : "triangles of a line";
    cells_view c = {s, a, brio_triangulation2_triangles(t)->vertex, f->triangles, f->hull_edges, 2};
    return wrong ? wrong : compare_cells(&c);
}

/* --- the hull --- */

static inline mask position_bit(const exact_answer *a, uint32_t point) {
    return 1u << a->position[point];
}

/* Whether from and to, in this order, are consecutive on one face of dimension 3 more, the other way round. */
static inline size_t faces_with_side(const brio_mesh *m, uint32_t from, uint32_t to) {
    size_t n = 0;
    for (size_t f = 0; f < m->num_faces; f++)
        for (uint64_t c = m->face_offsets[f]; c < m->face_offsets[f + 1]; c++) {
            uint64_t next = c + 1 < m->face_offsets[f + 1] ? c + 1 : m->face_offsets[f];
            n += m->face_vertices[c] == from && m->face_vertices[next] == to;
        }
    return n;
}

/* A polygon has the extreme positions of one plane; its first three corners turn so that all others are behind. */
static inline const char *compare_polygon(const exact_answer *a, const brio_mesh *m, const uint32_t *sample,
                                          size_t face) {
    const uint32_t *v = m->face_vertices + m->face_offsets[face];
    size_t corners = m->face_offsets[face + 1] - m->face_offsets[face], plane = 0;
    mask has = 0, three = 0, on;
    int turn = 1;
    for (size_t i = 0; i < corners; i++) {
        mask bit = position_bit(a, sample[v[i]]);
        if (has & bit) return "a polygon with a corner twice";
        has |= bit;
        if (i > 2) continue;
        if (__builtin_popcount(three & ~(bit - 1)) % 2) turn = -turn;
        three |= bit;
    }
    while (plane < a->planes && (a->plane[plane] & a->extreme) != has) plane++;
    if (corners < 3 || plane == a->planes) return "a facet of the hull that is none";
    return turn * supports(three, a->positions, &on) == -1 ? NULL : "a facet of the hull seen from inside";
}

static inline const char *compare_polygons(const exact_answer *a, const brio_mesh *m, const uint32_t *sample) {
    if (m->num_faces != a->planes) return "another number of facets";
    for (size_t f = 0; f < m->num_faces; f++) {
        const char *wrong = compare_polygon(a, m, sample, f);
        if (wrong) return wrong;
        for (uint64_t c = m->face_offsets[f]; c < m->face_offsets[f + 1]; c++) {
            uint64_t next = c + 1 < m->face_offsets[f + 1] ? c + 1 : m->face_offsets[f];
            if (faces_with_side(m, m->face_vertices[next], m->face_vertices[c]) != 1) return "an open hull";
        }
    }
    return NULL;
}

static inline const char *compare_hull(const exact_answer *a, const brio_mesh *m, const uint32_t *sample,
                                       const brio_convex_hull_stats *stats) {
    mask extreme = a->dimension == 0 ? 1 : a->extreme, found = 0;
    if (stats->dimension != a->dimension) return "a hull of another dimension";
    for (size_t v = 0; v < m->num_vertices; v++) {
        if (v && sample[v] <= sample[v - 1]) return "vertices of the hull out of order";
        if (a->lowest[a->position[sample[v]]] != sample[v]) return "a vertex of the hull with a lower twin";
        found |= position_bit(a, sample[v]);
    }
    if (found != extreme || stats->vertices != m->num_vertices) return "other vertices of the hull";
    if (a->dimension == 2 && (m->num_faces != 1 || m->face_offsets[1] != m->num_vertices)) return "no polygon";
    return a->dimension == 3 ? compare_polygons(a, m, sample) : NULL;
}

#endif
