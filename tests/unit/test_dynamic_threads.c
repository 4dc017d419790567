/* Batches of changes of a living triangulation, by several threads: they end in what building anew gives, whatever the
 * number of threads, and failures in the middle leave all as it was. */
#include "living_world.h"

#include "failing_allocator.h"

static size_t changed_anew(const world *w) {
    brio_dynamic_stats s = {.size = sizeof s};
    EXPECT(brio_dynamic_facts(w->d, &s) == BRIO_OK);
    return (size_t)s.anew;
}

static world world_of(shape s, int weighted, size_t n) {
    world w = world_new(s, weighted, 20 * n);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, weighted, &w.d) == BRIO_OK);
    for (size_t left = n, some; left > 0; left -= some) {
        some = left < AT_ONCE ? left : AT_ONCE;
        insert_some(&w, some);
    }
    return w;
}

static void make_batch(world *w, int kind, size_t n) {
    double spacing = (w->shape == CLUSTERS ? 1e-3 : 1) / cbrt((double)w->num_points);
    if (kind == 0) insert_some(w, n);
    if (kind == 1) remove_some(w, n);
    if (kind == 2) move_some(w, n, w->shape == GRID ? 0.125 : 0.3 * spacing);
    if (kind == 3) move_some(w, n * 2 / 3, 1);
    if (kind == 4) reweight_some(w, n / 2);
}

enum { NUM_KINDS = 5 };

/* All kinds of batches, of all kinds of points. Uniform points are many enough to be changed by several threads. */
static void batches_of_threads_end_as_built(void) {
    static const int THREADS[] = {2, 3, 8};
    size_t together = 0, n = BRIEF_TESTS ? 1000 : 2500;
    for (int s = 0; s < NUM_SHAPES; s += BRIEF_TESTS ? 3 : 1)
        for (int weighted = BRIEF_TESTS ? s % 2 : 0; weighted < (BRIEF_TESTS ? s % 2 + 1 : 2); weighted++) {
            world w = world_of((shape)s, weighted, n);
            for (int round = 0; round < (BRIEF_TESTS ? 5 : SHORT_TESTS ? 10 : 100); round++) {
                size_t anew = changed_anew(&w);
                brio_context_set_threads(w.ctx, THREADS[round % 3]);
                make_batch(&w, round % NUM_KINDS, BRIEF_TESTS ? 200 : 300);
                together += changed_anew(&w) == anew;
                EXPECT(is_as_built(&w), "%s, weighted %d, round %d", SHAPE[s], weighted, round);
                EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
            }
            world_free(&w);
        }
    EXPECT(together >= (BRIEF_TESTS ? 5 : 20), "%zu batches without building anew", together);
}

/* A change of a batch, which leaves the world's own list as it is. */
static brio_status try_batch(world *w, int kind, size_t n) {
    static double p[3 * AT_ONCE], weight[AT_ONCE];
    uint32_t index[AT_ONCE] = {0};
    state = 5;
    n = draw_indices(w, n, index);
    for (size_t i = 0; i < n; i++) {
        draw_point(w->shape, p + 3 * i);
        weight[i] = w->weighted ? draw_weight(w->shape) : 0;
    }
    const double *weights = w->weighted ? weight : NULL;
    if (kind == 0) return brio_dynamic_insert(w->d, p, weights, n, NULL);
    if (kind == 1) return brio_dynamic_remove(w->d, index, n);
    return brio_dynamic_move(w->d, index, p, weights, n * 2 / 3);
}

/* Threads stop in the middle of their parts, wherever the others are: the journals of all are written back. */
static void stopped_threads_leave_all(void) {
    size_t left = 0, cancelled = 0;
    for (int kind = 0; kind < 3; kind++) {
        world w = world_of(kind == 1 ? CLUSTERS : UNIFORM, kind == 1, BRIEF_TESTS ? 1400 : 2000);
        brio_context_set_threads(w.ctx, 3);
        brio_context_set_progress(w.ctx, stop_at, &left);
        brio_status status = BRIO_ERR_CANCELLED;
        for (size_t k = 1; k < 100000 && status != BRIO_OK; k += 1 + k / (BRIEF_TESTS ? 2 : 5)) {
            left = k;
            status = try_batch(&w, kind, 300);
            left = 0;
            EXPECT(status == BRIO_OK || status == BRIO_ERR_CANCELLED, "%s", brio_message(w.ctx));
            if (status == BRIO_OK) break;
            cancelled++;
            EXPECT(is_as_built(&w), "batch %d, stopped at %zu", kind, k);
            EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        }
        EXPECT(status == BRIO_OK);
        world_free(&w);
    }
    EXPECT(cancelled > 2, "%zu", cancelled);
}

