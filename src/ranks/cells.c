/* Cells by ranks: each rank computes those of its tiles, whose stars are final. Of other ranks it needs the points of
 * its halos, and the sums.
 *
 * The volume of all cells is summed exactly, as a whole number of 2^-1074, and rounded once. So it is the same for
 * every number of ranks and tiles. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "certificate/exact_sum.h"
#include "ranks/work.h"
#include "tiles/cells.h"
#include <math.h>
#include <string.h>

/* --- the cells of a rank --- */

typedef struct {
    brio_ranks *r;
    brio_tile_cells_fn take; /* NULL: nobody */
    void *user;
    brio_tiles_cells_stats stats;
    brio_exact_sum volume;
    double lost; /* not used */
    const brio_set_point *halo;
} cell_run;

static brio_status take_cells(void *user, brio_cells *cells, const uint64_t *site) {
    cell_run *c = user;
    brio_tile_cells_count(cells, &c->stats, &c->lost);
    for (size_t i = 0; i < cells->num_cells; i++)
        if (cells->bounded[i]) brio_exact_add(&c->volume, cells->volume[i]);
    if (!c->take) return BRIO_OK;
    BRIO_EXPECT(c->r->ctx, !c->take(cells, site, c->user), BRIO_ERR_CANCELLED,
                "cells: the caller's function ended the run");
    return BRIO_OK;
}

/* Copies the halo that was fetched, as a brio_halo_fn. */
static brio_status copy_halo(void *user, const uint64_t *halo, size_t n, brio_set_point *points) {
    const cell_run *c = user;
    (void)halo;
    if (n) memcpy(points, c->halo, n * sizeof *points);
    return BRIO_OK;
}

/* Fetches the halo of a tile, which all ranks do at once, and computes its cells. */
static brio_status run_tile(cell_run *c, const brio_cells_options *o, uint32_t tile) {
    brio_ranks *r = c->r;
    const brio_tile *facts = &r->t->tile[tile];
    const brio_tile_cells_sink sink = {take_cells, c};
    const brio_halo_reader reader = {copy_halo, c};
    uint64_t *place = NULL;
    brio_set_point *halo = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(r->ctx, place, facts->halo + 1));
    BRIO_TRY(BRIO_ALLOC(r->ctx, halo, facts->halo + 1));
    BRIO_TRY(brio_tile_halo(r->t, tile, place));
    BRIO_TRY(brio_ranks_rows(r, place, facts->halo, brio_ranks_own_point, sizeof *halo, halo));
    c->halo = halo;
    if (facts->points) status = brio_tile_run_cells(r->t, tile, o, &reader, &sink, &c->stats);
done:
    brio_release(r->ctx, place);
    brio_release(r->ctx, halo);
    return status;
}

/* --- the sums of all ranks --- */

typedef struct {
    brio_tiles_cells_stats stats;
    brio_exact_sum volume;
} share;

static brio_status add_shares(cell_run *c, const brio_cells_options *o) {
    brio_ranks *r = c->r;
    share s = {c->stats, c->volume};
    brio_tiles_cells_stats all = {.size = sizeof all, .region_volume = INFINITY};
    brio_exact_sum volume = {.terms = 0};
    brio_exact_carry(&s.volume);
    BRIO_FORWARD(brio_exchange_all(&r->x, &s, sizeof s));
    for (int i = 0; i < r->ranks; i++) {
        memcpy(&s, r->x.from[i]->bytes, sizeof s);
        all.cells += s.stats.cells;
        all.bounded += s.stats.bounded;
        all.faces += s.stats.faces;
        all.outside += s.stats.outside;
        all.region_volume = fmin(all.region_volume, s.stats.region_volume);
        brio_exact_add_sum(&volume, &s.volume);
    }
    all.volume_sum = brio_exact_rounded(&volume);
    if (!all.cells) BRIO_FORWARD(brio_tile_region(r->ctx, o, &all.region_volume));
    BRIO_FORWARD(brio_tile_cells_check(r->ctx, &all));
    r->cells = all;
    return BRIO_OK;
}

static brio_status run(brio_ranks *r, const brio_cells_options *options, brio_tile_cells_fn take, void *user) {
    cell_run c = {.r = r, .take = take, .user = user, .stats = {.size = sizeof c.stats, .region_volume = INFINITY}};
    brio_cells_options o = {0};
    BRIO_FORWARD(BRIO_TAKE(r->ctx, brio_cells_options, options, &o));
    BRIO_EXPECT(r->ctx, r->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(r->ctx, r->t->stars, BRIO_ERR_ARGUMENT, "the tiles have no stars: brio_ranks_options asks for them");
    BRIO_EXPECT(r->ctx, r->facts.dimension == 3 || !r->facts.points, BRIO_ERR_NO_ANSWER,
                "all points are in a plane: their cells are computed by one process only");
    for (uint32_t i = 0; i < r->t->num_tiles; i++) {
        BRIO_FORWARD(brio_progress(r->ctx, "cells", (double)i / r->t->num_tiles));
        BRIO_FORWARD(run_tile(&c, &o, i));
    }
    return add_shares(&c, &o);
}

brio_status brio_ranks_cells(brio_context *ctx, brio_ranks *r, const brio_cells_options *options,
                             brio_tile_cells_fn take, void *user) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    return brio_exchange_agree(&r->x, run(r, options, take, user));
}

const brio_tiles_cells_stats *brio_ranks_cells_facts(const brio_ranks *r) {
    return &r->cells;
}
