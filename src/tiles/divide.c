/* Points are taken, and divided into tiles by the cuts of cuts.h. */
#include "base/finite.h"
#include "base/memory.h"
#include "tiles/work.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { MOST_SOME = 1 << 15 };
/* Points that wait for a tile's file, and for those of all tiles (brio_waiting_bytes). Chosen. */
enum { BUFFER = 1 << 10, LEAST_BUFFER = 1 << 4, ALL_BUFFERS = 1 << 20 };

/* --- taking --- */

static brio_status flush_raw(brio_tiles *t) {
    brio_status status = brio_store_append(&t->raw, t->some, t->num_some * sizeof *t->some);
    t->num_some = 0;
    return status;
}

static void extend(brio_ball_box *box, const double *record) {
    for (int k = 0; k < 3; k++) {
        if (record[k] < box->low[k]) box->low[k] = record[k];
        if (record[k] > box->high[k]) box->high[k] = record[k];
    }
    if (record[3] > box->weight) box->weight = record[3];
}

static brio_status begin_taking(brio_tiles *t) {
    if (t->some) return BRIO_OK; /* what an earlier call made before it failed is not made again */
    if (t->raw.file < 0) BRIO_FORWARD(brio_store_create(&t->folder, "raw", &t->raw));
    BRIO_FORWARD(brio_tile_cuts_begin(t->ctx, &t->cuts));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->some, MOST_SOME));
    for (int k = 0; k < 3; k++) t->all.low[k] = INFINITY, t->all.high[k] = -INFINITY;
    t->all.weight = t->weighted ? -INFINITY : 0;
    t->lightest = t->weighted ? INFINITY : 0;
    return BRIO_OK;
}

brio_status brio_tiles_take(brio_tiles *t, const double *points, const double *weights, size_t num_points,
                            uint64_t first) {
    BRIO_FORWARD(begin_taking(t));
    for (size_t i = 0; i < num_points; i++) {
        brio_set_point *p = &t->some[t->num_some];
        for (size_t k = 0; k < 3; k++) p->record[k] = points[3 * i + k] + 0.0;
        p->record[3] = weights ? weights[i] + 0.0 : 0.0;
        p->name = first + i;
        static const char *const NAME[4] = {"x", "y", "z", "the weight"};
        for (int k = 0; k < 4; k++)
            BRIO_EXPECT(t->ctx, isfinite(p->record[k]), BRIO_ERR_NOT_FINITE, "point %llu: %s is %s",
                        (unsigned long long)p->name, NAME[k], isnan(p->record[k]) ? "NaN" : "infinite");
        t->stats.points++;
        extend(&t->all, p->record);
        if (p->record[3] < t->lightest) t->lightest = p->record[3];
        brio_tile_cuts_sample(&t->cuts, p->record, p->name);
        if (++t->num_some == MOST_SOME) BRIO_FORWARD(flush_raw(t));
        BRIO_FORWARD(brio_look(t->ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_tiles_end_taking(brio_tiles *t) {
    BRIO_FORWARD(begin_taking(t));
    return flush_raw(t);
}

brio_status brio_tiles_read_raw(brio_tiles *t, uint64_t from, size_t *count) {
    uint64_t left = t->stats.points - from;
    *count = left < MOST_SOME ? (size_t)left : MOST_SOME;
    return brio_store_read(&t->raw, from * sizeof *t->some, t->some, *count * sizeof *t->some);
}

void brio_tiles_drop_raw(brio_tiles *t) {
    brio_store_close(&t->raw);
    brio_store_remove(&t->folder, "raw");
    brio_release(t->ctx, t->some);
    brio_tile_cuts_drop_sample(t->ctx, &t->cuts);
    t->some = NULL;
}

/* --- cuts --- */

brio_status brio_tiles_cut(brio_tiles *t, uint32_t num_tiles, brio_ball_box *box) {
    brio_tile_home *home = NULL;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, home, num_tiles));
    brio_status status = brio_tile_cuts_make(t->ctx, &t->cuts, num_tiles, home);
    for (uint32_t i = 0; status == BRIO_OK && i < num_tiles; i++) {
        memcpy(box[i].low, home[i].low, sizeof home[i].low);
        memcpy(box[i].high, home[i].high, sizeof home[i].high);
        box[i].weight = t->all.weight;
    }
    brio_release(t->ctx, home);
    return status;
}

static brio_status cut_space(brio_tiles *t) {
    brio_ball_box *home = NULL;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, home, t->num_tiles));
    brio_status status = brio_tiles_cut(t, t->num_tiles, home);
    for (uint32_t i = 0; status == BRIO_OK && i < t->num_tiles; i++) t->tile[i].home = home[i];
    brio_release(t->ctx, home);
    return status;
}