static void memory_that_fails_in_a_thread_leaves_all(void) {
    for (int kind = 0; kind < 3; kind++) {
        failing_memory memory = {0, 0};
        brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
        world w = world_of(UNIFORM, kind == 2, 1100);
        brio_dynamic_free(w.d);
        brio_context_free(w.ctx);
        EXPECT(brio_context_new(&allocator, &w.ctx) == BRIO_OK);
        brio_status status = BRIO_ERR_NO_MEMORY;
        for (size_t k = 1; k < 4000 && status != BRIO_OK; k += BRIEF_TESTS ? 101 : SHORT_TESTS ? 13 : 1) {
            brio_context_set_threads(w.ctx, 1);
            EXPECT(brio_dynamic_new(w.ctx, w.point, w.weighted ? w.weight : NULL, w.num_points, w.weighted, &w.d) ==
                   BRIO_OK);
            brio_context_set_threads(w.ctx, 3);
            memory.left = k;
            status = try_batch(&w, kind, 200);
            memory.left = 0;
            EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "%s", brio_message(w.ctx));
            if (status != BRIO_OK) EXPECT(is_as_built(&w), "batch %d, request %zu", kind, k);
            if (status != BRIO_OK) EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
            brio_dynamic_free(w.d);
            w.d = NULL;
        }
        EXPECT(status == BRIO_OK);
        world_free(&w);
        EXPECT(memory.live == 0, "%zu blocks left", memory.live);
    }
}

/* Inserts points at two far corners, which threads do, and light ones everywhere, which are hidden: these are left to one
 * thread. */
static brio_status hide_many(world *w, size_t n) {
    static double p[3 * AT_ONCE], weight[AT_ONCE];
    state = 11;
    for (size_t i = 0; i < n; i++) {
        bool light = i % 6 > 0;
        for (size_t c = 0; c < 3; c++) p[3 * i + c] = light ? draw() : 0.7 * (double)(i % 12 > 0) + 0.3 * draw();
        weight[i] = light ? -1 : 0;
    }
    return brio_dynamic_insert(w->d, p, weight, n, NULL);
}

/* What one thread hides after a pass, before it digs a hole, is taken back before what the threads changed: tetrahedra
 * that it notes have mates that the threads wrote. */
static void points_hidden_after_a_pass_are_taken_back(void) {
    failing_memory memory = {0, 0};
    brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
    world w = world_new(UNIFORM, 1, 3000);
    size_t failures = 0;
    brio_context_free(w.ctx);
    EXPECT(brio_context_new(&allocator, &w.ctx) == BRIO_OK);
    for (size_t i = 0; i < 1500; i++) {
        double p[3];
        draw_point(w.shape, p);
        enter(&w, w.num_indices++, p, 0);
    }
    brio_status status = BRIO_ERR_NO_MEMORY;
    for (size_t k = 1; k < 1000 && status != BRIO_OK; k += BRIEF_TESTS ? 5 : 1) {
        brio_context_set_threads(w.ctx, 1);
        EXPECT(brio_dynamic_new(w.ctx, w.point, w.weight, w.num_points, 1, &w.d) == BRIO_OK);
        brio_context_set_threads(w.ctx, 2);
        memory.left = k;
        status = hide_many(&w, 384);
        memory.left = 0;
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "%s", brio_message(w.ctx));
        if (status != BRIO_OK) EXPECT(is_as_built(&w), "request %zu", k);
        if (status != BRIO_OK) EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        failures += status != BRIO_OK;
        brio_dynamic_free(w.d);
        w.d = NULL;
    }
    EXPECT(status == BRIO_OK && failures > (BRIEF_TESTS ? 2 : 10), "%zu", failures);
    world_free(&w);
    EXPECT(memory.live == 0, "%zu blocks left", memory.live);
}

SUITE(test_dynamic_threads) {
    RUN(batches_of_threads_end_as_built);
    RUN(stopped_threads_leave_all);
    RUN(memory_that_fails_in_a_thread_leaves_all);
    RUN(points_hidden_after_a_pass_are_taken_back);
    return harness_end();
}
