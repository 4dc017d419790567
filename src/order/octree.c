/* Blocks of points by an octree.
 *
 * A cell of the octree with more points than a block may have is divided into its eight halves. Several levels are
 * divided in one pass: the finest cells are numbered depth first, their points are counted and brought together, and
 * every cell of any level is then a range. Work is linear in the number of points as long as the levels are few.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, sections 5.3 and 5.8.
 * Differs from the paper: a cell that is still crowded after a pass starts again from the cube of its own points, so that
 * clusters of any size take few passes. */
#include "base/memory.h"
#include "base/parallel.h"
#include "order/blocks.h"
#include "order/cube.h"
#include <string.h>

enum { ROOT_LEVELS = 5, LEVELS = 3, POINTS_A_TASK = 1 << 13, NO_CELL = UINT32_MAX };

typedef struct {
    const double *points;
    uint32_t *index, *spare;
    size_t block_size;
    brio_block_fn visit;
    const void *user;
} octree;

/* The points of a pass and their cube, divided into 8^levels cells. */
typedef struct {
    const double *points;
    const uint32_t *from; /* the pass' indices, NULL when each is its own place */
    size_t begin, end;
    brio_cube cube;
    int levels, passes; /* `passes` with this one */
} grid;

/* --- a pass --- */

static inline uint32_t cells_of(const grid *g) {
    return UINT32_C(1) << 3 * g->levels;
}

static inline uint32_t index_at(const grid *g, size_t i) {
    return g->from ? g->from[i] : (uint32_t)i;
}

/* Enough levels for blocks of an even distribution. */
static int levels_for(size_t points, size_t block_size, int most) {
    int levels = 1;
    while (levels < most && points / block_size >> 3 * levels > 0) levels++;
    return levels;
}

/* Puts two zeros before each of five bits. */
static inline uint32_t spread(uint32_t x) {
    x = (x | x << 8) & 0x100f;
    x = (x | x << 4) & 0x10c3;
    return (x | x << 2) & 0x1249;
}

/* Number of the finest cell of a point, depth first. */
static inline uint32_t cell_of(const grid *g, uint32_t point) {
    const double *p = g->points + 3 * (size_t)point;
    const brio_cube *c = &g->cube;
    return spread(brio_cube_cell(c, p, 0)) << 2 | spread(brio_cube_cell(c, p, 1)) << 1 |
           spread(brio_cube_cell(c, p, 2));
}

static void add_to_cube(const grid *g, size_t from, size_t to, brio_cube *cube) {
    for (size_t i = from; i < to; i++) brio_cube_add(cube, g->points + 3 * (size_t)index_at(g, i));
}

static void count_cells(const grid *g, size_t from, size_t to, size_t *place) {
    for (size_t i = from; i < to; i++) place[cell_of(g, index_at(g, i))]++;
}

static void place_in_cells(const grid *g, size_t from, size_t to, size_t *place, uint32_t *index) {
    for (size_t i = from; i < to; i++) {
        uint32_t point = index_at(g, i);
        index[place[cell_of(g, point)]++] = point;
    }
}

/* --- blocks --- */

static void divide(const octree *o, size_t begin, size_t end, int passes);

static void visit_block(const octree *o, size_t begin, size_t end, int passes) {
    brio_block block = {begin, end, passes};
    o->visit(o->index, &block, o->user);
}

/* Visits the blocks of the cell that the finest cells [first, first + size) make; the points of finest cell c end at
 * stop[c]. Of the finest cells that are crowded, all but one are divided further. */
static void visit_cell(const octree *o, const grid *g, const size_t *stop, uint32_t first, uint32_t size,
                       uint32_t all_but) {
    size_t begin = first ? stop[first - 1] : g->begin, end = stop[first + size - 1];
    int passes = g->passes;
    if (begin == end) return;
    if (end - begin <= o->block_size) {
        visit_block(o, begin, end, passes);
    } else if (size > 1) {
        for (uint32_t i = 0; i < 8; i++) visit_cell(o, g, stop, first + size / 8 * i, size / 8, all_but);
    } else if (first != all_but) {
        BRIO_OMP(task if (end - begin > POINTS_A_TASK))
        divide(o, begin, end, passes);
    }
}

/* Points that no cube tells apart. */
static void visit_crowd(const octree *o, size_t begin, size_t end, int passes) {
    for (; end - begin > o->block_size; begin += o->block_size) visit_block(o, begin, begin + o->block_size, passes);
    visit_block(o, begin, end, passes);
}

