/* Ranks that triangulate and cut for one of them, rank 0, which reconstructs surfaces.
 *
 * Rank 0 has the points, and a context whose triangulator (triangulation.h) is the team. Whenever a surface needs a
 * triangulation, rank 0 says so, and all ranks do the same: rank 0 adds its points, which the ranks divide among each
 * other's tiles; all triangulate; the rows of all tiles go to rank 0, some at a time, then the mates of facets between
 * tiles. There they become the triangulation that one process makes (tiles/gather.c). Parts of minimum cuts are closed
 * tasks, which rank 0 sends to all (cuts.c). In between the others wait for the next word.
 *
 * A failure in a triangulation or a cut is that of all ranks. A failure of rank 0 between them reaches the others when
 * rank 0 dismisses them. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "ranks/work.h"
#include <string.h>

/* Chosen: 500 kB of rows from each rank are on their way at once, and points are added in blocks of 24 MB. */
enum { ROWS_AT_ONCE = 1 << 14, POINTS_AT_ONCE = 1 << 20 };

/* What rank 0 says. */
typedef enum { DISMISSED, TRIANGULATE, CUT } call;

typedef struct {
    uint64_t call, num_points;
} word;

struct brio_team_of_ranks {
    brio_context *ctx;
    brio_transport transport;
    brio_ranks_options options;
    brio_exchange x; /* of words */
    brio_triangulator triangulator;
    brio_part_decider decider;
    brio_team_facts facts;
};

/* --- rows --- */

/* Rows of a tile on their way to rank 0. */
typedef struct {
    uint64_t tile, first, count;
} rows_head;

/* Appends rows of a tile of this rank to what goes to rank 0. */
static brio_status put_rows(brio_ranks *r, const rows_head *head, const brio_tile_part *part, const uint32_t *mate) {
    void *rows;
    if (!head->count) return BRIO_OK;
    BRIO_FORWARD(brio_exchange_put(&r->x, 0, head, sizeof *head));
    BRIO_FORWARD(brio_exchange_room(&r->x, 0, head->count * sizeof(brio_gather_row), &rows));
    brio_gather_rows(part, mate, head->first, head->count, rows);
    return BRIO_OK;
}

/* Takes what came, on rank 0. */
static brio_status take_rows(const brio_ranks *r, brio_gather *g) {
    for (int i = 0; i < r->ranks; i++) {
        const uint8_t *at = r->x.from[i]->bytes;
        rows_head head;
        if (!r->x.from[i]->size) continue;
        memcpy(&head, at, sizeof head);
        BRIO_FORWARD(brio_gather_take(g, (uint32_t)head.tile, head.first,
                                      (const brio_gather_row *)(const void *)(at + sizeof head), head.count));
    }
    return BRIO_OK;
}

typedef struct {
    brio_ranks *r;
    brio_gather *gather; /* NULL on other ranks than 0 */
} sending;

/* Sends the rows of one tile of each rank to rank 0, as a brio_tile_part_fn. The tile's file is not needed any more. */
static brio_status send_part(void *user, uint32_t tile, const brio_tile_part *part, const uint32_t *mate) {
    sending *s = user;
    brio_ranks *r = s->r;
    size_t sent = 0;
    brio_tile_result_remove(r->t, tile);
    for (bool more = true; more; more = r->x.any) {
        size_t left = part->num_tetrahedra - sent, count = left < ROWS_AT_ONCE ? left : ROWS_AT_ONCE;
        BRIO_FORWARD(put_rows(r, &(rows_head){brio_ranks_tile(r, tile), sent, count}, part, mate));
        sent += count;
        BRIO_FORWARD(brio_exchange_now(&r->x, sent < part->num_tetrahedra));
        if (s->gather) BRIO_FORWARD(take_rows(r, s->gather));
    }
    return BRIO_OK;
}

/* Tells rank 0 how many tetrahedra each tile has.   first  on rank 0 #tiles of all ranks + 1. */
static brio_status count_rows(brio_ranks *r, uint64_t *first) {
    brio_tiles *t = r->t;
    for (uint32_t i = 0; i < t->num_tiles; i++)
        BRIO_FORWARD(brio_exchange_put(&r->x, 0, &t->tile[i].tetrahedra, sizeof t->tile[i].tetrahedra));
    BRIO_FORWARD(brio_exchange_now(&r->x, false));
    if (r->rank) return BRIO_OK;
    for (int i = 0; i < r->ranks; i++) {
        const uint64_t *count = r->x.from[i]->bytes;
        for (uint32_t k = 0; k < t->num_tiles; k++, first++) first[1] = first[0] + count[k];
    }
    return BRIO_OK;
}

