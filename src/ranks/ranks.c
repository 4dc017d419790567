/* The public functions of brio/ranks.h: each ends when all ranks agree that it went well. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/versioned.h"
#include "ranks/exchange.h"
#include "ranks/work.h"
#include <string.h>

enum { TILES = 4, MOST_TILES = 1 << 12 };

/* --- life --- */

/* Goes on with what a run before left only if it is there on all ranks. */
static brio_status agree_on_points(brio_ranks *r) {
    BRIO_FORWARD(brio_exchange_now(&r->x, !r->t->has_points));
    if (r->x.any && r->t->has_points) brio_tiles_forget(r->t);
    return BRIO_OK;
}

static brio_status open_tiles(brio_ranks *r, const brio_ranks_options *options) {
    brio_ranks_options o = {0};
    BRIO_FORWARD(BRIO_TAKE(r->ctx, brio_ranks_options, options, &o));
    brio_tiles_options of_tiles = {
        .size = sizeof of_tiles, .scratch = o.scratch, .tiles = o.tiles ? o.tiles : TILES, .stars = o.stars};
    BRIO_EXPECT(r->ctx, of_tiles.tiles <= MOST_TILES, BRIO_ERR_ARGUMENT, "%u tiles of a rank; at most %d", o.tiles,
                MOST_TILES);
    if (o.key) of_tiles.key = brio_hash(brio_hash(o.key, (uint64_t)r->ranks), (uint64_t)r->rank) | 1;
    BRIO_FORWARD(brio_tiles_new(r->ctx, &of_tiles, &r->t));
    r->t->first_place = (uint64_t)r->rank << RANK_SHIFT;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->ctx, r->sample, r->t->num_tiles));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->ctx, r->seen, r->t->num_tiles));
    for (uint32_t i = 0; i < r->t->num_tiles; i++) r->sample[i].ctx = r->ctx;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->ctx, r->served, r->ranks * RANK_SLOTS));
    return agree_on_points(r);
}

brio_status brio_ranks_prepare(brio_context *ctx, const brio_transport *transport, brio_ranks **out) {
    brio_ranks *r = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, r, 1));
    r->ctx = ctx, r->rank = transport->rank, r->ranks = transport->ranks;
    r->cells.size = sizeof r->cells;
    BRIO_TRY(brio_exchange_new(ctx, transport, &r->x));
    *out = r;
    r = NULL;
done:
    brio_ranks_free(r);
    return status;
}

brio_status brio_ranks_open(brio_ranks *r, const brio_ranks_options *options) {
    return brio_exchange_agree(&r->x, open_tiles(r, options));
}

brio_status brio_ranks_new(brio_context *ctx, const brio_transport *transport, const brio_ranks_options *options,
                           brio_ranks **out) {
    BRIO_DOOR;
    brio_transport how;
    *out = NULL;
    BRIO_FORWARD(brio_exchange_take(ctx, transport, &how));
    brio_status status = brio_ranks_prepare(ctx, &how, out);
    if (status != BRIO_OK) return brio_exchange_refuse(ctx, &how, status);
    status = brio_ranks_open(*out, options);
    if (status == BRIO_OK) return BRIO_OK;
    brio_ranks_free(*out);
    *out = NULL;
    return status;
}

void brio_ranks_free(brio_ranks *r) {
    if (!r) return;
    brio_context *ctx = r->ctx;
    if (r->t && r->t->key && r->t->has_points && r->x.failed) brio_tiles_leave(r->t);
    for (uint32_t i = 0; r->sample && i < r->t->num_tiles; i++) brio_release(ctx, r->sample[i].point);
    brio_release(ctx, r->sample);
    brio_release(ctx, r->seen);
    brio_release(ctx, r->served);
    brio_release(ctx, r->splitter);
    brio_release(ctx, r->rank_of);
    brio_tiles_free(r->t);
    brio_exchange_free(&r->x);
    brio_release(ctx, r);
}

int brio_ranks_has_points(const brio_ranks *r) {
    return r->t->has_points;
}

