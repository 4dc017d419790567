/* Memory account, growth, limits. */
#include "base/kept.h"
#include "base/memory.h"
#include "base/rng.h"
#include "harness.h"
#include "platform/pages.h"
#include <string.h>

static void grown_block_keeps_what_it_held(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    uint32_t *a = NULL;
    size_t capacity = 0, n = 3000000;
    bool same = true;
    for (size_t i = 0; i < n; i++) {
        EXPECT(BRIO_RESERVE(ctx, a, capacity, i + 1) == BRIO_OK);
        a[i] = (uint32_t)(i * 7);
    }
    for (size_t i = 0; i < n; i++) same &= a[i] == (uint32_t)(i * 7);
    EXPECT(same);
    EXPECT(brio_context_memory(ctx) >= n * 4);
    brio_release(ctx, a);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void limit_is_a_status_and_keeps_the_block(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    brio_context_set_memory_limit(ctx, 4 << 20);
    char *a = NULL;
    EXPECT(BRIO_ALLOC(ctx, a, 3 << 20) == BRIO_OK);
    a[5] = 'x';
    EXPECT(BRIO_RESIZE(ctx, a, 9 << 20) == BRIO_ERR_NO_MEMORY);
    EXPECT(strstr(brio_message(ctx), "out of memory") != NULL);
    EXPECT(a[5] == 'x');
    brio_release(ctx, a);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void size_overflow_is_a_status(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    double *a;
    EXPECT(BRIO_ALLOC(ctx, a, SIZE_MAX / 4) == BRIO_ERR_NO_MEMORY);
    EXPECT(BRIO_ALLOC(ctx, a, SIZE_MAX / 16) == BRIO_ERR_NO_MEMORY);
    brio_context_free(ctx);
}

/* A system that gives mappings back as a whole keeps none for the next block. */
static bool mappings_are_kept(void) {
    if (!brio_pages_divide()) printf("skipped: mappings that are kept, which cannot be divided on this system\n");
    return brio_pages_divide();
}

static void released_mapping_serves_the_next_block_cleared_where_asked(void) {
    if (!mappings_are_kept()) return;
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    char *a = NULL, *b = NULL, *c = NULL;
    bool zero = true;
    EXPECT(BRIO_ALLOC(ctx, a, 8 << 20) == BRIO_OK);
    memset(a, 'x', 8 << 20);
    brio_release(ctx, a);
    EXPECT(brio_context_memory(ctx) == 0 && ctx->kept_bytes >= 8 << 20);
    EXPECT(BRIO_ALLOC(ctx, b, 2 << 20) == BRIO_OK && b == a);
    EXPECT(BRIO_ALLOC_ZERO(ctx, c, 4 << 20) == BRIO_OK && c > a && c < a + (8 << 20));
    for (size_t i = 0; i < 4 << 20; i++) zero &= c[i] == 0;
    EXPECT(zero);
    brio_release(ctx, b);
    brio_release(ctx, c);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void what_is_kept_gives_way_to_the_limit(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    brio_context_set_memory_limit(ctx, 8 << 20);
    for (size_t size = 2 << 20; size < 8 << 20; size += 1 << 20) {
        char *a = NULL;
        EXPECT(BRIO_ALLOC(ctx, a, size) == BRIO_OK, "%zu bytes", size);
        brio_release(ctx, a);
    }
    brio_context_free(ctx);
}

static void only_so_much_is_kept_between_calls(void) {
    if (!mappings_are_kept()) return;
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    char *a = NULL;
    brio_keep_begin(ctx);
    EXPECT(BRIO_ALLOC(ctx, a, 200 << 20) == BRIO_OK);
    brio_release(ctx, a);
    EXPECT(ctx->kept_bytes >= 200 << 20);
    brio_keep_end(ctx);
    EXPECT(ctx->kept_bytes > 0 && ctx->kept_bytes <= 64 << 20);
    brio_context_free(ctx);
}

enum { BLOCKS = 24 };

static bool holds(const uint32_t *block, size_t n, uint32_t value) {
    for (size_t i = 0; i < n; i += 1024)
        if (block[i] != value) return false;
    return !n || block[n - 1] == value;
}

/* Blocks of many sizes come, grow, shrink and go; each keeps what it holds, and live and kept memory together stay at or
 * below the peak. */
static void keeping_never_makes_the_peak_higher(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    brio_rng rng = brio_rng_new(7);
    uint32_t *block[BLOCKS] = {NULL};
    size_t n[BLOCKS] = {0};
    brio_keep_begin(ctx);
    for (uint32_t step = 0; step < 3000; step++) {
        uint32_t i = brio_rng_below(&rng, BLOCKS);
        size_t size = (size_t)brio_rng_below(&rng, 1 << 10) << brio_rng_below(&rng, 11),
               same = n[i] < size ? n[i] : size;
        if (step % 3 == 0) {
            brio_release(ctx, block[i]);
            block[i] = NULL, n[i] = 0;
        } else {
            EXPECT(BRIO_RESIZE(ctx, block[i], size) == BRIO_OK);
            EXPECT(holds(block[i], same, i), "step %u: block %u", step, i);
            for (size_t j = same; j < size; j++) block[i][j] = i;
            n[i] = size;
        }
        EXPECT(brio_context_memory(ctx) + ctx->kept_bytes <= brio_context_memory_peak(ctx), "step %u", step);
    }
    for (uint32_t i = 0; i < BLOCKS; i++) {
        EXPECT(holds(block[i], n[i], i));
        brio_release(ctx, block[i]);
    }
    brio_keep_end(ctx);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_memory) {
    RUN(released_mapping_serves_the_next_block_cleared_where_asked);
    RUN(what_is_kept_gives_way_to_the_limit);
    RUN(only_so_much_is_kept_between_calls);
    RUN(keeping_never_makes_the_peak_higher);
    RUN(grown_block_keeps_what_it_held);
    RUN(limit_is_a_status_and_keeps_the_block);
    RUN(size_overflow_is_a_status);
    return harness_end();
}
