/* Surfaces of more points than fit in memory: brio_surface, whose arrays are in scratch files, with triangulations that
 * are made tile after tile. A triangulation is the same whoever makes it, so the surface has the same bits. */
#include "base/float_state.h"
#include "base/memory.h"
#include "tiles/gather.h"
#include "tiles/work.h"
#include "triangulation/triangulator.h"

brio_status brio_tiles_gather(brio_tiles *t, const double *points, size_t num_points, brio_triangulation **out) {
    brio_context *ctx = t->ctx;
    brio_status status = BRIO_OK;
    uint64_t *first = NULL;
    brio_gather g = {.ctx = ctx};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, first, t->num_tiles + 1));
    for (uint32_t i = 0; i < t->num_tiles; i++) first[i + 1] = first[i] + t->tile[i].tetrahedra;
    BRIO_TRY(brio_gather_new(ctx, first, t->num_tiles, t->stats.hull_facets, &g));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        brio_tile_part part = {.size = sizeof part};
        brio_tile_neighbour(*neighbours)[4] = NULL;
        status = brio_tiles_part(ctx, t, i, &part);
        if (status == BRIO_OK) status = BRIO_ALLOC(ctx, neighbours, part.num_tetrahedra + 1);
        if (status == BRIO_OK) status = brio_tiles_neighbours(ctx, t, i, &part, neighbours);
        if (status == BRIO_OK) brio_gather_part(&g, i, &part, (const brio_tile_neighbour(*)[4])neighbours);
        brio_tile_part_free(ctx, &part);
        brio_release(ctx, neighbours);
        BRIO_TRY(status);
    }
    status = brio_gather_end(&g, points, num_points, t->stats.duplicates, out);
done:
    brio_gather_free(&g);
    brio_release(ctx, first);
    return status;
}

/* Triangulates the tiles in memory, one after another, also where the arrays of the surface are in scratch files: what
 * the context's limit leaves is for one tile then. */
static brio_status run_in_memory(brio_tiles *t) {
    char *scratch = t->ctx->scratch;
    t->ctx->scratch = NULL;
    brio_status status = brio_tiles_run(t->ctx, t);
    t->ctx->scratch = scratch;
    return status;
}

/* Triangulates points in tiles. */
static brio_status make(void *user, brio_context *ctx, const double *points, size_t num_points,
                        brio_triangulation **out) {
    brio_status status = BRIO_OK;
    brio_tiles *t = NULL;
    *out = NULL;
    BRIO_TRY(brio_tiles_new(ctx, user, &t));
    BRIO_TRY(brio_tiles_add(ctx, t, points, NULL, num_points));
    BRIO_TRY(run_in_memory(t));
    status = t->stats.dimension < 3 ? brio_delaunay(ctx, points, NULL, num_points, NULL, out)
                                    : brio_tiles_gather(t, points, num_points, out);
done:
    brio_tiles_free(t);
    return status;
}

brio_status brio_tiles_surface(brio_context *ctx, const brio_tiles_options *tiles, const double *points,
                               size_t num_points, const brio_surface_options *options, brio_mesh **out,
                               brio_surface_stats *stats) {
    BRIO_DOOR;
    brio_tiles_options o = *tiles;
    struct brio_triangulator by = {&o, make};
    *out = NULL;
    BRIO_EXPECT(ctx, o.stars == 0 && o.key == 0, BRIO_ERR_ARGUMENT, "tiles of a surface have neither stars nor a key");
    BRIO_EXPECT(ctx, !options || options->method == BRIO_SURFACE_LABELED, BRIO_ERR_ARGUMENT,
                "labeled-delaunay alone works in tiles");
    ctx->triangulator = &by;
    brio_status status = brio_surface(ctx, points, num_points, options, out, stats);
    ctx->triangulator = NULL;
    return status;
}
