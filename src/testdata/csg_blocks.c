/* Blocks of cells.
 *
 * A block is far when the value at its centre exceeds the distance to its corners NEAR times. The factor allows for
 * shapes whose values have slopes above 1, and lets points a little outside the block use the block's nodes. */
#include "testdata/csg_blocks.h"
#include "base/team.h"
#include <math.h>

enum {
    CELLS_A_BLOCK = 4 /* along each axis; chosen, 3 to 6 take about equal time */,
    BLOCKS_A_CHUNK = 16,
    BATCH = 1 << 14 /* blocks between two reports of progress */
};

static const double NEAR = 1.6;
static const double HALF_DIAGONAL = 0.86602540378443865; /* of a cube of side 1 */

static size_t num_blocks(const brio_csg_blocks *b) {
    return (size_t)b->count[0] * b->count[1] * b->count[2];
}

static void centre_of(const brio_csg_blocks *b, size_t block, double *p) {
    size_t index[3] = {block % b->count[0], block / b->count[0] % b->count[1], block / b->count[0] / b->count[1]};
    for (int k = 0; k < 3; k++) p[k] = b->low[k] + ((double)index[k] + 0.5) * b->side;
}

static void fill_centres(void *user, size_t begin, size_t end, int thread) {
    brio_csg_blocks *b = user;
    (void)thread;
    for (size_t i = b->first + begin; i < b->first + end; i++) {
        double p[3];
        centre_of(b, i, p);
        b->centre[i] = brio_csg_value(b->tree, p, NULL);
    }
}

static void mark_blocks(void *user, size_t begin, size_t end, int thread) {
    brio_csg_blocks *b = user;
    (void)thread;
    for (size_t i = b->first + begin; i < b->first + end; i++) {
        double p[3];
        if (b->slot[i] == BRIO_CSG_FAR) continue;
        centre_of(b, i, p);
        brio_csg_mark(b->tree, p, NEAR * HALF_DIAGONAL * b->side, b->need + (size_t)b->slot[i] * b->words);
    }
}

static void number_near_blocks(brio_csg_blocks *b) {
    double near = NEAR * HALF_DIAGONAL * b->side;
    for (size_t i = 0; i < num_blocks(b); i++) b->slot[i] = fabs(b->centre[i]) <= near ? b->num_near++ : BRIO_CSG_FAR;
}

/* Calls body for all blocks, batch by batch, and reports progress. */
static brio_status in_batches(brio_context *ctx, brio_csg_blocks *b, brio_part_fn body, double from) {
    size_t n = num_blocks(b);
    for (b->first = 0; b->first < n; b->first += BATCH) {
        size_t count = n - b->first < BATCH ? n - b->first : BATCH;
        BRIO_FORWARD(brio_progress(ctx, "blocks", from + 0.5 * (double)b->first / (double)n));
        BRIO_FORWARD(brio_for_chunks(ctx, brio_threads(ctx, count, BLOCKS_A_CHUNK), count, BLOCKS_A_CHUNK, body, b));
    }
    return BRIO_OK;
}

brio_status brio_csg_blocks_find(brio_context *ctx, const brio_csg *tree, const brio_implicit_grid *grid,
                                 brio_csg_blocks *out) {
    *out = (brio_csg_blocks){.tree = tree, .side = CELLS_A_BLOCK * grid->cell, .words = (tree->num_nodes + 63) / 64};
    for (int k = 0; k < 3; k++) {
        out->low[k] = grid->low[k];
        out->inner[0][k] = grid->low[k] + 0.5 * grid->cell;
        out->inner[1][k] = grid->low[k] + (grid->cells[k] - 0.5) * grid->cell;
        out->count[k] = grid->cells[k] / CELLS_A_BLOCK + 1;
    }
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->centre, num_blocks(out)));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->slot, num_blocks(out)));
    BRIO_FORWARD(in_batches(ctx, out, fill_centres, 0));
    number_near_blocks(out);
    return BRIO_OK;
}

brio_status brio_csg_blocks_make(brio_context *ctx, const brio_csg *tree, const brio_implicit_grid *grid,
                                 brio_csg_blocks *out) {
    BRIO_FORWARD(brio_csg_blocks_find(ctx, tree, grid, out));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, out->need, (size_t)out->num_near * out->words));
    return in_batches(ctx, out, mark_blocks, 0.5);
}

double brio_csg_blocks_value(const double *p, const void *blocks) {
    const brio_csg_blocks *b = blocks;
    size_t index[3];
    for (int k = 0; k < 3; k++) {
        if (p[k] < b->inner[0][k] || p[k] > b->inner[1][k]) return 0.5 * b->side;
        double at = floor((p[k] - b->low[k]) / b->side);
        index[k] = (size_t)fmin(fmax(at, 0), b->count[k] - 1.0);
    }
    size_t block = (index[2] * b->count[1] + index[1]) * b->count[0] + index[0];
    uint32_t slot = b->slot[block];
    if (slot == BRIO_CSG_FAR) return b->centre[block];
    return brio_csg_value(b->tree, p, b->need + (size_t)slot * b->words);
}

void brio_csg_blocks_free(brio_context *ctx, brio_csg_blocks *blocks) {
    brio_release(ctx, blocks->centre);
    brio_release(ctx, blocks->slot);
    brio_release(ctx, blocks->need);
    *blocks = (brio_csg_blocks){0};
}
