/* A surface through points: one call for all methods of the table, whose options are checked and completed here. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/scratch_file.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "order/canonical_points.h"
#include "reconstruct/surface/method.h"
#include "tiles/work.h"
#include <math.h>
#include <stdio.h>

/* Share of the estimate that is needed in any case. Chosen. */
static const double SURE = 0.75;

/* Writes the names of the methods that have an option, with commas between. */
static void list_methods(const char *option, char *text, size_t room) {
    size_t used = 0;
    text[0] = 0;
    for (int m = 0; m < BRIO_SURFACE_END; m++) {
        if (brio_surface_method_has((brio_surface_method)m, option) && used < room)
            used += (size_t)snprintf(text + used, room - used, "%s%s", used ? ", " : "",
                                     brio_method_row_of((brio_surface_method)m)->enumerator);
    }
}

/* Refuses options of another method, which are a mistake. */
static brio_status check_uses(brio_context *ctx, const brio_surface_options *o) {
    const struct {
        const char *name;
        bool set;
    } uses[] = {{"noise", o->noise == BRIO_NOISE_SMOOTH},
                {"evidence", o->evidence != NULL},
                {"normals", o->normals != NULL},
                {"open", o->open != 0},
                {"holes", o->holes == BRIO_HOLES_CLOSED},
                {"simplify", o->simplify != 0},
                {"confidence", o->confidence != 0},
                {"polygons", o->polygons != 0},
                {"distance", o->distance != 0},
                {"poles.labeling", o->poles.labeling != 0},
                {"poles.sharp", o->poles.sharp != 0},
                {"poles.sampling_density", o->poles.sampling_density != 0},
                {"poles.solid", o->poles.solid != NULL},
                {"theta", o->theta != 0},
                {"boundaries", o->boundaries != 0},
                {"density", o->density != 0},
                {"pieces", o->pieces > 1},
                {"explanation", o->explanation != NULL},
                {"tiles", o->tiles != NULL}};
    for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
        char names[160];
        if (!uses[i].set || brio_surface_method_has(o->method, uses[i].name)) continue;
        list_methods(uses[i].name, names, sizeof names);
        return brio_fail(ctx, BRIO_ERR_ARGUMENT, "%s is an option of %s, and the method is %s", uses[i].name, names,
                         brio_method_row_of(o->method)->enumerator);
    }
    return BRIO_OK;
}

/* Takes the options and fills in the defaults that all methods share. */
static brio_status settle(brio_context *ctx, const brio_surface_options *options, brio_surface_options *o) {
    *o = (brio_surface_options){0};
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_surface_options, options, o));
    if (o->explanation) *o->explanation = NULL;
    if (!o->explained) o->explained = BRIO_MOST_EXPLAINED;
    BRIO_EXPECT(ctx, (unsigned)o->method < BRIO_SURFACE_END, BRIO_ERR_ARGUMENT, "no such method: %d", (int)o->method);
    BRIO_EXPECT(ctx, (unsigned)o->noise < BRIO_NOISE_END, BRIO_ERR_ARGUMENT, "no such way with noise: %d",
                (int)o->noise);
    BRIO_EXPECT(ctx, (unsigned)o->holes < BRIO_HOLES_END, BRIO_ERR_ARGUMENT, "no such way with holes: %d",
                (int)o->holes);
    BRIO_FORWARD(check_uses(ctx, o));
    BRIO_EXPECT(ctx, o->open >= 0 && o->open < INFINITY, BRIO_ERR_ARGUMENT,
                "open: %g spacings, expected a finite number, 0 or more", o->open);
    BRIO_EXPECT(ctx, !o->polygons || !o->simplify, BRIO_ERR_ARGUMENT,
                "a simplified surface has triangles, no polygons");
    if (!o->seed) o->seed = BRIO_SEED;
    return BRIO_OK;
}

/* Frees the explanation: a failure behind it leaves none. */
static void drop_explanation(const brio_surface_options *o) {
    if (!o->explanation) return;
    brio_explanation_free(*o->explanation);
    *o->explanation = NULL;
}

/* Of a sample of positions. With over KEPT all points count as if they had positions of their own. */
enum { ROOM = 1 << 11, KEPT = ROOM / 4 * 3 };

