/* Brute force for everything else that a result of brio_delaunay says: mates, infinite tetrahedra, the representative of
 * every point, and the counts. */
#ifndef BRIO_TESTS_BRUTE_RESULT_H
#define BRIO_TESTS_BRUTE_RESULT_H

#include "brute_check.h"
#include "triangulation/triangulation.h"

/* The arrays of a result that a test may change. */
typedef struct {
    brio_tetrahedron tet[2 * BRUTE_TETS];
    uint32_t representative[BRUTE_POINTS];
} brute_storage;

static inline void brute_copy(const brio_triangulation *from, brute_storage *storage, brio_triangulation *to) {
    *to = *from;
    to->tet = storage->tet, to->representative = storage->representative;
    size_t tets = from->stats.tetrahedra + from->stats.hull_facets;
    if (tets) memcpy(storage->tet, from->tet, tets * sizeof *from->tet);
    memcpy(storage->representative, from->representative, from->stats.points * sizeof *from->representative);
}

/* --- which points are vertices --- */

static inline int brute_dimension(const site_set *s) {
    int dimension = 0;
    if (s->hull_volume) return 3;
    for (size_t i = 0; i < s->n; i++)
        for (size_t j = 0; j < i; j++) {
            offset u = from_to(&s->p[0], &s->p[i]), v = cross(u, from_to(&s->p[0], &s->p[j]));
            if (dot(u, u) && dimension < 1) dimension = 1;
            if (dot(v, v)) dimension = 2;
        }
    return dimension;
}

/* The heaviest of the coincident points, then the lowest index. */
static inline bool stands_for_position(const site_set *s, size_t p) {
    for (size_t q = 0; q < s->n; q++) {
        if (q == p || compare_sites(&s->p[p], &s->p[q])) continue;
        int64_t more = s->weighted ? s->p[q].w - s->p[p].w : 0;
        if (more > 0 || (more == 0 && q < p)) return false;
    }
    return true;
}

static inline int64_t lift_of(const site_set *s, size_t p) {
    const int64_t *x = s->p[p].x;
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - (s->weighted ? s->p[p].w : 0);
}

/* Whether p, on the segment between a and b, has a lift above theirs. */
static inline bool above_segment(const site_set *s, size_t p, size_t a, size_t b) {
    offset u = from_to(&s->p[a], &s->p[b]), v = from_to(&s->p[a], &s->p[p]), off = cross(u, v);
    int64_t whole = dot(u, u), part = dot(u, v);
    if (!whole || dot(off, off) || part < 0 || part > whole) return false;
    return lift_of(s, p) * whole > lift_of(s, a) * (whole - part) + lift_of(s, b) * part;
}

/* The same for a triangle with p in it. */
static inline bool above_triangle(const site_set *s, size_t p, size_t a, size_t b, size_t c) {
    offset n = cross(from_to(&s->p[a], &s->p[b]), from_to(&s->p[a], &s->p[c]));
    int64_t la = dot(n, cross(from_to(&s->p[p], &s->p[b]), from_to(&s->p[p], &s->p[c])));
    int64_t lb = dot(n, cross(from_to(&s->p[p], &s->p[c]), from_to(&s->p[p], &s->p[a])));
    int64_t lc = dot(n, cross(from_to(&s->p[p], &s->p[a]), from_to(&s->p[p], &s->p[b])));
    if (!dot(n, n) || la < 0 || lb < 0 || lc < 0) return false;
    return lift_of(s, p) * (la + lb + lc) > lift_of(s, a) * la + lift_of(s, b) * lb + lift_of(s, c) * lc;
}

/* Whether a point of a flat input owns no cell: a segment or a triangle of others lies below its lift. A point that
 * touches from below is a vertex: the perturbation lifts a corner of what it touches higher. */
static inline bool hidden_in_flat(const site_set *s, size_t p) {
    for (size_t a = 0; a < s->n; a++)
        for (size_t b = 0; b < a; b++) {
            if (above_segment(s, p, a, b)) return true;
            for (size_t c = 0; c < b; c++)
                if (above_triangle(s, p, a, b, c)) return true;
        }
    return false;
}

