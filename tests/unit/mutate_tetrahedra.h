/* Ways to spoil a set of tetrahedra. Each takes a set and changes it at random; some leave it right, most do not. */
#ifndef BRIO_TESTS_MUTATE_TETRAHEDRA_H
#define BRIO_TESTS_MUTATE_TETRAHEDRA_H

#include "base/rng.h"
#include "brute_check.h"

enum { ALTERNATIVES = 6, NEAR_MISSES = 4, CANDIDATES = 4096 };

/* Points; Delaunay (regular) triangulations of them whose ties are broken in different ways; triangulations of nearly
 * the same points and weights; tetrahedra with an empty sphere. Points 2 to 2 + ring are on a circle round the axis of
 * points 0 and 1, where ring is not 0. */
typedef struct {
    site_set s;
    uint32_t ring;
    tet_set right[ALTERNATIVES], near_miss[NEAR_MISSES];
    uint32_t candidate[CANDIDATES][4];
    size_t num_candidates;
    brio_rng rng;
} scene;

static inline size_t draw(scene *e, size_t n) {
    return n ? brio_rng_below(&e->rng, (uint32_t)n) : 0;
}

static inline uint32_t draw_point(scene *e) {
    return (uint32_t)draw(e, e->s.n);
}

static inline void add_tet(tet_set *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    if (t->count == BRUTE_TETS) return;
    uint32_t v[4] = {a, b, c, d};
    memcpy(t->v[t->count++], v, sizeof v);
}

static inline void remove_tet(tet_set *t, size_t i) {
    memmove(t->v[i], t->v[i + 1], (t->count - i - 1) * sizeof *t->v);
    t->count--;
}

static inline bool tet_has(const uint32_t *v, uint32_t p) {
    return v[0] == p || v[1] == p || v[2] == p || v[3] == p;
}

/* --- vertices --- */

static inline void swap_in_tet(scene *e, tet_set *t) {
    uint32_t *v = t->v[draw(e, t->count)];
    size_t a = draw(e, 4), b = draw(e, 4);
    uint32_t swap = v[a];
    v[a] = v[b], v[b] = swap;
}

static inline void replace_vertex(scene *e, tet_set *t) {
    size_t i = draw(e, t->count);
    t->v[i][draw(e, 4)] = draw_point(e);
}

static inline void exchange_vertices(scene *e, tet_set *t) {
    uint32_t *v = &t->v[draw(e, t->count)][draw(e, 4)], *w = &t->v[draw(e, t->count)][draw(e, 4)];
    uint32_t swap = *v;
    *v = *w, *w = swap;
}

/* A coincident point, or p itself where there is none. */
static inline uint32_t twin_of(scene *e, uint32_t p) {
    uint32_t from = draw_point(e);
    for (uint32_t i = 0; i < e->s.n; i++) {
        uint32_t q = (from + i) % (uint32_t)e->s.n;
        if (q != p && compare_sites(&e->s.p[p], &e->s.p[q]) == 0) return q;
    }
    return p;
}

static inline void rename_vertex(scene *e, tet_set *t, uint32_t from, uint32_t to, size_t one_in) {
    for (size_t i = 0; i < 4 * t->count; i++)
        if (t->v[i / 4][i % 4] == from && draw(e, one_in) == 0) t->v[i / 4][i % 4] = to;
}

static inline void rename_everywhere(scene *e, tet_set *t) {
    rename_vertex(e, t, t->v[draw(e, t->count)][draw(e, 4)], draw_point(e), 1);
}

static inline void rename_to_twin(scene *e, tet_set *t) {
    uint32_t p = t->v[draw(e, t->count)][draw(e, 4)];
    if (p < e->s.n) rename_vertex(e, t, p, twin_of(e, p), 1 + draw(e, 2));
}

static inline void point_out_of_range(scene *e, tet_set *t) {
    t->v[draw(e, t->count)][draw(e, 4)] = draw(e, 2) ? (uint32_t)e->s.n : UINT32_MAX;
}

