/* A triangulation by many ranks: what its stages share. The tiles of a rank are numbered from 0 in it; tile i of rank r
 * is tile r * tiles + i of all. A place has its rank in the upper bits. */
#ifndef BRIO_RANKS_WORK_H
#define BRIO_RANKS_WORK_H

#include "ranks/exchange.h"
#include "reconstruct/labels/cut_in_parts.h"
#include "tiles/work.h"

enum { RANK_SHIFT = 40, RANK_SLOTS = 2 /* tiles that a rank works on at once */ };

/** Where the tiles of another rank ask: the source of the tile that asked last from a slot of this rank. */
typedef struct {
    uint32_t tile;
    brio_tile_source *source;
} brio_rank_served;

struct brio_ranks {
    brio_context *ctx;
    brio_exchange x;
    brio_tiles *t;
    int rank, ranks;
    brio_tiles_stats facts;       /* of all ranks */
    brio_ranks_traffic traffic;   /* the same */
    brio_tiles_cells_stats cells; /* of all ranks; 0 before brio_ranks_cells ended well */
    bool joined;
    size_t own_nodes;         /* nodes of this rank's points, which come first; known once `joined` */
    uint32_t own_root;        /* node over this rank's tiles; TILE_NONE if there are no points */
    double (*splitter)[3];    /* ranks - 1, ascending: where lists of positions are divided among ranks */
    brio_found *sample;       /* of each own tile, the points of other ranks that it begins with */
    brio_ball_box *seen;      /* of each own tile: all points in it are known when it begins */
    brio_rank_served *served; /* by rank and slot */
    uint64_t *rank_of;        /* of each own place: its vertex' rank among all; NULL before brio_ranks_sum */
    uint64_t far_asked, far_found, rounds, question_bytes;
    bool has_result;
};

/** Does of brio_ranks_new what needs no other rank, so that its failure is known to none.
 *  transport  one that brio_exchange_take checked. */
brio_status brio_ranks_prepare(brio_context *ctx, const brio_transport *transport, brio_ranks **out);
/** Does the rest; collective. */
brio_status brio_ranks_open(brio_ranks *r, const brio_ranks_options *options);

/** --- stages, collective; each returns BRIO_OK or a failure of this rank or of all --- */

/** Sends the points to the ranks of their tiles. */
brio_status brio_ranks_divide(brio_ranks *r);
/** Tells all ranks of each other's tiles: extreme points, a basis, upper nodes. */
brio_status brio_ranks_join(brio_ranks *r);
/** Triangulates all tiles. */
brio_status brio_ranks_complete(brio_ranks *r);
/** Sums the hashes of all tetrahedra. */
brio_status brio_ranks_sum(brio_ranks *r, uint64_t *checksum);

/** Writes the rows of own places. */
typedef brio_status (*brio_answer_fn)(brio_ranks *r, const uint64_t *places, size_t n, void *rows);
/** Fetches rows by their places from the ranks that have them.   answer  is called once for each rank that asks.
 *  rows  n of `size` bytes, a multiple of 8. */
brio_status brio_ranks_rows(brio_ranks *r, const uint64_t *places, size_t n, brio_answer_fn answer, size_t size,
                            void *rows);
/** Reads points of this rank, as a brio_answer_fn: rows are brio_set_point. */
brio_status brio_ranks_own_points(brio_ranks *r, const uint64_t *places, size_t n, void *rows);

/** Makes the part of a tile of this rank, which all ranks do at once. */
brio_status brio_ranks_make_part(brio_ranks *r, uint32_t tile, brio_tile_part *p);

/** Makes the parts of all tiles, which all ranks do at once, hands on each, and sends the answers to all facets without
 *  a neighbour in theirs to rank 0, into files of all ranks' tiles (tiles/work.h).
 *  with  takes a part of this rank. It may exchange, if it does on all ranks. */
brio_status brio_ranks_join_at_0(brio_ranks *r, brio_tile_part_fn with, void *user);

/** Has all ranks decide the parts of a cut: rank 0 calls lead, all others follow. Return what brio_tasks_share does. */
brio_status brio_ranks_lead_cut(brio_exchange *x, brio_parts *p);
brio_status brio_ranks_follow_cut(brio_exchange *x);

/** Returns the number of an own tile among those of all ranks. */
static inline uint32_t brio_ranks_tile(const brio_ranks *r, uint32_t tile) {
    return (uint32_t)r->rank * r->t->num_tiles + tile;
}

static inline int brio_rank_of_place(uint64_t place) {
    return (int)(place >> RANK_SHIFT);
}

#endif
