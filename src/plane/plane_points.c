/* The points of a finished triangulation of the plane, see plane_points.h. */
#include "plane/plane_points.h"
#include "base/memory.h"

brio_status brio_plane_take_points(brio_context *ctx, const brio_triangulation2 *t, brio_plane_input *given,
                                   brio_plane_record **record) {
    brio_status status = BRIO_OK;
    *record = NULL;
    BRIO_REQUIRE(ctx, t->stats.coordinates == 2, BRIO_ERR_ARGUMENT,
                 "the triangulation has points in space, made by brio_delaunay2_flat");
    BRIO_REQUIRE(ctx, given->count == t->stats.points, BRIO_ERR_ARGUMENT,
                 "%zu points were given, the triangulation has %zu", given->count, t->stats.points);
    BRIO_TRY(brio_plane_records_new(ctx, given, NULL, 0, record));
    BRIO_REQUIRE(ctx, given->hash == t->points_hash, BRIO_ERR_ARGUMENT,
                 "the points are not those of the triangulation, or were changed since");
done:
    if (status != BRIO_OK) {
        brio_release(ctx, *record);
        *record = NULL;
    }
    return status;
}
