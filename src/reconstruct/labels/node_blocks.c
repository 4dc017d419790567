/* Blocks of nodes for the improvement of labels.
 *
 * Only nodes near violated edges take part, because a set of nodes whose flip lowers the energy has a violated edge on
 * its border. The nodes are sorted along a Hilbert curve through a cube at a random place, and the sorted list is cut
 * into runs. Poles that one cube separates, another cube keeps together. Two blocks that an edge joins must not change
 * at the same time, so the blocks are coloured, and a colour is a round. */
#include "reconstruct/labels/node_blocks.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/hilbert.h"
#include <math.h>
#include <string.h>

/* HOPS: a node of a block is at most this many edges from a node with a violated edge. CURVE_BITS: the curve has
 * 2^CURVE_BITS cells on each side of the cube. All are chosen, except OUTSIDE. */
enum { HOPS = 3, OUTSIDE = 255, CURVE_BITS = 11, NODES_A_THREAD = 1024, NODES_A_CHUNK = 1024 };

/* What one thread finds: the pairs of blocks that an edge joins, as higher number << 32 | lower number. */
typedef struct {
    uint64_t *pair;
    size_t count, capacity;
    uint32_t *seen; /* #blocks: 1 + the last block that was found to be joined to the block */
} joiner;

typedef struct {
    const brio_signed_graph *g;
    const uint8_t *label, *fixed;
    int threads;     /* of all loops here */
    uint8_t hop;     /* the depth of the nodes whose neighbours are reached now */
    joiner *joiners; /* one for each thread */
    brio_status joined;
    double *points;   /* positions of the nodes of the region, and two corners of the cube */
    uint8_t *depth;   /* #nodes: edges from the nearest node with a violated edge, or OUTSIDE */
    uint8_t *trouble; /* #blocks: 1 if one of the block's nodes has a violated edge */
    uint64_t *pair;   /* the pairs of all threads, sorted */
    size_t num_pairs;
    brio_node_blocks *out;
} finder;

/* --- the region --- */

static bool is_troubled(const finder *f, uint32_t p) {
    const brio_signed_graph *g = f->g;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        if (g->edge[e].weight != 0 && brio_label_violates(f->label, p, g->edge[e])) return true;
    return false;
}

/* Sets the depth of the neighbours of p that have none. Relaxed order suffices: threads that reach a node in one hop
 * write the same depth. No thread looks for that depth in this hop, and the next hop is another run. */
static void reach_neighbours(const finder *f, uint32_t p, uint8_t depth) {
    const brio_signed_graph *g = f->g;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
        uint8_t *there = &f->depth[g->edge[e].node];
        if (__atomic_load_n(there, __ATOMIC_RELAXED) == OUTSIDE && !f->fixed[g->edge[e].node])
            __atomic_store_n(there, depth, __ATOMIC_RELAXED);
    }
}

static void mark_troubled(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) f->depth[p] = !f->fixed[p] && is_troubled(f, (uint32_t)p) ? 0 : OUTSIDE;
}

static void hop_from(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        if (__atomic_load_n(&f->depth[p], __ATOMIC_RELAXED) == f->hop) reach_neighbours(f, (uint32_t)p, f->hop + 1);
}

static brio_status mark_region(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->g->ctx;
    size_t n = f->g->count;
    BRIO_TRY(brio_for_chunks(ctx, f->threads, n, NODES_A_CHUNK, mark_troubled, f));
    for (f->hop = 0; f->hop < HOPS; f->hop++) BRIO_TRY(brio_for_chunks(ctx, f->threads, n, NODES_A_CHUNK, hop_from, f));
done:
    return status;
}

static brio_status list_region(finder *f) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    size_t n = f->g->count, count = 0;
    BRIO_TRY(BRIO_ALLOC(b->ctx, f->depth, n));
    BRIO_TRY(mark_region(f));
    for (size_t p = 0; p < n; p++) b->count += f->depth[p] != OUTSIDE;
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->node, b->count));
    for (size_t p = 0; p < n; p++)
        if (f->depth[p] != OUTSIDE) b->node[count++] = (uint32_t)p;
done:
    return status;
}

/* --- along a curve --- */

