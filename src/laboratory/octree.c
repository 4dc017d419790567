/* Divides points into blocks by an octree.
 *
 * A cell of the octree with more than block_size points is divided into its eight octants. One pass divides several
 * levels: it numbers the finest cells depth first, counts their points and moves the points of each finest cell
 * together. Every cell of any level is then a range. The work is linear in the number of points times the number of
 * passes.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, sections 5.3 and 5.8.
 * Differs from the paper: a cell that is still crowded after a pass starts again from the bounding cube of the cell's
 * points, so that clusters of any size take few passes.
 *
 * All threads divide large cells in turns. In a turn each large cell is one task: a thread passes once over its points
 * and finishes its small cells. The large cells inside it wait for the next turn. */
#include "base/memory.h"
#include "base/places.h"
#include "base/team.h"
#include "laboratory/blocks.h"
#include "order/cube.h"
#include <assert.h>
#include <string.h>

enum { ROOT_LEVELS = 5, LEVELS = 3, LARGE = 1 << 13, POINTS_A_THREAD = 1 << 13, NO_CELL = UINT32_MAX };

/* A cell with more than LARGE points, not yet divided. No two large cells of a turn share a point. */
typedef struct {
    size_t begin, end;
    int passes;
} large_cell;

typedef struct {
    const double *points;
    uint32_t *index, *spare;
    uint16_t *cell; /* room for a number a point */
    size_t block_size;
    brio_block_fn visit;
    const void *user;
    large_cell *now, *next; /* the cells of this turn and of the next turn; room for n / LARGE + 1 cells each */
    size_t num_next;        /* number of cells in `next`; all threads of a turn raise it atomically */
} octree;

/* The points of a pass and their cube, divided into 8^levels cells. The pass counts the points of the cells and then
 * places them; it keeps the cells in between, because the caller's points may change meanwhile. */
typedef struct {
    const double *points;
    const uint32_t *from; /* the indices before the pass; NULL: index i is at position i */
    uint16_t *cell;       /* of each position, once it is counted: the number of its finest cell */
    size_t begin, end;
    brio_cube cube;
    int levels, passes; /* `passes` includes this pass */
} grid;

/* --- a pass --- */

static inline uint32_t cells_of(const grid *g) {
    assert(0 < g->levels && g->levels <= ROOT_LEVELS); /* numbers of cells have 15 bits */
    return UINT32_C(1) << 3 * g->levels;
}

static inline uint32_t index_at(const grid *g, size_t i) {
    return g->from ? g->from[i] : (uint32_t)i;
}

/* Returns enough levels, at most `most`, to reach block_size when the points are evenly distributed. */
static int levels_for(size_t points, size_t block_size, int most) {
    int levels = 1;
    while (levels < most && points / block_size >> 3 * levels > 0) levels++;
    return levels;
}

/* Inserts two zero bits above each of the lowest five bits of x. */
static inline uint32_t spread(uint32_t x) {
    assert(x >> 5 == 0);
    x = (x | x << 8) & 0x100f;
    x = (x | x << 4) & 0x10c3;
    return (x | x << 2) & 0x1249;
}

/* Returns the depth-first number of the finest cell of a point. */
static inline uint16_t cell_of(const grid *g, uint32_t point) {
    const double *p = g->points + 3 * (size_t)point;
    const brio_cube *c = &g->cube;
    return (uint16_t)(spread(brio_cube_cell(c, p, 0)) << 2 | spread(brio_cube_cell(c, p, 1)) << 1 |
                      spread(brio_cube_cell(c, p, 2)));
}

static void add_to_cube(const grid *g, size_t from, size_t to, brio_cube *cube) {
    for (size_t i = from; i < to; i++) brio_cube_add(cube, g->points + 3 * (size_t)index_at(g, i));
}

static void count_cells(const grid *g, size_t from, size_t to, size_t *place) {
    for (size_t i = from; i < to; i++) place[g->cell[i] = cell_of(g, index_at(g, i))]++;
}

static void place_in_cells(const grid *g, size_t from, size_t to, size_t *place, uint32_t *index) {
    for (size_t i = from; i < to; i++) index[place[g->cell[i]]++] = index_at(g, i);
}

/* --- blocks --- */

static void divide(octree *o, size_t begin, size_t end, int passes);

