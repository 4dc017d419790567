/* Brute force that knows, for a few points with small integer coordinates, whether a set of tetrahedra is a Delaunay
 * (regular) triangulation. It shares no code with the library. All arithmetic is in 64-bit integers: coordinates up to
 * 64 and weights up to 2^14 leave every determinant below 2^50.
 *
 * A set is right when
 *   - its tetrahedra have volume, and every facet is in two of them, or in one of them and on the convex hull;
 *   - their volumes add up to the volume of the hull, which is found from the points alone;
 *   - every two of them have disjoint interiors: a plane parallel to a facet of one, or to an edge of each, separates
 *     them;
 *   - no point, duplicates and hidden ones included, is inside the (ortho)sphere of any of them. */
#ifndef BRIO_TESTS_BRUTE_CHECK_H
#define BRIO_TESTS_BRUTE_CHECK_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { BRUTE_POINTS = 48, BRUTE_TETS = 512 };

typedef struct {
    int64_t x[3], w;
} site;

typedef struct {
    size_t n;
    bool weighted;
    site p[BRUTE_POINTS];
    int64_t hull_volume; /* six times */
} site_set;

typedef struct {
    size_t count;
    uint32_t v[BRUTE_TETS][4];
} tet_set;

typedef struct {
    int64_t x[3];
} offset;

static inline offset from_to(const site *a, const site *b) {
    return (offset){{b->x[0] - a->x[0], b->x[1] - a->x[1], b->x[2] - a->x[2]}};
}

static inline offset cross(offset u, offset v) {
    return (offset){
        {u.x[1] * v.x[2] - u.x[2] * v.x[1], u.x[2] * v.x[0] - u.x[0] * v.x[2], u.x[0] * v.x[1] - u.x[1] * v.x[0]}};
}

static inline int64_t dot(offset u, offset v) {
    return u.x[0] * v.x[0] + u.x[1] * v.x[1] + u.x[2] * v.x[2];
}

static inline int sign_of(int64_t x) {
    return (x > 0) - (x < 0);
}

/* Six times the signed volume. */
static inline int64_t volume_of(const site *a, const site *b, const site *c, const site *d) {
    return dot(cross(from_to(a, b), from_to(a, c)), from_to(a, d));
}

static inline int64_t volume_at(const site_set *s, const uint32_t *v) {
    return volume_of(&s->p[v[0]], &s->p[v[1]], &s->p[v[2]], &s->p[v[3]]);
}

static inline int compare_sites(const site *a, const site *b) {
    for (int k = 0; k < 3; k++)
        if (a->x[k] != b->x[k]) return a->x[k] < b->x[k] ? -1 : 1;
    return 0;
}

/* --- the hull --- */

/* All points on one side of the plane of three points that are not collinear: which side, as +-1, else 0. */
static inline int supporting_side(const site_set *s, size_t i, size_t j, size_t k) {
    offset normal = cross(from_to(&s->p[i], &s->p[j]), from_to(&s->p[i], &s->p[k]));
    if (!dot(normal, normal)) return 0;
    int side = 0;
    for (size_t m = 0; m < s->n; m++) {
        int here = sign_of(dot(normal, from_to(&s->p[i], &s->p[m])));
        if (here && here == -side) return 0;
        if (here) side = here;
    }
    return side;
}

/* Six times the volume of the cone from point 0 over the polygon that the hull has in one plane: gift wrapping from its
 * least point. */
static inline int64_t cone_over(const site_set *s, const uint32_t *in, size_t count, offset normal) {
    uint32_t first = in[0];
    for (size_t m = 1; m < count; m++)
        if (compare_sites(&s->p[in[m]], &s->p[first]) < 0) first = in[m];
    int64_t sum = 0;
    for (uint32_t at = first;;) {
        uint32_t next = at;
        for (size_t m = 0; m < count; m++) {
            offset u = from_to(&s->p[at], &s->p[next]), v = from_to(&s->p[at], &s->p[in[m]]);
            int64_t turn = dot(normal, cross(u, v));
            if (dot(v, v) && (next == at || turn < 0 || (turn == 0 && dot(v, v) > dot(u, u)))) next = in[m];
        }
        sum += volume_of(&s->p[0], &s->p[first], &s->p[at], &s->p[next]);
        if (compare_sites(&s->p[next], &s->p[first]) == 0) return llabs(sum);
        at = next;
    }
}

