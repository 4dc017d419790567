/* Voronoi vertices, the direction of each sample's pole, and what lies which way as seen from there.
 *
 * One pass over the tetrahedra computes the centres and offers each to its four samples as the farther pole; another
 * one, with the directions known, tells on which side of its samples each centre lies and offers it as the pole on the
 * other side. Samples on the hull have an unbounded cell: the sum of the unit outward normals of their hull facets
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

/* Makes a tetrahedron, whose centre lies at `to` from sample p, the pole of p unless there is a farther one. Threads
 * may offer at once: the farthest one wins, whoever comes first. */
static inline void offer(const brio_pole_vectors *v, uint32_t *pole, size_t p, uint32_t tet, const double *to) {
    double far = square(to);
    uint32_t now = __atomic_load_n(pole, __ATOMIC_ACQUIRE);
    for (;;) {
        double other[3];
        if (now != BRIO_INFINITE) {
            if (now >= v->num_finite) return; /* on the hull */
            brio_towards_centre(v, now, p, other);
            double there = square(other);
            if (far < there ||
                (far == there && brio_compare_by_position(v->points, v->t.tet, v->centre, tet, now) <= 0))
                return;
        }
        if (__atomic_compare_exchange_n(pole, &now, tet, true, __ATOMIC_RELEASE, __ATOMIC_ACQUIRE)) return;
    }
}

/* --- the passes --- */

/* Normals are added as multiples of 2^-36, which is exact for up to 2^17 of them, so that the order is of no
 * importance. Samples on the hull take no other pole. */
static void find_hull_vectors(brio_pole_vectors *v) {
    static const double ROUND = 0x1.8p16;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) {
        double *normal = v->centre + 3 * tet;
        outward_normal(v, v->t.tet[tet].vertex, normal);
        v->error[tet] = 0x1p-48;
        for (int i = 0; i < 3; i++) {
            size_t p = v->t.tet[tet].vertex[i];
            for (size_t k = 0; k < 3; k++) v->vector[3 * p + k] += (normal[k] + ROUND) - ROUND;
            v->pole[2 * p] = (uint32_t)tet;
        }
    }
}

/* The centres of the tetrahedra from `first` on, up to BRIO_CENTRES of them. */
static size_t find_centres(const brio_pole_vectors *v, size_t first) {
    const double *p[BRIO_CENTRES][4];
    double centre[BRIO_CENTRES][3], error[BRIO_CENTRES];
    size_t count = v->num_finite - first < BRIO_CENTRES ? v->num_finite - first : BRIO_CENTRES;
    for (size_t n = 0; n < BRIO_CENTRES; n++)
        for (int i = 0; i < 4; i++) p[n][i] = v->points + 3 * (size_t)v->t.tet[first + (n < count ? n : 0)].vertex[i];
    brio_rough_centres(p, centre, error);
    memcpy(v->centre + 3 * first, centre, count * sizeof *centre);
    memcpy(v->error + first, error, count * sizeof *error);
    return count;
}

static void find_poles(const brio_context *ctx, brio_pole_vectors *v) {
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t first = 0; first < v->num_finite; first += BRIO_CENTRES) {
        size_t end = first + find_centres(v, first);
        for (size_t tet = first; tet < end; tet++)
            for (int i = 0; i < 4 && !isnan(v->centre[3 * tet]); i++) {
                size_t p = v->t.tet[tet].vertex[i];
                double to[3];
                brio_towards_centre(v, tet, p, to);
                offer(v, v->pole + 2 * p, p, (uint32_t)tet, to);
            }
    }
}

static void find_vectors(const brio_context *ctx, brio_pole_vectors *v) {
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t p = 0; p < v->num_points; p++) {
        uint32_t pole = v->pole[2 * p];
        if (pole < v->num_finite) brio_towards_centre(v, pole, p, v->vector + 3 * p);
        make_unit(v->vector + 3 * p);
    }
}

/* The side and the depth of a Voronoi vertex for each of its samples. Its distance is the same from all, but for the error. */
static int sides_of(const brio_pole_vectors *v, size_t tet, double sine) {
    double to[4][3], along[4], most = 0;
    int bits = 0, slots = tet < v->num_finite ? 4 : 3;
    for (int i = 0; i < slots; i++) {
        size_t p = v->t.tet[tet].vertex[i];
        const double *axis = v->vector + 3 * p;
        brio_towards_centre(v, tet, p, to[i]);
        double far = square(to[i]);
        along[i] = to[i][0] * axis[0] + to[i][1] * axis[1] + to[i][2] * axis[2];
        most = far > most ? far : most;
    }
    double length = sqrt(most), limit = sine * length + 6 * v->error[tet] + 0x1p-48 * length;
    for (int i = 0; i < slots; i++) {
        size_t p = v->t.tet[tet].vertex[i];
        double across = most - along[i] * along[i]; /* squared distance from the axis */
        int depth = (across > most * 0x1p-8) + (across > most * 0x1p-6) + (across > most * 0x1p-4);
        bits |= (along[i] > limit) << 2 * i | (along[i] < -limit) << (2 * i + 1) | depth << (8 + 2 * i);
        if (along[i] < 0 && slots == 4) offer(v, v->pole + 2 * p + 1, p, (uint32_t)tet, to[i]);
    }
    return bits;
}

/* The sides, and the poles on the other side. */
static void find_sides(const brio_context *ctx, brio_pole_vectors *v) {
    double sine = sin(v->theta);
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t tet = 0; tet < v->t.count; tet++) v->sides[tet] = (uint16_t)sides_of(v, tet, sine);
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
    BRIO_TRY(BRIO_ALLOC(ctx, out->error, out->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->vector, 3 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, out->pole, 2 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, out->sides, out->t.count));
    memset(out->pole, 0xff, 2 * num_points * sizeof *out->pole);
    find_hull_vectors(out);
    find_poles(ctx, out);
    BRIO_TRY(brio_progress(ctx, "poles", 0.5));
    find_vectors(ctx, out);
    find_sides(ctx, out);
done:
    return status;
}

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v) {
    brio_release(ctx, v->centre);
    brio_release(ctx, v->error);
    brio_release(ctx, v->vector);
    brio_release(ctx, v->pole);
    brio_release(ctx, v->sides);
    *v = (brio_pole_vectors){0};
}