static inline void flat_vertices(const site_set *s, bool vertex[BRUTE_POINTS]) {
    for (size_t p = 0; p < s->n; p++) vertex[p] = stands_for_position(s, p) && !hidden_in_flat(s, p);
}

static inline void used_vertices(const site_set *s, const tet_set *t, bool vertex[BRUTE_POINTS]) {
    for (size_t p = 0; p < s->n; p++) vertex[p] = false;
    for (size_t i = 0; i < 4 * t->count; i++) vertex[t->v[i / 4][i % 4]] = true;
}

/* --- representatives and counts --- */

/* The vertex at the position of p, or else the nearest by power distance, ties by lexicographic position. */
static inline uint32_t brute_representative(const site_set *s, const bool vertex[BRUTE_POINTS], size_t p) {
    uint32_t best = BRIO_INFINITE;
    int64_t least = 0;
    for (uint32_t v = 0; v < s->n; v++) {
        if (!vertex[v]) continue;
        offset d = from_to(&s->p[p], &s->p[v]);
        if (!dot(d, d)) return v;
        int64_t distance = dot(d, d) - (s->weighted ? s->p[v].w : 0);
        bool first = best == BRIO_INFINITE || distance < least ||
                     (distance == least && compare_sites(&s->p[v], &s->p[best]) < 0);
        if (first) best = v, least = distance;
    }
    return best;
}

static inline void brute_counts(const site_set *s, const bool vertex[BRUTE_POINTS], brio_delaunay_stats *stats) {
    size_t positions = 0;
    stats->points = s->n, stats->vertices = 0;
    for (size_t p = 0; p < s->n; p++) positions += stands_for_position(s, p), stats->vertices += vertex[p];
    stats->duplicates = s->n - positions;
    stats->hidden = positions - stats->vertices;
    stats->dimension = brute_dimension(s);
}

/* --- mates and infinite tetrahedra --- */

static inline bool same_facet(const brio_triangulation *t, size_t f, size_t g) {
    triangle a = facet_at(t->tet[f / 4].vertex, (int)(f % 4)), b = facet_at(t->tet[g / 4].vertex, (int)(g % 4));
    return !compare_triangles(&a, &b);
}

static inline bool mates_are_right(const brio_triangulation *t) {
    size_t handles = 4 * (t->stats.tetrahedra + t->stats.hull_facets);
    for (size_t f = 0; f < handles; f++) {
        uint32_t g = t->tet[f / 4].mate[f % 4];
        if (g >= handles || g / 4 == f / 4 || t->tet[g / 4].mate[g % 4] != f || !same_facet(t, f, g)) return false;
    }
    return true;
}

/* One for each hull facet, and outside of it. The finite ones are right. */
static inline bool infinite_are_right(const site_set *s, const brio_triangulation *t) {
    size_t first = t->stats.tetrahedra, end = first + t->stats.hull_facets, facets = 0;
    for (size_t f = 0; f < 4 * first; f++) {
        triangle a = facet_at(t->tet[f / 4].vertex, (int)(f % 4));
        facets += supporting_side(s, a.v[0], a.v[1], a.v[2]) != 0;
    }
    if (facets != t->stats.hull_facets) return false;
    for (size_t i = first; i < end; i++) {
        const uint32_t *v = t->tet[i].vertex;
        if (v[3] != BRIO_INFINITE || v[0] >= s->n || v[1] >= s->n || v[2] >= s->n) return false;
        if (supporting_side(s, v[0], v[1], v[2]) != -1) return false;
        size_t with = 0;
        for (size_t f = 0; f < 4 * end; f++) with += same_facet(t, 4 * i + 3, f);
        if (with != 2) return false;
    }
    return true;
}

static inline bool finite_are_right(const site_set *s, const brio_triangulation *t, tet_set *finite) {
    if (t->stats.tetrahedra > BRUTE_TETS) return false;
    finite->count = t->stats.tetrahedra;
    for (size_t i = 0; i < finite->count; i++) {
        memcpy(finite->v[i], t->tet[i].vertex, sizeof *finite->v);
        for (int k = 0; k < 4; k++)
            if (finite->v[i][k] >= s->n || !stands_for_position(s, finite->v[i][k])) return false;
        if (volume_at(s, finite->v[i]) <= 0) return false;
    }
    return brute_accepts(s, finite) && brute_canonical(s, finite);
}