/* --- one triangulation --- */

/* What rank 0 has besides: its points, and what becomes of the rows. */
typedef struct {
    uint64_t *first;
    brio_gather rows;
} at_rank_0;

static brio_status add_points(brio_ranks *r, const at_rank_0 *own) {
    const brio_input *input = own ? &own->rows.input : NULL;
    for (size_t i = 0; input && i < input->count; i += POINTS_AT_ONCE) {
        size_t some = input->count - i < POINTS_AT_ONCE ? input->count - i : POINTS_AT_ONCE;
        BRIO_FORWARD(brio_ranks_add(r->ctx, r, input->points + 3 * i, NULL, some, i));
    }
    return BRIO_OK;
}

static brio_status make_room(brio_ranks *r, at_rank_0 *own) {
    if (!own) return BRIO_OK;
    return brio_gather_begin(&own->rows, own->first, (uint32_t)r->ranks * r->t->num_tiles, r->facts.hull_facets);
}

static brio_status collect(brio_ranks *r, at_rank_0 *own) {
    brio_status status = BRIO_OK;
    if (own) status = BRIO_ALLOC_ZERO(r->ctx, own->first, (size_t)r->ranks * r->t->num_tiles + 1);
    BRIO_FORWARD(brio_exchange_agree(&r->x, status));
    BRIO_FORWARD(brio_exchange_agree(&r->x, count_rows(r, own ? own->first : NULL)));
    BRIO_FORWARD(brio_exchange_agree(&r->x, make_room(r, own)));
    char *scratch = r->ctx->scratch;
    r->ctx->scratch = NULL; /* tiles are in memory */
    status = brio_ranks_join_at_0(r, send_part, &(sending){r, own ? &own->rows : NULL});
    if (status == BRIO_OK && own) status = brio_gather_join(&own->rows, r->t);
    r->ctx->scratch = scratch;
    return brio_exchange_agree(&r->x, status);
}

/* Triangulates with all ranks.   own  NULL on other ranks than 0.   facts  of the triangulation, written. */
static brio_status work_together(brio_team_of_ranks *t, at_rank_0 *own, brio_tiles_stats *facts) {
    brio_status status = BRIO_OK;
    brio_ranks *r = NULL;
    char *scratch = t->ctx->scratch;
    t->ctx->scratch = NULL; /* tiles are in memory */
    status = brio_ranks_prepare(t->ctx, &t->transport, &r);
    if (status != BRIO_OK) status = brio_exchange_agree(&t->x, status); /* others are in brio_ranks_open */
    BRIO_TRY(status);
    BRIO_TRY(brio_ranks_open(r, &t->options));
    BRIO_TRY(brio_ranks_agree(t->ctx, r, add_points(r, own), NULL));
    BRIO_TRY(brio_ranks_run(t->ctx, r));
    *facts = *brio_ranks_facts(r);
    t->ctx->scratch = scratch;
    if (facts->dimension == 3) BRIO_TRY(collect(r, own));
    t->facts.bytes += r->x.bytes;
    t->facts.bytes_received += r->x.received_bytes;
    t->facts.triangulations++;
done:
    t->ctx->scratch = scratch;
    if (r && r->x.broken) brio_exchange_break(&t->x, status); /* words cannot be exchanged, either */
    brio_ranks_free(r);
    return status;
}

/* --- rank 0 --- */

static brio_status say(brio_team_of_ranks *t, word w) {
    return brio_exchange_all(&t->x, &w, sizeof w);
}

/* Makes a triangulation on rank 0. */
static brio_status make(void *user, brio_context *ctx, const double *points, size_t num_points, uint64_t seed,
                        brio_triangulation **out) {
    brio_team_of_ranks *t = user;
    const brio_delaunay_options of_one = {.size = sizeof of_one, .seed = seed};
    brio_status status = BRIO_OK;
    brio_tiles_stats facts = {0};
    at_rank_0 own = {.rows = {.ctx = ctx, .input = {points, NULL, num_points}, .seed = seed}};
    *out = NULL;
    BRIO_TRY(say(t, (word){TRIANGULATE, num_points}));
    BRIO_TRY(work_together(t, &own, &facts));
    status = facts.dimension < 3 ? brio_delaunay(ctx, points, NULL, num_points, &of_one, out)
                                 : brio_gather_end(&own.rows, facts.duplicates, out);
done:
    brio_gather_free(&own.rows);
    brio_release(ctx, own.first);
    return status;
}

