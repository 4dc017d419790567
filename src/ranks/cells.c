/* Cells by ranks: each rank computes those of its tiles, whose stars are final. Of other ranks it needs the points of
 * its halos, and the sums.
 *
 * In the order of their sites each rank has those of a range. The ranges follow from a sample of the sites that all
 * ranks have, so each rank gets about as many. The cells of a slab go to their ranks when it was computed; there
 * they are divided into files and sorted, as by one process (tiles/ordered_cells.c).
 *
 * The volume of all cells is summed exactly, as a whole number of 2^-1074, and rounded once. So it is the same for
 * every number of ranks and tiles.
 *
 * Based on: Frazer, McKellar. Samplesort: a sampling approach to minimal storage tree sorting. JACM 1970. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
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
    uint64_t scratch_bytes; /* of all ranks, the most that there were */
    const brio_set_point *halo;
    brio_ordered_cells *order; /* NULL: cells are handed on as they are computed */
    uint64_t *first;           /* of each rank but 0, the least site of its range */
} cell_run;

static brio_status hand_on(void *user, brio_cells *cells, const uint64_t *site) {
    const cell_run *c = user;
    if (!c->take) return BRIO_OK;
    BRIO_EXPECT(c->r->ctx, !c->take(cells, site, c->user), BRIO_ERR_CANCELLED,
                "cells: the caller's function ended the run");
    return BRIO_OK;
}

/* --- to the ranks of their sites --- */

static int rank_of_site(const cell_run *c, uint64_t site) {
    int low = 0, high = c->r->ranks - 1; /* the number of ranges that begin at it or below, without that of rank 0 */
    while (low < high) {
        int middle = (low + high) / 2;
        if (c->first[middle] <= site)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Sends the cells that wait, and takes those of this rank's range.   more  whether this rank may have more of this
 * tile: see finish_tile. */
static brio_status pass_cells(cell_run *c, bool more) {
    BRIO_FORWARD(brio_exchange_now(&c->r->x, more));
    for (int i = 0; i < c->r->ranks; i++) {
        const uint8_t *bytes = c->r->x.received[i].bytes;
        size_t size;
        for (uint64_t at = 0; at < c->r->x.received[i].size; at += size)
            BRIO_FORWARD(brio_ordered_cells_put(c->order, bytes + at, &size));
    }
    return BRIO_OK;
}

/* Passes cells until no rank has any of its tile: the slabs of tiles are not equally many. */
static brio_status finish_tile(cell_run *c) {
    do BRIO_FORWARD(pass_cells(c, false));
    while (c->r->x.any);
    return BRIO_OK;
}

/* Takes the cells of a slab. */
static brio_status take_cells(void *user, brio_cells *cells, const uint64_t *site) {
    cell_run *c = user;
    const void *bytes;
    size_t size;
    brio_tile_cells_count(cells, &c->stats);
    for (size_t i = 0; i < cells->num_cells; i++)
        if (cells->bounded[i]) brio_exact_add(&c->volume, cells->volume[i]);
    if (!c->order) return hand_on(c, cells, site);
    for (size_t i = 0; i < cells->num_cells; i++) {
        BRIO_FORWARD(brio_ordered_cells_pack(c->order, cells, i, site[i], &bytes, &size));
        BRIO_FORWARD(brio_exchange_put(&c->r->x, rank_of_site(c, site[i]), bytes, size));
    }
    return pass_cells(c, true);
}

/* --- ranges of sites --- */

enum { SAMPLE_A_TILE = 128 }; /* sites; a part of a rank has 64, so that its cells vary by an eighth. Chosen */

/* Sends all ranks the sites of this one whose hash is small. */
static brio_status send_sample(brio_ranks *r) {
    brio_set_point *points = NULL;
    uint64_t *site = NULL;
    size_t n = 0, capacity = 0;
    uint64_t wanted = (uint64_t)SAMPLE_A_TILE * r->t->num_tiles * (uint64_t)r->ranks, all = r->facts.points;
    uint64_t most = all > wanted ? UINT64_MAX / all * wanted : UINT64_MAX;
    brio_status status = BRIO_OK;
    for (uint32_t i = 0; i < r->t->num_tiles; i++) {
        const brio_tile *facts = &r->t->tile[i];
        if (!facts->points) continue;
        BRIO_TRY(BRIO_ALLOC(r->ctx, points, facts->points));
        BRIO_TRY(brio_tile_points(r->t, facts->place, facts->points, points));
        for (uint32_t k = 0; k < facts->points; k++) {
            if (brio_mix(points[k].name) > most) continue;
            BRIO_TRY(BRIO_RESERVE(r->ctx, site, capacity, n + 1));
            site[n++] = points[k].name;
        }
        brio_release(r->ctx, points);
        points = NULL;
    }
    status = brio_exchange_all(&r->x, site, n * sizeof *site);
done:
    brio_release(r->ctx, points);
    brio_release(r->ctx, site);
    return status;
}

/* Cuts the sites of all ranks into ranges of about as many, and makes the files of this rank's. */
static brio_status begin_order(cell_run *c, const brio_cells_options *o, bool with_faces) {
    brio_ranks *r = c->r;
    size_t n = 0, parts = (size_t)BRIO_ORDERED_PARTS * r->t->num_tiles, all = parts * (size_t)r->ranks;
    uint64_t *site = NULL, *end = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(send_sample(r));
    for (int i = 0; i < r->ranks; i++) n += r->x.from[i]->size / sizeof *site;
    BRIO_TRY(BRIO_ALLOC(r->ctx, site, n + 1));
    BRIO_TRY(BRIO_ALLOC(r->ctx, end, parts));
    BRIO_TRY(BRIO_ALLOC(r->ctx, c->first, r->ranks));
    n = 0;
    for (int i = 0; i < r->ranks; i++) {
        size_t size = r->x.from[i]->size;
        if (size) memcpy(site + n, r->x.from[i]->bytes, size);
        n += size / sizeof *site;
    }
    site[n] = 0; /* of no sites */
    BRIO_TRY(brio_sort_many_keys(r->ctx, site, n));
    for (size_t i = 1; i < (size_t)r->ranks; i++) c->first[i - 1] = site[n * i / (size_t)r->ranks];
    for (size_t i = 1; i < parts; i++) end[i - 1] = site[n * ((size_t)r->rank * parts + i) / all];
    status = brio_ordered_cells_new(r->t, o, with_faces, end, &c->order);
done:
    brio_release(r->ctx, site);
    brio_release(r->ctx, end);
    return status;
}

/* --- tiles --- */

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
    BRIO_TRY(brio_ranks_rows(r, place, facts->halo, brio_ranks_own_points, sizeof *halo, halo));
    c->halo = halo;
    if (facts->points) BRIO_TRY(brio_tile_run_cells(r->t, tile, o, &reader, &sink, &c->stats));
    if (c->order) status = finish_tile(c);
done:
    brio_release(r->ctx, place);
    brio_release(r->ctx, halo);
    return status;
}

/* --- the sums of all ranks --- */

typedef struct {
    brio_tiles_cells_stats stats;
    brio_exact_sum volume;
    uint64_t scratch_bytes;
} share;

static brio_status add_shares(cell_run *c, const brio_cells_options *o) {
    brio_ranks *r = c->r;
    share s = {c->stats, c->volume, r->t->folder.most};
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
        c->scratch_bytes += s.scratch_bytes;
    }
    all.volume_sum = brio_exact_rounded(&volume);
    if (!all.cells) BRIO_FORWARD(brio_tile_region(r->ctx, o, &all.region_volume));
    BRIO_FORWARD(brio_tile_cells_check(r->ctx, &all));
    c->stats = all;
    return BRIO_OK;
}

