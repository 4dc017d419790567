/* Voronoi vertices, and the direction of each sample's pole.
 *
 * One pass computes the certified centres; one over the tetrahedra offers each centre to its four samples as the
 * farther pole; a last one, with the directions known, as the pole on the other side. Samples on the hull have an
 * unbounded cell: the sum of the unit outward normals of their hull facets stands for the direction to the pole.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999. */
#include "dual/pole_vectors.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "predicates/circumcentre.h"
#include <string.h>

static double square(const double *x) {
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

/* Makes a vector a unit one; a zero or infinite one becomes zero. Scaled first, so that nothing under- or overflows. */
static void make_unit(double *x) {
    double most = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
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

static void find_centres(const brio_context *ctx, brio_pole_vectors *v) {
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t tet = 0; tet < v->t.count; tet++) {
        const uint32_t *corner = v->t.tet[tet].vertex;
        const double *r[4] = {0};
        if (tet >= v->num_finite) {
            outward_normal(v, corner, v->centre + 3 * tet);
            v->error[tet] = 0x1p-48;
            continue;
        }
        for (int i = 0; i < 4; i++) r[i] = v->points + 3 * (size_t)corner[i];
        if (brio_centre(r[0], r[1], r[2], r[3], false, v->centre + 3 * tet, v->error + tet)) continue;
        v->centre[3 * tet] = NAN;
        v->error[tet] = INFINITY;
    }
}

/* Keeps the farther one of a sample's pole so far, at squared distance *most, and another centre at `to`; a tie goes by
 * the centres. */
static void offer(const brio_pole_vectors *v, uint32_t *best, double *most, uint32_t tet, const double *to) {
    double now = square(to);
    if (*best != BRIO_INFINITE && now < *most) return;
    if (*best != BRIO_INFINITE && now == *most &&
        brio_lexicographic(v->centre + 3 * (size_t)tet, v->centre + 3 * (size_t)*best) <= 0)
        return;
    *best = tet;
    *most = now;
}

/* Hull facets first: their samples take no other pole, and the sum of normals instead of its direction. */
static void find_hull_vectors(brio_pole_vectors *v) {
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            size_t p = v->t.tet[tet].vertex[i];
            for (int k = 0; k < 3; k++) v->vector[3 * p + (size_t)k] += v->centre[3 * tet + (size_t)k];
            v->pole[2 * p] = (uint32_t)tet;
        }
}

static void find_poles(brio_pole_vectors *v, double *most) {
    for (size_t tet = 0; tet < v->num_finite; tet++) {
        if (isnan(v->centre[3 * tet])) continue;
        for (int i = 0; i < 4; i++) {
            size_t p = v->t.tet[tet].vertex[i];
            double to[3];
            if (v->pole[2 * p] != BRIO_INFINITE && v->pole[2 * p] >= v->num_finite) continue;
            brio_towards_centre(v, tet, p, to);
            offer(v, v->pole + 2 * p, most + p, (uint32_t)tet, to);
        }
    }
    for (size_t p = 0; p < v->num_points; p++) {
        uint32_t pole = v->pole[2 * p];
        if (pole < v->num_finite) brio_towards_centre(v, pole, p, v->vector + 3 * p);
        make_unit(v->vector + 3 * p);
    }
}

static void find_opposite_poles(brio_pole_vectors *v, double *most) {
    for (size_t tet = 0; tet < v->num_finite; tet++) {
        if (isnan(v->centre[3 * tet])) continue;
        for (int i = 0; i < 4; i++) {
            size_t p = v->t.tet[tet].vertex[i];
            const double *axis = v->vector + 3 * p;
            double to[3];
            brio_towards_centre(v, tet, p, to);
            if (to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2] < 0)
                offer(v, v->pole + 2 * p + 1, most + p, (uint32_t)tet, to);
        }
    }
}

brio_status brio_pole_vectors_find(brio_context *ctx, const brio_triangulation *t, const double *points,
                                   size_t num_points, brio_pole_vectors *out) {
    brio_status status = BRIO_OK;
    const brio_stats *s = brio_triangulation_stats(t);
    double *most = NULL; /* of each sample: the squared distance of the pole that is looked for */
    *out = (brio_pole_vectors){.num_finite = s->tetrahedra, .num_points = num_points, .points = points};
    /* the kernel's structure is shared by those who only read */
    out->t = (brio_tetrahedra){.tet = (brio_tetrahedron *)brio_triangulation_tetrahedra(t),
                               .count = s->tetrahedra + s->hull_facets,
                               .infinite = BRIO_INFINITE};
    BRIO_TRY(BRIO_ALLOC(ctx, out->centre, 3 * out->t.count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->error, out->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->vector, 3 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, out->pole, 2 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, most, num_points));
    memset(out->pole, 0xff, 2 * num_points * sizeof *out->pole);
    find_centres(ctx, out);
    BRIO_TRY(brio_progress(ctx, "poles", 0.5));
    find_hull_vectors(out);
    find_poles(out, most);
    find_opposite_poles(out, most);
done:
    brio_release(ctx, most);
    return status;
}

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v) {
    brio_release(ctx, v->centre);
    brio_release(ctx, v->error);
    brio_release(ctx, v->vector);
    brio_release(ctx, v->pole);
    *v = (brio_pole_vectors){0};
}
