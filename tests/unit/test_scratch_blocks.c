/* Blocks in scratch files: which folders take them, their memory account, the ways to their bytes. */
#include "base/memory.h"
#include "harness.h"
#include <string.h>

/* "" stood for the root folder, where root may write. */
static void scratch_folder_without_a_name_is_refused(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    EXPECT(brio_context_set_scratch(ctx, "") == BRIO_ERR_OPEN);
    EXPECT(strstr(brio_message(ctx), "\"\": not a writable folder"), "%s", brio_message(ctx));
    EXPECT(!ctx->scratch);
    brio_context_free(ctx);
}

static void scratch_block_grows_and_is_not_counted(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    EXPECT(brio_context_set_scratch(ctx, "/nowhere/at/all") == BRIO_ERR_OPEN);
    EXPECT(brio_context_set_scratch(ctx, "/proc") == BRIO_ERR_OPEN); /* root may write there, but it takes no files */
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    size_t before = brio_context_memory(ctx);
    char *a = NULL;
    EXPECT(BRIO_ALLOC(ctx, a, 3 << 20) == BRIO_OK);
    memset(a, 'y', 3 << 20);
    EXPECT(BRIO_RESIZE(ctx, a, 9 << 20) == BRIO_OK);
    EXPECT(a[0] == 'y' && a[(3 << 20) - 1] == 'y');
    a[(9 << 20) - 1] = 'z';
    EXPECT(brio_context_memory(ctx) == before);
    brio_release(ctx, a);
    brio_context_free(ctx);
}

/* What goes past the cache and what goes through it, or through the mapping, are the same bytes. */
static void scratch_block_is_one_whatever_way_it_is_reached(void) {
    enum { BYTES = 3 << 20, PAGE = 4096 };
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    size_t before = brio_context_memory(ctx);
    unsigned char *block, *memory;
    EXPECT(BRIO_ALLOC(ctx, block, BYTES) == BRIO_OK);
    EXPECT(BRIO_ALLOC_IN_MEMORY(ctx, memory, BYTES) == BRIO_OK);
    EXPECT((uintptr_t)memory % PAGE == 0 && (uintptr_t)block % PAGE == 0);
    for (size_t i = 0; i < BYTES; i++) block[i] = (unsigned char)(i * 7 / 5);
    for (int direct = 1; direct >= 0; direct--) {
        brio_block_direct(block, direct);
        EXPECT(brio_block_read(ctx, block, PAGE, memory, BYTES - PAGE) == BRIO_OK);
        EXPECT(!memcmp(memory, block + PAGE, BYTES - PAGE));
        memset(memory, direct + 1, BYTES);
        EXPECT(brio_block_write(ctx, block, 2 * PAGE, memory, 3 * PAGE) == BRIO_OK);
        EXPECT(brio_block_write(ctx, block, 9 * PAGE + 5, memory, 70) == BRIO_OK);
        EXPECT(block[2 * PAGE] == direct + 1 && block[5 * PAGE - 1] == direct + 1);
        EXPECT(block[9 * PAGE + 5] == direct + 1 && block[9 * PAGE + 74] == direct + 1);
        EXPECT(block[2 * PAGE - 1] == (unsigned char)((2 * PAGE - 1) * 7 / 5));
        EXPECT(block[9 * PAGE + 75] == (unsigned char)((9 * PAGE + 75) * 7 / 5));
    }
    brio_release(ctx, block);
    brio_release(ctx, memory);
    EXPECT(brio_context_memory(ctx) == before);
    brio_context_free(ctx);
}

SUITE(test_scratch_blocks) {
    RUN(scratch_folder_without_a_name_is_refused);
    RUN(scratch_block_grows_and_is_not_counted);
    RUN(scratch_block_is_one_whatever_way_it_is_reached);
    return harness_end();
}
