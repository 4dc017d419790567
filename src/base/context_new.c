/* Contexts, made and freed, and their settings. */
#include "base/context.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/scratch_file.h"
#include "base/team.h"
#include "base/versioned.h"
#include "platform/disk.h"
#include "platform/pages.h"
#include <assert.h>
#include <stdlib.h>
#include <string.h>

static void *system_alloc(size_t size, void *user) {
    (void)user;
    return malloc(size);
}
static void *system_realloc(void *block, size_t size, void *user) {
    (void)user;
    return brio_heap_resize(block, size);
}
static void system_free(void *block, void *user) {
    (void)user;
    free(block);
}

/* Returns the most threads that a context takes. More than four threads for a processor only wait for each other. On a
 * few processors a test may want more: 64 is chosen. */
static int most_threads(int processors) {
    int most = 4 * processors;
    return most > 64 ? most : 64;
}

brio_status brio_context_new(const brio_allocator *allocator, brio_context **out) {
    const brio_allocator system = {system_alloc, system_realloc, system_free, NULL};
    const brio_allocator *a = allocator ? allocator : &system;
    int processors = brio_processors(), most = most_threads(processors);
    assert(1 <= processors && processors <= most);
    brio_context *ctx = a->alloc(sizeof *ctx + brio_team_bytes(most), a->user);
    *out = ctx;
    if (!ctx) return BRIO_ERR_NO_MEMORY;
    memset(ctx, 0, sizeof *ctx);
    ctx->allocator = *a;
    ctx->custom = allocator != NULL;
    ctx->machine_limit = brio_system_memory();
    ctx->bar = (brio_bar){0, 1};
    ctx->processors = processors;
    ctx->most_threads = most;
    ctx->team = brio_team_begin(ctx + 1, most, processors);
    brio_mutex_new(&ctx->lock);
    return BRIO_OK;
}

void brio_context_free(brio_context *ctx) {
    if (!ctx) return;
    brio_release(ctx, ctx->scratch);
    brio_kept_free(ctx);
    brio_team_end(ctx->team);
    brio_mutex_free(&ctx->lock);
    brio_allocator a = ctx->allocator;
    a.free(ctx, a.user);
}

brio_status brio_last_failure(brio_context *ctx, brio_failure *out) {
    BRIO_FORWARD(BRIO_CHECK_RESULT(ctx, brio_failure, out));
    BRIO_GIVE(brio_failure, out, &ctx->failure);
    return BRIO_OK;
}

void brio_context_set_threads(brio_context *ctx, int threads) {
    assert(ctx->most_threads >= 1);
    ctx->threads = threads < 0 ? 0 : threads < ctx->most_threads ? threads : ctx->most_threads;
}

int brio_context_threads(const brio_context *ctx) {
    return ctx->threads > 0 ? ctx->threads : ctx->processors;
}

void brio_context_set_progress(brio_context *ctx, brio_progress_fn progress, void *user) {
    ctx->progress = progress;
    ctx->progress_user = user;
    ctx->stage = NULL;
    ctx->share = 0;
}

void brio_context_set_memory_limit(brio_context *ctx, size_t bytes) {
    ctx->caller_limit = bytes;
}

/* Finds whether missing pages of scratch files are to be read with those about them: where the disk's window for that
 * is known, at most MOST_WINDOW, and one in SHARE bytes of the memory. MOST_WINDOW: measured (docs/decisions/032), 16
 * to 128 KiB are alike; the usual window of Linux. SHARE: chosen. */
static bool scratch_in_runs(const brio_context *ctx) {
    enum { MOST_WINDOW = 1 << 17, SHARE = 64 };
    size_t window = brio_read_around(ctx->scratch);
    return window > 0 && window <= MOST_WINDOW && window <= brio_memory_limit(ctx) / SHARE;
}

brio_status brio_context_set_scratch(brio_context *ctx, const char *folder) {
    BRIO_EXPECT(ctx, !folder || !ctx->custom, BRIO_ERR_ARGUMENT,
                "a scratch folder and a caller's allocator exclude each other");
    if (folder) BRIO_FORWARD(brio_scratch_try(ctx, folder));
    brio_release(ctx, ctx->scratch);
    ctx->scratch = NULL;
    if (folder) {
        BRIO_FORWARD(BRIO_ALLOC(ctx, ctx->scratch, strlen(folder) + 1));
        strcpy(ctx->scratch, folder);
        ctx->scratch_in_runs = scratch_in_runs(ctx);
    }
    return BRIO_OK;
}
