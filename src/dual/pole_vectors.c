/* Voronoi vertices, the direction of each sample's pole, and what lies which way as seen from there.
 *
 * One pass over the tetrahedra computes the centres and offers each to its four samples as the farther pole; another
 * one, with the directions known, tells on which side of its samples each centre lies and offers it as the pole on the
 * other side. The distance of a centre is the same from all four, so it is kept with the tetrahedron; and what is on
 * offer is one word with the distance in its upper half. Samples on the hull have an unbounded cell: the sum of the unit outward normals of their hull facets
 * stands for the direction to the pole. The error bounds of the centres count in favour of the co-cone, so that
 * rounding loses no triangle.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999.
 *           Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000. */
#include "dual/pole_vectors.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "dual/position_order.h"
#include "predicates/circumcentre.h"
#include "predicates/double_double.h"
#include <string.h>

static double square(const double *x) {
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

/* Makes a vector a unit one; a zero or infinite one becomes zero. Scaled first, so that nothing under- or overflows. */
static void make_unit(double *x) {
    double most = 0;
    for (int k = 0; k < 3; k++) most = fabs(x[k]) > most ? fabs(x[k]) : most;
    double scale = most > 0 && most < INFINITY ? 1 / most : 0;
    if (!(scale < INFINITY)) scale = 0;
    for (int k = 0; k < 3; k++) x[k] *= scale;
    double length = sqrt(square(x));
    for (int k = 0; k < 3 && length > 0; k++) x[k] /= length;
}

/* The unit normal of a hull facet, away from the points. */
static void outward_normal(const brio_pole_vectors *v, const uint32_t *corner, double *normal) {
    const double *a = v->points + 3 * (size_t)corner[0];
    double u[3], w[3];
    for (int k = 0; k < 3; k++) {
        u[k] = v->points[3 * (size_t)corner[1] + (size_t)k] - a[k];
        w[k] = v->points[3 * (size_t)corner[2] + (size_t)k] - a[k];
    }
    make_unit(u);
    make_unit(w);
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        normal[k] = u[m] * w[n] - u[n] * w[m];
    }
    make_unit(normal);
}

/* --- which of two Voronoi vertices is farther --- */

/* What the search for poles keeps beside its result. A pole on offer is a key: the upper half of the bits of the squared
 * distance over its tetrahedron, so that one look tells for most that they are nearer. */
typedef struct {
    brio_pole_vectors *v;
    double *square;    /* of each Voronoi vertex: its squared distance from its samples; NaN where there is none */
    uint64_t *farther; /* of each sample, as v->pole: the keys */
} search;

enum { AHEAD = 8 }; /* tetrahedra between fetching and using */

static const double ROUGH = 0x1p-30 + 0x1p-50;
static const uint64_t NO_KEY = BRIO_INFINITE, HULL_KEY = (uint64_t)UINT32_MAX << 32;

static inline uint64_t key_of(double square, uint32_t tet) {
    uint64_t bits;
    memcpy(&bits, &square, sizeof bits);
    return (bits & HULL_KEY) | tet;
}

/* A quick look, which most keys do not pass. */
static inline bool may_be_farther(uint64_t key, const uint64_t *pole) {
    return key >> 32 >= __atomic_load_n(pole, __ATOMIC_RELAXED) >> 32;
}

/* Whether a key is that of a farther Voronoi vertex than another. */
static inline bool is_farther(const search *s, uint64_t key, uint64_t than) {
    if (key >> 32 != than >> 32) return key >> 32 > than >> 32;
    uint32_t tet = (uint32_t)key, other = (uint32_t)than;
    if (than == NO_KEY) return true;
    return s->square[tet] != s->square[other]
               ? s->square[tet] > s->square[other]
               : brio_compare_by_position(s->v->points, s->v->t.tet, s->v->centre, tet, other) > 0;
}

/* Makes a tetrahedron a pole unless there is a farther one. Threads may offer at once: the farthest one wins, whoever
 * comes first. */
static inline void offer(const search *s, uint64_t *pole, uint64_t key) {
    uint64_t now = __atomic_load_n(pole, __ATOMIC_RELAXED);
    while (is_farther(s, key, now))
        if (__atomic_compare_exchange_n(pole, &now, key, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) return;
}

/* --- the passes --- */

/* Normals are added as multiples of 2^-36, which is exact for up to 2^17 of them, so that the order is of no
 * importance. Samples on the hull take no other pole. */
static void find_hull_vectors(search *s) {
    static const double ROUND = 0x1.8p16;
    brio_pole_vectors *v = s->v;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) {
        double *normal = v->centre + 3 * tet;
        outward_normal(v, v->t.tet[tet].vertex, normal);
        s->square[tet] = square(normal);
        for (int i = 0; i < 3; i++) {
            size_t p = v->t.tet[tet].vertex[i];
            for (size_t k = 0; k < 3; k++) v->vector[3 * p + k] += (normal[k] + ROUND) - ROUND;
            s->farther[2 * p] = HULL_KEY | tet;
        }
    }
}

