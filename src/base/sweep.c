/* Loops along arrays: see sweep.h. A stretch of rows is asked for when the loop enters the one before it. */
#include "base/sweep.h"
#include "base/memory.h"
#include "platform/pages.h"

/* Rows that are asked for at once: STRETCH_BYTES of the widest array, as far as the bounds allow. LEAST: bytes of less
 * are left to page faults. Chosen, but LEAST_STRETCH is that of a piece of brio_for. */
enum { STRETCH_BYTES = 1 << 18, LEAST_STRETCH = 1 << 11, MOST_STRETCH = BRIO_SWEEP_STRETCH, LEAST = 1 << 14 };

void brio_expect_rows(const brio_context *ctx, const brio_swept *swept, size_t num_swept, size_t begin, size_t end) {
    if (!ctx->scratch || begin >= end) return;
    for (size_t i = 0; i < num_swept; i++) {
        if (!swept[i].rows) continue;
        uintptr_t from = (uintptr_t)swept[i].rows + begin * swept[i].size;
        size_t bytes = (end - begin) * swept[i].size, before = from % 4096;
        if (bytes >= LEAST) brio_pages_advise((void *)(from - before), bytes + before, BRIO_PAGES_SOON);
    }
}

void brio_expect_next(const brio_context *ctx, size_t row, size_t n, const brio_swept *swept, size_t num_swept) {
    size_t from = row + BRIO_SWEEP_STRETCH, to = from + BRIO_SWEEP_STRETCH;
    brio_expect_rows(ctx, swept, num_swept, from, to < n ? to : n);
}

brio_status brio_settle_rows(brio_context *ctx, const brio_swept *swept, size_t num_swept, size_t begin, size_t end) {
    if (!ctx->scratch || begin >= end) return BRIO_OK;
    for (size_t i = 0; i < num_swept; i++)
        if (swept[i].rows && swept[i].written && (end - begin) * swept[i].size >= LEAST)
            BRIO_FORWARD(brio_block_settle(ctx, swept[i].rows, begin * swept[i].size, (end - begin) * swept[i].size));
    return BRIO_OK;
}

typedef struct {
    brio_context *ctx;
    brio_part_fn body;
    void *user;
    const brio_swept *swept;
    size_t num_swept, n, stretch;
    brio_status status;
} sweep;

/* Works on a piece. Pieces ascend, and are shorter than a stretch. */
static void sweep_piece(void *user, size_t begin, size_t end, int thread) {
    sweep *s = user;
    size_t next = (begin + s->stretch - 1) / s->stretch * s->stretch; /* the stretch that begins here, if any does */
    if (next < end) {
        size_t last = next + 2 * s->stretch < s->n ? next + 2 * s->stretch : s->n;
        brio_expect_rows(s->ctx, s->swept, s->num_swept, next + s->stretch, last);
        if (next >= s->stretch)
            brio_report(&s->status, brio_settle_rows(s->ctx, s->swept, s->num_swept, next - s->stretch, next));
    }
    s->body(s->user, begin, end, thread);
}

brio_status brio_sweep_arrays(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user,
                              const brio_swept *swept, size_t num_swept) {
    sweep s = {ctx, body, user, swept, num_swept, n, MOST_STRETCH, BRIO_OK};
    if (!ctx->scratch) return brio_for(ctx, threads, n, body, user);
    for (size_t i = 0; i < num_swept; i++)
        while (s.stretch > LEAST_STRETCH && s.stretch * swept[i].size > STRETCH_BYTES) s.stretch /= 2;
    brio_expect_rows(ctx, swept, num_swept, 0, n < s.stretch ? n : s.stretch);
    BRIO_FORWARD(brio_for(ctx, threads, n, sweep_piece, &s));
    return s.status;
}
