/* Voronoi and power cells of all points, tile after tile.
 *
 * A tile has the final stars of its points (docs/decisions/017-tiles.md), and the numbers of a cell depend on its star
 * and on the box of all points alone (src/cells). So they are those that one process computes of all points, bit for
 * bit. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "tiles/cells.h"
#include <math.h>
#include <string.h>

typedef struct {
    brio_tiles *t;
    const brio_cells_options *options;
    brio_cell_frame frame;
    const brio_tile_cells_sink *sink;
    brio_tiles_cells_stats *stats;
    uint64_t *site;
    size_t site_capacity;
} cell_run;

void brio_tile_cells_count(const brio_cells *cells, brio_tiles_cells_stats *s) {
    s->cells += cells->num_cells;
    if (cells->face_offsets) s->faces += cells->face_offsets[cells->num_cells];
    for (size_t c = 0; c < cells->num_cells; c++) s->bounded += cells->bounded[c];
}

/* Counts the sites that are not in the box. */
static void count_outside(cell_run *r, const brio_cell_complex *c) {
    const double *box = r->options->box;
    for (size_t i = 0; box && i < c->num_sites; i++) {
        bool inside = true;
        for (size_t k = 0; k < 3; k++) inside &= c->points[3 * i + k] >= box[k] && c->points[3 * i + k] <= box[k + 3];
        r->stats->outside += !inside;
    }
}

/* Names the sites and the neighbours by the points' indices, and hands the cells on. */
static brio_status hand_on(cell_run *r, const brio_slabs *s, brio_cells *cells) {
    size_t n = cells->num_cells;
    BRIO_FORWARD(BRIO_RESERVE(r->t->ctx, r->site, r->site_capacity, n + 1));
    for (size_t c = 0; c < n; c++) r->site[c] = s->points[s->row[cells->site[c]]].name;
    for (size_t f = 0; cells->face_offsets && f < cells->face_offsets[n]; f++) {
        int64_t *neighbour = &cells->face_neighbours[f];
        if (*neighbour >= 0) *neighbour = (int64_t)s->points[s->row[*neighbour]].name;
    }
    return r->sink->take(r->sink->user, cells, r->site);
}

static brio_status run_slab(cell_run *r, brio_slabs *s, size_t slab) {
    brio_cells *cells = NULL;
    BRIO_FORWARD(brio_slabs_take(s, slab, r->options->vertices));
    if (!s->complex.num_sites) return BRIO_OK;
    s->complex.frame = &r->frame;
    BRIO_FORWARD(brio_cells_of_complex(r->t->ctx, &s->complex, r->options, &cells));
    r->stats->region_volume = cells->region_volume;
    count_outside(r, &s->complex);
    brio_status status = hand_on(r, s, cells);
    brio_cells_free(cells);
    return status;
}

static brio_status run_tile(cell_run *r, const brio_halo_reader *halo, uint32_t tile, brio_bar bar, uint64_t *done) {
    brio_slabs s;
    brio_status status = BRIO_OK;
    double all = (double)(r->t->stats.vertices + 1);
    BRIO_TRY(brio_slabs_open(r->t, tile, halo, &s));
    for (size_t slab = 0; slab < s.count; slab++) {
        uint64_t next = *done + r->t->tile[tile].vertices / s.count;
        brio_progress_part(r->t->ctx, bar, (double)*done / all, (double)next / all);
        BRIO_TRY(run_slab(r, &s, slab));
        *done = next;
    }
done:
    brio_slabs_free(&s);
    return status;
}

brio_status brio_tile_region(brio_context *ctx, const brio_cells_options *options, double *volume) {
    brio_tetrahedron none;
    const brio_cell_frame frame = {.weight = 0};
    const brio_cell_complex nothing = {.tet = &none, .frame = &frame};
    brio_cells *cells = NULL;
    BRIO_FORWARD(brio_cells_of_complex(ctx, &nothing, options, &cells));
    *volume = cells->region_volume;
    brio_cells_free(cells);
    return BRIO_OK;
}

static brio_cell_frame frame_of(const brio_tiles *t) {
    brio_cell_frame f = {.weight = fmax(fabs(t->all.weight), fabs(t->lightest))};
    memcpy(f.low, t->all.low, sizeof f.low);
    memcpy(f.high, t->all.high, sizeof f.high);
    return f;
}

brio_status brio_tiles_run_cells(brio_tiles *t, const brio_cells_options *options, const brio_tile_cells_sink *sink,
                                 brio_tiles_cells_stats *stats) {
    cell_run r = {.t = t, .options = options, .frame = frame_of(t), .sink = sink, .stats = stats};
    const brio_halo_reader halo = brio_tile_own_halo(t);
    brio_bar bar = brio_progress_bar(t->ctx);
    brio_status status = BRIO_OK;
    uint64_t done = 0;
    for (uint32_t i = 0; i < t->num_tiles; i++)
        if (t->tile[i].points) BRIO_TRY(run_tile(&r, &halo, i, bar, &done));
    if (!t->stats.vertices) status = brio_tile_region(t->ctx, options, &stats->region_volume);
done:
    brio_progress_part(t->ctx, bar, 0, 1);
    brio_release(t->ctx, r.site);
    return status;
}