/* --- whole tetrahedra --- */

static inline void drop_tet(scene *e, tet_set *t) {
    remove_tet(t, draw(e, t->count));
}

static inline void repeat_tet(scene *e, tet_set *t) {
    uint32_t *v = t->v[draw(e, t->count)];
    add_tet(t, v[0], v[1], v[2], v[3]);
}

static inline void overwrite_tet(scene *e, tet_set *t) {
    size_t from = draw(e, t->count), to = draw(e, t->count);
    memmove(t->v[to], t->v[from], sizeof *t->v);
}

static inline void add_candidate(scene *e, tet_set *t) {
    if (!e->num_candidates) return;
    const uint32_t *v = e->candidate[draw(e, e->num_candidates)];
    add_tet(t, v[0], v[1], v[2], v[3]);
}

static inline void drop_star(scene *e, tet_set *t) {
    uint32_t p = t->v[draw(e, t->count)][draw(e, 4)];
    for (size_t i = t->count; i-- > 0;)
        if (tet_has(t->v[i], p)) remove_tet(t, i);
}

static inline void shuffle_tets(scene *e, tet_set *t) {
    for (size_t i = t->count; i-- > 1;) {
        uint32_t swap[4], *v = t->v[i], *w = t->v[draw(e, i + 1)];
        memcpy(swap, v, sizeof swap);
        memmove(v, w, sizeof swap);
        memcpy(w, swap, sizeof swap);
    }
}

/* --- flips, whatever their geometry --- */

/* Another tetrahedron with the facet of t->v[a] opposite to slot i, and its apex; or a itself. */
static inline size_t across(const tet_set *t, size_t a, int i, uint32_t *apex) {
    triangle f = facet_at(t->v[a], i);
    for (size_t b = 0; b < t->count; b++)
        for (int k = 0; k < 4; k++) {
            triangle g = facet_at(t->v[b], k);
            if (b == a || compare_triangles(&f, &g)) continue;
            *apex = t->v[b][k];
            return b;
        }
    return a;
}

static inline void remove_two(tet_set *t, size_t a, size_t b) {
    remove_tet(t, a > b ? a : b);
    remove_tet(t, a > b ? b : a);
}

static inline void flip_2_3(scene *e, tet_set *t) {
    size_t a = draw(e, t->count);
    int i = (int)draw(e, 4);
    uint32_t far = 0, near = t->v[a][i];
    size_t b = across(t, a, i, &far);
    triangle f = facet_at(t->v[a], i);
    if (a == b) return;
    remove_two(t, a, b);
    for (int k = 0; k < 3; k++) add_tet(t, f.v[k], f.v[(k + 1) % 3], near, far);
}

/* Two tetrahedra on a quadrilateral of the hull take its other diagonal. */
static inline void flip_2_2(scene *e, tet_set *t) {
    size_t a = draw(e, t->count);
    int i = (int)draw(e, 4), k = (int)draw(e, 3);
    uint32_t far = 0, near = t->v[a][i];
    size_t b = across(t, a, i, &far);
    triangle f = facet_at(t->v[a], i);
    if (a == b) return;
    remove_two(t, a, b);
    add_tet(t, near, far, f.v[k], f.v[(k + 1) % 3]);
    add_tet(t, near, far, f.v[k], f.v[(k + 2) % 3]);
}

