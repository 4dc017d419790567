/* The graph of votes.
 *
 * A sample sees the Voronoi vertices of its cell: those towards its pole are on one side of the surface, those in the
 * opposite direction are on the other side. Which of the two sides is outside is unknown, too. So a wrong guess
 * about one sample does not spread: its tetrahedra have three other samples each.
 *
 * A flat tetrahedron within the surface tells next to nothing, whatever the direction of its Voronoi vertex. A thick
 * one tells much: hence the log-odds by direction and thickness. The four votes of a tetrahedron are counted as
 * independent. The area between the labels decides where nobody votes, and keeps single flat tetrahedra from sticking
 * out. Area costs little where the samples of a facet see its two tetrahedra in opposite directions, so that thin walls
 * do not vanish to save area.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009 (labels of
 *           Delaunay tetrahedra of least energy).
 *           Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999 (the two sides of a cell).
 * Differs from the papers: no lines of sight are known. Samples are unknowns, too. */
#include "reconstruct/labeled_delaunay/vote_graph.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/vector.h"
#include "reconstruct/cocone/triangle.h"
#include "reconstruct/labeled_delaunay/vote_weight.h"
#include <math.h>
#include <stdlib.h>

/* All chosen. */
enum { TETS_A_THREAD = 1 << 11, SAMPLES_A_THREAD = 1 << 12, SLICE = 1 << 17, STARS = 1 << 11 };

/* In log-odds, of a facet of the area of an equilateral triangle whose sides are one spacing: AREA is its weight in any
 * case, DOUBT is added if its samples see both of its tetrahedra in one direction. Larger facets weigh more, up to
 * MOST_AREA times as much. All chosen on generated solids. */
static const double AREA = 1, DOUBT = 6, MOST_AREA = 3;

typedef struct {
    brio_vote_graph *g;
    const brio_pole_vectors *dual;
    const double *spacing;
    double noise;
} builder;

/* Returns the number of samples of a tetrahedron: an infinite one has the infinite vertex in slot 3. */
static int num_samples(const brio_pole_vectors *v, size_t tet) {
    return tet < v->num_finite ? 4 : 3;
}

static const double *corner_of(const brio_pole_vectors *v, size_t tet, int slot) {
    return v->points + 3 * (size_t)v->t.tet[tet].vertex[slot];
}

/* Returns the inradius: three times the volume by the area. */
static double inradius(const brio_pole_vectors *v, size_t tet) {
    double u[3][3], n[3], area = 0;
    const double *o = corner_of(v, tet, 0);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) u[i][k] = corner_of(v, tet, i + 1)[k] - o[k];
    for (int i = 0; i < 4; i++) {
        const uint8_t *f = BRIO_FACET[i];
        area += brio_triangle_area(corner_of(v, tet, f[0]), corner_of(v, tet, f[1]), corner_of(v, tet, f[2]));
    }
    brio_cross(u[0], u[1], n);
    return area > 0 ? fabs(brio_dot(n, u[2])) / (2 * area) : 0;
}

/* Returns the cosine of the angle between the axis of a sample and the direction to the Voronoi vertex, 0 if the vertex
 * is not known. */
static double cosine_at(const brio_pole_vectors *v, size_t tet, uint32_t p) {
    double to[3], square;
    brio_towards_centre(v, tet, p, to);
    square = brio_dot(to, to);
    return square > 0 && square < INFINITY ? brio_dot(to, v->plane + 4 * (size_t)p) / sqrt(square) : 0;
}

/* Returns the log-odds that the two tetrahedra of a facet have one label. The votes are still cosines. */
static double facet_log_odds(const builder *b, uint32_t facet) {
    const brio_pole_vectors *v = b->dual;
    uint32_t tet = brio_tet_of(facet), other = brio_tet_of(*brio_mate(&v->t, facet));
    const uint8_t *f = BRIO_FACET[brio_slot_of(facet)];
    double spacing = 0, alike = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t p = v->t.tet[tet].vertex[f[k]];
        size_t there = (size_t)brio_slot_of_vertex(v->t.tet[other].vertex, p);
        spacing += b->spacing[p] / 3;
        alike += (double)b->g->vote[tet][f[k]] * (double)b->g->vote[other][there] / 3;
    }
    double unit = sqrt(3) / 4 * spacing * spacing;
    double area = brio_triangle_area(corner_of(v, tet, f[0]), corner_of(v, tet, f[1]), corner_of(v, tet, f[2]));
    return (AREA + DOUBT * (1 + alike) / 2) * (area < MOST_AREA * unit ? area / unit : MOST_AREA);
}

