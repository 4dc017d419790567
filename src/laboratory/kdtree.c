/* Divides points into blocks by a k-d tree. A cell with more than block_size points is halved at the median across the
 * longest side of the bounding box of its points.
 *
 * A node stores an index with its coordinates in 2^32 steps of a cube around the points, so memory is read in sequence.
 * A cell shorter than FEW_STEPS takes new coordinates from its own cube, so clusters of any size are resolved.
 * Selection finds the median. The index breaks ties between equal coordinates, so duplicates are halved too. The work
 * is O(n log n).
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, sections 5.3 and 5.8.
 *           Hoare. Algorithm 65: find. CACM 1961.
 * Differs from the paper: selection in place of sorting. */
#include "base/memory.h"
#include "base/rng.h"
#include "laboratory/blocks.h"
#include "order/cube.h"
#include "base/halving.h"
#include <assert.h>

enum { STEP_BITS = 32, FEW_STEPS = 1 << 10, POINTS_A_PIECE = 1 << 13, SAMPLE = 31 };

typedef struct {
    uint32_t step[3], index;
} node;

typedef struct {
    const double *points;
    node *nodes;
    uint32_t *index;
    size_t block_size;
    brio_block_fn visit;
    const void *user;
} kdtree;

/* --- the median --- */

/* Returns the key of a node; no two nodes have the same key. */
static inline uint64_t key_of(const node *a, int axis) {
    return (uint64_t)a->step[axis] << 32 | a->index;
}

static inline void swap_nodes(node *a, node *b) {
    node swap = *a;
    *a = *b, *b = swap;
}

/* Returns a random node that about `half` of the n nodes precede: the quantile of a sample. */
static size_t choose_pivot(const node *nodes, size_t n, size_t half, int axis) {
    assert(0 < half && half < n);
    size_t sample[SAMPLE], size = n < 8 * SAMPLE ? 3 : SAMPLE;
    brio_rng rng = brio_rng_new(n);
    for (size_t i = 0, j; i < size; i++) {
        size_t drawn = brio_rng_below(&rng, (uint32_t)n);
        for (j = i; j > 0 && key_of(&nodes[sample[j - 1]], axis) > key_of(&nodes[drawn], axis); j--)
            sample[j] = sample[j - 1];
        sample[j] = drawn;
    }
    return sample[half * size / n];
}

/* Moves the nodes with keys less than the pivot's key to the front, and the pivot behind these nodes. Returns the
 * number of these nodes. */
static size_t divide_by_pivot(node *nodes, size_t n, size_t pivot, int axis) {
    size_t front = 0;
    uint64_t key = key_of(&nodes[pivot], axis);
    swap_nodes(&nodes[pivot], &nodes[n - 1]);
    for (size_t i = 0; i < n - 1; i++) { /* always swaps, so that the processor has no branch to predict */
        bool before = key_of(&nodes[i], axis) < key;
        swap_nodes(&nodes[i], &nodes[front]);
        front += before;
    }
    swap_nodes(&nodes[front], &nodes[n - 1]);
    assert(front < n);
    return front;
}

/* Moves the `half` nodes with the least keys to the front. */
static void select_least(node *nodes, size_t n, size_t half, int axis) {
    assert(half <= n);
    while (half > 0 && half < n) {
        size_t front = divide_by_pivot(nodes, n, choose_pivot(nodes, n, half, axis), axis);
        if (half <= front)
            n = front;
        else
            nodes += front + 1, half -= front + 1, n -= front + 1;
    }
}

/* --- cells --- */

/* Returns the longest side of the nodes' bounding box in steps, and writes its axis. */
static uint32_t longest_side(const node *nodes, size_t n, int *axis) {
    uint32_t low[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, high[3] = {0, 0, 0};
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) {
            low[c] = nodes[i].step[c] < low[c] ? nodes[i].step[c] : low[c];
            high[c] = nodes[i].step[c] > high[c] ? nodes[i].step[c] : high[c];
        }
    *axis = 0;
    for (int c = 1; c < 3; c++)
        if (high[c] - low[c] > high[*axis] - low[*axis]) *axis = c;
    return high[*axis] - low[*axis];
}

/* Computes the coordinates of the nodes anew, in steps of the nodes' own cube. */
static void take_steps(const kdtree *k, node *nodes, size_t n) {
    brio_cube cube;
    brio_cube_new(&cube, k->points + 3 * (size_t)nodes[0].index);
    for (size_t i = 1; i < n; i++) brio_cube_add(&cube, k->points + 3 * (size_t)nodes[i].index);
    brio_cube_divide(&cube, STEP_BITS);
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) nodes[i].step[c] = brio_cube_cell(&cube, k->points + 3 * (size_t)nodes[i].index, c);
}

static void visit_block(const kdtree *k, size_t begin, size_t end, int passes) {
    assert(begin < end && end - begin <= k->block_size);
    brio_block block = {begin, end, passes};
    for (size_t i = begin; i < end; i++) k->index[i] = k->nodes[i].index;
    k->visit(k->index, &block, k->user);
}

/* Halves a cell: moves the nodes with the least coordinates along the longest side to [begin, middle). */
static void cut(const void *user, size_t begin, size_t middle, size_t end) {
    const kdtree *k = user;
    node *nodes = k->nodes + begin;
    size_t n = end - begin;
    int axis;
    if (longest_side(nodes, n, &axis) < FEW_STEPS) {
        take_steps(k, nodes, n);
        longest_side(nodes, n, &axis);
    }
    select_least(nodes, n, middle - begin, axis);
}

static void divide(const void *user, size_t begin, size_t end, int passes) {
    const kdtree *k = user;
    size_t middle = begin + (end - begin) / 2;
    if (end - begin <= k->block_size) {
        visit_block(k, begin, end, passes);
        return;
    }
    cut(k, begin, middle, end);
    divide(k, begin, middle, passes + 1);
    divide(k, middle, end, passes + 1);
}

brio_status brio_kdtree_blocks(brio_context *ctx, const brio_blocks *b) {
    kdtree k = {b->points, NULL, b->index, b->block_size, b->visit, b->user};
    size_t n = b->n;
    if (n == 0) return BRIO_OK;
    brio_status status = BRIO_ALLOC(ctx, k.nodes, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) k.nodes[i] = (node){{0, 0, 0}, (uint32_t)i};
    size_t least = b->block_size > POINTS_A_PIECE ? b->block_size : POINTS_A_PIECE;
    status = brio_halve(ctx, &(brio_halving){.count = n, .least = least, .cut = cut, .finish = divide, .user = &k});
    brio_release(ctx, k.nodes);
    return status;
}
