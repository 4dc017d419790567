/* The poles of samples.
 *
 * The first pass over the tetrahedra offers each circumcentre to its four vertices as the farther pole. The second pass
 * offers it as the pole on the other side, where the vectors to the two poles make an obtuse angle. Among equal
 * distances the position of the centre decides, then the positions of the tetrahedron's vertices. So the best
 * tetrahedron is the greatest in a total order, and the order of the offers does not matter.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 2.8. */
#include "base/context.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "dual/farthest.h"
#include "dual/poles.h"
#include "dual/position_order.h"
#include "order/hilbert.h"
#include "predicates/circumcentre.h"
#include "predicates/predicates.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* --- the shape of a cell --- */

/* The radius of a Voronoi cell inside the co-cone of its sample.
 *
 * Every facet of the Delaunay triangulation is dual to a Voronoi edge, which belongs to the cells of the facet's three
 * vertices. A quadratic equation cuts the edge with the cone about the direction to the sample's farther pole. The
 * distance from the sample is convex along the edge, so an end of a piece in the co-cone is the farthest point of it.
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. IJCGA 2002 (the
 *           co-cone).
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, corollary 23: on an r-sample the radius is at
 *           most 1.3 r / (1 - r) times the local feature size.
 * Differs from the paper: the distance to the nearer pole stands for the local feature size.
 */

/** Voronoi cells, represented by the dual tetrahedra. The struct owns nothing. */
typedef struct {
    const brio_tetrahedron *tet; /* finite tetrahedra come first */
    size_t num_finite;
    const double *centre; /* #finite by 3: circumcentres; NaN in the first coordinate where a double cannot hold one */
    const double *points;
    size_t num_samples;      /* the first num_samples points are the samples */
    const uint32_t *pole_of; /* #samples by 2: the tetrahedra of the farther and the nearer pole, or UINT32_MAX */
} brio_shaped_cells;

enum { SAMPLES_A_THREAD = 1 << 13, EDGES_OF_TETRAHEDRA_A_THREAD = 1 << 13 };

static const double SQUARED_SINE = 0.14644660940672624; /* derived: sin(pi / 8)^2 */

static void subtract(const double *a, const double *b, double *difference) {
    for (int k = 0; k < 3; k++) difference[k] = a[k] - b[k];
}

/* A Voronoi edge relative to a sample: the ends a and b, and the vector n from the sample to its farther pole. */
typedef struct {
    double a[3], b[3], n[3];
} seen_edge;

/* Returns whether both ends are in one of the two cones outside the co-cone. That cone is convex, so it holds the whole
 * edge. Most edges pass this test. */
static inline bool is_in_one_cone(const seen_edge *e) {
    double an = brio_dot(e->a, e->n), bn = brio_dot(e->b, e->n), limit = SQUARED_SINE * brio_dot(e->n, e->n);
    return an * bn > 0 && an * an > limit * brio_dot(e->a, e->a) && bn * bn > limit * brio_dot(e->b, e->b);
}

/* Returns the largest squared length of a point of the edge in the co-cone, or 0 when no point is in the co-cone. */
static double reach_in_cocone(const seen_edge *e) {
    const double *a = e->a, *b = e->b, *n = e->n;
    double d[3], limit = SQUARED_SINE * brio_dot(n, n), most = 0;
    subtract(b, a, d);
    /* x is in the co-cone when (x.n)^2 - limit x.x <= 0; for x = a + t d the left side is (q2 t + 2 q1) t + q0 */
    double an = brio_dot(a, n), dn = brio_dot(d, n), aa = brio_dot(a, a), ad = brio_dot(a, d), dd = brio_dot(d, d);
    double q2 = dn * dn - limit * dd, q1 = an * dn - limit * ad, q0 = an * an - limit * aa;
    if (q0 <= 0) most = aa;
    if (q2 + 2 * q1 + q0 <= 0) most = fmax(most, brio_dot(b, b));
    double discriminant = q1 * q1 - q2 * q0;
    if (discriminant < 0) return most;
    double sum = -(q1 + copysign(sqrt(discriminant), q1)), root[2] = {sum / q2, q0 / sum};
    for (int i = 0; i < 2; i++)
        if (root[i] > 0 && root[i] < 1) most = fmax(most, aa + root[i] * (2 * ad + root[i] * dd));
    return most;
}