/* Appends two opposite corners of a cube to the n points. The cube has twice the size of the points and contains them
 * at a random place. */
static void draw_cube(double *points, size_t n, uint64_t draw) {
    double low[3], high[3], side = 0;
    for (size_t k = 0; k < 3; k++) {
        low[k] = high[k] = points[k];
        for (size_t i = 1; i < n; i++) {
            low[k] = points[3 * i + k] < low[k] ? points[3 * i + k] : low[k];
            high[k] = points[3 * i + k] > high[k] ? points[3 * i + k] : high[k];
        }
        side = fmax(side, high[k] - low[k]);
    }
    brio_rng rng = brio_rng_new(draw);
    for (size_t k = 0; k < 3; k++) {
        points[3 * n + k] = low[k] - side * brio_rng_double(&rng);
        points[3 * n + 3 + k] = points[3 * n + k] + 2 * side;
    }
}

static void copy_positions(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        memcpy(f->points + 3 * i, f->g->position + 3 * (size_t)f->out->node[i], 3 * sizeof *f->points);
}

static brio_status sort_along_curve(finder *f, uint64_t draw) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    uint64_t *keys = NULL;
    size_t n = b->count;
    BRIO_TRY(BRIO_ALLOC(b->ctx, f->points, 3 * (n + 2)));
    BRIO_TRY(BRIO_ALLOC(b->ctx, keys, n + 2));
    BRIO_TRY(brio_for(b->ctx, f->threads, n, copy_positions, f));
    draw_cube(f->points, n, draw);
    BRIO_TRY(brio_hilbert_keys(b->ctx, f->points, n + 2, CURVE_BITS, keys));
    BRIO_TRY(brio_radix_sort(b->ctx, keys, b->node, n, 3 * CURVE_BITS));
done:
    brio_release(b->ctx, f->points);
    f->points = NULL;
    brio_release(b->ctx, keys);
    return status;
}

static brio_status set_places(const finder *f) {
    brio_node_blocks *b = f->out;
    brio_status status = BRIO_ALLOC(b->ctx, b->place, f->g->count);
    if (status != BRIO_OK) return status;
    memset(b->place, 255, f->g->count * sizeof *b->place);
    for (size_t i = 0; i < b->count; i++) b->place[b->node[i]] = (uint32_t)i;
    return BRIO_OK;
}

/* --- rounds --- */

static brio_status find_trouble(finder *f) {
    brio_node_blocks *b = f->out;
    b->num_blocks = (b->count + ((size_t)1 << b->bits) - 1) >> b->bits;
    brio_status status = BRIO_ALLOC_ZERO(b->ctx, f->trouble, b->num_blocks);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < b->count; i++) f->trouble[i >> b->bits] |= f->depth[b->node[i]] == 0;
    return BRIO_OK;
}

/* Lists the pairs of a block and the blocks of lower number, with violated edges, that an edge joins to it. */
static brio_status join(const finder *f, joiner *j, uint32_t block) {
    const brio_signed_graph *g = f->g;
    const brio_node_blocks *b = f->out;
    brio_status status = BRIO_OK;
    for (size_t i = brio_node_block_begin(b, block); i < brio_node_block_begin(b, block + 1); i++)
        for (size_t e = g->first[b->node[i]]; e < g->first[b->node[i] + 1]; e++) {
            uint32_t place = b->place[g->edge[e].node], other = place >> b->bits;
            if (place == BRIO_NO_PLACE || other >= block || j->seen[other] == block + 1 || !f->trouble[other]) continue;
            j->seen[other] = block + 1;
            BRIO_TRY(BRIO_RESERVE(b->ctx, j->pair, j->capacity, j->count + 1));
            j->pair[j->count++] = (uint64_t)block << 32 | other;
        }
done:
    return status;
}

static void join_part(void *user, size_t begin, size_t end, int thread) {
    finder *f = user;
    for (size_t block = begin; block < end; block++)
        if (f->trouble[block]) brio_report(&f->joined, join(f, &f->joiners[thread], (uint32_t)block));
}