static inline bool brute_accepts_result(const site_set *s, const brio_triangulation *t) {
    bool vertex[BRUTE_POINTS];
    tet_set finite;
    brio_delaunay_stats right;
    if (t->stats.dimension != brute_dimension(s)) return false;
    if (t->stats.dimension < 3) {
        if (t->stats.tetrahedra || t->stats.hull_facets) return false;
        flat_vertices(s, vertex);
    } else {
        if (!finite_are_right(s, t, &finite) || !infinite_are_right(s, t) || !mates_are_right(t)) return false;
        used_vertices(s, &finite, vertex);
    }
    brute_counts(s, vertex, &right);
    for (size_t p = 0; p < s->n; p++)
        if (t->representative[p] != brute_representative(s, vertex, p)) return false;
    return t->stats.points == right.points && t->stats.vertices == right.vertices &&
           t->stats.duplicates == right.duplicates && t->stats.hidden == right.hidden;
}

/* --- a result from its finite tetrahedra --- */

static inline void brute_mates(brio_triangulation *t) {
    size_t handles = 4 * (t->stats.tetrahedra + t->stats.hull_facets);
    for (size_t f = 0; f < handles; f++) t->tet[f / 4].mate[f % 4] = UINT32_MAX;
    for (size_t f = 0; f < handles; f++)
        for (size_t g = 0; g < handles; g++)
            if (f / 4 != g / 4 && same_facet(t, f, g)) t->tet[f / 4].mate[f % 4] = (uint32_t)g;
}

static inline void swap_vertices(uint32_t *v, int i, int j) {
    uint32_t swap = v[i];
    v[i] = v[j], v[j] = swap;
}

/* How many of the tetrahedra have the facet of v opposite to slot k. */
static inline size_t facet_uses(const tet_set *t, const uint32_t *v, int k) {
    triangle f = facet_at(v, k);
    size_t uses = 0;
    for (size_t i = 0; i < 4 * t->count; i++) {
        triangle g = facet_at(t->v[i / 4], (int)(i % 4));
        uses += !compare_triangles(&f, &g);
    }
    return uses;
}

/* The infinite tetrahedron behind facet k of v: its first three vertices run round the other way. */
static inline void infinite_behind(const uint32_t *v, int k, uint32_t *w) {
    static const int order[4][3] = {{3, 1, 2}, {2, 0, 3}, {3, 0, 1}, {1, 0, 2}};
    for (int i = 0; i < 3; i++) w[i] = v[order[k][i]];
    w[3] = BRIO_INFINITE;
}

/* Fills the arrays of t as brio_delaunay would if `finite` were its tetrahedra; facets of one tetrahedron are the hull's.
 * False, and t as it was, when an index is out of range or there are too many of those facets. */
static inline bool brute_result(const site_set *s, const tet_set *finite, brio_triangulation *t) {
    bool vertex[BRUTE_POINTS];
    size_t count = finite->count, hull = 0;
    for (size_t f = 0; f < 4 * finite->count; f++) {
        if (finite->v[f / 4][f % 4] >= s->n) return false;
        hull += facet_uses(finite, finite->v[f / 4], (int)(f % 4)) == 1;
    }
    if (count == 0 || count + hull > 2 * BRUTE_TETS) return false;
    for (size_t i = 0; i < finite->count; i++) {
        uint32_t *v = t->tet[i].vertex;
        memcpy(v, finite->v[i], sizeof *finite->v);
        if (volume_at(s, v) < 0) swap_vertices(v, 0, 1);
        for (int k = 0; k < 4; k++)
            if (facet_uses(finite, v, k) == 1) infinite_behind(v, k, t->tet[count++].vertex);
    }
    t->stats.tetrahedra = finite->count, t->stats.hull_facets = count - finite->count;
    brute_mates(t);
    used_vertices(s, finite, vertex);
    brute_counts(s, vertex, &t->stats);
    for (size_t p = 0; p < s->n; p++) t->representative[p] = brute_representative(s, vertex, p);
    return true;
}

#endif
