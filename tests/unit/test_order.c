/* Insertion orders: permutations, the curve's continuity, the share of each round, what the blocks are. */
#include "base/team.h"
#include "failing_allocator.h"
#include "harness.h"
#include "base/memory.h"
#include "laboratory/blocks.h"
#include "order/canonical_points.h"
#include "order/curve.h"
#include "order/hilbert.h"
#include "order/order.h"
#include "points.h"
#include "trial.h"

static void curve_visits_each_cell_once_in_unit_steps(void) {
    enum { BITS = 4, SIDE = 1 << BITS, CELLS = SIDE * SIDE * SIDE };
    static int at[CELLS][3];
    static char seen[CELLS];
    for (uint32_t x = 0; x < SIDE; x++)
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t z = 0; z < SIDE; z++) {
                uint64_t key = brio_hilbert_key(x, y, z, BITS);
                EXPECT(key < CELLS && !seen[key]);
                seen[key] = 1;
                at[key][0] = (int)x, at[key][1] = (int)y, at[key][2] = (int)z;
            }
    for (int k = 1; k < CELLS; k++) {
        int steps = 0;
        for (int c = 0; c < 3; c++) steps += abs(at[k][c] - at[k - 1][c]);
        EXPECT(steps == 1);
    }
}

/* --- every order --- */

enum { MOST = 40000 };
static double points[3 * MOST];
static uint32_t order[MOST], other[MOST], rank[MOST], index_of[MOST], spare[MOST];

static trial_options options_of(int kind, size_t block_size) {
    trial_options o = {0};
    o.order = kind;
    o.block_size = block_size;
    return o;
}

/* Points of every kind that could be hard to tell apart; the names are for messages. */
static const char *hard_points(int set, size_t n) {
    switch (set) {
    case 0:
        uniform_points(1, n, points);
        return "uniform";
    case 1:
        integer_points(1, n, 3, points);
        return "lattice with duplicates";
    case 2:
        for (size_t i = 0; i < 3 * n; i++) points[i] = i % 2 ? 1.7e308 : -1.7e308;
        return "far apart";
    case 3:
        clustered_points(5, n, points);
        return "clusters";
    case 4:
        integer_points(2, n, 100, points);
        for (size_t i = 0; i < n; i++) points[3 * i + 2] = 7;
        return "in a plane";
    case 5:
        for (size_t i = 0; i < 3 * n; i++) points[i] = -0.1;
        return "at one position";
    case 6:
        for (size_t i = 0; i < n; i++)
            for (int c = 0; c < 3; c++) points[3 * i + (size_t)c] = ldexp(1, -(int)(i % 2000));
        return "halved again and again";
    case 7:
        uniform_points(1, n, points);
        for (size_t i = 0; i < n; i += 3) points[3 * i + i % 2] = i % 4 ? NAN : i % 8 ? INFINITY : -INFINITY;
        return "not finite";
    default:
        return NULL;
    }
}

static bool is_permutation(const uint32_t *a, size_t n) {
    static char seen[MOST];
    memset(seen, 0, n);
    for (size_t i = 0; i < n; i++)
        if (a[i] >= n || seen[a[i]]++) return false;
    return true;
}

static void every_order_is_a_permutation(void) {
    brio_context *ctx = new_context();
    for (int set = 0; hard_points(set, 0); set++)
        for (size_t n = 0; n <= 5000; n = n < 3 ? n + 1 : 5000 + (n == 5000))
            for (int kind = 0; kind < TRIAL_ORDERS; kind++)
                for (size_t block_size = 0; block_size < 100; block_size = block_size * 10 + 1) {
                    const char *name = hard_points(set, n);
                    trial_options o = options_of(kind, block_size);
                    EXPECT(trial_order(ctx, &(brio_input){points, NULL, n}, &o, order, NULL, NULL, NULL) == BRIO_OK);
                    EXPECT(is_permutation(order, n), "order %d of %zu points %s", kind, n, name);
                }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void number_of_threads_does_not_matter(void) {
    brio_context *ctx = new_context();
    for (int set = 0; set < 4; set++)
        for (int kind = 0; kind < TRIAL_ORDERS; kind++) {
            hard_points(set, MOST);
            trial_options o = options_of(kind, 0);
            brio_context_set_threads(ctx, 1);
            EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, NULL, NULL, NULL) == BRIO_OK);
            brio_context_set_threads(ctx, 3);
            EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, other, NULL, NULL, NULL) == BRIO_OK);
            EXPECT(!memcmp(order, other, sizeof order), "order %d of set %d", kind, set);
        }
    brio_context_free(ctx);
}

