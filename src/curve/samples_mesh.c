/* Points of a plane in canonical order, scaled by a power of two, so that nothing depends on the order or the unit of
 * the caller's; and a mesh whose vertices are the distinct positions of points: what curves and trees are made over. */
#include "curve/samples_mesh.h"
#include "base/memory.h"
#include "base/scale.h"
#include "order/canonical_points.h"
#include <math.h>

brio_status brio_samples_mesh(brio_context *ctx, const double *points, size_t num_points, uint32_t *vertex,
                              brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    void *sample;
    size_t count = 0;
    for (size_t i = 0; i < num_points; i++)
        if (vertex[i] != BRIO_INFINITE) vertex[i] = (uint32_t)count++;
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(brio_mesh_set_vertices(mesh, NULL, count));
    BRIO_TRY(brio_mesh_add_property(mesh, "sample", BRIO_SCALAR_UINT32, &sample));
    for (size_t i = 0; i < num_points; i++) {
        if (vertex[i] == BRIO_INFINITE) continue;
        for (size_t k = 0; k < 3; k++) mesh->vertices[3 * (size_t)vertex[i] + k] = points[3 * i + k];
        ((uint32_t *)sample)[vertex[i]] = (uint32_t)i;
    }
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    return status;
}

/* --- points of a plane --- */

/* Points off their plane by at most this share of their extent are taken for points of it: as single precision, or
 * decimals of a file, leave them. Chosen. */
static const double THIN = 0x1p-20;

static double extent_of(const double *points, size_t num_points) {
    double extent = 0;
    for (size_t k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < num_points; i++) {
            low = fmin(low, points[3 * i + k]);
            high = fmax(high, points[3 * i + k]);
        }
        extent = fmax(extent, high - low);
    }
    return extent;
}

brio_status brio_flat_points_take(brio_context *ctx, const double *points, size_t n, brio_flat_points *out) {
    brio_status status = BRIO_OK;
    double *rows = NULL;
    BRIO_TRY(brio_refuse_points(ctx, points, n));
    BRIO_REQUIRE(ctx, n > 0, BRIO_ERR_NO_ANSWER, "no points, so no curve");
    BRIO_TRY(brio_canonical_points(ctx, points, n, &out->order));
    BRIO_TRY(BRIO_ALLOC(ctx, rows, 3 * n));
    brio_copy_points(points, out->order, n, rows);
    out->exponent = brio_exponent(brio_greatest(rows, 3 * n));
    BRIO_TRY(brio_scale(ctx, rows, 3 * n, -out->exponent, rows));
    BRIO_TRY(brio_plane_fit(ctx, rows, n, &out->frame));
    BRIO_REQUIRE(ctx, out->frame.dimension < 3 || out->frame.thickness <= THIN * extent_of(rows, n),
                 BRIO_BECAUSE(ctx, NOT_FLAT, BRIO_ERR_NO_ANSWER),
                 "the points are not in a plane: one is %g off the plane that fits them best",
                 ldexp(out->frame.thickness, out->exponent));
    BRIO_TRY(BRIO_ALLOC(ctx, out->at, n));
    brio_plane_project(&out->frame, rows, n, *out->at);
done:
    brio_release(ctx, rows);
    return status;
}

void brio_flat_points_free(brio_context *ctx, brio_flat_points *flat) {
    brio_release(ctx, flat->order);
    brio_release(ctx, flat->at);
}