/* Three or four tetrahedra round an edge become two or four others. */
static inline void flip_edge(scene *e, tet_set *t) {
    const uint32_t *v = t->v[draw(e, t->count)];
    size_t i = draw(e, 4), j = (i + 1 + draw(e, 3)) % 4, round[5], n = 0;
    uint32_t p = v[i], q = v[j], link[4][2];
    for (size_t a = 0; a < t->count && n < 5; a++)
        if (tet_has(t->v[a], p) && tet_has(t->v[a], q)) round[n++] = a;
    if (p == q || (n != 3 && n != 4)) return;
    for (size_t a = 0; a < n; a++)
        for (int k = 0, m = 0; k < 4 && m < 2; k++)
            if (t->v[round[a]][k] != p && t->v[round[a]][k] != q) link[a][m++] = t->v[round[a]][k];
    uint32_t ring[4] = {link[0][0], link[0][1], 0, 0};
    for (size_t a = 1; a < n; a++)
        for (int m = 0; m < 2; m++) {
            if (link[a][m] == ring[1]) ring[2] = link[a][1 - m];
            if (n == 4 && link[a][m] == ring[0]) ring[3] = link[a][1 - m];
        }
    for (size_t a = n; a-- > 0;) remove_tet(t, round[a]);
    for (int m = 0; m < 2; m++) {
        add_tet(t, ring[0], ring[1], ring[2], m ? p : q);
        if (n == 4) add_tet(t, ring[0], ring[2], ring[3], m ? p : q);
    }
}

static inline void flip_1_4(scene *e, tet_set *t) {
    size_t a = draw(e, t->count);
    uint32_t v[4], x = draw_point(e);
    memcpy(v, t->v[a], sizeof v);
    remove_tet(t, a);
    for (int i = 0; i < 4; i++) add_tet(t, v[(i + 1) % 4], v[(i + 2) % 4], v[(i + 3) % 4], x);
}

static inline void flip_4_1(scene *e, tet_set *t) {
    uint32_t p = t->v[draw(e, t->count)][draw(e, 4)], link[4];
    size_t round[5], n = 0, found = 0;
    for (size_t a = 0; a < t->count && n < 5; a++)
        if (tet_has(t->v[a], p)) round[n++] = a;
    if (n != 4) return;
    for (uint32_t q = 0; q < e->s.n && found < 4; q++)
        for (size_t a = 0; a < n; a++)
            if (q != p && tet_has(t->v[round[a]], q)) {
                link[found++] = q;
                break;
            }
    if (found < 4) return;
    for (size_t a = n; a-- > 0;) remove_tet(t, round[a]);
    add_tet(t, link[0], link[1], link[2], link[3]);
}

/* --- symmetries --- */

/* A map of space that permutes and reflects the axes and takes one point to another. */
typedef struct {
    int axis[3], sign[3];
    uint32_t from, to;
} isometry;

static inline isometry draw_isometry(scene *e) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    isometry g = {.from = draw_point(e), .to = draw_point(e)};
    size_t o = draw(e, 6);
    for (int k = 0; k < 3; k++) g.axis[k] = order[o][k], g.sign[k] = draw(e, 2) ? 1 : -1;
    return g;
}

/* The image of a point, which must be one of the points; else the point itself. */
static inline uint32_t image_of(const scene *e, const isometry *g, uint32_t p) {
    if (p >= e->s.n) return p;
    offset d = from_to(&e->s.p[g->from], &e->s.p[p]);
    site at = e->s.p[g->to];
    for (int k = 0; k < 3; k++) at.x[k] += g->sign[k] * d.x[g->axis[k]];
    for (uint32_t q = 0; q < e->s.n; q++)
        if (compare_sites(&e->s.p[q], &at) == 0) return q;
    return p;
}

/* Moves each tetrahedron with probability 1 / one_in. */
static inline void move_some(scene *e, tet_set *t, size_t one_in) {
    isometry g = draw_isometry(e);
    for (size_t a = 0; a < t->count; a++) {
        if (draw(e, one_in)) continue;
        for (int i = 0; i < 4; i++) t->v[a][i] = image_of(e, &g, t->v[a][i]);
    }
}

static inline void move_one(scene *e, tet_set *t) {
    isometry g = draw_isometry(e);
    uint32_t *v = t->v[draw(e, t->count)];
    for (int i = 0; i < 4; i++) v[i] = image_of(e, &g, v[i]);
}

static inline void move_part(scene *e, tet_set *t) {
    move_some(e, t, 1 + draw(e, t->count));
}

/* --- two triangulations --- */