/* Differences of 2^-1000 and less fell into few cells. */
static void powers_of_two_do_not_change_the_order(void) {
    static const int exponents[] = {-1074, -1030, -990, -500, 500, 1016};
    brio_context *ctx = new_context();
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++)
        for (int kind = 0; kind < TRIAL_ORDERS; kind++) {
            trial_options o = options_of(kind, 0);
            integer_points(3, MOST, 100, points);
            for (size_t i = 0; i < 3 * MOST; i++) points[i] -= 50;
            EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, NULL, NULL, NULL) == BRIO_OK);
            for (size_t i = 0; i < 3 * MOST; i++) points[i] = ldexp(points[i], exponents[e]);
            EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, other, NULL, NULL, NULL) == BRIO_OK);
            EXPECT(!memcmp(order, other, sizeof order), "order %d, 2^%d", kind, exponents[e]);
        }
    brio_context_free(ctx);
}

static void seed_decides_every_random_choice(void) {
    brio_context *ctx = new_context();
    uniform_points(1, MOST, points);
    for (int kind = 0; kind < TRIAL_ORDERS; kind++) {
        trial_options o = options_of(kind, 0);
        bool random = kind != BRIO_ORDER_HILBERT && kind != BRIO_ORDER_INPUT;
        EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, NULL, NULL, NULL) == BRIO_OK);
        EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, other, NULL, NULL, NULL) == BRIO_OK);
        EXPECT(!memcmp(order, other, sizeof order), "order %d", kind);
        o.seed++;
        EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, other, NULL, NULL, NULL) == BRIO_OK);
        EXPECT((memcmp(order, other, sizeof order) != 0) == random, "order %d", kind);
    }
    brio_context_free(ctx);
}

static brio_status order_everything(brio_context *ctx) {
    brio_status status = BRIO_OK;
    for (int kind = 0; kind < TRIAL_ORDERS && status == BRIO_OK; kind++) {
        trial_options o = options_of(kind, 10);
        status = trial_order(ctx, &(brio_input){points, NULL, 1000}, &o, order, rank, NULL, NULL);
    }
    return status;
}

static void refused_memory_is_a_status(void) {
    uniform_points(1, 1000, points);
    expect_clean_failures(order_everything);
}

/* --- rounds --- */

/* Each round has the share 1 - ratio of the points that are left, within what chance does; the first one or two points.
 */
static void rounds_shrink_by_the_ratio(void) {
    const struct {
        int kind;
        double given, ratio;
    } rows[] = {{BRIO_ORDER_BRIO, 0, 0.125},
                {TRIAL_BRIO_OCTREE, 0, 0.5},
                {TRIAL_BRIO_KDTREE, 0, 0.5},
                {TRIAL_BRIO_OCTREE, 0.3, 0.3},
                {BRIO_ORDER_BRIO, 0.7, 0.7}};
    brio_context *ctx = new_context();
    uniform_points(3, MOST, points);
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
        trial_options o = options_of(rows[row].kind, 0);
        brio_round_ends rounds;
        o.round_ratio = rows[row].given;
        EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, NULL, NULL, &rounds) == BRIO_OK);
        EXPECT(rounds.count > 1 && rounds.end[rounds.count - 1] == MOST);
        EXPECT(MOST * pow(rows[row].ratio, rounds.count) < 1 && MOST * pow(rows[row].ratio, rounds.count - 1) >= 1);
        for (int r = rounds.count - 1; r > 0; r--) {
            double left = (double)rounds.end[r], before = (double)rounds.end[r - 1], expected = rows[row].ratio * left;
            EXPECT(fabs(before - expected) <= 5 * sqrt(left) / 2, "row %zu: %g of %g", row, before, left);
        }
    }
    brio_context_free(ctx);
}