/* --- distribution --- */

struct brio_tile_tray {
    brio_store_file file;
    brio_set_point *buffer;
    size_t count, room;
};

typedef brio_tile_tray tray;

/* Returns how many points wait for each tile's file. */
static size_t room_of_tray(const brio_tiles *t) {
    enum { SIZE = sizeof(brio_set_point) };
    return brio_waiting_bytes(t->ctx, t->num_tiles, LEAST_BUFFER * SIZE, BUFFER * SIZE, ALL_BUFFERS * SIZE) / SIZE;
}

double brio_tiles_divide_bytes(const brio_tiles *t) {
    enum { OF_TILE = sizeof(brio_tile) + sizeof(brio_tile_home) + sizeof(brio_ball_box) + sizeof(tray) };
    size_t waiting = room_of_tray(t) * sizeof(brio_set_point) + BRIO_BLOCK_HEADER;
    return MOST_SOME * sizeof(brio_set_point) + brio_tile_cuts_bytes(t->num_tiles) +
           t->num_tiles * (double)(OF_TILE + waiting);
}

brio_status brio_tile_trays_new(brio_tiles *t, brio_tile_tray **out) {
    char name[32];
    BRIO_FORWARD(BRIO_ALLOC_ZERO(t->ctx, *out, t->num_tiles));
    tray *trays = *out;
    for (uint32_t i = 0; i < t->num_tiles; i++) trays[i].file.file = -1;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        snprintf(name, sizeof name, "divided-%u", i);
        BRIO_FORWARD(brio_store_create(&t->folder, name, &trays[i].file));
        brio_store_shut(&trays[i].file);
        trays[i].room = room_of_tray(t);
        BRIO_FORWARD(BRIO_ALLOC(t->ctx, trays[i].buffer, trays[i].room));
    }
    return BRIO_OK;
}

brio_status brio_tile_trays_put(brio_tiles *t, brio_tile_tray *trays, uint32_t tile, const brio_set_point *p) {
    tray *tr = &trays[tile];
    t->tile[tile].raw++;
    tr->buffer[tr->count++] = *p;
    if (tr->count < tr->room) return BRIO_OK;
    tr->count = 0;
    return brio_store_append(&tr->file, tr->buffer, tr->room * sizeof *p);
}

brio_status brio_tile_trays_end(brio_tiles *t, brio_tile_tray *trays) {
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_FORWARD(brio_store_append(&trays[i].file, trays[i].buffer, trays[i].count * sizeof(brio_set_point)));
        trays[i].count = 0;
    }
    return BRIO_OK;
}

void brio_tile_trays_free(brio_tiles *t, brio_tile_tray *trays) {
    for (uint32_t i = 0; trays && i < t->num_tiles; i++) {
        brio_store_close(&trays[i].file);
        brio_release(t->ctx, trays[i].buffer);
    }
    brio_release(t->ctx, trays);
}

static brio_status distribute(brio_tiles *t, tray *trays) {
    size_t some;
    for (uint64_t done = 0; done < t->stats.points; done += some) {
        BRIO_FORWARD(brio_progress(t->ctx, "divide", (double)done / (double)t->stats.points));
        BRIO_FORWARD(brio_tiles_read_raw(t, done, &some));
        for (size_t i = 0; i < some; i++)
            BRIO_FORWARD(brio_tile_trays_put(t, trays, brio_tile_cuts_find(&t->cuts, t->some[i].record), &t->some[i]));
    }
    return brio_tile_trays_end(t, trays);
}

brio_status brio_tiles_divide(brio_tiles *t) {
    tray *trays = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_tiles_end_taking(t));
    BRIO_TRY(cut_space(t));
    BRIO_TRY(brio_tile_trays_new(t, &trays));
    BRIO_TRY(distribute(t, trays));
    brio_tiles_drop_raw(t);
done:
    brio_tile_trays_free(t, trays);
    return status;
}