static brio_status join_all(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    size_t n = f->out->num_blocks;
    for (int t = 0; t < f->threads; t++) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f->joiners[t].seen, n));
    BRIO_TRY(brio_for_chunks(ctx, n < (size_t)f->threads ? (int)n : f->threads, n, 1, join_part, f));
    status = f->joined;
done:
    return status;
}

static brio_status list_pairs(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f->joiners, (size_t)f->threads));
    BRIO_TRY(join_all(f));
    for (int t = 0; t < f->threads; t++) f->num_pairs += f->joiners[t].count;
    BRIO_TRY(BRIO_ALLOC(ctx, f->pair, f->num_pairs));
    for (size_t t = 0, count = 0; t < (size_t)f->threads; count += f->joiners[t++].count)
        if (f->joiners[t].count) memcpy(f->pair + count, f->joiners[t].pair, f->joiners[t].count * sizeof *f->pair);
    BRIO_TRY(brio_sort_many_keys(ctx, f->pair, f->num_pairs));
done:
    for (int t = 0; f->joiners && t < f->threads; t++) {
        brio_release(ctx, f->joiners[t].pair);
        brio_release(ctx, f->joiners[t].seen);
    }
    brio_release(ctx, f->joiners);
    return status;
}

/* Gives each block, in order, the first round that no earlier block joined to it has.
 *  taken  #blocks + 1, all 0: for each round, 1 + the last block that cannot have it. */
static void colour_blocks(const finder *f, uint32_t *round, uint32_t *taken) {
    brio_node_blocks *b = f->out;
    for (size_t block = 0, i = 0; block < b->num_blocks; block++) {
        if (!f->trouble[block]) continue;
        for (; i < f->num_pairs && f->pair[i] >> 32 == block; i++)
            taken[round[(uint32_t)f->pair[i]]] = (uint32_t)block + 1;
        uint32_t r = 0;
        while (taken[r] == block + 1) r++;
        round[block] = r;
        if (r >= b->num_rounds) b->num_rounds = r + 1;
    }
}

static brio_status list_rounds(const finder *f, const uint32_t *round) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, b->first_round, b->num_rounds + 1));
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->block, b->num_blocks));
    for (size_t i = 0; i < b->num_blocks; i++)
        if (f->trouble[i]) b->first_round[round[i]]++;
    for (size_t r = 0, end = 0; r <= b->num_rounds; r++) end += b->first_round[r], b->first_round[r] = end;
    for (size_t i = b->num_blocks; i-- > 0;)
        if (f->trouble[i]) b->block[--b->first_round[round[i]]] = (uint32_t)i;
done:
    return status;
}

static brio_status divide_into_rounds(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    uint32_t *round = NULL, *taken = NULL;
    BRIO_TRY(find_trouble(f));
    BRIO_TRY(list_pairs(f));
    BRIO_TRY(BRIO_ALLOC(ctx, round, f->out->num_blocks));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, taken, f->out->num_blocks + 1));
    colour_blocks(f, round, taken);
    BRIO_TRY(list_rounds(f, round));
done:
    brio_release(ctx, round);
    brio_release(ctx, taken);
    return status;
}

/* --- the blocks --- */

brio_status brio_node_blocks_find(const brio_signed_graph *g, const uint8_t *label, const uint8_t *fixed, int bits,
                                  uint64_t draw, brio_node_blocks *out) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(g->ctx, g->count, NODES_A_THREAD);
    finder f = {.g = g, .label = label, .fixed = fixed, .threads = threads, .out = out};
    *out = (brio_node_blocks){.ctx = g->ctx, .bits = bits};
    BRIO_TRY(list_region(&f));
    if (out->count > (size_t)1 << bits) BRIO_TRY(sort_along_curve(&f, draw));
    BRIO_TRY(set_places(&f));
    BRIO_TRY(divide_into_rounds(&f));
done:
    brio_release(g->ctx, f.depth);
    brio_release(g->ctx, f.trouble);
    brio_release(g->ctx, f.pair);
    return status;
}

void brio_node_blocks_free(brio_node_blocks *b) {
    brio_release(b->ctx, b->node);
    brio_release(b->ctx, b->place);
    brio_release(b->ctx, b->first_round);
    brio_release(b->ctx, b->block);
}
