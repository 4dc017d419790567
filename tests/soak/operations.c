/* Random operations on living triangulations, as many as one likes.
 *
 * operations COUNT [SEED]: inserts, removes, moves and reweights points, one in most calls, some hundred in some of them, by one
 * to four threads. Points are uniform, on a grid, cospherical, clustered, on a scan's lines, or all of these, with weights and
 * without; a triangulation gets 10,000 calls, or a 32nd of them, then another one begins. After every 1,000th call the snapshot is compared with what
 * brio_delaunay makes of the points that are left, byte by byte, and checked exactly. Prints a line for each kind of points; fails
 * if there was a difference. A quarter of the operations are in space that repeats, in one to three directions of three cells, where
 * the checksum is compared with that of a fresh build of the positions on the grid. */
#include "../unit/wrapped_world.h"

enum { EACH = 10000, TURNS = 32, EVERY = 1000 };

static void change_some(world *w, size_t usual) {
    static const double STEP[] = {1e-9, 1e-3, 0.125, 1};
    size_t n = draw() < 0.97 ? 1 : 1 + draw_below(300);
    double what = draw(), more = w->num_points < usual ? 0.35 : 0.15;
    brio_context_set_threads(w->ctx, n > 128 ? 1 + (int)draw_below(4) : 1);
    if (what < more)
        insert_some(w, n);
    else if (what < 0.5)
        remove_some(w, n);
    else if (what < 0.8 || !w->weighted)
        move_some(w, n, STEP[draw_below(4)]);
    else
        reweight_some(w, n);
}

/* Makes calls with one triangulation; returns how many comparisons found a difference. */
static size_t run(shape s, int weighted, size_t count, size_t *compared) {
    static const size_t USUAL[] = {30, 300, 3000};
    size_t usual = USUAL[draw_below(3)], differences = 0;
    world w = world_new(s, weighted, 310 * count);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, weighted, &w.d) == BRIO_OK);
    for (size_t i = 1; i <= count; i++) {
        change_some(&w, usual);
        if (i % EVERY && i < count) continue;
        differences += !is_as_built(&w) || brio_dynamic_check(w.ctx, w.d) != BRIO_OK;
        (*compared)++;
    }
    world_free(&w);
    return differences;
}

/* The same in space that repeats. */
static size_t run_wrapped(shape s, int weighted, size_t count, size_t *compared) {
    static const size_t USUAL[] = {4, 60, 1000};
    size_t usual = USUAL[draw_below(3)], differences = 0, every = usual < 1000 ? EVERY / 10 : EVERY;
    wrapped w = wrapped_new(s, weighted, (int)draw_below(WRAPPED_CELLS), (int)draw_below(7), 310 * count);
    wrapped_start(&w);
    for (size_t i = 1; i <= count; i++) {
        size_t n = draw() < 0.97 ? 1 : 1 + draw_below(usual < 300 ? usual : 300);
        brio_context_set_threads(w.ctx, n > 64 ? 1 + (int)draw_below(4) : 1);
        change_wrapped(&w, usual, n);
        if (i % every && i < count) continue;
        differences += !is_as_fresh(&w) || !are_in_place(&w) || brio_dynamic_periodic_check(w.ctx, w.d) != BRIO_OK;
        (*compared)++;
    }
    wrapped_free(&w);
    return differences;
}

int main(int argc, char **argv) {
    size_t count = argc > 1 ? (size_t)atoll(argv[1]) : 100000, all = 0, differences = 0;
    static const shape WRAPPED[] = {UNIFORM, GRID, CLUSTERS};
    size_t calls[NUM_SHAPES][2] = {{0}}, compared[NUM_SHAPES][2] = {{0}}, differ[NUM_SHAPES][2] = {{0}};
    size_t wrapped_calls = 0, wrapped_compared = 0, wrapped_differ = 0;
    size_t each = count / TURNS < EACH ? count / TURNS + 1 : EACH;
    state = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    for (size_t turn = 0; all < count; turn++) {
        if (turn % 4 == 3) {
            size_t left = count - all, n = left < each ? left : each;
            wrapped_differ += run_wrapped(WRAPPED[turn / 4 % 3], (int)(turn / 12 % 2), n, &wrapped_compared);
            wrapped_calls += n;
            all += n;
            continue;
        }
        size_t s = (turn - turn / 4) / 2 % NUM_SHAPES, weighted = (turn - turn / 4) % 2, left = count - all,
               n = left < each ? left : each;
        differ[s][weighted] += run((shape)s, (int)weighted, n, &compared[s][weighted]);
        calls[s][weighted] += n;
        all += n;
    }
    for (size_t s = 0; s < NUM_SHAPES; s++)
        for (size_t weighted = 0; weighted < 2; weighted++) {
            printf("%-9s %-9s %8zu operations, %5zu comparisons, %zu differences\n", SHAPE[s],
                   weighted ? "weighted" : "", calls[s][weighted], compared[s][weighted], differ[s][weighted]);
            differences += differ[s][weighted];
        }
    printf("%-19s %8zu operations, %5zu comparisons, %zu differences\n", "in space that repeats", wrapped_calls,
           wrapped_compared, wrapped_differ);
    differences += wrapped_differ;
    printf("%zu operations, %zu differences, %d other failures\n", all, differences, harness_failures);
    return differences || harness_failures;
}