static void visit_block(const octree *o, size_t begin, size_t end, int passes) {
    assert(begin < end && end - begin <= o->block_size);
    brio_block block = {begin, end, passes};
    o->visit(o->index, &block, o->user);
}

/* Appends a large cell to `next`. Relaxed order is enough: the position belongs to this thread alone, and other threads
 * read the cell only after the turn, whose end orders the write before the reads. */
static void leave_for_next_turn(octree *o, size_t begin, size_t end, int passes) {
    assert(end - begin > LARGE); /* the room for large cells */
    size_t place = __atomic_fetch_add(&o->num_next, 1, __ATOMIC_RELAXED);
    o->next[place] = (large_cell){begin, end, passes};
}

/* Visits the blocks of the cell that consists of the finest cells [first, first + size). The points of finest cell c
 * end at stop[c]. Leaves crowded finest cells that are large for the next turn. Divides the other crowded finest cells,
 * except finest cell all_but. */
static void visit_cell(octree *o, const grid *g, const size_t *stop, uint32_t first, uint32_t size, uint32_t all_but) {
    size_t begin = first ? stop[first - 1] : g->begin, end = stop[first + size - 1];
    assert(begin <= end && end <= g->end);
    int passes = g->passes;
    if (begin == end) return;
    if (end - begin <= o->block_size) {
        visit_block(o, begin, end, passes);
    } else if (size > 1) {
        for (uint32_t i = 0; i < 8; i++) visit_cell(o, g, stop, first + size / 8 * i, size / 8, all_but);
    } else if (end - begin > LARGE) {
        leave_for_next_turn(o, begin, end, passes);
    } else if (first != all_but) {
        divide(o, begin, end, passes);
    }
}

/* Cuts points that no cube can separate into blocks, in their present order. */
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

/* Moves the points of each finest cell c together, so that they end at stop[c]. Returns false, and moves nothing, when
 * one finest cell holds all points. */
static bool bring_cells_together(const octree *o, grid *g, size_t *stop) {
    memcpy(o->spare + g->begin, o->index + g->begin, (g->end - g->begin) * sizeof *o->index);
    brio_cube_new(&g->cube, g->points + 3 * (size_t)index_at(g, g->begin));
    add_to_cube(g, g->begin, g->end, &g->cube);
    if (!brio_cube_divide(&g->cube, g->levels)) return false;
    memset(stop, 0, cells_of(g) * sizeof *stop);
    count_cells(g, g->begin, g->end, stop);
    if (stop[g->cell[g->begin]] == g->end - g->begin) return false;
    brio_counts_to_places(stop, 1, cells_of(g), g->begin);
    place_in_cells(g, g->begin, g->end, stop, o->index);
    return true;
}

static grid grid_of(const octree *o, size_t begin, size_t end, int passes) {
    int levels = levels_for(end - begin, o->block_size, LEVELS);
    return (grid){.points = o->points,
                  .from = o->spare,
                  .cell = o->cell,
                  .begin = begin,
                  .end = end,
                  .levels = levels,
                  .passes = passes};
}

/* Divides [begin, end), which is not large, into blocks. The loop continues with the most crowded cell. The recursion
 * enters only other cells, which have at most half the points, so its depth is at most log2 LARGE. */
static void divide(octree *o, size_t begin, size_t end, int passes) {
    size_t stop[1 << 3 * LEVELS];
    while (end - begin > o->block_size) {
        grid g = grid_of(o, begin, end, ++passes);
        if (!bring_cells_together(o, &g, stop)) {
            visit_crowd(o, begin, end, passes);
            return;
        }
        uint32_t most = most_crowded(&g, stop);
        visit_cell(o, &g, stop, 0, cells_of(&g), most);
        if (most) begin = stop[most - 1];
        end = stop[most];
        assert(begin <= end);
    }
}

/* --- turns --- */

/* Passes once over the points of the large cells [from, to) of this turn, and finishes the small cells inside them. */
static void divide_large(void *user, size_t from, size_t to, int thread) {
    octree *o = user;
    size_t stop[1 << 3 * LEVELS];
    (void)thread;
    for (size_t i = from; i < to; i++) {
        const large_cell *c = &o->now[i];
        grid g = grid_of(o, c->begin, c->end, c->passes + 1);
        if (bring_cells_together(o, &g, stop))
            visit_cell(o, &g, stop, 0, cells_of(&g), NO_CELL);
        else
            visit_crowd(o, c->begin, c->end, g.passes);
    }
}