/* The round is the point's own: orders of the same ratio agree on it. */
static void round_follows_from_the_index(void) {
    static uint8_t round_of[MOST];
    brio_round_ends rounds;
    brio_context *ctx = new_context();
    uniform_points(3, MOST, points);
    for (int kind = TRIAL_BRIO_OCTREE; kind <= TRIAL_BRIO_KDTREE; kind++) {
        trial_options o = options_of(kind, 0);
        EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, NULL, NULL, &rounds) == BRIO_OK);
        for (size_t i = 0, r = 0; i < MOST; i++) {
            while (i >= rounds.end[r]) r++;
            EXPECT(kind == TRIAL_BRIO_OCTREE || round_of[order[i]] == r);
            round_of[order[i]] = (uint8_t)r;
        }
    }
    brio_context_free(ctx);
}

static void ranks_rise_inside_rounds(void) {
    brio_context *ctx = new_context();
    uniform_points(3, MOST, points);
    for (int kind = 0; kind < TRIAL_ORDERS; kind++) {
        trial_options o = options_of(kind, 500);
        brio_round_ends rounds;
        if (!brio_order_has_ranks(o.order)) continue;
        EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, rank, NULL, &rounds) == BRIO_OK);
        EXPECT(is_permutation(rank, MOST));
        for (int r = 0; r < rounds.count; r++)
            for (size_t i = (r ? rounds.end[r - 1] : 0) + 1; i < rounds.end[r]; i++) EXPECT(rank[i] > rank[i - 1]);
    }
    brio_context_free(ctx);
}

/* Which round each place along the curve has in the sequence by these weights, or in the order without weights. */
static void rounds_along_the_curve(brio_context *ctx, const double *weights, uint8_t *round, brio_round_ends *rounds) {
    trial_options o = options_of(BRIO_ORDER_BRIO, 0);
    brio_input input = {points, weights, MOST};
    EXPECT(trial_order(ctx, &input, &o, order, rank, weights ? spare : NULL, rounds) == BRIO_OK);
    EXPECT(is_permutation(order, MOST) && is_permutation(rank, MOST) && (!weights || is_permutation(spare, MOST)));
    for (size_t i = 0, r = 0; i < MOST; i++) {
        while (i >= rounds->end[r]) r++;
        uint32_t at = weights ? spare[i] : (uint32_t)i;
        round[rank[at]] = (uint8_t)r;
        index_of[rank[at]] = order[at];
    }
}

/* The order itself, which decides how the tetrahedra stand in the result, is the one without weights. */
static void weights_change_the_sequence_and_not_the_order(void) {
    static double weights[MOST];
    brio_context *ctx = new_context();
    trial_options o = options_of(BRIO_ORDER_BRIO, 0);
    brio_round_ends rounds;
    uniform_points(3, MOST, points);
    integer_weights(5, MOST, 1000, weights);
    EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, other, NULL, NULL, NULL) == BRIO_OK);
    EXPECT(trial_order(ctx, &(brio_input){points, weights, MOST}, &o, order, rank, spare, &rounds) == BRIO_OK);
    EXPECT(memcmp(order, other, sizeof order) == 0);
    for (int r = 0; r < rounds.count; r++)
        for (size_t i = (r ? rounds.end[r - 1] : 0) + 1; i < rounds.end[r]; i++)
            EXPECT(rank[spare[i]] > rank[spare[i - 1]]);
    brio_context_free(ctx);
}