static inline bool collinear(const site_set *s, size_t i, size_t j, size_t k) {
    offset n = cross(from_to(&s->p[i], &s->p[j]), from_to(&s->p[i], &s->p[k]));
    return !dot(n, n);
}

/* Whether i, j, k are the first points that are not collinear among those of their plane. */
static inline bool names_plane(const site_set *s, const uint32_t *in, size_t i, size_t j, size_t k) {
    size_t m = 1;
    if (in[0] != i) return false;
    while (compare_sites(&s->p[in[m]], &s->p[i]) == 0) m++;
    if (in[m] != j) return false;
    while (collinear(s, i, j, in[m])) m++;
    return in[m] == k;
}

/* Six times the volume of the convex hull, 0 for flat points: a cone over each of its planes. */
static inline int64_t hull_volume(const site_set *s) {
    int64_t sum = 0;
    for (size_t i = 0; i < s->n; i++)
        for (size_t j = i + 1; j < s->n; j++)
            for (size_t k = j + 1; k < s->n; k++) {
                if (!supporting_side(s, i, j, k)) continue;
                offset normal = cross(from_to(&s->p[i], &s->p[j]), from_to(&s->p[i], &s->p[k]));
                uint32_t in[BRUTE_POINTS];
                size_t count = 0;
                for (uint32_t m = 0; m < s->n; m++)
                    if (dot(normal, from_to(&s->p[i], &s->p[m])) == 0) in[count++] = m;
                if (names_plane(s, in, i, j, k)) sum += cone_over(s, in, count, normal);
            }
    return sum;
}

/* --- spheres --- */

/* Positive for e inside the (ortho)sphere of the tetrahedron v, of either orientation. */
static inline int64_t inside_sphere(const site_set *s, const uint32_t *v, const site *e) {
    int64_t m[4][4];
    for (int i = 0; i < 4; i++) {
        const site *a = &s->p[v[i]];
        offset d = from_to(e, a);
        for (int k = 0; k < 3; k++) m[i][k] = d.x[k];
        m[i][3] = dot(d, d) - (s->weighted ? a->w - e->w : 0);
    }
    int64_t det = 0;
    for (int i = 0; i < 4; i++) { /* along the last column */
        offset r[3];
        for (int j = 0, n = 0; j < 4; j++)
            if (j != i) r[n++] = (offset){{m[j][0], m[j][1], m[j][2]}};
        det += (i % 2 ? -1 : 1) * m[i][3] * dot(r[0], cross(r[1], r[2]));
    }
    return sign_of(volume_at(s, v)) * det;
}

/* Whether e, on the sphere and at no vertex, conflicts with the tetrahedron under the perturbation: by the rule of
 * docs/decisions/002. */
static inline bool tie_conflicts(const site_set *s, const uint32_t *v, const site *e) {
    const site *five[5] = {&s->p[v[0]], &s->p[v[1]], &s->p[v[2]], &s->p[v[3]], e};
    for (int i = 1; i < 5; i++)
        for (int j = i; j > 0 && compare_sites(five[j], five[j - 1]) > 0; j--) {
            const site *swap = five[j];
            five[j] = five[j - 1], five[j - 1] = swap;
        }
    for (int n = 0; n < 5; n++) {
        if (five[n] == e) return false;
        const site *with[4];
        for (int i = 0; i < 4; i++) with[i] = &s->p[v[i]] == five[n] ? e : &s->p[v[i]];
        int64_t volume = volume_of(with[0], with[1], with[2], with[3]);
        if (volume) return sign_of(volume) == sign_of(volume_at(s, v));
    }
    return false;
}

static inline bool at_vertex(const site_set *s, const uint32_t *v, const site *e) {
    for (int i = 0; i < 4; i++)
        if (compare_sites(&s->p[v[i]], e) == 0) return true;
    return false;
}

static inline bool sphere_is_empty(const site_set *s, const uint32_t *v) {
    for (size_t m = 0; m < s->n; m++)
        if (inside_sphere(s, v, &s->p[m]) > 0) return false;
    return true;
}

/* --- sets of tetrahedra --- */

typedef struct {
    uint32_t v[3];
} triangle;