static brio_status check_call(const brio_ranks *r, const brio_cells_options *o, int ordered) {
    BRIO_EXPECT(r->ctx, ordered >= 0 && ordered <= 2, BRIO_ERR_ARGUMENT, "cells: ordered is %d, not 0, 1 or 2",
                ordered);
    BRIO_EXPECT(r->ctx, !ordered || !o->vertices, BRIO_ERR_ARGUMENT,
                "cells with vertices come tile after tile, not in the order of their sites");
    BRIO_EXPECT(r->ctx, r->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(r->ctx, r->t->stars, BRIO_ERR_ARGUMENT, "the tiles have no stars: brio_ranks_options asks for them");
    BRIO_EXPECT(r->ctx, r->facts.dimension == 3 || !r->facts.points, BRIO_ERR_NO_ANSWER,
                "all points are in a plane: their cells are computed by one process only");
    return BRIO_OK;
}

static brio_status run(cell_run *c, const brio_cells_options *options, int ordered) {
    brio_ranks *r = c->r;
    brio_cells_options o = {0};
    BRIO_FORWARD(BRIO_TAKE(r->ctx, brio_cells_options, options, &o));
    BRIO_FORWARD(check_call(r, &o, ordered));
    if (ordered) BRIO_FORWARD(begin_order(c, &o, ordered == 1));
    for (uint32_t i = 0; i < r->t->num_tiles; i++) {
        BRIO_FORWARD(brio_progress(r->ctx, "cells", (double)i / r->t->num_tiles));
        BRIO_FORWARD(run_tile(c, &o, i));
    }
    BRIO_FORWARD(add_shares(c, &o));
    return ordered ? brio_ordered_cells_hand_on(c->order, &(brio_tile_cells_sink){hand_on, c}) : BRIO_OK;
}

brio_status brio_ranks_cells(brio_context *ctx, brio_ranks *r, const brio_cells_options *options, int ordered,
                             brio_tile_cells_fn take, void *user) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    cell_run c = {.r = r, .take = take, .user = user, .stats = {.size = sizeof c.stats, .region_volume = INFINITY}};
    brio_status status = brio_exchange_agree(&r->x, run(&c, options, ordered));
    if (status == BRIO_OK) r->cells = c.stats, r->facts.scratch_bytes = c.scratch_bytes;
    brio_ordered_cells_free(c.order);
    brio_release(ctx, c.first);
    return status;
}

const brio_tiles_cells_stats *brio_ranks_cells_facts(const brio_ranks *r) {
    return &r->cells;
}