const brio_tiles_stats *brio_ranks_facts(const brio_ranks *r) {
    return &r->facts;
}

const brio_ranks_traffic *brio_ranks_sent(const brio_ranks *r) {
    return &r->traffic;
}

/* --- points --- */

brio_status brio_ranks_add(brio_context *ctx, brio_ranks *r, const double *points, const double *weights,
                           size_t num_points, uint64_t first) {
    BRIO_DOOR;
    brio_tiles *t = r->t;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    BRIO_EXPECT(ctx, !t->has_points && !t->torn, BRIO_ERR_ARGUMENT, "the ranks have all their points already");
    if (!num_points) return BRIO_OK;
    if (!t->stats.points) t->weighted = weights != NULL;
    BRIO_EXPECT(ctx, !weights == !t->weighted, BRIO_ERR_ARGUMENT, "earlier points have %s, and these have %s",
                t->weighted ? "weights" : "no weights", weights ? "some" : "none");
    return brio_tiles_take(t, points, weights, num_points, first);
}

brio_status brio_ranks_agree(brio_context *ctx, brio_ranks *r, brio_status status, const char *sentence) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    if (status != BRIO_OK && sentence) brio_fail(ctx, status, "%s", sentence);
    return brio_exchange_agree(&r->x, status);
}

/* --- facts of all ranks --- */

typedef struct {
    brio_tiles_stats stats;
    uint64_t points, far_asked, far_found, rounds, bytes, question_bytes;
    double waited;
} rank_facts;

static void add_stats(brio_tiles_stats *to, const brio_tiles_stats *s) {
    to->vertices += s->vertices;
    to->hidden += s->hidden;
    to->tiles += s->tiles;
    to->tetrahedra += s->tetrahedra;
    to->hull_facets += s->hull_facets;
    to->asked += s->asked;
    to->found += s->found;
    to->sampled += s->sampled;
    to->read += s->read;
    to->triangulated += s->triangulated;
    to->resumed += s->resumed;
    to->scratch_bytes += s->scratch_bytes;
    if (s->most_rounds > to->most_rounds) to->most_rounds = s->most_rounds;
    if (s->most_points > to->most_points) to->most_points = s->most_points;
    if (s->most_tetrahedra > to->most_tetrahedra) to->most_tetrahedra = s->most_tetrahedra;
}

static void add_traffic(brio_ranks_traffic *to, const rank_facts *f) {
    to->bytes += f->bytes;
    to->question_bytes += f->question_bytes;
    to->far_asked += f->far_asked;
    to->far_found += f->far_found;
    to->rounds += f->rounds;
    to->waited_seconds += f->waited;
    if (f->points > to->most_points) to->most_points = f->points;
    if (f->points < to->least_points) to->least_points = f->points;
}

static brio_status add_facts(brio_ranks *r) {
    rank_facts f = {.far_asked = r->far_asked,
                    .far_found = r->far_found,
                    .rounds = r->rounds,
                    .bytes = r->x.bytes,
                    .question_bytes = r->question_bytes,
                    .waited = r->x.waited};
    brio_tiles_add_facts(r->t);
    for (uint32_t i = 0; i < r->t->num_tiles; i++) f.points += r->t->tile[i].points;
    f.stats = r->t->stats;
    BRIO_FORWARD(brio_exchange_all(&r->x, &f, sizeof f));
    r->traffic = (brio_ranks_traffic){.size = sizeof r->traffic, .least_points = UINT64_MAX};
    r->facts = (brio_tiles_stats){.size = sizeof r->facts,
                                  .points = r->facts.points,
                                  .duplicates = r->facts.duplicates,
                                  .dimension = r->facts.dimension,
                                  .weighted = r->t->weighted,
                                  .divide_seconds = r->facts.divide_seconds};
    for (int i = 0; i < r->ranks; i++) {
        memcpy(&f, r->x.from[i]->bytes, sizeof f);
        add_stats(&r->facts, &f.stats);
        add_traffic(&r->traffic, &f);
    }
    r->traffic.waited_seconds /= r->ranks;
    r->traffic.exchanges = r->x.ended;
    return BRIO_OK;
}