/* Blocks of 64 places along the curve keep their number of points in each round. */
static void heavier_points_take_the_earlier_rounds_of_their_block(void) {
    enum { BLOCK = 64 };
    static double weights[MOST];
    static uint8_t plain[MOST], weighted[MOST], alone[MOST];
    brio_context *ctx = new_context();
    brio_round_ends rounds, same;
    uniform_points(3, MOST, points);
    integer_weights(5, MOST, 1000, weights);
    rounds_along_the_curve(ctx, NULL, plain, &rounds);
    brio_context_set_threads(ctx, 1);
    rounds_along_the_curve(ctx, weights, alone, &same);
    brio_context_set_threads(ctx, 3);
    rounds_along_the_curve(ctx, weights, weighted, &same);
    EXPECT(memcmp(alone, weighted, sizeof alone) == 0);
    EXPECT(memcmp(rounds.end, same.end, (size_t)rounds.count * sizeof *rounds.end) == 0);
    for (size_t i = 0; i < MOST; i++) {
        size_t begin = i / BLOCK * BLOCK, end = begin + BLOCK < MOST ? begin + BLOCK : MOST;
        int before = 0, after = 0;
        for (size_t j = begin; j < end; j++) {
            EXPECT(weighted[i] >= weighted[j] || weights[index_of[i]] >= weights[index_of[j]], "%zu and %zu", i, j);
            before += plain[j] == weighted[i], after += weighted[j] == weighted[i];
        }
        EXPECT(before == after, "round %d: %d of block %zu, not %d", weighted[i], after, i / BLOCK, before);
    }
    for (size_t i = 0; i < MOST; i++) weights[i] = -1.5;
    rounds_along_the_curve(ctx, weights, weighted, &same);
    EXPECT(memcmp(plain, weighted, sizeof plain) == 0);
    brio_context_free(ctx);
}

/* With ratio 1/2 half of the points are in the last round: the positions at which the curve starts anew tell the
 * rounds. */
static void rounds_follow_the_curve(void) {
    static uint64_t key[MOST];
    brio_context *ctx = new_context();
    uniform_points(3, MOST, points);
    brio_hilbert_keys(ctx, points, MOST, 7, key); /* coarser than the order's own curve */
    trial_options o = options_of(BRIO_ORDER_BRIO, 0);
    o.round_ratio = 0.5;
    brio_round_ends rounds;
    EXPECT(trial_order(ctx, &(brio_input){points, NULL, MOST}, &o, order, NULL, NULL, &rounds) == BRIO_OK);
    for (int r = 1; r < rounds.count; r++)
        for (size_t i = rounds.end[r - 1] + 1; i < rounds.end[r]; i++) EXPECT(key[order[i - 1]] <= key[order[i]]);
    EXPECT(rounds.end[rounds.count - 2] > 0.48 * MOST && rounds.end[rounds.count - 2] < 0.52 * MOST);
    brio_context_free(ctx);
}

/* --- blocks --- */

static brio_block blocks[MOST]; /* blocks[i] begins at place i, or is empty */

static void keep_block(uint32_t *index, const brio_block *block, const void *user) {
    (void)index, (void)user;
    blocks[block->begin] = *block;
}

/* Divides the points by one of the trees and checks what holds for both; points moved, by the number of points. */
static double make_blocks(bool octree, size_t n, size_t block_size) {
    brio_context *ctx = new_context();
    double work = 0;
    memset(blocks, 0, sizeof blocks);
    brio_blocks wanted = {points, n, block_size, index_of, keep_block, NULL};
    brio_status status = octree ? brio_octree_blocks(ctx, &wanted, spare) : brio_kdtree_blocks(ctx, &wanted);
    EXPECT(status == BRIO_OK && is_permutation(index_of, n));
    for (size_t begin = 0; begin < n;) {
        const brio_block *b = &blocks[begin];
        EXPECT(b->begin == begin && b->end > begin && b->end - begin <= block_size && b->end <= n);
        if (b->end <= begin) break;
        work += (double)b->passes * (double)(b->end - begin);
        begin = b->end;
    }
    brio_context_free(ctx);
    return work / (double)n;
}