static brio_status take_turns(brio_context *ctx, octree *o, int threads) {
    while (o->num_next) {
        large_cell *swap = o->now;
        size_t count = o->num_next;
        o->now = o->next, o->next = swap;
        o->num_next = 0;
        BRIO_FORWARD(brio_for_chunks(ctx, count < (size_t)threads ? (int)count : threads, count, 1, divide_large, o));
    }
    return BRIO_OK;
}

/* --- the root --- */

typedef struct {
    octree *o;
    const grid *g;
    size_t *place;      /* #threads by #cells: the counts of each thread's part, then the positions where it writes */
    const size_t *stop; /* #cells: the ends of the cells, which are the last thread's positions after writing */
} root;

static void count_part(void *user, size_t begin, size_t end, int thread) {
    const root *r = user;
    count_cells(r->g, begin, end, r->place + cells_of(r->g) * (size_t)thread);
}

static void place_part(void *user, size_t begin, size_t end, int thread) {
    const root *r = user;
    place_in_cells(r->g, begin, end, r->place + cells_of(r->g) * (size_t)thread, r->o->index);
}

static void visit_octants(void *user, size_t begin, size_t end, int thread) {
    const root *r = user;
    uint32_t size = cells_of(r->g) / 8;
    (void)thread;
    for (size_t i = begin; i < end; i++) visit_cell(r->o, r->g, r->stop, size * (uint32_t)i, size, NO_CELL);
}

/* Does the work of bring_cells_together for all points, with all threads. */
static brio_status bring_all_together(brio_context *ctx, root *r, int threads) {
    size_t cells = cells_of(r->g), n = r->g->end;
    BRIO_FORWARD(brio_for(ctx, threads, n, count_part, r));
    for (size_t c = 0, place = 0; c < cells; c++)
        place = brio_counts_to_places(r->place + c, cells, (size_t)threads, place);
    BRIO_FORWARD(brio_for(ctx, threads, n, place_part, r));
    r->stop = r->place + cells * (size_t)(threads - 1);
    assert(r->stop[cells - 1] == n);
    return BRIO_OK;
}

static brio_status divide_root(brio_context *ctx, octree *o, grid *g, int threads) {
    brio_status status = BRIO_OK;
    root r = {.o = o, .g = g};
    BRIO_TRY(BRIO_ALLOC(ctx, o->cell, g->end));
    g->cell = o->cell;
    BRIO_TRY(BRIO_ALLOC(ctx, o->now, g->end / LARGE + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, o->next, g->end / LARGE + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, r.place, cells_of(g) * (size_t)threads));
    BRIO_TRY(bring_all_together(ctx, &r, threads));
    BRIO_TRY(brio_for_chunks(ctx, threads, 8, 1, visit_octants, &r));
    BRIO_TRY(take_turns(ctx, o, threads));
done:
    brio_release(ctx, o->now);
    brio_release(ctx, o->next);
    brio_release(ctx, o->cell);
    brio_release(ctx, r.place);
    return status;
}

brio_status brio_octree_blocks(brio_context *ctx, const brio_blocks *b, uint32_t *spare) {
    octree o = {.points = b->points,
                .index = b->index,
                .spare = spare,
                .block_size = b->block_size,
                .visit = b->visit,
                .user = b->user};
    size_t n = b->n;
    grid g = {.points = b->points, .end = n, .levels = levels_for(n, b->block_size, ROOT_LEVELS), .passes = 1};
    int threads = brio_threads(ctx, n, POINTS_A_THREAD);
    if (n == 0) return BRIO_OK;
    brio_status status = brio_cube_of(ctx, b->points, NULL, n, threads, &g.cube);
    if (status != BRIO_OK) return status;
    if (n > b->block_size && brio_cube_divide(&g.cube, g.levels)) return divide_root(ctx, &o, &g, threads);
    for (size_t i = 0; i < n; i++) b->index[i] = (uint32_t)i;
    visit_crowd(&o, 0, n, 1);
    return BRIO_OK;
}