/* Raises *most to value; other threads may raise *most meanwhile. Relaxed order is enough: no other data depends on
 * *most, and its final value is read after the parallel loop. */
static void raise_to(double *most, double value) {
    double now;
    __atomic_load(most, &now, __ATOMIC_RELAXED);
    while (now < value && !__atomic_compare_exchange(most, &now, &value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

/* Raises square[s] to the largest squared distance from sample s to a point of the edge in the co-cone.
 * reach  at least the squared distance from s to the farther end of the edge, and barely more. */
static inline void offer_edge(const brio_shaped_cells *c, uint32_t s, const double *from, const double *to,
                              double reach, double *square) {
    double so_far;
    if (s >= c->num_samples || c->pole_of[2 * (size_t)s] == UINT32_MAX) return;
    __atomic_load(&square[s], &so_far, __ATOMIC_RELAXED);
    if (reach <= so_far) return;
    const double *sample = c->points + 3 * (size_t)s;
    seen_edge e;
    subtract(from, sample, e.a);
    subtract(to, sample, e.b);
    subtract(c->centre + 3 * (size_t)c->pole_of[2 * (size_t)s], sample, e.n);
    if (!is_in_one_cone(&e)) raise_to(&square[s], reach_in_cocone(&e));
}

/* Offers the Voronoi edges of tetrahedron t to the samples of its facets. Each Voronoi edge is offered once, by the
 * lower of its two tetrahedra. The three samples of a facet have equal distances to each end of the dual edge. */
static void offer_edges(const brio_shaped_cells *c, size_t t, double *square) {
    static const double MORE = 1 + 1e-9; /* chosen: exceeds the relative rounding error of a squared distance */
    assert(t < c->num_finite);
    const double *from = c->centre + 3 * t;
    if (isnan(from[0])) return;
    double own = brio_square_distance(from, c->points + 3 * (size_t)c->tet[t].vertex[0]);
    for (int i = 0; i < 4; i++) {
        size_t u = c->tet[t].mate[i] / 4;
        const double *to = c->centre + 3 * u;
        if (u < t || u >= c->num_finite || isnan(to[0])) continue;
        double other = brio_square_distance(to, c->points + 3 * (size_t)c->tet[t].vertex[(i + 1) % 4]);
        double reach = MORE * fmax(own, other);
        for (int k = 1; k < 4; k++) offer_edge(c, c->tet[t].vertex[(i + k) % 4], from, to, reach, square);
    }
}

static double nearer_pole_square(const brio_shaped_cells *c, size_t s) {
    uint32_t nearer = c->pole_of[2 * s + 1];
    if (nearer == UINT32_MAX) return INFINITY;
    return brio_square_distance(c->centre + 3 * (size_t)nearer, c->points + 3 * s);
}

/* --- the loops --- */

typedef struct {
    const brio_shaped_cells *c;
    double most, *shape;
} measurement;

/* Sets shape[s] to a squared radius for now: the radius at which the shape is `most`. */
static void set_least_radii(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t s = begin; s < end; s++) m->shape[s] = nearer_pole_square(m->c, s) / (m->most * m->most);
}

static void raise_radii(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t t = begin; t < end; t++) offer_edges(m->c, t, m->shape);
}

static void divide_by_radii(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t s = begin; s < end; s++) {
        double square = m->shape[s];
        m->shape[s] = square > 0 && square < INFINITY ? sqrt(nearer_pole_square(m->c, s) / square) : m->most;
    }
}