static void blocks_are_never_too_large(void) {
    for (int set = 0; hard_points(set, 0); set++)
        for (int octree = 0; octree < 2; octree++)
            for (size_t block_size = 1; block_size < 10000; block_size *= 9) {
                hard_points(set, 5000);
                make_blocks(octree, 5000, block_size);
            }
}

/* Number of a point's cell in the cube [0, 1]^3 divided three times, depth first. */
static unsigned cell_of(const double *p) {
    unsigned cell = 0;
    for (int level = 1; level <= 3; level++)
        for (int c = 0; c < 3; c++) cell = cell << 1 | ((unsigned)(p[c] * 8) >> (3 - level) & 1);
    return cell;
}

/* Blocks of evenly spread points are the cells of the octree that have few points and whose parents have many, and they
 * come in the order of the cells. */
static void octree_blocks_are_cells_depth_first(void) {
    enum { N = 20000, BLOCK = 100 };
    static unsigned in_cell[4][512]; /* points of the cells of each level */
    uniform_points(8, N, points);
    for (size_t c = 0; c < 3; c++) points[c] = 0, points[3 + c] = 1 - 0x1p-53;
    memset(in_cell, 0, sizeof in_cell);
    for (size_t i = 0; i < N; i++)
        for (int level = 0; level < 4; level++) in_cell[level][cell_of(points + 3 * i) >> 3 * (3 - level)]++;
    make_blocks(true, N, BLOCK);
    unsigned next = 0;
    for (size_t begin = 0; begin < N; begin = blocks[begin].end) {
        unsigned first = cell_of(points + 3 * (size_t)index_of[begin]), last = first;
        for (size_t i = begin; i < blocks[begin].end; i++) {
            unsigned cell = cell_of(points + 3 * (size_t)index_of[i]);
            first = cell < first ? cell : first, last = cell > last ? cell : last;
        }
        int level = 3;
        while (first >> 3 * (3 - level) != last >> 3 * (3 - level)) level--;
        EXPECT(first >= next && blocks[begin].passes == 1);
        EXPECT(in_cell[level][first >> 3 * (3 - level)] == blocks[begin].end - begin, "block at %zu", begin);
        EXPECT(in_cell[level - 1][first >> 3 * (4 - level)] > BLOCK, "block at %zu", begin);
        next = last + 1;
    }
}

typedef struct {
    double low, high;
} interval;

/* Of coordinate c of the points index_of[begin, end). */
static interval extent(size_t begin, size_t end, size_t c) {
    interval e = {INFINITY, -INFINITY};
    for (size_t i = begin; i < end; i++) {
        double x = points[3 * (size_t)index_of[i] + c];
        e.low = fmin(e.low, x), e.high = fmax(e.high, x);
    }
    return e;
}

static double longest_side(size_t begin, size_t end) {
    double side = 0;
    for (size_t c = 0; c < 3; c++) side = fmax(side, extent(begin, end, c).high - extent(begin, end, c).low);
    return side;
}

/* Whether a plane across the longest side has index_of[begin, middle) on one side and index_of[middle, end) on the
 * other. */
static bool plane_between(size_t begin, size_t middle, size_t end) {
    double side = longest_side(begin, end);
    for (size_t c = 0; c < 3; c++) {
        interval a = extent(begin, middle, c), b = extent(middle, end, c);
        if (b.high - a.low >= 0.999999 * side && a.high <= b.low) return true;
    }
    return false;
}

/* A cluster is divided as the whole is, however small it is: its blocks are cells of its own cube. */
static void octree_divides_clusters(void) {
    enum { N = 5000 };
    for (int bits = 20; bits <= 50; bits += 15) {
        double size = ldexp(1, -bits);
        uniform_points(6, N, points);
        for (size_t i = 0; i < 3 * (N - 10); i++) points[i] = 1 + points[i] * size;
        make_blocks(true, N, 200);
        for (size_t b = 0; b < N; b = blocks[b].end)
            if (blocks[b].end - b > 10) EXPECT(longest_side(b, blocks[b].end) <= 0.5 * size, "block at %zu", b);
    }
}

