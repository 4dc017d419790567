/* Voronoi vertices, the direction from each sample to its farther pole, and the side of the sample on which each vertex
 * lies.
 *
 * The first pass over the tetrahedra computes the centres and offers each centre to its four samples as the farther
 * pole. The second pass knows the directions to the farther poles. It finds on which side of its samples each centre
 * lies, and offers the centre as the pole on the other side.
 * A centre is equally far from its four samples, so one squared distance is stored with the centre. Each sample stores
 * the plane through it normal to its axis, which takes one load. The height of a centre above this plane is its
 * position along the axis. Samples on the hull have an unbounded cell: the sum of the unit outward normals of their
 * hull facets replaces the direction to the pole. A centre within its error bound of the co-cone counts as in the
 * co-cone, so that rounding loses no triangle.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999.
 *           Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000. */
#include "dual/pole_vectors.h"
#include "base/memory.h"
#include "base/team.h"
#include "dual/farthest.h"
#include "dual/position_order.h"
#include "predicates/circumcentre.h"
#include "predicates/double_double.h"
#include "triangulation/view.h"
#include <assert.h>
#include <string.h>

static double square(const double *x) {
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

/* Divides a vector by its length; a zero or infinite vector becomes zero. Scales the vector first, so that its square
 * neither underflows nor overflows. */
static void make_unit(double *x) {
    double most = 0;
    for (int k = 0; k < 3; k++) most = fabs(x[k]) > most ? fabs(x[k]) : most;
    double scale = most > 0 && most < INFINITY ? 1 / most : 0;
    if (!(scale < INFINITY)) scale = 0;
    for (int k = 0; k < 3; k++) x[k] *= scale;
    double length = sqrt(square(x));
    for (int k = 0; k < 3 && length > 0; k++) x[k] /= length;
}

/* Writes the unit normal of a hull facet that points away from the point set. */
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

/* Writes the row of `centre` of an infinite tetrahedron. */
static void write_ray(const brio_pole_vectors *v, size_t tet, double *row) {
    outward_normal(v, v->t.tet[tet].vertex, row);
    row[3] = square(row);
}

/* --- which of two Voronoi vertices is farther --- */

/* The workspace of the search for poles. Keys are those of farthest.h. */
typedef struct {
    brio_pole_vectors *v;
    uint64_t *farther[2]; /* #P each: the key of the farther pole [0] and of the pole on the other side [1] */
    int threads;          /* the threads of a pass over the tetrahedra */
    double sine;          /* sin(theta) */
} search;

/* AHEAD: the samples of tetrahedron t + AHEAD are prefetched while tetrahedron t is processed. */
enum { AHEAD = 8, TETRAHEDRA_A_THREAD = 1 << 11, BATCHES_A_THREAD = TETRAHEDRA_A_THREAD / BRIO_CENTRE_BATCH };
enum { SAMPLES_A_THREAD = 1 << 12 };

/* Derived: the relative error of brio_rough_centres, 2^-30, and a margin for rounding. */
static const double ROUGH = 0x1p-30 + 0x1p-50;

static bool is_farther(const void *user, uint32_t tet, uint32_t than, uint32_t sample) {
    const brio_pole_vectors *v = user;
    const double *a = v->centre + 4 * (size_t)tet, *b = v->centre + 4 * (size_t)than;
    (void)sample; /* the squared distance from the samples is stored with the centre */
    if (a[3] != b[3]) return a[3] > b[3];
    int sign = brio_lexicographic(a, b);
    if (sign == 0) sign = brio_compare_corners(v->points, v->t.tet + tet, v->t.tet + than);
    return sign > 0;
}

static __attribute__((noinline)) void offer(const search *s, uint64_t *pole, uint64_t key) {
    brio_offer_farthest(pole, key, s->threads == 1, is_farther, s->v, 0);
}

/* --- the passes --- */

/* Makes infinite tetrahedron `tet` the pole of sample p unless p has an infinite pole whose hull facet is greater by
 * position. Infinite poles are equally far, and their order in memory depends on the order of the points. */
static void offer_hull_facet(search *s, size_t p, size_t tet) {
    const brio_tetrahedron *t = s->v->t.tet;
    uint64_t now = s->farther[0][p];
    if (now == BRIO_NO_FARTHEST || brio_compare_hull_facets(s->v->points, t + tet, t + brio_farthest_tet(now)) > 0)
        s->farther[0][p] = BRIO_ENDLESS | tet;
}

/* Adds up the normals at each hull sample and gives the sample an infinite pole, which no finite pole replaces. Each
 * normal is rounded to multiples of 2^-36, so that a sum of up to 2^17 normals is exact in every order. */
static void find_hull_vectors(search *s) {
    static const double ROUND = 0x1.8p16;
    brio_pole_vectors *v = s->v;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) {
        assert(v->t.tet[tet].vertex[3] == v->t.infinite); /* finite tetrahedra come first */
        double *normal = v->centre + 4 * tet;
        write_ray(v, tet, normal);
        for (int i = 0; i < 3; i++) {
            size_t p = v->t.tet[tet].vertex[i];
            for (size_t k = 0; k < 3; k++) v->plane[4 * p + k] += (normal[k] + ROUND) - ROUND;
            offer_hull_facet(s, p, tet);
        }
    }
}