/* Writes shape[s], #samples: the distance from sample s to its nearer pole, divided by the radius of the cell of s in
 * the co-cone. The co-cone holds the directions within pi / 8 of the plane through s normal to the direction to the
 * farther pole. The radius is the largest distance from s to a point on an edge of the cell in the co-cone. Long, thin
 * cells have large shapes. Writes about `most` for larger shapes and for samples without a nearer pole. Relies on
 * offer_edge skipping the edges within the radius at which the shape is `most`: such edges cannot change the result. */
static brio_status cell_shapes(brio_context *ctx, const brio_shaped_cells *c, double most, double *shape) {
    brio_status status = BRIO_OK;
    assert(most > 0);
    measurement m = {c, most, shape};
    int threads = brio_threads(ctx, c->num_samples, SAMPLES_A_THREAD);
    BRIO_TRY(brio_for(ctx, threads, c->num_samples, set_least_radii, &m));
    BRIO_TRY(
        brio_for(ctx, brio_threads(ctx, c->num_finite, EDGES_OF_TETRAHEDRA_A_THREAD), c->num_finite, raise_radii, &m));
    status = brio_for(ctx, threads, c->num_samples, divide_by_radii, &m);
done:
    return status;
}

/* Returns whether a cell of this shape is bad for a surface sampled with density r: whether its radius in the co-cone
 *  exceeds 1.3 r / (1 - r) times the distance to the nearer pole. */
static bool cell_is_bad(double shape, double density) {
    assert(0 < density && density < 1);
    return shape < (1 - density) / (1.3 * density);
}

/* --- poles --- */

enum { NO_TET = UINT32_MAX, AHEAD = 12, TETRAHEDRA_A_THREAD = 1 << 14, POLES_A_THREAD = 1 << 14 };

typedef struct {
    const brio_tetrahedron *tet;
    const double *points;
    size_t num_tets, num_samples;
    double *centre;     /* #tets by 3: circumcentres; NaN where doubles cannot hold one */
    uint32_t *best;     /* #samples by 2: the tetrahedron of the pole on each side */
    uint64_t *farthest; /* #samples by 2: the keys of the best tetrahedra (farthest.h); NULL after find_best */
    bool alone;         /* only one thread makes offers */
} finder;

static const double *centre_of(const finder *f, uint32_t tet) {
    assert(tet < f->num_tets);
    return f->centre + 3 * (size_t)tet;
}

/* Finds the centres of the batches [begin, end) of BRIO_CENTRE_BATCH tetrahedra. */
static void find_centres(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t tet = begin * BRIO_CENTRE_BATCH; tet < end * BRIO_CENTRE_BATCH && tet < f->num_tets;
         tet += BRIO_CENTRE_BATCH) {
        uint32_t vertex[BRIO_CENTRE_BATCH][4];
        size_t left = f->num_tets - tet, count = left < BRIO_CENTRE_BATCH ? left : BRIO_CENTRE_BATCH;
        for (size_t n = 0; n < count; n++) memcpy(vertex[n], f->tet[tet + n].vertex, sizeof *vertex);
        brio_centres(&(brio_centre_batch){f->points, NULL, (const uint32_t(*)[4])vertex, count}, f->centre + 3 * tet,
                     NULL);
    }
}

static brio_status find_all_centres(brio_context *ctx, finder *f) {
    size_t batches = (f->num_tets + BRIO_CENTRE_BATCH - 1) / BRIO_CENTRE_BATCH;
    return brio_for(ctx, brio_threads(ctx, f->num_tets, TETRAHEDRA_A_THREAD), batches, find_centres, f);
}

static int compare_tets(const finder *f, uint32_t s, uint32_t t) {
    return brio_compare_by_position(f->points, f->tet, f->centre, s, t);
}

