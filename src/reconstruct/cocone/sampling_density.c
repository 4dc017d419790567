/* The density of a sample, compared with the guarantee.
 *
 * An r-sample has, for every point x of the surface, a sample within r times the local feature size at x. The points
 * farthest from their samples are near the circumcentres of the surface's triangles. So the circumradius of a triangle
 * divided by the local feature size at its corners estimates r there.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 2.6 and theorem 19. */
#include "reconstruct/cocone/sampling_density.h"
#include "base/memory.h"
#include "base/sort.h"
#include "predicates/predicates.h"
#include "reconstruct/cocone/triangle.h"

/* Derived: the guarantee of theorem 19 holds up to this r. */
static const double GUARANTEED_R = 0.08;

/* Returns the corner of a face with the least position. The circle is computed from there, so that its rounding does
 * not depend on the corner that comes first. */
static size_t least_corner(const double (*p)[3]) {
    size_t least = 0;
    for (size_t k = 1; k < 3; k++)
        if (brio_lexicographic(p[k], p[least]) < 0) least = k;
    return least;
}

/* Sets r[p] to the largest circumradius of the faces at sample p, times 2^-exponent. */
static void largest_circles(const brio_mesh *mesh, int exponent, double *r) {
    double factor = ldexp(1, -exponent);
    bool ordinary = isnormal(factor) && factor < INFINITY;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *corner = mesh->face_vertices + 3 * f;
        double p[3][3];
        for (int k = 0; k < 9; k++) {
            double x = mesh->vertices[3 * (size_t)corner[k / 3] + (size_t)(k % 3)];
            p[k / 3][k % 3] = ordinary ? x * factor : ldexp(x, -exponent);
        }
        size_t first = least_corner((const double(*)[3])p);
        double radius = sqrt(brio_circle_square(p[first], p[(first + 1) % 3], p[(first + 2) % 3]));
        for (int k = 0; k < 3; k++) r[corner[k]] = r[corner[k]] < radius ? radius : r[corner[k]];
    }
}

static brio_status summarize(brio_context *ctx, const double *r, size_t n, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    uint32_t *order = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, keys, n));
    BRIO_TRY(BRIO_ALLOC(ctx, order, n));
    for (size_t p = 0; p < n; p++) {
        if (!(r[p] > 0)) continue;
        keys[count] = brio_double_key(r[p]);
        order[count++] = (uint32_t)p;
        stats->outside_guarantee += r[p] > GUARANTEED_R;
    }
    if (count == 0) goto done;
    BRIO_TRY(brio_radix_sort(ctx, keys, order, count, 64));
    stats->r_median = r[order[count / 2]];
    stats->r_p95 = r[order[count - 1 - count / 20]];
done:
    brio_release(ctx, keys);
    brio_release(ctx, order);
    return status;
}

brio_status brio_sampling_density(const double *size, int exponent, brio_mesh *mesh, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    double *size_property, *r;
    BRIO_TRY(brio_mesh_add_property(mesh, "feature_size", BRIO_SCALAR_FLOAT64, (void **)&size_property));
    BRIO_TRY(brio_mesh_add_property(mesh, "r", BRIO_SCALAR_FLOAT64, (void **)&r));
    largest_circles(mesh, exponent, r);
    for (size_t p = 0; p < mesh->num_vertices; p++) {
        size_property[p] = ldexp(size[p], exponent);
        r[p] = r[p] > 0 ? r[p] / size[p] : 0;
    }
    BRIO_TRY(summarize(mesh->context, r, mesh->num_vertices, stats));
done:
    return status;
}