static inline int compare_triangles(const void *a, const void *b) {
    return memcmp(a, b, sizeof(triangle));
}

static inline triangle facet_at(const uint32_t *v, int apex) {
    triangle f;
    for (int i = 0, n = 0; i < 4; i++)
        if (i != apex) f.v[n++] = v[i];
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && f.v[j] < f.v[j - 1]; j--) {
            uint32_t swap = f.v[j];
            f.v[j] = f.v[j - 1], f.v[j - 1] = swap;
        }
    return f;
}

static inline bool facets_match(const site_set *s, const tet_set *t) {
    triangle f[4 * BRUTE_TETS];
    size_t n = 4 * t->count, same;
    for (size_t i = 0; i < n; i++) f[i] = facet_at(t->v[i / 4], (int)(i % 4));
    qsort(f, n, sizeof *f, compare_triangles);
    for (size_t i = 0; i < n; i += same) {
        for (same = 1; i + same < n && !compare_triangles(&f[i], &f[i + same]);) same++;
        if (same > 2 || (same == 1 && !supporting_side(s, f[i].v[0], f[i].v[1], f[i].v[2]))) return false;
    }
    return true;
}

/* Whether the vertices of a and b lie on opposite closed sides of a plane with this normal. */
static inline bool separates(const site_set *s, const uint32_t *a, const uint32_t *b, offset normal) {
    int64_t low[2] = {INT64_MAX, INT64_MAX}, high[2] = {INT64_MIN, INT64_MIN};
    if (!dot(normal, normal)) return false;
    for (int i = 0; i < 8; i++) {
        const site *p = &s->p[i < 4 ? a[i] : b[i - 4]];
        int64_t h = dot(normal, (offset){{p->x[0], p->x[1], p->x[2]}});
        if (h < low[i / 4]) low[i / 4] = h;
        if (h > high[i / 4]) high[i / 4] = h;
    }
    return high[0] <= low[1] || high[1] <= low[0];
}

static inline bool facet_separates(const site_set *s, const uint32_t *a, const uint32_t *b) {
    for (int i = 0; i < 4; i++) {
        triangle f = facet_at(a, i);
        offset normal = cross(from_to(&s->p[f.v[0]], &s->p[f.v[1]]), from_to(&s->p[f.v[0]], &s->p[f.v[2]]));
        if (separates(s, a, b, normal)) return true;
    }
    return false;
}

static inline bool interiors_are_disjoint(const site_set *s, const uint32_t *a, const uint32_t *b) {
    static const int edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    if (facet_separates(s, a, b) || facet_separates(s, b, a)) return true;
    for (int i = 0; i < 36; i++) {
        const int *e = edge[i / 6], *f = edge[i % 6];
        offset u = from_to(&s->p[a[e[0]]], &s->p[a[e[1]]]), v = from_to(&s->p[b[f[0]]], &s->p[b[f[1]]]);
        if (separates(s, a, b, cross(u, v))) return true;
    }
    return false;
}

/* Whether the set is a Delaunay (regular) triangulation of points of dimension 3. */
static inline bool brute_accepts(const site_set *s, const tet_set *t) {
    int64_t sum = 0;
    for (size_t i = 0; i < t->count; i++) {
        for (int k = 0; k < 4; k++)
            if (t->v[i][k] >= s->n) return false;
        int64_t volume = volume_at(s, t->v[i]);
        if (!volume) return false;
        sum += llabs(volume);
    }
    if (sum != s->hull_volume || !facets_match(s, t)) return false;
    for (size_t i = 0; i < t->count; i++)
        if (!sphere_is_empty(s, t->v[i])) return false;
    for (size_t i = 0; i < t->count; i++)
        for (size_t j = 0; j < i; j++)
            if (!interiors_are_disjoint(s, t->v[i], t->v[j])) return false;
    return true;
}

/* Whether a right set breaks ties by the perturbation. */
static inline bool brute_canonical(const site_set *s, const tet_set *t) {
    for (size_t i = 0; i < t->count; i++)
        for (size_t m = 0; m < s->n; m++) {
            const site *e = &s->p[m];
            if (at_vertex(s, t->v[i], e) || inside_sphere(s, t->v[i], e) < 0) continue;
            if (tie_conflicts(s, t->v[i], e)) return false;
        }
    return true;
}

#endif
