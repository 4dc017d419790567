/* One function for each method of brio_surface, so that a test says what it is about. Crusts keep their polygons. */
#ifndef SURFACE_CALLS_H
#define SURFACE_CALLS_H

#include "brio/brio.h"

#define LABELED_OPTIONS                                                                                                \
    { .holes = BRIO_HOLES_CLOSED }
#define CRUST_OPTIONS                                                                                                  \
    { .method = BRIO_SURFACE_POWER_CRUST, .polygons = 1 }
#define OFFSET_OPTIONS                                                                                                 \
    { .method = BRIO_SURFACE_OFFSET, .polygons = 1 }
#define COCONE_OPTIONS                                                                                                 \
    { .method = BRIO_SURFACE_COCONE }

/* samples  NULL, or #P: receives the point of each vertex. */
static inline brio_status make_labeled(brio_context *ctx, const double *points, size_t n, const brio_surface_options *o,
                                       brio_mesh **out, uint32_t *samples, brio_surface_stats *stats) {
    static const brio_surface_options usual = LABELED_OPTIONS;
    brio_status status = brio_surface(ctx, points, n, o ? o : &usual, out, stats);
    for (size_t v = 0; samples && status == BRIO_OK && v < (*out)->num_vertices; v++)
        samples[v] = (uint32_t)brio_property_value(brio_mesh_property(*out, "sample"), v);
    return status;
}

static inline brio_status make_crust(brio_context *ctx, const double *points, size_t n, const brio_surface_options *o,
                                     brio_mesh **out, double *normals, brio_surface_stats *stats) {
    static const brio_surface_options usual = CRUST_OPTIONS;
    brio_surface_options own = o ? *o : usual;
    own.normals = normals;
    own.polygons = own.polygons && !own.simplify;
    return brio_surface(ctx, points, n, &own, out, stats);
}

static inline brio_status make_offset(brio_context *ctx, const double *points, size_t n, double distance,
                                      const brio_surface_options *o, brio_mesh **out, brio_surface_stats *stats) {
    static const brio_surface_options usual = OFFSET_OPTIONS;
    brio_surface_options own = o ? *o : usual;
    own.distance = distance;
    own.polygons = own.polygons && !own.simplify;
    return brio_surface(ctx, points, n, &own, out, stats);
}

static inline brio_status make_cocone(brio_context *ctx, const double *points, size_t n, const brio_surface_options *o,
                                      brio_mesh **out, brio_surface_stats *stats) {
    static const brio_surface_options usual = COCONE_OPTIONS;
    return brio_surface(ctx, points, n, o ? o : &usual, out, stats);
}

#endif