static uint32_t most_crowded(const grid *g, const size_t *stop) {
    uint32_t most = 0;
    size_t points = stop[0] - g->begin;
    for (uint32_t c = 1; c < cells_of(g); c++)
        if (stop[c] - stop[c - 1] > points) {
            points = stop[c] - stop[c - 1];
            most = c;
        }
    return most;
}

/* Brings the points of each finest cell c together, which then end at stop[c]; false when all are in one. */
static bool bring_cells_together(const octree *o, grid *g, size_t *stop) {
    size_t sum = g->begin;
    memcpy(o->spare + g->begin, o->index + g->begin, (g->end - g->begin) * sizeof *o->index);
    brio_cube_new(&g->cube, g->points + 3 * (size_t)index_at(g, g->begin));
    add_to_cube(g, g->begin, g->end, &g->cube);
    if (!brio_cube_divide(&g->cube, g->levels)) return false;
    memset(stop, 0, cells_of(g) * sizeof *stop);
    count_cells(g, g->begin, g->end, stop);
    if (stop[cell_of(g, index_at(g, g->begin))] == g->end - g->begin) return false;
    for (uint32_t c = 0; c < cells_of(g); c++) {
        size_t points = stop[c];
        stop[c] = sum;
        sum += points;
    }
    place_in_cells(g, g->begin, g->end, stop, o->index);
    return true;
}

/* Divides [begin, end) into blocks. The most crowded cell is left for the next turn, so that the recursion is no deeper
 * than log2 n. */
static void divide(const octree *o, size_t begin, size_t end, int passes) {
    size_t stop[1 << 3 * LEVELS];
    while (end - begin > o->block_size) {
        grid g = {.points = o->points, .from = o->spare, .begin = begin, .end = end, .passes = ++passes};
        g.levels = levels_for(end - begin, o->block_size, LEVELS);
        if (!bring_cells_together(o, &g, stop)) {
            visit_crowd(o, begin, end, passes);
            return;
        }
        uint32_t most = most_crowded(&g, stop);
        visit_cell(o, &g, stop, 0, cells_of(&g), most);
        if (most) begin = stop[most - 1];
        end = stop[most];
    }
}

/* --- the root --- */

static brio_cube cube_of(const grid *g, int threads) {
    brio_cube first, all;
    brio_cube_new(&first, g->points);
    all = first;
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++) {
        brio_cube own = first;
        add_to_cube(g, brio_part(g->end, t, threads), brio_part(g->end, t + 1, threads), &own);
        BRIO_OMP(critical(brio_octree_cube))
        brio_cube_join(&all, &own);
    }
    return all;
}

/* The same as bring_cells_together for all points, by all threads; place holds the counts of each thread's part, and the
 * last of them the ends. */
static void bring_all_together(const octree *o, const grid *g, int threads, size_t *place) {
    size_t cells = cells_of(g), n = g->end, sum = 0;
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++)
        count_cells(g, brio_part(n, t, threads), brio_part(n, t + 1, threads), place + cells * (size_t)t);
    for (size_t c = 0; c < cells; c++)
        for (int t = 0; t < threads; t++) {
            size_t points = place[cells * (size_t)t + c];
            place[cells * (size_t)t + c] = sum;
            sum += points;
        }
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++)
        place_in_cells(g, brio_part(n, t, threads), brio_part(n, t + 1, threads), place + cells * (size_t)t, o->index);
}

brio_status brio_octree_blocks(brio_context *ctx, const double *points, size_t n, size_t block_size, int threads,
                               uint32_t *index, uint32_t *spare, brio_block_fn visit, const void *user) {
    octree o = {points, index, spare, block_size, visit, user};
    grid root = {.points = points, .end = n, .levels = levels_for(n, block_size, ROOT_LEVELS), .passes = 1};
    size_t *place = NULL;
    if (n == 0) return BRIO_OK;
    root.cube = cube_of(&root, threads);
    if (n <= block_size || !brio_cube_divide(&root.cube, root.levels)) {
        for (size_t i = 0; i < n; i++) index[i] = (uint32_t)i;
        visit_crowd(&o, 0, n, 1);
        return BRIO_OK;
    }
    brio_status status = BRIO_ALLOC_ZERO(ctx, place, cells_of(&root) * (size_t)threads);
    if (status != BRIO_OK) return status;
    bring_all_together(&o, &root, threads, place);
    const size_t *stop = place + cells_of(&root) * (size_t)(threads - 1);
    BRIO_OMP(parallel for schedule(dynamic, 1) num_threads(threads))
    for (uint32_t i = 0; i < 8; i++) visit_cell(&o, &root, stop, cells_of(&root) / 8 * i, cells_of(&root) / 8, NO_CELL);
    brio_release(ctx, place);
    return BRIO_OK;
}
