/* Memory account, growth, limits. */
#include "base/memory.h"
#include "harness.h"
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

static void scratch_block_grows_and_is_not_counted(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    EXPECT(brio_context_set_scratch(ctx, "/nowhere/at/all") == BRIO_ERR_OPEN);
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    size_t before = brio_context_memory(ctx);
    char *a = NULL;
    EXPECT(BRIO_ALLOC(ctx, a, 3 << 20) == BRIO_OK);
    memset(a, 'y', 3 << 20);
    EXPECT(BRIO_RESIZE(ctx, a, 9 << 20) == BRIO_OK);
    EXPECT(a[0] == 'y' && a[(3 << 20) - 1] == 'y' && a[(9 << 20) - 1] == 0);
    EXPECT(brio_context_memory(ctx) == before);
    brio_release(ctx, a);
    brio_context_free(ctx);
}

int main(void) {
    RUN(grown_block_keeps_what_it_held);
    RUN(limit_is_a_status_and_keeps_the_block);
    RUN(size_overflow_is_a_status);
    RUN(scratch_block_grows_and_is_not_counted);
    return harness_end();
}