static bool is_farther(const void *user, uint32_t tet, uint32_t than, uint32_t sample) {
    const finder *f = user;
    const double *s = f->points + 3 * (size_t)sample;
    double distance = brio_square_distance(centre_of(f, tet), s), other = brio_square_distance(centre_of(f, than), s);
    return distance > other || (distance == other && compare_tets(f, tet, than) > 0);
}

static bool opposite(const finder *f, uint32_t first, uint32_t tet, const double *s) {
    const double *p = centre_of(f, first), *q = centre_of(f, tet);
    return (p[0] - s[0]) * (q[0] - s[0]) + (p[1] - s[1]) * (q[1] - s[1]) + (p[2] - s[2]) * (q[2] - s[2]) < 0;
}

/* Prefetches the samples that tetrahedron `tet` will offer its centre to: consecutive tetrahedra may read far
 * samples. */
static inline void fetch_samples(const finder *f, size_t tet) {
    for (int i = 0; i < 4; i++) {
        size_t v = f->tet[tet].vertex[i];
        if (v >= f->num_samples) continue;
        __builtin_prefetch(f->points + 3 * v);
        __builtin_prefetch(f->farthest + 2 * v, 1);
    }
}

static inline void offer_to_samples(const finder *f, size_t tet, size_t side) {
    if (tet + AHEAD < f->num_tets) fetch_samples(f, tet + AHEAD);
    if (isnan(f->centre[3 * tet])) return;
    for (int i = 0; i < 4; i++) {
        size_t v = f->tet[tet].vertex[i];
        if (v >= f->num_samples) continue;
        const double *s = f->points + 3 * v;
        uint64_t key = brio_farthest_key(brio_square_distance(f->centre + 3 * tet, s), (uint32_t)tet);
        uint64_t *place = &f->farthest[2 * v + side];
        if (!brio_may_be_farthest(key, place)) continue;
        if (side == 1 && !opposite(f, brio_farthest_tet(place[-1]), (uint32_t)tet, s)) continue;
        brio_offer_farthest(place, key, f->alone, is_farther, f, (uint32_t)v);
    }
}

static void offer_as_farther(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) offer_to_samples(user, tet, 0);
}

static void offer_on_other_side(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) offer_to_samples(user, tet, 1);
}

static void discard_bad(finder *f, const brio_pole_filter *filter, const double *shape, size_t *bad_cells) {
    for (size_t s = 0; s < f->num_samples; s++) {
        if (!cell_is_bad(shape[s], filter->sampling_density)) continue;
        f->best[2 * s + 1] = NO_TET;
        if (filter->both) f->best[2 * s] = NO_TET;
        ++*bad_cells;
    }
}

static brio_status look_at_shapes(brio_context *ctx, finder *f, const brio_pole_filter *filter, brio_poles *out) {
    brio_shaped_cells cells = {f->tet, f->num_tets, f->centre, f->points, f->num_samples, f->best};
    double r = filter->sampling_density, most = filter->shapes;
    if (r > 0) most = fmax(most, (1 - r) / (1.3 * r));
    if (!(most > 0)) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->shape, f->num_samples));
    BRIO_FORWARD(
        cell_shapes(ctx, &cells, 1.01 * most, out->shape)); /* 1.01, chosen: the cut exceeds `most` despite rounding */
    if (r > 0) discard_bad(f, filter, out->shape, &out->bad_cells);
    return BRIO_OK;
}

/* --- from tetrahedra to numbered poles --- */

static int compare_for_sort(uint32_t s, uint32_t t, const void *user) {
    return compare_tets(user, s, t);
}

/* The poles in a list of tetrahedra, and the arrays to fill for the poles. */
typedef struct {
    const finder *f;
    const uint32_t *list; /* #poles: tetrahedra */
    double *centre;       /* #poles by 3 */
    brio_poles *poles;
    uint32_t *number; /* #tets: the number of the pole; unset for tetrahedra that are not poles */
} list_of_poles;

