/* Neighbours of tetrahedra across the tiles of all ranks: the steps of tiles/neighbours.c. A facet without a neighbour
 * in its part goes to a rank by its hash, where both of its sides meet, and each side's rank is told the other one. */
#include "base/float_state.h"
#include "base/memory.h"
#include "ranks/work.h"
#include "store/row_files.h"

static brio_status send_lone(void *user, const brio_lone_facet *l) {
    brio_ranks *r = user;
    int rank = (int)(brio_lone_facet_hash(l) % (uint64_t)r->ranks);
    return brio_exchange_put(&r->x, rank, l, sizeof *l);
}

static brio_status send_answer(void *user, const brio_facet_answer *a) {
    brio_ranks *r = user;
    return brio_exchange_put(&r->x, (int)(a->tile / r->t->num_tiles), a, sizeof *a);
}

static brio_status send_answer_to_0(void *user, const brio_facet_answer *a) {
    brio_ranks *r = user;
    return brio_exchange_put(&r->x, 0, a, sizeof *a);
}

/* Exchanges rows, and puts those that come into files: facets by their hash, answers by their tile. */
static brio_status pass(brio_ranks *r, brio_row_files *files, bool lone) {
    size_t size = lone ? sizeof(brio_lone_facet) : sizeof(brio_facet_answer);
    BRIO_FORWARD(brio_exchange_now(&r->x, false));
    for (int i = 0; i < r->ranks; i++) {
        const uint8_t *row = r->x.received[i].bytes;
        for (uint64_t at = 0; at < r->x.received[i].size; at += size) {
            const void *here = row + at;
            uint64_t into =
                lone ? brio_lone_facet_hash(here) / (uint64_t)r->ranks : ((const brio_facet_answer *)here)->tile;
            BRIO_FORWARD(brio_row_files_put(files, (uint32_t)(into % files->count), here, size));
        }
    }
    return BRIO_OK;
}

/* Makes the part of a tile, and sends what is lone. */
static brio_status divide_tile(brio_ranks *r, uint32_t tile, brio_tile_part_fn with, void *user, brio_row_files *lone) {
    brio_tile_part p = {.size = sizeof p};
    uint32_t *mate = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_ranks_make_part(r, tile, &p));
    BRIO_TRY(BRIO_ALLOC(r->ctx, mate, 4 * p.num_tetrahedra + 1));
    BRIO_TRY(brio_tile_match_inside(r->ctx, brio_ranks_tile(r, tile), &p, mate));
    if (with) BRIO_TRY(with(user, tile, &p, mate));
    BRIO_TRY(brio_tile_lone_facets(brio_ranks_tile(r, tile), &p, mate, send_lone, r));
    status = pass(r, lone, true);
done:
    brio_tile_part_free(r->ctx, &p);
    brio_release(r->ctx, mate);
    return status;
}

static brio_status divide_lone(brio_ranks *r, brio_tile_part_fn with, void *user) {
    brio_tiles *t = r->t;
    brio_row_files lone = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_open(&t->folder, "lone", t->num_tiles, &lone));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_TRY(brio_progress(r->ctx, "neighbours", 0.9 * i / t->num_tiles));
        BRIO_TRY(divide_tile(r, i, with, user, &lone));
    }
    status = brio_row_files_flush(&lone);
done:
    brio_row_files_close(&lone);
    return status;
}

/* Has the facets answered.   files  of answers that come to this rank.   to_0  whether all of them go to rank 0. */
static brio_status join_lone(brio_ranks *r, uint32_t files, bool to_0) {
    brio_tiles *t = r->t;
    brio_row_files joined = {0};
    uint64_t alone = 0, all = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_open(&t->folder, "joined", files, &joined));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_TRY(brio_progress(r->ctx, "neighbours", 0.9 + 0.1 * i / t->num_tiles));
        BRIO_TRY(brio_facet_pairs(t, i, to_0 ? send_answer_to_0 : send_answer, r, &alone));
        BRIO_TRY(pass(r, &joined, false));
    }
    BRIO_TRY(brio_row_files_flush(&joined));
    BRIO_TRY(brio_exchange_all(&r->x, &alone, sizeof alone));
    for (int i = 0; i < r->ranks; i++) all += *(const uint64_t *)r->x.from[i]->bytes;
    BRIO_REQUIRE(r->ctx, all == r->facts.hull_facets, BRIO_ERR_OPEN,
                 "%s: files were changed from outside: %llu facets of %llu on the hull", t->folder.path,
                 (unsigned long long)all, (unsigned long long)r->facts.hull_facets);
done:
    brio_row_files_close(&joined);
    return status;
}

brio_status brio_ranks_join_at_0(brio_ranks *r, brio_tile_part_fn with, void *user) {
    brio_status status = divide_lone(r, with, user);
    uint32_t files = r->rank ? 1 : (uint32_t)r->ranks * r->t->num_tiles;
    return status == BRIO_OK ? join_lone(r, files, true) : status;
}

/* Finds all neighbours that are of another tile, unless a call before did so on all ranks. */
static brio_status join(brio_ranks *r) {
    brio_tiles *t = r->t;
    BRIO_FORWARD(brio_exchange_now(&r->x, !t->has_neighbours));
    if (!r->x.any) return BRIO_OK;
    t->has_neighbours = false;
    brio_status status = divide_lone(r, NULL, NULL);
    if (status == BRIO_OK) status = join_lone(r, t->num_tiles, false);
    t->has_neighbours = status == BRIO_OK;
    if (status == BRIO_OK) return BRIO_OK;
    brio_facet_files_remove(t);
    return status;
}

static brio_status name_neighbours(brio_ranks *r, uint32_t tile, const brio_tile_part *part,
                                   brio_tile_neighbour (*neighbours)[4]) {
    uint64_t all = (uint64_t)r->ranks * r->t->num_tiles;
    BRIO_EXPECT(r->ctx, r->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(r->ctx, tile < r->t->num_tiles, BRIO_ERR_ARGUMENT, "tile %u of %u", tile, r->t->num_tiles);
    BRIO_EXPECT(r->ctx, all < BRIO_NO_TILE, BRIO_ERR_TOO_LARGE, "%llu tiles of all ranks have no numbers",
                (unsigned long long)all);
    BRIO_EXPECT(r->ctx, part->num_tetrahedra == r->t->tile[tile].tetrahedra, BRIO_ERR_ARGUMENT,
                "%zu tetrahedra of tile %u, which has %llu", part->num_tetrahedra, tile,
                (unsigned long long)r->t->tile[tile].tetrahedra);
    BRIO_FORWARD(join(r));
    if (!part->num_tetrahedra) return BRIO_OK;
    return brio_tile_name_neighbours(r->t, tile, brio_ranks_tile(r, tile), all, part, neighbours);
}

brio_status brio_ranks_neighbours(brio_context *ctx, brio_ranks *r, uint32_t tile, const brio_tile_part *part,
                                  brio_tile_neighbour (*neighbours)[4]) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    return brio_exchange_agree(&r->x, name_neighbours(r, tile, part, neighbours));
}