/* Computes the centres of up to BRIO_CENTRE_BATCH tetrahedra from `first` on. */
static void find_centres(const brio_pole_vectors *v, size_t first, size_t count, double *centre) {
    assert(count <= BRIO_CENTRE_BATCH && first + count <= v->num_finite);
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    for (size_t n = 0; n < count; n++) memcpy(vertex[n], v->t.tet[first + n].vertex, sizeof *vertex);
    brio_rough_centres(&(brio_centre_batch){v->points, NULL, (const uint32_t(*)[4])vertex, count}, centre);
}

void brio_centre_row(const brio_pole_vectors *v, size_t tet, double row[4]) {
    if (v->centre)
        memcpy(row, v->centre + 4 * tet, 4 * sizeof *row);
    else if (tet < v->num_finite)
        find_centres(v, tet, 1, row);
    else
        write_ray(v, tet, row);
}

/* Computes the centres of the batches [from, to), each of BRIO_CENTRE_BATCH tetrahedra, and offers them as farther
 * poles. */
static void find_poles(void *user, size_t from, size_t to, int thread) {
    const search *s = user;
    const brio_pole_vectors *v = s->v;
    uint64_t *farther = s->farther[0];
    (void)thread;
    for (size_t first = from * BRIO_CENTRE_BATCH; first < to * BRIO_CENTRE_BATCH && first < v->num_finite;
         first += BRIO_CENTRE_BATCH) {
        size_t left = v->num_finite - first, count = left < BRIO_CENTRE_BATCH ? left : BRIO_CENTRE_BATCH;
        size_t end = first + count;
        find_centres(v, first, count, v->centre + 4 * first);
        for (size_t tet = first; tet < end; tet++) {
            uint32_t vertex[4];
            uint64_t key = brio_farthest_key(v->centre[4 * tet + 3], (uint32_t)tet);
            if (isnan(v->centre[4 * tet + 3])) continue;
            memcpy(vertex, v->t.tet[tet].vertex, sizeof vertex);
            for (int i = 0; i < 4; i++)
                if (brio_may_be_farthest(key, farther + vertex[i])) offer(s, farther + vertex[i], key);
        }
    }
}

static void find_planes(void *user, size_t begin, size_t end, int thread) {
    const search *s = user;
    const brio_pole_vectors *v = s->v;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        uint32_t pole = brio_farthest_tet(s->farther[0][p]);
        double *plane = v->plane + 4 * p;
        const double *x = v->points + 3 * p;
        assert(pole < v->t.count || pole == BRIO_INFINITE);
        if (pole < v->num_finite) brio_towards_centre(v, pole, p, plane);
        make_unit(plane);
        plane[3] = -(plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2]);
    }
}

/* One number for each of the four slots of a tetrahedron. */
typedef double slots __attribute__((vector_size(32)));
typedef int64_t slot_bits __attribute__((vector_size(32)));

#ifdef __clang__
#define CHOOSE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define CHOOSE(a, b, i, j, k, l) __builtin_shuffle(a, b, (slot_bits){i, j, k, l})
#endif

/* Writes the sum of the four entries of row[i] to slot i of *sum. */
BRIO_INLINE void add_rows(const slots row[4], slots *sum) {
    slots a = CHOOSE(row[0], row[1], 0, 4, 2, 6) + CHOOSE(row[0], row[1], 1, 5, 3, 7);
    slots b = CHOOSE(row[2], row[3], 0, 4, 2, 6) + CHOOSE(row[2], row[3], 1, 5, 3, 7);
    *sum = CHOOSE(a, b, 0, 1, 4, 5) + CHOOSE(a, b, 2, 3, 6, 7);
}