/* Has all ranks decide the parts of a cut. */
static brio_status decide(void *user, brio_parts *parts) {
    brio_team_of_ranks *t = user;
    uint64_t before = t->x.bytes, received_before = t->x.received_bytes;
    BRIO_FORWARD(say(t, (word){CUT, 0}));
    BRIO_FORWARD(brio_ranks_lead_cut(&t->x, parts));
    t->facts.parts += parts->num_parts;
    t->facts.part_bytes += t->x.bytes - before;
    t->facts.part_bytes_received += t->x.received_bytes - received_before;
    return BRIO_OK;
}

static brio_status team_new(brio_context *ctx, const brio_transport *transport, const brio_ranks_options *options,
                            brio_team_of_ranks **out) {
    brio_team_of_ranks *t = NULL;
    brio_transport how;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(brio_exchange_take(ctx, transport, &how));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t, 1));
    t->ctx = ctx;
    t->transport = how;
    t->facts.size = sizeof t->facts;
    BRIO_TRY(BRIO_TAKE(ctx, brio_ranks_options, options, &t->options));
    BRIO_REQUIRE(ctx, !t->options.stars && !t->options.key, BRIO_ERR_ARGUMENT,
                 "ranks of a team have neither stars nor a key");
    BRIO_TRY(brio_exchange_new(ctx, &t->transport, &t->x));
    *out = t;
    t = NULL;
done:
    if (t) brio_exchange_free(&t->x);
    brio_release(ctx, t);
    return status == BRIO_OK ? status : brio_exchange_refuse(ctx, &how, status);
}

static void team_free(brio_team_of_ranks *t) {
    brio_exchange_free(&t->x);
    brio_release(t->ctx, t);
}

brio_status brio_ranks_lead(brio_context *ctx, const brio_transport *transport, const brio_ranks_options *options,
                            brio_team_of_ranks **out) {
    BRIO_DOOR;
    BRIO_FORWARD(team_new(ctx, transport, options, out));
    brio_team_of_ranks *t = *out;
    t->triangulator = (brio_triangulator){t, make};
    t->decider = (brio_part_decider){decide, t, (size_t)t->transport.ranks * (size_t)brio_context_threads(ctx)};
    ctx->triangulator = &t->triangulator;
    ctx->decider = &t->decider;
    return BRIO_OK;
}

const brio_team_facts *brio_ranks_led(const brio_team_of_ranks *team) {
    return &team->facts;
}

brio_status brio_ranks_dismiss(brio_team_of_ranks *team, brio_status status, const char *sentence) {
    BRIO_DOOR;
    if (!team) return status;
    brio_context *ctx = team->ctx;
    ctx->triangulator = NULL;
    ctx->decider = NULL;
    if (status != BRIO_OK && sentence) brio_fail(ctx, status, "%s", sentence);
    if (status == BRIO_OK) status = say(team, (word){DISMISSED, 0});
    status = brio_exchange_agree(&team->x, status);
    team_free(team);
    return status;
}

/* --- other ranks --- */

static brio_status serve(brio_team_of_ranks *t) {
    brio_tiles_stats facts;
    word w;
    for (;;) {
        BRIO_FORWARD(brio_exchange_now(&t->x, false));
        memcpy(&w, t->x.from[0]->bytes, sizeof w);
        if (w.call == DISMISSED) return BRIO_OK;
        if (w.call == CUT) {
            BRIO_FORWARD(brio_ranks_follow_cut(&t->x));
            continue;
        }
        brio_status status = work_together(t, NULL, &facts);
        (void)status; /* of all ranks, if it is a failure: rank 0 says it again when it dismisses this one */
    }
}

brio_status brio_ranks_serve(brio_context *ctx, const brio_transport *transport, const brio_ranks_options *options) {
    BRIO_DOOR;
    brio_team_of_ranks *t;
    BRIO_FORWARD(team_new(ctx, transport, options, &t));
    brio_status status = brio_exchange_agree(&t->x, serve(t));
    team_free(t);
    return status;
}