/* Estimates how many positions points have: counts those whose hash is a multiple of a number.   seen  ROOM zeros. */
static double count_positions(const double *points, size_t num_points, uint64_t *seen) {
    uint64_t step = num_points / (KEPT / 2) + 1;
    size_t count = 0;
    for (size_t i = 0; i < num_points; i++) {
        uint64_t hash = brio_position_hash(points + 3 * i), at = brio_mix(hash) % ROOM;
        if (hash % step != 0) continue;
        while (seen[at] != 0 && seen[at] != hash) at = (at + 1) % ROOM;
        if (seen[at] == hash || hash == 0) continue;
        if (++count > KEPT) return (double)num_points;
        seen[at] = hash;
    }
    return fmin((double)count * (double)step, (double)num_points);
}

/* Bytes that a surface needs, or that there are: of scratch files, and of memory for a tile. */
typedef struct {
    double disk, tile;
} space;

static space needed(double num_points, const brio_surface_options *o) {
    space need = {brio_method_bytes(brio_method_row_of(o->method), num_points, o), 0};
    if (!o->tiles) return need;
    need.tile = brio_tiles_least_memory(o->tiles, num_points);
    return need;
}

static bool fits(space need, space there) {
    return SURE * need.disk <= there.disk && SURE * need.tile <= there.tile;
}

/* Refuses points for which the folder of scratch files, or the memory for a tile, has no room: before the work, not an
 * hour after. Points that are given twice need it once; they are looked for only where it matters. */
static brio_status require_room(brio_context *ctx, const double *points, size_t num_points,
                                const brio_surface_options *o) {
    uint64_t disk, *seen; /* not on the stack, of which callers may have 64 KiB */
    space there = {INFINITY, (double)brio_memory_limit(ctx)}, need = needed((double)num_points, o);
    if (brio_scratch_room(ctx, &disk)) there.disk = (double)disk;
    if (fits(need, there)) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, seen, ROOM));
    need = needed(count_positions(points, num_points, seen), o);
    brio_release(ctx, seen);
    BRIO_EXPECT(ctx, SURE * need.disk <= there.disk, BRIO_ERR_NO_MEMORY,
                "%s: %zu points need about %.0f MB of scratch files, and this disk has room for %.0f MB", ctx->scratch,
                num_points, need.disk / 1e6, there.disk / 1e6);
    BRIO_EXPECT(ctx, fits(need, there), BRIO_ERR_NO_MEMORY,
                "each tile needs about %.1f MB of the %.1f MB that are allowed: take about %.0f times as many tiles",
                need.tile / 1e6, there.tile / 1e6, ceil(1.2 * need.tile / there.tile));
    return BRIO_OK;
}

/* Makes the surface by its method, from triangulations that are made in tiles if options say so. */
static brio_status make(brio_context *ctx, const double *points, size_t num_points, const brio_surface_options *o,
                        brio_mesh *mesh, brio_surface_stats *stats) {
    brio_triangulator in_tiles;
    const brio_method_row *method = brio_method_row_of(o->method);
    if (!o->tiles) return method->make(ctx, points, num_points, o, mesh, stats);
    BRIO_EXPECT(ctx, !ctx->triangulator, BRIO_ERR_ARGUMENT,
                "tiles: ranks triangulate for this surface, in their tiles");
    BRIO_FORWARD(brio_triangulate_in_tiles(ctx, o->tiles, &in_tiles));
    ctx->triangulator = &in_tiles;
    brio_status status = method->make(ctx, points, num_points, o, mesh, stats);
    ctx->triangulator = NULL;
    return status;
}

brio_status brio_surface(brio_context *ctx, const double *points, size_t num_points,
                         const brio_surface_options *options, brio_mesh **out, brio_surface_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_surface_options o = {0};
    brio_surface_stats s = {0};
    brio_tiles_options tiles = {0};
    brio_mesh *mesh = NULL;
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_surface_stats, stats));
    BRIO_TRY(settle(ctx, options, &o));
    if (o.tiles) {
        BRIO_TRY(BRIO_TAKE(ctx, brio_tiles_options, o.tiles, &tiles));
        o.tiles = &tiles;
    }
    BRIO_TRY(brio_refuse_points(ctx, points, num_points)); /* before anything is read by their number */
    BRIO_TRY(require_room(ctx, points, num_points, &o));
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(make(ctx, points, num_points, &o, mesh, &s));
    *out = mesh;
    mesh = NULL;
done:
    if (status != BRIO_OK) drop_explanation(&o);
    BRIO_GIVE(brio_surface_stats, stats, &s);
    brio_mesh_free(mesh);
    return status;
}