/* Writes to *row the products of the plane of sample p with the coordinates of a centre. The sum of the products is the
 * position of the centre along the axis of p. */
BRIO_INLINE void multiply_plane(const brio_pole_vectors *v, uint32_t p, const slots *centre, slots *row) {
    memcpy(row, v->plane + 4 * (size_t)p, sizeof *row);
    *row *= *centre;
}

/* Writes the position of a Voronoi vertex along the axis of each of its samples; 0 in the slot of the infinite
 * vertex. */
BRIO_INLINE void measure_along(const brio_pole_vectors *v, size_t tet, bool finite, slots *along) {
    const uint32_t *vertex = v->t.tet[tet].vertex;
    slots centre, row[4];
    memcpy(&centre, v->centre + 4 * tet, sizeof centre);
    centre[3] = finite;
    multiply_plane(v, vertex[0], &centre, &row[0]);
    multiply_plane(v, vertex[1], &centre, &row[1]);
    multiply_plane(v, vertex[2], &centre, &row[2]);
    row[3] = (slots){0};
    if (finite) multiply_plane(v, vertex[3], &centre, &row[3]);
    add_rows(row, along);
}

/* Returns a bound for the error of each coordinate of a centre, or of a direction when `finite` is false. Includes the
 * rounding of the position along an axis, a sum of four products whose fourth factor was rounded before. The centre is
 * one of brio_rough_centres, at `distance` from its samples, whose coordinates are at most 1. */
static inline double error_of(double distance, bool finite) {
    return finite ? ROUGH * distance + 0x1p-50 * (1 + distance) : 0x1p-48;
}

/* Returns the sides of a Voronoi vertex for its samples. Bits 0..15 are those of brio_pole_vectors.sides. Bit 16 + i is
 * set when the vertex lies behind the plane of the sample in slot i. */
BRIO_INLINE uint32_t look_at_samples(const brio_pole_vectors *v, size_t tet, bool finite, double sine) {
    static const slot_bits POLE = {1, 2, 4, 8}, ANTIPOLE = {16, 32, 64, 128},
                           BEHIND = {1 << 16, 2 << 16, 4 << 16, 8 << 16};
    static const slot_bits DEPTH_LOW = {256, 512, 1024, 2048}, DEPTH_HIGH = {4096, 8192, 16384, 32768};
    double most = v->centre[4 * tet + 3], length = sqrt(most), limit = sine * length + 6 * error_of(length, finite);
    slots along;
    measure_along(v, tet, finite, &along);
    slots across = most - along * along; /* squared distance from the axis */
    slot_bits over_4 = across > most * 0x1p-4, over_6 = across > most * 0x1p-6, over_8 = across > most * 0x1p-8;
    slot_bits bits = ((along > limit) & POLE) | ((along < -limit) & ANTIPOLE) | ((along < 0) & BEHIND) |
                     ((over_4 ^ over_6 ^ over_8) & DEPTH_LOW) | (over_6 & DEPTH_HIGH);
    return (uint32_t)(bits[0] | bits[1] | bits[2] | bits[3]);
}

/* Offers a Voronoi vertex to sample p as the pole on the other side, when the vertex is behind the plane of p. */
BRIO_INLINE void offer_if(bool behind, const search *s, uint32_t p, uint64_t key) {
    if (behind & brio_may_be_farthest(key, s->farther[1] + p)) offer(s, s->farther[1] + p, key);
}

/* Returns the sides of a finite Voronoi vertex, and offers the vertex as the pole on the other side of its samples. One
 * distance serves the four samples: their distances are equal except for the error of the centre. */
BRIO_INLINE uint16_t sides_of(const search *s, size_t tet, double sine) {
    uint32_t bits = look_at_samples(s->v, tet, true, sine);
    uint64_t key = brio_farthest_key(s->v->centre[4 * tet + 3], (uint32_t)tet);
    const uint32_t *vertex = s->v->t.tet[tet].vertex;
    offer_if(bits >> 16 & 1, s, vertex[0], key);
    offer_if(bits >> 17 & 1, s, vertex[1], key);
    offer_if(bits >> 18 & 1, s, vertex[2], key);
    offer_if(bits >> 19 & 1, s, vertex[3], key);
    assert((bits & bits >> 4 & 15) == 0 && bits >> 20 == 0); /* a centre is on one side of a sample */
    return (uint16_t)bits;
}