/* The centres of the tetrahedra from `first` on, up to BRIO_CENTRES of them. */
static size_t find_centres(const search *s, size_t first) {
    const brio_pole_vectors *v = s->v;
    const double *p[BRIO_CENTRES][4];
    brio_rough_centre centre[BRIO_CENTRES];
    size_t count = v->num_finite - first < BRIO_CENTRES ? v->num_finite - first : BRIO_CENTRES;
    for (size_t n = 0; n < BRIO_CENTRES; n++)
        for (int i = 0; i < 4; i++) p[n][i] = v->points + 3 * (size_t)v->t.tet[first + (n < count ? n : 0)].vertex[i];
    brio_rough_centres((const double *const(*)[4])p, centre);
    for (size_t n = 0; n < count; n++) {
        memcpy(v->centre + 3 * (first + n), centre[n].at, sizeof centre[n].at);
        s->square[first + n] = centre[n].square;
    }
    return count;
}

static void find_poles(const brio_context *ctx, const search *s) {
    const brio_pole_vectors *v = s->v;
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t first = 0; first < v->num_finite; first += BRIO_CENTRES) {
        size_t end = first + find_centres(s, first);
        for (size_t tet = first; tet < end; tet++) {
            uint64_t key = key_of(s->square[tet], (uint32_t)tet);
            for (int i = 0; i < 4 && !isnan(s->square[tet]); i++) {
                uint64_t *farther = s->farther + 2 * (size_t)v->t.tet[tet].vertex[i];
                if (may_be_farther(key, farther)) offer(s, farther, key);
            }
        }
    }
}

static void find_vectors(const brio_context *ctx, const search *s) {
    const brio_pole_vectors *v = s->v;
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t p = 0; p < v->num_points; p++) {
        uint32_t pole = (uint32_t)s->farther[2 * p];
        if (pole < v->num_finite) brio_towards_centre(v, pole, p, v->vector + 3 * p);
        make_unit(v->vector + 3 * p);
    }
}

/* A number for each slot of a tetrahedron. */
typedef double slots __attribute__((vector_size(32)));
typedef int64_t slot_bits __attribute__((vector_size(32)));

/* How far a Voronoi vertex lies along the axis of each of its samples; 0 for the infinite vertex. */
BRIO_INLINE void measure_along(const brio_pole_vectors *v, size_t tet, slots *along) {
    const uint32_t *vertex = v->t.tet[tet].vertex;
    const double *centre = v->centre + 3 * tet, *x[4], *n[4];
    slots sum = {0};
    for (int i = 0; i < 4; i++) {
        size_t p = vertex[i] != BRIO_INFINITE ? vertex[i] : vertex[0];
        x[i] = v->points + 3 * p;
        n[i] = v->vector + 3 * p;
    }
    if (tet < v->num_finite) {
        for (int k = 0; k < 3; k++)
            sum +=
                (centre[k] - (slots){x[0][k], x[1][k], x[2][k], x[3][k]}) * (slots){n[0][k], n[1][k], n[2][k], n[3][k]};
    } else {
        for (int k = 0; k < 3; k++) sum += centre[k] * (slots){n[0][k], n[1][k], n[2][k], 0};
    }
    *along = sum;
}

/* Bounds the error of each coordinate of a centre at a distance from its samples (brio_rough_centres, for coordinates of
 * at most 1), or of a direction, and what rounding adds to its place along an axis. */
static inline double error_of(const brio_pole_vectors *v, size_t tet, double distance) {
    return tet < v->num_finite ? ROUGH * distance + 0x1p-53 * (1 + distance) : 0x1p-48;
}

/* The side and the depth of a Voronoi vertex for each of its samples, and offers it as the pole on their other side. Its
 * distance is the same from all, but for the error. */