static void copy_centres(void *user, size_t begin, size_t end, int thread) {
    const list_of_poles *l = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) memcpy(l->centre + 3 * p, centre_of(l->f, l->list[p]), 3 * sizeof *l->centre);
}

/* Sorts poles along a Hilbert curve, so that neighbours in space are neighbours in memory. Sorts poles with equal keys
 * by position. */
static brio_status sort_poles(brio_context *ctx, const finder *f, uint32_t *list, size_t count) {
    enum { BITS = 16 };
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    list_of_poles l = {.f = f, .list = list};
    BRIO_TRY(BRIO_ALLOC(ctx, keys, count));
    BRIO_TRY(BRIO_ALLOC(ctx, l.centre, 3 * count));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, count, POLES_A_THREAD), count, copy_centres, &l));
    BRIO_TRY(brio_hilbert_keys(ctx, l.centre, count, BITS, keys));
    BRIO_TRY(brio_radix_sort(ctx, keys, list, count, 3 * BITS));
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && keys[end] == keys[begin];) end++;
        brio_sort_indices(list + begin, end - begin, compare_for_sort, f);
    }
done:
    brio_release(ctx, keys);
    brio_release(ctx, l.centre);
    return status;
}

static brio_status list_poles(brio_context *ctx, const finder *f, uint32_t **list, size_t *count) {
    brio_status status = BRIO_OK;
    uint8_t *is_pole = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, is_pole, f->num_tets));
    *count = 0;
    for (size_t i = 0; i < 2 * f->num_samples; i++)
        if (f->best[i] != NO_TET) *count += !is_pole[f->best[i]], is_pole[f->best[i]] = 1;
    BRIO_TRY(BRIO_ALLOC(ctx, *list, *count));
    for (size_t tet = 0, n = 0; tet < f->num_tets; tet++)
        if (is_pole[tet]) (*list)[n++] = (uint32_t)tet;
    BRIO_TRY(sort_poles(ctx, f, *list, *count));
done:
    brio_release(ctx, is_pole);
    return status;
}

static void fill_poles(void *user, size_t begin, size_t end, int thread) {
    const list_of_poles *l = user;
    const finder *f = l->f;
    const uint32_t *list = l->list;
    brio_poles *poles = l->poles;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        if (p + AHEAD < poles->count) {
            __builtin_prefetch(&f->tet[list[p + AHEAD]]);
            __builtin_prefetch(centre_of(f, list[p + AHEAD]));
        }
        const uint32_t *v = f->tet[list[p]].vertex;
        const double *first = f->points + 3 * (size_t)v[0];
        poles->bounding[p] = v[0] >= f->num_samples;
        for (int i = 1; i < 4; i++) {
            const double *x = f->points + 3 * (size_t)v[i];
            if (brio_lexicographic(x, first) < 0) first = x;
            poles->bounding[p] |= v[i] >= f->num_samples;
        }
        memcpy(poles->centre + 3 * p, centre_of(f, list[p]), 3 * sizeof *poles->centre);
        memcpy(poles->touched + 4 * p, v, 4 * sizeof *v);
        poles->square[p] = brio_square_distance(poles->centre + 3 * p, first);
    }
}

static void number_part(void *user, size_t begin, size_t end, int thread) {
    const list_of_poles *l = user;
    (void)thread;
    assert(l->list[end - 1] < l->f->num_tets);
    for (size_t p = begin; p < end; p++) l->number[l->list[p]] = (uint32_t)p;
}

/* Replaces the tetrahedra in f->best[begin .. end) by the numbers of the poles. */
static void rename_part(void *user, size_t begin, size_t end, int thread) {
    const list_of_poles *l = user;
    uint32_t *best = l->f->best;
    (void)thread;
    for (size_t i = begin; i < end; i++) best[i] = best[i] == NO_TET ? BRIO_NO_POLE : l->number[best[i]];
}