/* Whether w's vertices are all on the sphere of v. */
static inline bool same_sphere(const scene *e, const uint32_t *v, const uint32_t *w) {
    for (int i = 0; i < 4; i++)
        if (v[i] >= e->s.n || w[i] >= e->s.n || inside_sphere(&e->s, v, &e->s.p[w[i]])) return false;
    return true;
}

/* The cell of a sphere is triangulated as in another triangulation, or in a random way by candidates. */
static inline void replace_cell(scene *e, tet_set *t) {
    const tet_set *other = &e->right[draw(e, ALTERNATIVES)];
    uint32_t v[4];
    memcpy(v, t->v[draw(e, t->count)], sizeof v);
    for (int i = 0; i < 4; i++)
        if (v[i] >= e->s.n) return;
    if (!volume_at(&e->s, v)) return;
    for (size_t a = t->count; a-- > 0;)
        if (same_sphere(e, v, t->v[a])) remove_tet(t, a);
    for (size_t a = 0; a < other->count; a++) {
        const uint32_t *w = other->v[a];
        if (same_sphere(e, v, w)) add_tet(t, w[0], w[1], w[2], w[3]);
    }
}

static inline void join_part(scene *e, tet_set *t) {
    const tet_set *other = &e->right[draw(e, ALTERNATIVES)];
    size_t one_in = 1 + draw(e, 4);
    for (size_t a = 0; a < other->count; a++)
        if (draw(e, one_in) == 0) add_tet(t, other->v[a][0], other->v[a][1], other->v[a][2], other->v[a][3]);
}

/* The whole set once more, over coincident points where there are any. */
static inline void join_twin(scene *e, tet_set *t) {
    size_t n = t->count;
    for (size_t a = 0; a < n; a++) {
        uint32_t v[4];
        for (int i = 0; i < 4; i++) v[i] = t->v[a][i] < e->s.n ? twin_of(e, t->v[a][i]) : t->v[a][i];
        add_tet(t, v[0], v[1], v[2], v[3]);
    }
}

static inline void take_near_miss(scene *e, tet_set *t) {
    *t = e->near_miss[draw(e, NEAR_MISSES)];
}

/* --- closed sets of empty spheres, which only their overlaps and gaps give away --- */

static inline size_t times_used(const tet_set *t, const triangle *f) {
    size_t n = 0;
    for (size_t i = 0; i < 4 * t->count; i++) {
        triangle g = facet_at(t->v[i / 4], (int)(i % 4));
        n += !compare_triangles(f, &g);
    }
    return n;
}

/* Whether a candidate fits on a facet: it has the facet, and none of its facets twice before. */
static inline bool fits(const tet_set *t, const uint32_t *c, const triangle *f) {
    bool has = false;
    for (int i = 0; i < 4; i++) {
        triangle g = facet_at(c, i);
        has |= !compare_triangles(f, &g);
        if (times_used(t, &g) > 1) return false;
    }
    return has;
}

static inline bool close_facet(scene *e, tet_set *t, const triangle *f) {
    size_t from = draw(e, e->num_candidates);
    for (size_t i = 0; i < e->num_candidates; i++) {
        const uint32_t *c = e->candidate[(from + i) % e->num_candidates];
        if (!tet_has(c, f->v[0]) || !tet_has(c, f->v[1]) || !tet_has(c, f->v[2]) || !fits(t, c, f)) continue;
        add_tet(t, c[0], c[1], c[2], c[3]);
        return true;
    }
    return false;
}

/* Opens the set somewhere, then adds candidates until every facet is closed or on the hull, if that succeeds. */
static inline void regrow(scene *e, tet_set *t) {
    if (!e->num_candidates) return;
    size_t keep = draw(e, t->count + 1), most = t->count + 12;
    shuffle_tets(e, t);
    t->count = keep;
    add_candidate(e, t);
    for (size_t i = 0; i < 4 * t->count && t->count < most && t->count < BRUTE_TETS; i++) {
        triangle f = facet_at(t->v[i / 4], (int)(i % 4));
        if (f.v[2] >= e->s.n || times_used(t, &f) != 1 || supporting_side(&e->s, f.v[0], f.v[1], f.v[2])) continue;
        if (!close_facet(e, t, &f)) return;
    }
}