/* --- all stages --- */

static brio_status divide(brio_ranks *r) {
    brio_tiles *t = r->t;
    t->torn = true;
    BRIO_FORWARD(brio_ranks_divide(r));
    BRIO_FORWARD(brio_tiles_arrange(t));
    t->has_points = true;
    t->torn = false;
    return t->key ? brio_tiles_save(t) : BRIO_OK;
}

static brio_status run(brio_ranks *r) {
    double start = brio_seconds();
    BRIO_EXPECT(r->ctx, !r->has_result, BRIO_ERR_ARGUMENT, "the tiles are triangulated already");
    BRIO_EXPECT(r->ctx, !r->t->torn, BRIO_ERR_ARGUMENT,
                "an earlier run ended while it divided the points: add them anew");
    if (!r->t->has_points) BRIO_FORWARD(divide(r));
    BRIO_FORWARD(brio_ranks_join(r));
    r->facts.divide_seconds = brio_seconds() - start;
    start = brio_seconds();
    BRIO_EXPECT(
        r->ctx, !r->t->weighted || r->facts.dimension == 3 || r->facts.points < 2, BRIO_ERR_NO_ANSWER,
        "all points are in a plane, and have weights: there are no tetrahedra, and which points are hidden is found "
        "without tiles only");
    if (r->facts.dimension == 3) {
        BRIO_FORWARD(brio_tiles_require_memory(r->t, r->t->num_tiles > 1 ? RANK_SLOTS : 1));
        BRIO_FORWARD(brio_ranks_complete(r));
    }
    BRIO_FORWARD(add_facts(r));
    r->facts.triangulate_seconds = brio_seconds() - start;
    return BRIO_OK;
}

brio_status brio_ranks_run(brio_context *ctx, brio_ranks *r) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    brio_status status = brio_exchange_agree(&r->x, run(r));
    r->has_result |= status == BRIO_OK; /* on all ranks or on none */
    return status;
}

brio_status brio_ranks_checksum(brio_context *ctx, brio_ranks *r, uint64_t *checksum) {
    BRIO_DOOR;
    double start = brio_seconds();
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    brio_status status = brio_exchange_agree(&r->x, brio_ranks_sum(r, checksum));
    r->facts.rank_seconds = brio_seconds() - start;
    return status;
}

/* --- parts --- */

brio_status brio_ranks_own_points(brio_ranks *r, const uint64_t *places, size_t n, void *rows) {
    const brio_halo_reader own = brio_tile_own_halo(r->t);
    return own.read(own.user, places, n, rows);
}

static brio_status read_halo(void *user, const uint64_t *halo, size_t n, brio_set_point *points) {
    return brio_ranks_rows(user, halo, n, brio_ranks_own_points, sizeof *points, points);
}

brio_status brio_ranks_make_part(brio_ranks *r, uint32_t tile, brio_tile_part *p) {
    BRIO_EXPECT(r->ctx, r->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(r->ctx, tile < r->t->num_tiles, BRIO_ERR_ARGUMENT, "tile %u of %u", tile, r->t->num_tiles);
    if (!r->t->tile[tile].tetrahedra)
        return brio_ranks_rows(r, NULL, 0, brio_ranks_own_points, sizeof(brio_set_point), NULL);
    return brio_tile_part_make(r->t, tile, &(brio_halo_reader){read_halo, r}, p);
}

brio_status brio_ranks_part(brio_context *ctx, brio_ranks *r, uint32_t tile, brio_tile_part *out) {
    BRIO_DOOR;
    brio_tile_part p = {.size = sizeof p};
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    brio_status status = BRIO_CHECK_RESULT(ctx, brio_tile_part, out);
    status = brio_exchange_agree(&r->x, status == BRIO_OK ? brio_ranks_make_part(r, tile, &p) : status);
    if (status != BRIO_OK)
        brio_tile_part_free(ctx, &p);
    else
        BRIO_GIVE(brio_tile_part, out, &p);
    return status;
}