BRIO_INLINE int sides_of(const search *s, size_t tet, double sine) {
    static const slot_bits pole = {1, 4, 16, 64}, antipole = {2, 8, 32, 128}, depth = {256, 1024, 4096, 16384};
    const brio_pole_vectors *v = s->v;
    double most = s->square[tet], length = sqrt(most), limit = sine * length + 6 * error_of(v, tet, length);
    slots along;
    measure_along(v, tet, &along);
    slots across = most - along * along; /* squared distance from the axis */
    slot_bits bits = ((along > limit) & pole) | ((along < -limit) & antipole);
    bits +=
        ((across > most * 0x1p-8) & depth) + ((across > most * 0x1p-6) & depth) + ((across > most * 0x1p-4) & depth);
    for (int i = 0; i < 4 && tet < v->num_finite; i++) {
        uint64_t *farther = s->farther + 2 * (size_t)v->t.tet[tet].vertex[i] + 1, key = key_of(most, (uint32_t)tet);
        if ((along[i] < 0) & may_be_farther(key, farther)) offer(s, farther, key);
    }
    return (int)(bits[0] | bits[1] | bits[2] | bits[3]);
}

/* Fetches what sides_of needs of the samples of a tetrahedron. */
static inline void expect_samples(const brio_pole_vectors *v, size_t tet) {
    for (int i = 0; i < 4 && tet < v->num_finite; i++) {
        __builtin_prefetch(v->points + 3 * (size_t)v->t.tet[tet].vertex[i]);
        __builtin_prefetch(v->vector + 3 * (size_t)v->t.tet[tet].vertex[i]);
    }
}

/* The sides of the tetrahedra [from, to). */
BRIO_INLINE void find_sides_of(const search *s, size_t from, size_t to, double sine) {
    for (size_t tet = from; tet < to; tet++) {
        expect_samples(s->v, tet + AHEAD);
        s->v->sides[tet] = (uint16_t)sides_of(s, tet, sine);
    }
}

static void find_sides_plain(const search *s, size_t from, size_t to, double sine) {
    find_sides_of(s, from, to, sine);
}
BRIO_TARGET_FMA static void find_sides_wide(const search *s, size_t from, size_t to, double sine) {
    find_sides_of(s, from, to, sine);
}

/* The sides, and the poles on the other side. */
static void find_sides(const brio_context *ctx, const search *s) {
    double sine = sin(s->v->theta);
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel num_threads(brio_context_threads(ctx))) {
        size_t from = brio_part(s->v->t.count, brio_thread(), brio_team_size());
        size_t to = brio_part(s->v->t.count, brio_thread() + 1, brio_team_size());
        if (dd_have_fma())
            find_sides_wide(s, from, to, sine);
        else
            find_sides_plain(s, from, to, sine);
    }
}

static brio_status search_poles(brio_context *ctx, brio_pole_vectors *v) {
    brio_status status = BRIO_OK;
    search s = {.v = v};
    BRIO_TRY(BRIO_ALLOC(ctx, s.square, v->t.count));
    BRIO_TRY(BRIO_ALLOC(ctx, s.farther, 2 * v->num_points));
    for (size_t i = 0; i < 2 * v->num_points; i++) s.farther[i] = NO_KEY;
    find_hull_vectors(&s);
    find_poles(ctx, &s);
    BRIO_TRY(brio_progress(ctx, "poles", 0.5));
    find_vectors(ctx, &s);
    find_sides(ctx, &s);
    for (size_t i = 0; i < 2 * v->num_points; i++) v->pole[i] = (uint32_t)s.farther[i];
done:
    brio_release(ctx, s.square);
    brio_release(ctx, s.farther);
    return status;
}

brio_status brio_pole_vectors_find(brio_context *ctx, const brio_triangulation *t, const double *points,
                                   size_t num_points, double theta, brio_pole_vectors *out) {
    brio_status status = BRIO_OK;
    const brio_stats *s = brio_triangulation_stats(t);
    *out = (brio_pole_vectors){.num_finite = s->tetrahedra,
                               .num_points = num_points,
                               .num_vertices = s->vertices,
                               .points = points,
                               .theta = theta};
    /* the kernel's structure is shared by those who only read */
    out->t = (brio_tetrahedra){.tet = (brio_tetrahedron *)brio_triangulation_tetrahedra(t),
                               .count = s->tetrahedra + s->hull_facets,
                               .infinite = BRIO_INFINITE};
    BRIO_TRY(BRIO_ALLOC(ctx, out->centre, 3 * out->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->vector, 3 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, out->pole, 2 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, out->sides, out->t.count));
    BRIO_TRY(search_poles(ctx, out));
done:
    return status;
}

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v) {
    brio_release(ctx, v->centre);
    brio_release(ctx, v->vector);
    brio_release(ctx, v->pole);
    brio_release(ctx, v->sides);
    *v = (brio_pole_vectors){0};
}