/* Writes the weight of a facet, at both ends. */
static void weigh_facet(const builder *b, uint32_t facet) {
    uint32_t mate = *brio_mate(&b->dual->t, facet);
    float weight = (float)(BRIO_VOTE_UNIT * facet_log_odds(b, facet));
    b->g->facet[brio_tet_of(facet)][brio_slot_of(facet)] = weight;
    b->g->facet[brio_tet_of(mate)][brio_slot_of(mate)] = weight;
}

/* The three steps of building, for parts of the tetrahedra. Votes are cosines at first, between the axis of the sample
 * in a slot and the direction to the Voronoi vertex. */

static void find_cosines(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++)
        for (int i = 0; i < 4; i++) {
            bool there = i < num_samples(b->dual, tet);
            b->g->vote[tet][i] = there ? (float)cosine_at(b->dual, tet, b->dual->t.tet[tet].vertex[i]) : 0;
        }
}

static void weigh_facets(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    const brio_pole_vectors *v = b->dual;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++)
        for (int i = 0; i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            if (tet >= v->num_finite && i < 3)
                b->g->facet[tet][i] = 0;
            else if (facet < *brio_mate(&v->t, facet))
                weigh_facet(b, facet);
        }
}

static void weigh_votes(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    const brio_pole_vectors *v = b->dual;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) {
        double thick = tet < v->num_finite ? inradius(v, tet) : INFINITY;
        for (int i = 0; i < num_samples(v, tet); i++) {
            float *vote = &b->g->vote[tet][i];
            double ratio = thick / b->spacing[v->t.tet[tet].vertex[i]];
            *vote = (float)(BRIO_VOTE_UNIT * brio_vote_log_odds((double)*vote, ratio, b->noise));
        }
    }
}

/* --- stars --- */

brio_status brio_for_tet_slices(const brio_vote_graph *g, brio_tet_slice *slice, const brio_swept *along,
                                brio_part_fn body, void *user) {
    brio_status status = BRIO_OK;
    size_t count = g->dual->t.count, n = g->dual->num_points, most = g->ctx->scratch ? BRIO_SWEEP_STRETCH : SLICE;
    int threads = brio_threads(g->ctx, n, SAMPLES_A_THREAD);
    for (slice->first = 0; slice->first < count; slice->first = slice->end) {
        slice->end = count - slice->first < most ? count : slice->first + most;
        brio_expect_rows(g->ctx, along, slice->end, count - slice->end < most ? count : slice->end + most);
        BRIO_TRY(brio_for_parts(g->ctx, threads, n, body, user));
    }
done:
    return status;
}

typedef struct {
    const builder *b;
    size_t *next; /* #P: how many entries a star has, then where the next one goes */
    brio_tet_slice slice;
} lister;

/* The two steps of listing. */

static void count_entries(void *user, size_t begin, size_t end, int thread) {
    const lister *l = user;
    const brio_pole_vectors *v = l->b->dual;
    (void)thread;
    for (size_t tet = l->slice.first; tet < l->slice.end; tet++)
        for (int i = 0; i < num_samples(v, tet); i++) {
            size_t p = v->t.tet[tet].vertex[i];
            if (p - begin < end - begin) l->next[p]++;
        }
}

static void write_entries(void *user, size_t begin, size_t end, int thread) {
    const lister *l = user;
    const brio_pole_vectors *v = l->b->dual;
    (void)thread;
    for (size_t tet = l->slice.first; tet < l->slice.end; tet++)
        for (int i = 0; i < num_samples(v, tet); i++) {
            size_t p = v->t.tet[tet].vertex[i];
            if (p - begin < end - begin) l->b->g->star[l->next[p]++] = brio_facet_of((uint32_t)tet, i);
        }
}