/* Numbers the poles and replaces the tetrahedra in f->best by these numbers. */
static brio_status number_poles(brio_context *ctx, finder *f, brio_poles *poles) {
    brio_status status = BRIO_OK;
    uint32_t *list = NULL;
    list_of_poles l = {.f = f, .poles = poles};
    BRIO_TRY(list_poles(ctx, f, &list, &poles->count));
    BRIO_TRY(BRIO_ALLOC(ctx, poles->centre, 3 * poles->count));
    BRIO_TRY(BRIO_ALLOC(ctx, poles->square, poles->count));
    BRIO_TRY(BRIO_ALLOC(ctx, poles->touched, 4 * poles->count));
    BRIO_TRY(BRIO_ALLOC(ctx, poles->bounding, poles->count));
    l.list = list;
    int threads = brio_threads(ctx, poles->count, POLES_A_THREAD);
    BRIO_TRY(brio_for(ctx, threads, poles->count, fill_poles, &l));
    BRIO_TRY(BRIO_ALLOC(ctx, l.number, f->num_tets));
    BRIO_TRY(brio_for(ctx, threads, poles->count, number_part, &l));
    BRIO_TRY(brio_for(ctx, threads, 2 * f->num_samples, rename_part, &l));
done:
    brio_release(ctx, list);
    brio_release(ctx, l.number);
    return status;
}

/* Fills f->best: offers the centre of each tetrahedron to its samples, as the farther pole and on the other side. */
static brio_status find_best(brio_context *ctx, finder *f) {
    brio_status status = BRIO_OK;
    size_t places = 2 * f->num_samples;
    int threads = brio_threads(ctx, f->num_tets, TETRAHEDRA_A_THREAD);
    BRIO_TRY(BRIO_ALLOC(ctx, f->farthest, places));
    for (size_t i = 0; i < places; i++) f->farthest[i] = BRIO_NO_FARTHEST;
    f->alone = threads == 1;
    BRIO_TRY(brio_for(ctx, threads, f->num_tets, offer_as_farther, f));
    BRIO_TRY(brio_for(ctx, threads, f->num_tets, offer_on_other_side, f));
    BRIO_TRY(BRIO_ALLOC(ctx, f->best, places));
    for (size_t i = 0; i < places; i++) f->best[i] = brio_farthest_tet(f->farthest[i]);
done:
    brio_release(ctx, f->farthest);
    f->farthest = NULL;
    return status;
}

brio_status brio_poles_find(brio_context *ctx, const brio_triangulation *t, const double *points, size_t num_samples,
                            const brio_pole_filter *filter, brio_poles *out) {
    brio_status status = BRIO_OK;
    finder f = {.tet = brio_triangulation_tetrahedra(t),
                .points = points,
                .num_tets = brio_triangulation_stats(t)->tetrahedra,
                .num_samples = num_samples};
    *out = (brio_poles){0};
    BRIO_TRY(BRIO_ALLOC(ctx, f.centre, 3 * f.num_tets));
    BRIO_TRY(find_all_centres(ctx, &f));
    BRIO_TRY(brio_progress(ctx, "poles", 0.5));
    BRIO_TRY(find_best(ctx, &f));
    BRIO_TRY(look_at_shapes(ctx, &f, filter, out));
    BRIO_TRY(number_poles(ctx, &f, out));
    out->of_sample = f.best;
    f.best = NULL;
done:
    brio_release(ctx, f.centre);
    brio_release(ctx, f.best);
    if (status != BRIO_OK) brio_poles_free(ctx, out);
    return status;
}

void brio_poles_free(brio_context *ctx, brio_poles *poles) {
    brio_release(ctx, poles->centre);
    brio_release(ctx, poles->square);
    brio_release(ctx, poles->touched);
    brio_release(ctx, poles->bounding);
    brio_release(ctx, poles->shape);
    brio_release(ctx, poles->of_sample);
    *poles = (brio_poles){0};
}
