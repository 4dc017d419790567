/* The tree of boxes over the blocks of all tiles: see work.h. The children of a node follow each other in the array,
 * and the last node is the root. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include "tiles/work.h"
#include <assert.h>
#include <string.h>

enum { BLOCKS_A_THREAD = 1 << 8 };

static const brio_ball_box NOTHING = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, -INFINITY};

static void extend(brio_ball_box *box, const brio_ball_box *by) {
    for (int k = 0; k < 3; k++) {
        if (by->low[k] < box->low[k]) box->low[k] = by->low[k];
        if (by->high[k] > box->high[k]) box->high[k] = by->high[k];
    }
    if (by->weight > box->weight) box->weight = by->weight;
}

static brio_status append(brio_tiles *t, const brio_tile_node *node) {
    BRIO_EXPECT(t->ctx, t->num_nodes < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE, "more than 2^32 - 17 blocks of points");
    BRIO_FORWARD(BRIO_RESERVE(t->ctx, t->node, t->node_capacity, t->num_nodes + 1));
    t->node[t->num_nodes++] = *node;
    return BRIO_OK;
}

typedef struct {
    const brio_tile *tile;
    const brio_set_point *points;
    brio_tile_node *node;
} blocks;

/* Sets the nodes of some blocks of a tile. */
static void set_blocks(void *user, size_t begin, size_t end, int thread) {
    const blocks *b = user;
    (void)thread;
    for (size_t block = begin; block < end; block++) {
        size_t first = block * TILE_BLOCK, left = b->tile->points - first, n = left < TILE_BLOCK ? left : TILE_BLOCK;
        brio_tile_node *node = &b->node[block];
        *node = (brio_tile_node){.box = NOTHING,
                                 .sample = b->points[first],
                                 .place = b->tile->place + first,
                                 .points = (uint32_t)n,
                                 .tile = TILE_NONE};
        node->sample.name = node->place;
        for (size_t i = first; i < first + n; i++) {
            const double *r = b->points[i].record;
            extend(&node->box, &(brio_ball_box){{r[0], r[1], r[2]}, {r[0], r[1], r[2]}, r[3]});
        }
    }
}

static brio_status append_blocks(brio_tiles *t, const brio_tile *tile, const brio_set_point *points) {
    size_t n = ((size_t)tile->points + TILE_BLOCK - 1) / TILE_BLOCK;
    BRIO_EXPECT(t->ctx, t->num_nodes + n < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE, "more than 2^32 - 17 blocks of points");
    BRIO_FORWARD(BRIO_RESERVE(t->ctx, t->node, t->node_capacity, t->num_nodes + n));
    blocks b = {tile, points, t->node + t->num_nodes};
    t->num_nodes += n;
    return brio_for(t->ctx, brio_threads(t->ctx, n, BLOCKS_A_THREAD), n, set_blocks, &b);
}

/* Appends nodes over the nodes from `begin` on, level by level, up to one. */
static brio_status append_levels(brio_tiles *t, size_t begin) {
    for (size_t end = t->num_nodes; end - begin > 1; begin = end, end = t->num_nodes)
        for (size_t first = begin; first < end; first += TILE_FAN) {
            size_t n = end - first < TILE_FAN ? end - first : TILE_FAN;
            brio_tile_node node = {
                .box = NOTHING, .first = (uint32_t)first, .children = (uint32_t)n, .tile = TILE_NONE};
            node.sample = t->node[first + brio_mix(first) % n].sample;
            for (size_t i = 0; i < n; i++) extend(&node.box, &t->node[first + i].box);
            BRIO_FORWARD(append(t, &node));
        }
    return BRIO_OK;
}

brio_status brio_tile_tree_add(brio_tiles *t, uint32_t tile, const brio_set_point *points) {
    brio_tile *facts = &t->tile[tile];
    size_t begin = t->num_nodes;
    facts->root = TILE_NONE;
    if (!facts->points) return BRIO_OK;
    BRIO_FORWARD(append_blocks(t, facts, points));
    BRIO_FORWARD(append_levels(t, begin));
    facts->root = (uint32_t)t->num_nodes - 1;
    return BRIO_OK;
}

brio_status brio_tile_tree_close(brio_tiles *t) {
    size_t begin = t->num_nodes;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        if (t->tile[i].root == TILE_NONE) continue;
        brio_tile_node root = t->node[t->tile[i].root]; /* a copy: roots follow each other */
        root.tile = i;
        t->tile[i].root = (uint32_t)t->num_nodes;
        BRIO_FORWARD(append(t, &root));
    }
    return append_levels(t, begin);
}

/* --- several processes --- */

enum { UPPER_LEVELS = 2 }; /* below the root of a tile. Chosen: docs/scaling.md */

static uint32_t points_below(const brio_tiles *t, const brio_tile_node *node) {
    uint32_t sum = node->points;
    for (uint32_t c = 0; c < node->children; c++) sum += points_below(t, &t->node[node->first + c]);
    return sum;
}

brio_status brio_tile_tree_upper(brio_tiles *t, brio_tile_node **out, size_t *count) {
    brio_status status = BRIO_OK;
    brio_tile_node *list = NULL;
    size_t n = 0, capacity = 0;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        if (t->tile[i].root == TILE_NONE || !t->tile[i].points) continue;
        BRIO_TRY(BRIO_RESERVE(t->ctx, list, capacity, n + 1));
        list[n] = t->node[t->tile[i].root];
        list[n].tile = i;
        size_t level = n++;
        for (int k = 0; k < UPPER_LEVELS; k++)
            for (size_t end = n; level < end; level++) {
                brio_tile_node from = list[level];
                list[level].first = (uint32_t)n;
                BRIO_TRY(BRIO_RESERVE(t->ctx, list, capacity, n + from.children));
                for (uint32_t c = 0; c < from.children; c++) list[n++] = t->node[from.first + c];
            }
        for (; level < n; level++) {
            list[level].points = points_below(t, &list[level]);
            list[level].children = 0;
        }
    }
    *out = list, *count = n;
    list = NULL;
done:
    brio_release(t->ctx, list);
    return status;
}

brio_status brio_tile_roots_add(brio_tiles *t, brio_tile_roots *roots, uint32_t node) {
    BRIO_FORWARD(BRIO_RESERVE(t->ctx, roots->node, roots->capacity, roots->count + 1));
    roots->node[roots->count++] = node;
    return BRIO_OK;
}

brio_status brio_tile_tree_far(brio_tiles *t, const brio_tile_node *nodes, size_t count, int rank,
                               brio_tile_roots *roots) {
    uint32_t begin = (uint32_t)t->num_nodes;
    for (size_t i = 0; i < count; i++) {
        brio_tile_node node = nodes[i];
        bool is_root = node.tile != TILE_NONE;
        node.tile = node.children ? TILE_NONE : TILE_FAR;
        node.first = node.children ? begin + node.first : (uint32_t)rank;
        BRIO_FORWARD(append(t, &node));
        if (is_root) BRIO_FORWARD(brio_tile_roots_add(t, roots, begin + (uint32_t)i));
    }
    return BRIO_OK;
}

brio_status brio_tile_tree_join(brio_tiles *t, const brio_tile_roots *roots) {
    size_t begin = t->num_nodes;
    for (size_t i = 0; i < roots->count; i++) {
        brio_tile_node root = t->node[roots->node[i]];
        if (root.tile < t->num_tiles) t->tile[root.tile].root = (uint32_t)t->num_nodes;
        BRIO_FORWARD(append(t, &root));
    }
    return append_levels(t, begin);
}