static void expect_halves(size_t begin, size_t end) {
    if (blocks[begin].end == end) return;
    size_t middle = begin + (end - begin) / 2;
    EXPECT(plane_between(begin, middle, end), "%zu to %zu", begin, end);
    expect_halves(begin, middle);
    expect_halves(middle, end);
}

static void kdtree_cells_are_halved_by_planes(void) {
    uniform_points(4, 20000, points);
    make_blocks(false, 20000, 50);
    expect_halves(0, 20000);
    integer_points(1, 5000, 12, points);
    make_blocks(false, 5000, 50);
    expect_halves(0, 5000);
    for (int scale = 0; scale < 2; scale++) { /* a cluster that the steps of the whole cube do not resolve */
        uniform_points(4, 5000, points);
        for (size_t i = 0; i < 3 * 1250; i++) points[i] *= scale ? 0x1p-60 : 0x1p-40;
        make_blocks(false, 5000, 50);
        expect_halves(0, 5000);
        for (size_t i = 0; i < 1250; i++) EXPECT(index_of[i] < 1250);
    }
}

/* What a block is to a round: its points stand together, the blocks in their order, the points not in theirs. */
static void rounds_visit_blocks_in_turn(void) {
    enum { N = 30000, BLOCK = 300 };
    static uint32_t block_of[N];
    const int kinds[] = {TRIAL_OCTREE, TRIAL_BRIO_OCTREE, TRIAL_BRIO_KDTREE};
    brio_context *ctx = new_context();
    for (int set = 0; set < 4; set += 3)
        for (int i = 0; i < 3; i++) {
            brio_round_ends rounds;
            trial_options o = options_of(kinds[i], BLOCK);
            size_t rises = 0, pairs = 0;
            hard_points(set, N);
            make_blocks(kinds[i] != TRIAL_BRIO_KDTREE, N, BLOCK);
            for (size_t b = 0; b < N; b = blocks[b].end)
                for (size_t j = b; j < blocks[b].end; j++) block_of[index_of[j]] = (uint32_t)b;
            EXPECT(trial_order(ctx, &(brio_input){points, NULL, N}, &o, order, NULL, NULL, &rounds) == BRIO_OK);
            for (int r = 0; r < rounds.count; r++)
                for (size_t j = (r ? rounds.end[r - 1] : 0) + 1; j < rounds.end[r]; j++) {
                    uint32_t before = block_of[order[j - 1]], now = block_of[order[j]];
                    EXPECT(before <= now, "order %d, round %d", kinds[i], r);
                    if (before == now) pairs++, rises += order[j] > order[j - 1];
                }
            EXPECT(pairs > N / 2 && fabs((double)rises / (double)pairs - 0.5) < 0.02, "%zu of %zu", rises, pairs);
        }
    brio_context_free(ctx);
}

/* The octree passes over each point about as often for many points as for few; a tree that sorts would pass more often. */
static void octree_work_is_linear(void) {
    uniform_points(2, MOST, points);
    for (size_t n = 5000; n <= MOST; n *= 2) EXPECT(make_blocks(true, n, 200) <= 1.5, "%zu points", n);
    sphere_points(2, MOST, points);
    for (size_t n = 5000; n <= MOST; n *= 2) EXPECT(make_blocks(true, n, 20) <= 3, "%zu points", n);
    clustered_points(2, MOST, points);
    for (size_t n = 5000; n <= MOST; n *= 2) EXPECT(make_blocks(true, n, 20) <= 5, "%zu points", n);
    for (size_t n = 5000; n <= MOST; n *= 2) { /* a cluster takes one pass more, however small it is */
        uniform_points(2, n, points);
        for (size_t i = 0; i < 3 * (n - 10); i++) points[i] = 1 + points[i] * 0x1p-40;
        EXPECT(make_blocks(true, n, 200) <= 3, "%zu points", n);
    }
}

/* Cells that reach over the parts of several threads, in which they are sorted again by other keys: a thread once took
 * the middle of such a cell for its start. */