/* Lists the stars of the samples. */
static brio_status list_stars(const builder *b) {
    brio_status status = BRIO_OK;
    brio_vote_graph *g = b->g;
    lister l = {.b = b};
    size_t n = b->dual->num_points;
    const brio_swept *along = BRIO_ARRAYS(BRIO_READS(b->dual->t.tet));
    BRIO_TRY(BRIO_ALLOC_ZERO(g->ctx, l.next, n));
    BRIO_TRY(brio_for_tet_slices(g, &l.slice, along, count_entries, &l));
    g->first[n] = brio_counts_to_places(l.next, 1, n, 0);
    for (size_t p = 0; p < n; p++) g->first[p] = l.next[p];
    BRIO_TRY(brio_for_tet_slices(g, &l.slice, along, write_entries, &l));
done:
    brio_release(g->ctx, l.next);
    return status;
}

brio_status brio_vote_graph_new(brio_context *ctx, brio_pole_vectors *dual, const double *spacing, double noise,
                                const float *own, brio_vote_graph *out) {
    brio_status status = BRIO_OK;
    size_t size = dual->t.count, hull = size - dual->num_finite;
    builder b = {.g = out, .dual = dual, .spacing = spacing, .noise = noise};
    int threads = brio_threads(ctx, size, TETS_A_THREAD);
    *out = (brio_vote_graph){.ctx = ctx, .dual = dual, .num_free = own ? size : dual->num_finite, .own = own};
    BRIO_TRY(BRIO_ALLOC(ctx, out->vote, size));
    BRIO_TRY(brio_sweep(ctx, threads, size, find_cosines, &b, BRIO_READS(dual->t.tet),
                        BRIO_READS((double(*)[4])dual->centre), BRIO_WRITES(out->vote)));
    brio_pole_vectors_drop(ctx, dual);
    BRIO_TRY(BRIO_ALLOC(ctx, out->facet, size));
    BRIO_TRY(BRIO_ALLOC(ctx, out->first, dual->num_points + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->star, 4 * dual->num_finite + 3 * hull));
    BRIO_TRY(brio_sweep(ctx, threads, size, weigh_facets, &b, BRIO_READS(dual->t.tet), BRIO_READS(out->vote),
                        BRIO_WRITES(out->facet)));
    BRIO_TRY(brio_sweep(ctx, threads, size, weigh_votes, &b, BRIO_READS(dual->t.tet), BRIO_WRITES(out->vote)));
    BRIO_TRY(list_stars(&b));
done:
    return status;
}

void brio_vote_graph_free(brio_vote_graph *g) {
    brio_release(g->ctx, g->vote);
    brio_release(g->ctx, g->facet);
    brio_release(g->ctx, g->first);
    brio_release(g->ctx, g->star);
    *g = (brio_vote_graph){.ctx = g->ctx};
}

/* Returns about where the tetrahedra of a star are: the middle one of them. */
static size_t middle_of_star(const brio_vote_graph *g, size_t p) {
    if (p >= g->dual->num_points || g->first[p] == g->first[p + 1]) return g->dual->num_finite;
    return brio_star_tet(g->star[g->first[p] + (g->first[p + 1] - g->first[p]) / 2]);
}

void brio_expect_stars(const brio_vote_graph *g, size_t sample) {
    size_t n = g->dual->num_points, from = sample + STARS, to = from + STARS < n ? from + STARS : n;
    if (!g->ctx->scratch || sample % STARS != 0 || from >= n) return;
    brio_expect_rows(g->ctx, BRIO_ARRAYS(BRIO_READS(g->star)), g->first[from], g->first[to]);
    brio_expect_rows(g->ctx, BRIO_ARRAYS(BRIO_READS(g->dual->t.tet)), middle_of_star(g, from), middle_of_star(g, to));
}

/* --- sums --- */

typedef struct {
    const brio_vote_graph *g;
    brio_vote_unit unit;
    const uint8_t *label;
    int64_t *outer, *all;
    bool alone; /* one thread does all */
} adder;

static void begin_sums(void *user, size_t begin, size_t end, int thread) {
    const adder *a = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        a->outer[p] = brio_in_vote_units(a->unit, brio_own_vote(a->g, p));
        if (a->all) a->all[p] = llabs(a->outer[p]);
    }
}

