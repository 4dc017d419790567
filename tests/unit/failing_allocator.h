/* Memory that runs out at a chosen request, and knows what was not given back. Threads may use it together; after the
 * one that fails, requests are granted again. */
#ifndef BRIO_TESTS_FAILING_ALLOCATOR_H
#define BRIO_TESTS_FAILING_ALLOCATOR_H

#include "harness.h"

typedef struct {
    size_t left; /* requests until the one that fails; 0: none fails */
    size_t live; /* blocks not given back */
} failing_memory;

static inline int failing_memory_refuses(failing_memory *m) {
    size_t left = __atomic_load_n(&m->left, __ATOMIC_RELAXED);
    return left > 0 && __atomic_sub_fetch(&m->left, 1, __ATOMIC_RELAXED) == 0;
}

static inline void *failing_alloc(size_t size, void *user) {
    failing_memory *m = user;
    void *block = failing_memory_refuses(m) ? NULL : malloc(size);
    if (block) __atomic_add_fetch(&m->live, 1, __ATOMIC_RELAXED);
    return block;
}

static inline void *failing_realloc(void *block, size_t size, void *user) {
    return failing_memory_refuses(user) ? NULL : realloc(block, size);
}

static inline void failing_free(void *block, void *user) {
    failing_memory *m = user;
    if (block) __atomic_sub_fetch(&m->live, 1, __ATOMIC_RELAXED);
    free(block);
}

/* Runs `work`, which frees all it made, with the k-th request for memory refused, for k = 1, 2, ... until it succeeds:
 * each failure must be BRIO_ERR_NO_MEMORY and leave nothing behind. */
static inline void expect_clean_failures(brio_status (*work)(brio_context *ctx)) {
    brio_status status = BRIO_ERR_NO_MEMORY;
    for (size_t k = 1; k < 2000 && status != BRIO_OK; k += BRIEF_TESTS ? 3 + k / 16 : 1) {
        failing_memory memory = {0, 0};
        brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
        brio_context *ctx;
        EXPECT(brio_context_new(&allocator, &ctx) == BRIO_OK);
        brio_context_set_threads(ctx, 1);
        memory.left = k;
        status = work(ctx);
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "request %zu: %s", k, brio_status_string(status));
        EXPECT(memory.live == 1, "request %zu: %zu blocks left", k, memory.live - 1);
        EXPECT(brio_context_memory(ctx) == 0, "request %zu", k);
        brio_context_free(ctx);
    }
    EXPECT(status == BRIO_OK);
}

#endif