/* Prefetches the planes that sides_of will read for a tetrahedron. */
static inline void expect_samples(const brio_pole_vectors *v, size_t tet) {
    for (int i = 0; i < 4 && tet < v->num_finite; i++)
        __builtin_prefetch(v->plane + 4 * (size_t)v->t.tet[tet].vertex[i]);
}

/* Computes the sides of the tetrahedra [from, to), and offers the finite ones as poles on the other side. */
BRIO_INLINE void find_sides_of(const search *s, size_t from, size_t to, double sine) {
    size_t finite = s->v->num_finite;
    for (size_t tet = from; tet < to && tet < finite; tet++) {
        expect_samples(s->v, tet + AHEAD);
        s->v->sides[tet] = sides_of(s, tet, sine);
    }
    for (size_t tet = from < finite ? finite : from; tet < to; tet++)
        s->v->sides[tet] = (uint16_t)look_at_samples(s->v, tet, false, sine);
}

static void find_sides_plain(const search *s, size_t from, size_t to, double sine) {
    find_sides_of(s, from, to, sine);
}
BRIO_TARGET_FMA static void find_sides_wide(const search *s, size_t from, size_t to, double sine) {
    find_sides_of(s, from, to, sine);
}

/* Runs find_sides_of with fused multiply-add where the processor has it. */
static void find_sides(void *user, size_t from, size_t to, int thread) {
    const search *s = user;
    (void)thread;
    if (brio_have_fma())
        find_sides_wide(s, from, to, s->sine);
    else
        find_sides_plain(s, from, to, s->sine);
}

static brio_status search_poles(brio_context *ctx, brio_pole_vectors *v) {
    brio_status status = BRIO_OK;
    size_t batches = (v->num_finite + BRIO_CENTRE_BATCH - 1) / BRIO_CENTRE_BATCH;
    search s = {.v = v, .threads = brio_threads(ctx, batches, BATCHES_A_THREAD), .sine = sin(v->theta)};
    for (int side = 0; side < 2; side++) {
        BRIO_TRY(BRIO_ALLOC(ctx, s.farther[side], v->num_points));
        for (size_t p = 0; p < v->num_points; p++) s.farther[side][p] = BRIO_NO_FARTHEST;
    }
    find_hull_vectors(&s);
    BRIO_TRY(brio_sweep(ctx, s.threads, batches, find_poles, &s,
                        {v->t.tet, BRIO_CENTRE_BATCH * sizeof *v->t.tet, false},
                        {v->centre, BRIO_CENTRE_BATCH * 4 * sizeof *v->centre, true}));
    BRIO_TRY(brio_progress(ctx, "poles", 0.5));
    BRIO_TRY(brio_sweep(ctx, brio_threads(ctx, v->num_points, SAMPLES_A_THREAD), v->num_points, find_planes, &s,
                        BRIO_READS(s.farther[0]), {v->points, 3 * sizeof *v->points, false},
                        {v->plane, 4 * sizeof *v->plane, true}));
    BRIO_TRY(brio_sweep(ctx, s.threads, v->t.count, find_sides, &s, BRIO_READS(v->t.tet),
                        {v->centre, 4 * sizeof *v->centre, false}, BRIO_WRITES(v->sides)));
    for (size_t i = 0; i < 2 * v->num_points; i++) v->pole[i] = brio_farthest_tet(s.farther[i % 2][i / 2]);
done:
    for (int side = 0; side < 2; side++) brio_release(ctx, s.farther[side]);
    return status;
}

brio_status brio_pole_vectors_find(brio_context *ctx, const brio_triangulation *t, const double *points,
                                   size_t num_points, double theta, brio_pole_vectors *out) {
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    assert(num_points == s->points && 0 < theta && theta < 1.6);
    *out = (brio_pole_vectors){.num_finite = s->tetrahedra,
                               .num_points = num_points,
                               .num_vertices = s->vertices,
                               .points = points,
                               .theta = theta};
    out->t = brio_tetrahedra_of(t);
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->centre, 4 * out->t.count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, out->plane, 4 * num_points));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->pole, 2 * num_points));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->sides, out->t.count));
    return search_poles(ctx, out);
}

void brio_pole_vectors_drop(brio_context *ctx, brio_pole_vectors *v) {
    brio_release(ctx, v->centre);
    brio_release(ctx, v->plane);
    brio_release(ctx, v->pole);
    v->centre = v->plane = NULL;
    v->pole = NULL;
}

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v) {
    brio_pole_vectors_drop(ctx, v);
    brio_release(ctx, v->sides);
    *v = (brio_pole_vectors){0};
}