static inline void add(int64_t *sum, int64_t more, bool alone) {
    if (alone)
        *sum += more;
    else
        __atomic_fetch_add(sum, more, __ATOMIC_RELAXED);
}

static inline void add_votes_of(const adder *a, size_t begin, size_t end, bool alone, bool both) {
    const brio_pole_vectors *v = a->g->dual;
    const brio_vote_unit unit = a->unit;
    for (size_t tet = begin; tet < end; tet++) {
        const uint32_t *vertex = v->t.tet[tet].vertex;
        const float *vote = a->g->vote[tet];
        bool outer = a->label[tet] == BRIO_LABEL_OUTER;
        for (int i = 0, n = num_samples(v, tet); i < n; i++) {
            int64_t weight = brio_in_vote_units(unit, vote[i]);
            add(&a->outer[vertex[i]], outer ? weight : -weight, alone);
            if (both) add(&a->all[vertex[i]], llabs(weight), alone);
        }
    }
}

static void add_votes(void *user, size_t begin, size_t end, int thread) {
    const adder *a = user;
    (void)thread;
    if (a->all)
        add_votes_of(a, begin, end, a->alone, true);
    else if (a->alone)
        add_votes_of(a, begin, end, true, false);
    else
        add_votes_of(a, begin, end, false, false);
}

brio_status brio_sum_votes(const brio_vote_graph *g, brio_vote_unit unit, const uint8_t *label, int64_t *outer,
                           int64_t *all) {
    size_t n = g->dual->num_points, size = g->dual->t.count;
    int threads = brio_threads(g->ctx, size, TETS_A_THREAD);
    adder a = {g, unit, label, outer, all, threads == 1};
    BRIO_FORWARD(brio_for(g->ctx, brio_threads(g->ctx, n, SAMPLES_A_THREAD), n, begin_sums, &a));
    return brio_sweep(g->ctx, threads, size, add_votes, &a, BRIO_READS(g->dual->t.tet), BRIO_READS(g->vote));
}

/* --- energy --- */

/* Returns a weight in whole numbers: sums have room for 2^33 edges. */
static int64_t whole(float weight) {
    return (int64_t)(0x1p28 * (double)weight + 0.5);
}

/* Sums |weight| over the violated edges of a tetrahedron, those across a facet only to tetrahedra of higher number. */
static int64_t violated_at(const brio_vote_graph *g, const uint8_t *label, uint32_t tet) {
    const brio_tetrahedron *t = &g->dual->t.tet[tet];
    int64_t sum = label[tet] == BRIO_LABEL_INNER ? whole(brio_hull_vote(g, tet)) : 0;
    for (int i = 0; i < 4; i++) {
        uint32_t other = brio_tet_of(t->mate[i]);
        float vote = g->vote[tet][i];
        if (vote != 0 && (label[tet] == label[g->dual->t.count + t->vertex[i]]) == (vote < 0))
            sum += whole(fabsf(vote));
        if (other > tet && label[tet] != label[other]) sum += whole(g->facet[tet][i]);
    }
    return sum;
}

typedef struct {
    const brio_vote_graph *g;
    const uint8_t *label;
    int64_t all;
} energy;

static void sum_tets(void *user, size_t begin, size_t end, int thread) {
    energy *e = user;
    int64_t sum = 0;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) sum += violated_at(e->g, e->label, (uint32_t)tet);
    __atomic_fetch_add(&e->all, sum, __ATOMIC_RELAXED);
}

/* Adds whole numbers, so that the sum does not depend on the threads. */
brio_status brio_vote_energy(const brio_vote_graph *g, const uint8_t *label, double *out) {
    energy e = {.g = g, .label = label};
    size_t size = g->dual->t.count;
    brio_status status = brio_sweep(g->ctx, brio_threads(g->ctx, size, TETS_A_THREAD), size, sum_tets, &e,
                                    BRIO_READS(g->dual->t.tet), BRIO_READS(g->vote), BRIO_READS(g->facet));
    for (size_t p = 0; p < g->dual->num_points && g->own; p++)
        if ((g->own[p] < 0) == (label[size + p] == BRIO_LABEL_OUTER)) e.all += whole(fabsf(g->own[p]));
    *out = 0x1p-28 * (double)e.all;
    return status;
}
