/* How dense a sample is, held against the guarantee.
 *
 * A sample is an r-sample when every point x of the surface has a sample within r times its local feature size. The
 * points that are farthest from their samples are close to the circumcentres of the triangles of the surface; so the
 * circumradius of a triangle over the local feature size at its corners estimates r there.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 2.6 and theorem 19. */
#include "reconstruct/sampling_density.h"
#include "base/memory.h"
#include "base/sort.h"
#include "dual/feature_size.h"
#include "reconstruct/triangle.h"

/* The guarantee of theorem 19 holds up to this r. */
static const double GUARANTEED_R = 0.08;

/* r[p] = the largest circumradius of the faces of each sample. */
static void largest_circles(const brio_pole_vectors *v, const brio_mesh *mesh, double *r) {
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *corner = mesh->face_vertices + 3 * f;
        double radius = sqrt(brio_circle_square(v->points + 3 * (size_t)corner[0], v->points + 3 * (size_t)corner[1],
                                                v->points + 3 * (size_t)corner[2]));
        for (int k = 0; k < 3; k++) r[corner[k]] = fmax(r[corner[k]], radius);
    }
}

static int compare_doubles(uint32_t a, uint32_t b, const void *user) {
    const double *x = user;
    return (x[a] > x[b]) - (x[a] < x[b]);
}

static brio_status summarize(brio_context *ctx, const double *r, size_t n, brio_cocone_stats *stats) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, order, n));
    for (size_t p = 0; p < n; p++) {
        if (!(r[p] > 0)) continue;
        order[count++] = (uint32_t)p;
        stats->outside_guarantee += r[p] > GUARANTEED_R;
    }
    if (count == 0) goto done;
    brio_sort_indices(order, count, compare_doubles, r);
    stats->r_median = r[order[count / 2]];
    stats->r_p95 = r[order[count - 1 - count / 20]];
done:
    brio_release(ctx, order);
    return status;
}

brio_status brio_sampling_density(brio_context *ctx, const brio_pole_vectors *v, int exponent, brio_mesh *mesh,
                                  brio_cocone_stats *stats) {
    brio_status status = BRIO_OK;
    double *size = NULL, *size_property, *r;
    BRIO_TRY(brio_feature_sizes(ctx, v, &size));
    BRIO_TRY(brio_mesh_add_property(mesh, "feature_size", BRIO_FLOAT64, (void **)&size_property));
    BRIO_TRY(brio_mesh_add_property(mesh, "r", BRIO_FLOAT64, (void **)&r));
    largest_circles(v, mesh, r);
    for (size_t p = 0; p < v->num_points; p++) {
        size_property[p] = ldexp(size[p], exponent);
        r[p] = r[p] > 0 ? r[p] / size[p] : 0;
    }
    BRIO_TRY(summarize(ctx, r, v->num_points, stats));
done:
    brio_release(ctx, size);
    return status;
}