/* Tetrahedra round an axis in steps that meet every point of the ring, and wind round the axis once or five times. */
static inline void wind(scene *e, tet_set *t) {
    static const uint32_t step[4] = {1, 5, 7, 11};
    uint32_t by = step[draw(e, 4)], from = 0;
    if (!e->ring) return;
    t->count = 0;
    do {
        uint32_t to = (from + by) % e->ring;
        add_tet(t, 0, 1, 2 + from, 2 + to);
        from = to;
    } while (from != 0);
}

static inline bool is_open(const scene *e, const tet_set *t, triangle f) {
    return times_used(t, &f) == 1 && !supporting_side(&e->s, f.v[0], f.v[1], f.v[2]);
}

/* A flat tetrahedron between two different pairs of open facets of one quadrilateral. */
static inline void add_flat(scene *e, tet_set *t) {
    size_t from = draw(e, 4 * t->count);
    for (size_t i = 0; i < 4 * t->count; i++) {
        size_t h = (from + i) % (4 * t->count);
        triangle f = facet_at(t->v[h / 4], (int)(h % 4));
        if (f.v[2] >= e->s.n || !is_open(e, t, f)) continue;
        for (uint32_t d = 0; d < e->s.n; d++) {
            uint32_t v[4] = {f.v[0], f.v[1], f.v[2], d};
            bool fit = d != f.v[0] && d != f.v[1] && d != f.v[2] && !volume_at(&e->s, v);
            for (int k = 0; k < 3 && fit; k++) fit = is_open(e, t, facet_at(v, k));
            if (!fit) continue;
            add_tet(t, v[0], v[1], v[2], v[3]);
            return;
        }
    }
}

static inline void replace_cell_and_add_flat(scene *e, tet_set *t) {
    replace_cell(e, t);
    add_flat(e, t);
    add_flat(e, t);
}

/* A flat tetrahedron on the hull, on one facet at least. */
static inline void add_flat_on_hull(scene *e, tet_set *t) {
    size_t from = draw(e, 4 * t->count);
    for (size_t i = 0; i < 4 * t->count; i++) {
        size_t h = (from + i) % (4 * t->count);
        triangle f = facet_at(t->v[h / 4], (int)(h % 4));
        if (f.v[2] >= e->s.n || times_used(t, &f) != 1) continue;
        for (uint32_t d = 0; d < e->s.n; d++) {
            uint32_t v[4] = {f.v[0], f.v[1], f.v[2], d};
            triangle g = facet_at(v, (int)draw(e, 3));
            if (tet_has(t->v[h / 4], d) || volume_at(&e->s, v) || times_used(t, &g) != 1) continue;
            size_t odd = draw(e, 2);
            add_tet(t, v[odd], v[1 - odd], v[2], v[3]);
            return;
        }
    }
}

typedef void (*mutation)(scene *, tet_set *);

static const mutation MUTATIONS[] = {swap_in_tet,
                                     replace_vertex,
                                     exchange_vertices,
                                     rename_everywhere,
                                     rename_to_twin,
                                     point_out_of_range,
                                     drop_tet,
                                     repeat_tet,
                                     overwrite_tet,
                                     add_candidate,
                                     drop_star,
                                     shuffle_tets,
                                     flip_2_3,
                                     flip_2_2,
                                     flip_edge,
                                     flip_1_4,
                                     flip_4_1,
                                     move_one,
                                     move_part,
                                     replace_cell,
                                     join_part,
                                     join_twin,
                                     regrow,
                                     take_near_miss,
                                     wind,
                                     add_flat,
                                     replace_cell_and_add_flat,
                                     add_flat_on_hull};

static inline void mutate(scene *e, tet_set *t) {
    MUTATIONS[draw(e, sizeof MUTATIONS / sizeof *MUTATIONS)](e, t);
}

#endif