brio_status brio_tile_run_cells(brio_tiles *t, uint32_t tile, const brio_cells_options *options,
                                const brio_halo_reader *halo, const brio_tile_cells_sink *sink,
                                brio_tiles_cells_stats *stats) {
    cell_run r = {.t = t, .options = options, .frame = frame_of(t), .sink = sink, .stats = stats};
    brio_bar bar = brio_progress_bar(t->ctx);
    uint64_t done = 0;
    brio_status status = run_tile(&r, halo, tile, bar, &done);
    brio_progress_part(t->ctx, bar, 0, 1);
    brio_release(t->ctx, r.site);
    return status;
}

/* --- the public function --- */

/* What the caller's function gets, and what is counted of it. */
typedef struct {
    brio_context *ctx;
    brio_tile_cells_fn take;
    void *user;
    brio_tiles_cells_stats *stats;
    double lost;
} caller;

/* Adds the volumes of bounded cells. The rounding errors go to c->lost [Neumaier 1974]. */
static void add_volumes(caller *c, const brio_cells *cells) {
    for (size_t i = 0; i < cells->num_cells; i++) {
        double x = cells->volume[i], sum = c->stats->volume_sum, next = sum + x;
        if (!cells->bounded[i]) continue;
        if (isfinite(next)) c->lost += fabs(sum) >= fabs(x) ? (sum - next) + x : (x - next) + sum;
        c->stats->volume_sum = next;
    }
}

static brio_status call(void *user, brio_cells *cells, const uint64_t *site) {
    caller *c = user;
    brio_tile_cells_count(cells, c->stats);
    add_volumes(c, cells);
    BRIO_EXPECT(c->ctx, !c->take(cells, site, c->user), BRIO_ERR_CANCELLED,
                "cells: the caller's function ended the run");
    return BRIO_OK;
}

brio_status brio_tile_cells_check(brio_context *ctx, const brio_tiles_cells_stats *s) {
    static const double MOST = 0.01;
    double filled = s->volume_sum / s->region_volume;
    if (!s->cells || !isnormal(s->region_volume) || !isfinite(filled)) return BRIO_OK;
    BRIO_EXPECT(ctx, fabs(filled - 1) <= MOST, BRIO_ERR_NO_ANSWER,
                "the cells fill %.3g of the region: it is too small or too thin beside its distance from the points",
                filled);
    return BRIO_OK;
}

static brio_status check_call(brio_context *ctx, const brio_tiles *t, const brio_cells_options *o, int ordered) {
    BRIO_EXPECT(ctx, ordered >= 0 && ordered <= 2, BRIO_ERR_ARGUMENT, "cells: ordered is %d, not 0, 1 or 2", ordered);
    BRIO_EXPECT(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_EXPECT(ctx, t->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(ctx, t->stars, BRIO_ERR_ARGUMENT, "the tiles have no stars: brio_tiles_options asks for them");
    BRIO_EXPECT(ctx, !ordered || !o->vertices, BRIO_ERR_ARGUMENT,
                "cells with vertices come tile after tile, not in the order of their sites");
    BRIO_EXPECT(ctx, t->stats.dimension == 3 || !t->stats.points, BRIO_ERR_NO_ANSWER,
                "all points are in a plane: their cells are computed without tiles only");
    return BRIO_OK;
}

brio_status brio_tiles_cells(brio_context *ctx, brio_tiles *t, const brio_cells_options *options, int ordered,
                             brio_tile_cells_fn take, void *user) {
    BRIO_DOOR;
    brio_cells_options o = {0};
    brio_tiles_cells_stats s = {.size = sizeof s, .region_volume = INFINITY};
    caller c = {.ctx = ctx, .take = take, .user = user, .stats = &s};
    const brio_tile_cells_sink sink = {call, &c};
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_cells_options, options, &o));
    BRIO_FORWARD(check_call(ctx, t, &o, ordered));
    brio_status status =
        ordered ? brio_tiles_run_ordered_cells(t, &o, ordered == 1, &sink, &s) : brio_tiles_run_cells(t, &o, &sink, &s);
    t->stats.scratch_bytes = t->folder.most;
    BRIO_FORWARD(status);
    s.volume_sum += c.lost;
    BRIO_FORWARD(brio_tile_cells_check(ctx, &s));
    t->cells = s;
    return BRIO_OK;
}

const brio_tiles_cells_stats *brio_tiles_cells_facts(const brio_tiles *t) {
    return &t->cells;
}
