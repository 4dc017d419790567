/* Brute force for triangulations of the plane: for a few points with small integer coordinates it finds all triangles of
 * the perturbed Delaunay (regular) triangulation, and the representative of every point. It shares no code with the
 * library. A triple is a triangle when no other position conflicts with it. */
#ifndef BRIO_TESTS_PLANE_BRUTE_H
#define BRIO_TESTS_PLANE_BRUTE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { BRUTE_MOST = 48 };

typedef struct {
    int64_t x, y, w;
} plane_site;

typedef struct {
    size_t n;
    bool weighted;
    plane_site p[BRUTE_MOST];
} plane_set;

typedef struct {
    int dimension;
    size_t vertices, hidden, count;
    uint32_t triple[4 * BRUTE_MOST][3]; /* counterclockwise, least vertex first, sorted */
    uint32_t representative[BRUTE_MOST];
    bool vertex[BRUTE_MOST];
} plane_answer;

static inline int64_t brute_orient(const plane_site *a, const plane_site *b, const plane_site *c) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static inline int brute_compare(const plane_site *a, const plane_site *b) {
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return (a->y > b->y) - (a->y < b->y);
}

static inline int64_t brute_lift(const plane_set *s, const plane_site *a) {
    return a->x * a->x + a->y * a->y - (s->weighted ? a->w : 0);
}

/* Of the points at the position of point i, the heaviest, then the first. */
static inline uint32_t brute_first(const plane_set *s, uint32_t i) {
    uint32_t best = i;
    for (uint32_t k = 0; k < s->n; k++) {
        if (brute_compare(&s->p[k], &s->p[i])) continue;
        int64_t more = s->weighted ? s->p[k].w - s->p[best].w : 0;
        if (more > 0 || (more == 0 && k < best)) best = k;
    }
    return best;
}

/* Whether e conflicts with the counterclockwise triangle v. */
static inline bool brute_conflict(const plane_set *s, const uint32_t *v, const plane_site *e) {
    const plane_site *p[4] = {&s->p[v[0]], &s->p[v[1]], &s->p[v[2]], e};
    int64_t minor[4] = {brute_orient(p[1], p[2], p[3]), -brute_orient(p[0], p[2], p[3]), brute_orient(p[0], p[1], p[3]),
                        -brute_orient(p[0], p[1], p[2])};
    int64_t det = 0;
    for (int i = 0; i < 4; i++) det += brute_lift(s, p[i]) * minor[i];
    /* a tie: the lift of the lexicographically largest point with a minor grows by most */
    for (int largest = -1; det == 0;) {
        int next = -1;
        for (int i = 0; i < 4; i++)
            if ((largest < 0 || brute_compare(p[i], p[largest]) < 0) && (next < 0 || brute_compare(p[i], p[next]) > 0))
                next = i;
        largest = next;
        det = minor[next];
    }
    return det > 0;
}

static inline bool brute_is_triangle(const plane_set *s, const uint32_t *v) {
    if (brute_orient(&s->p[v[0]], &s->p[v[1]], &s->p[v[2]]) <= 0) return false;
    for (uint32_t e = 0; e < s->n; e++)
        if (brute_first(s, e) == e && e != v[0] && e != v[1] && e != v[2] && brute_conflict(s, v, &s->p[e]))
            return false;
    return true;
}

/* Whether p, on the line of a and b, is strictly between them and strictly above the lifted segment. */
static inline bool brute_above(const plane_set *s, const plane_site *a, const plane_site *b, const plane_site *p) {
    if (brute_compare(a, p) >= 0 || brute_compare(p, b) >= 0) return false;
    int64_t ap = p->x != a->x ? p->x - a->x : p->y - a->y, pb = b->x != p->x ? b->x - p->x : b->y - p->y;
    return brute_lift(s, p) * (llabs(ap) + llabs(pb)) > brute_lift(s, a) * llabs(pb) + brute_lift(s, b) * llabs(ap);
}

/* Marks the vertices of points on a line. A tie does not hide: an end of the segment is lexicographically larger. */
static inline void brute_line(const plane_set *s, plane_answer *out) {
    for (uint32_t p = 0; p < s->n; p++) {
        out->vertex[p] = brute_first(s, p) == p;
        for (uint32_t a = 0; a < s->n; a++)
            for (uint32_t b = 0; b < s->n; b++)
                if (brute_above(s, &s->p[a], &s->p[b], &s->p[p])) out->vertex[p] = false;
    }
}

static inline int brute_dimension(const plane_set *s) {
    int dimension = s->n ? 0 : -1;
    for (uint32_t i = 1; i < s->n; i++) {
        if (brute_compare(&s->p[0], &s->p[i]) && dimension == 0) dimension = 1;
        for (uint32_t k = 1; k < i; k++)
            if (brute_orient(&s->p[0], &s->p[i], &s->p[k])) return 2;
    }
    return dimension;
}

/* The vertex of least power distance to point p; ties are lexicographic. */
static inline uint32_t brute_nearest(const plane_set *s, const plane_answer *a, uint32_t p) {
    uint32_t best = UINT32_MAX;
    int64_t least = 0;
    for (uint32_t v = 0; v < s->n; v++) {
        if (!a->vertex[v]) continue;
        int64_t x = s->p[v].x - s->p[p].x, y = s->p[v].y - s->p[p].y;
        int64_t power = x * x + y * y - (s->weighted ? s->p[v].w : 0);
        if (best == UINT32_MAX || power < least || (power == least && brute_compare(&s->p[v], &s->p[best]) < 0))
            best = v, least = power;
    }
    return best;
}

static inline void brute_triangles(const plane_set *s, plane_answer *out) {
    for (uint32_t a = 0; a < s->n; a++)
        for (uint32_t b = 0; b < s->n; b++)
            for (uint32_t c = 0; c < s->n; c++) {
                uint32_t v[3] = {a, b, c};
                if (a >= b || a >= c || b == c) continue;
                if (brute_first(s, a) != a || brute_first(s, b) != b || brute_first(s, c) != c) continue;
                if (!brute_is_triangle(s, v)) continue;
                memcpy(out->triple[out->count++], v, sizeof v);
                out->vertex[a] = out->vertex[b] = out->vertex[c] = true;
            }
}

static inline int brute_triple_order(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

static inline void plane_brute(const plane_set *s, plane_answer *out) {
    memset(out, 0, sizeof *out);
    out->dimension = brute_dimension(s);
    if (out->dimension == 2)
        brute_triangles(s, out);
    else
        brute_line(s, out);
    qsort(out->triple, out->count, sizeof *out->triple, brute_triple_order);
    for (uint32_t p = 0; p < s->n; p++) {
        uint32_t first = brute_first(s, p);
        out->vertices += out->vertex[p];
        out->hidden += first == p && !out->vertex[p];
        out->representative[p] = out->vertex[first] ? first : brute_nearest(s, out, p);
    }
}

#endif
