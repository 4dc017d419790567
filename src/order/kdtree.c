/* Blocks of points by a k-d tree: a cell with more points than a block may have is halved at the median across the longest
 * side of its points' box.
 *
 * The medians are found by selection [Hoare 1961] on the coordinate, in 2^32 steps of the cube of the cell's points, with
 * the point's index below it: no two points are equal, so that duplicates are halved as anything else is. n log n in all.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, sections 5.3 and 5.8.
 * Differs from the paper: selection in place of sorting. */
#include "base/memory.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "order/blocks.h"
#include "order/cube.h"

enum { KEY_BITS = 32, POINTS_A_TASK = 1 << 13 };

typedef struct {
    const double *points;
    uint64_t *items; /* key across the longest side, index */
    uint32_t *index;
    size_t block_size;
    brio_block_fn visit;
    const void *user;
} kdtree;

static inline uint64_t median_of_three(uint64_t a, uint64_t b, uint64_t c) {
    uint64_t low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

/* An item that is likely to be near the middle, whatever the order. */
static uint64_t choose_pivot(const uint64_t *items, size_t n) {
    brio_rng rng = brio_rng_new(n);
    uint64_t three[3];
    for (int i = 0; i < 3; i++) three[i] = items[brio_rng_below(&rng, (uint32_t)n)];
    return median_of_three(three[0], three[1], three[2]);
}

/* Brings the `half` least items to the front. No two are equal. */
static void select_least(uint64_t *items, size_t n, size_t half) {
    size_t begin = 0, end = n;
    while (begin < half && half < end) {
        uint64_t pivot = choose_pivot(items + begin, end - begin);
        size_t i = begin, j = end - 1;
        for (;; i++, j--) {
            while (items[i] < pivot) i++;
            while (items[j] > pivot) j--;
            if (i >= j) break;
            uint64_t swap = items[i];
            items[i] = items[j], items[j] = swap;
        }
        if (half <= i)
            end = i;
        else
            begin = i == j ? i + 1 : i; /* where they met stands the pivot, in its place */
    }
}

/* Gives the items the keys of their points' longest side. */
static void set_keys(const kdtree *k, uint64_t *items, size_t n) {
    brio_cube cube;
    int axis = 0;
    brio_cube_new(&cube, k->points + 3 * (size_t)(uint32_t)items[0]);
    for (size_t i = 1; i < n; i++) brio_cube_add(&cube, k->points + 3 * (size_t)(uint32_t)items[i]);
    brio_cube_divide(&cube, KEY_BITS);
    for (int c = 1; c < 3; c++)
        if (cube.high[c] - cube.low[c] > cube.high[axis] - cube.low[axis]) axis = c;
    for (size_t i = 0; i < n; i++) {
        uint64_t index = (uint32_t)items[i];
        items[i] = (uint64_t)brio_cube_cell(&cube, k->points + 3 * index, axis) << 32 | index;
    }
}

static void divide(const kdtree *k, size_t begin, size_t end, int passes) {
    uint64_t *items = k->items + begin;
    size_t n = end - begin, half = n / 2;
    if (n <= k->block_size) {
        brio_block block = {begin, end, passes};
        for (size_t i = 0; i < n; i++) k->index[begin + i] = (uint32_t)items[i];
        k->visit(k->index, &block, k->user);
        return;
    }
    set_keys(k, items, n);
    select_least(items, n, half);
    BRIO_OMP(task if (n > POINTS_A_TASK))
    divide(k, begin, begin + half, passes + 1);
    divide(k, begin + half, end, passes + 1);
}

brio_status brio_kdtree_blocks(brio_context *ctx, const double *points, size_t n, size_t block_size, int threads,
                               uint32_t *index, brio_block_fn visit, const void *user) {
    kdtree k = {points, NULL, index, block_size, visit, user};
    if (n == 0) return BRIO_OK;
    brio_status status = BRIO_ALLOC(ctx, k.items, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) k.items[i] = i;
    BRIO_OMP(parallel num_threads(threads))
    BRIO_OMP(single)
    divide(&k, 0, n, 0);
    brio_release(ctx, k.items);
    return BRIO_OK;
}