static void cells_over_several_parts_are_sorted_by_one_thread(void) {
    enum { N = 30000, CLUSTERS = 5, TIMES = 40 };
    static uint64_t one[N], many[N], room[N];
    brio_context *ctx = new_context();
    uniform_points(3, N, points);
    for (size_t i = 0; i < N; i++)
        for (size_t k = 0; k < 3; k++)
            points[3 * i + k] = (double)((i % CLUSTERS) >> k & 1) + points[3 * i + k] * 0x1p-30;
    for (size_t i = 0; i < N; i++) one[i] = i;
    EXPECT(brio_sort_along_curve(ctx, points, one, room, N, 1) == BRIO_OK);
    for (int time = 0; time < TIMES; time++) {
        size_t differ = 0;
        for (size_t i = 0; i < N; i++) many[i] = i;
        brio_context_set_threads(ctx, 2 + time % 7);
        EXPECT(brio_sort_along_curve(ctx, points, many, room, N, brio_threads(ctx, N, 1)) == BRIO_OK);
        for (size_t i = 0; i < N; i++) differ += (uint32_t)many[i] != (uint32_t)one[i];
        EXPECT(differ == 0, "%zu places differ with %d threads", differ, 2 + time % 7);
    }
    brio_context_free(ctx);
}

/* The positions in the canonical order of shuffled points: those of the points as they were. */
static void canonical_order_goes_by_position_alone(void) {
    enum { N = 3000 };
    static double shuffled[3 * N];
    static size_t place[N];
    brio_context *ctx = new_context();
    for (int set = 0; set < 3; set++) {
        uint32_t *first = NULL, *second = NULL;
        size_t differ = 0, falling = 0;
        if (set == 0) integer_points(7, N, 9, points); /* four at each position */
        if (set == 1) clustered_points(7, N, points);
        if (set == 2) memset(points, 0, sizeof points);
        shuffle_points(8, N, points, shuffled, place);
        for (size_t i = 0; i < 3 * N; i++) shuffled[i] = shuffled[i] == 0 ? -0.0 : shuffled[i];
        EXPECT(brio_canonical_points(ctx, points, N, &first) == BRIO_OK);
        brio_context_set_threads(ctx, 3);
        EXPECT(brio_canonical_points(ctx, shuffled, N, &second) == BRIO_OK);
        for (size_t r = 0; r < N; r++) {
            const double *p = points + 3 * (size_t)first[r], *q = shuffled + 3 * (size_t)second[r];
            differ += !brio_same_position(p, q);
            falling += r > 0 && brio_same_position(p, p - 3 * (ptrdiff_t)first[r] + 3 * (ptrdiff_t)first[r - 1]) &&
                       first[r] < first[r - 1];
        }
        EXPECT(differ == 0 && falling == 0, "set %d: %zu positions differ, %zu indices fall", set, differ, falling);
        brio_release(ctx, first);
        brio_release(ctx, second);
    }
    brio_context_free(ctx);
}

SUITE(test_order) {
    RUN(curve_visits_each_cell_once_in_unit_steps);
    RUN(every_order_is_a_permutation);
    RUN(number_of_threads_does_not_matter);
    RUN(powers_of_two_do_not_change_the_order);
    RUN(seed_decides_every_random_choice);
    RUN(refused_memory_is_a_status);
    RUN(rounds_shrink_by_the_ratio);
    RUN(round_follows_from_the_index);
    RUN(ranks_rise_inside_rounds);
    RUN(weights_change_the_sequence_and_not_the_order);
    RUN(heavier_points_take_the_earlier_rounds_of_their_block);
    RUN(rounds_follow_the_curve);
    RUN(blocks_are_never_too_large);
    RUN(octree_blocks_are_cells_depth_first);
    RUN(octree_divides_clusters);
    RUN(kdtree_cells_are_halved_by_planes);
    RUN(rounds_visit_blocks_in_turn);
    RUN(octree_work_is_linear);
    RUN(cells_over_several_parts_are_sorted_by_one_thread);
    RUN(canonical_order_goes_by_position_alone);
    return harness_end();
}
