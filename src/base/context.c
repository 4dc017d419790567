/* The last message of a context, and its progress. All code needs these; what makes a context needs memory and threads,
 * and stands above them (context_new.c). */
#include "base/context.h"
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>

const char *brio_message(const brio_context *ctx) {
    return ctx->message;
}

brio_status brio_fail(brio_context *ctx, brio_status status, const char *format, ...) {
    assert(status != BRIO_OK); /* BRIO_TRY would go on */
    va_list arguments;
    va_start(arguments, format);
    brio_mutex_lock(&ctx->lock); /* several threads may fail at a time */
    vsnprintf(ctx->message, sizeof ctx->message, format, arguments);
    ctx->failure = ctx->next;
    ctx->failure.status = status;
    ctx->next = (brio_failure){0};
    ctx->failures++;
    brio_mutex_unlock(&ctx->lock);
    va_end(arguments);
    return status;
}

void brio_reason_is(brio_context *ctx, brio_reason reason) {
    brio_mutex_lock(&ctx->lock);
    ctx->next.reason = reason;
    brio_mutex_unlock(&ctx->lock);
}

void brio_name_point(brio_context *ctx, size_t point) {
    brio_mutex_lock(&ctx->lock);
    brio_failure *f = &ctx->next;
    if (f->num_points < sizeof f->points / sizeof *f->points) f->points[f->num_points] = point;
    f->num_points++;
    brio_mutex_unlock(&ctx->lock);
}

void brio_block_is(brio_context *ctx, size_t bytes) {
    brio_mutex_lock(&ctx->lock);
    ctx->next.bytes = bytes;
    brio_mutex_unlock(&ctx->lock);
}

static double place_in(brio_bar bar, double fraction) {
    return fraction == 1 ? bar.to : bar.from + fraction * (bar.to - bar.from);
}

void brio_progress_part(brio_context *ctx, brio_bar bar, double from, double to) {
    assert(0 <= from && from <= to && to <= 1 + 1e-9); /* up to rounding */
    ctx->bar = (brio_bar){place_in(bar, from), place_in(bar, to)};
}

brio_status brio_progress(brio_context *ctx, const char *stage, double fraction) {
    assert(!(fraction < 0));
    ctx->stage = stage;
    ctx->share = place_in(ctx->bar, fraction);
    return brio_ask(ctx);
}

brio_status brio_ask(brio_context *ctx) {
    const char *stage = ctx->stage ? ctx->stage : "start";
    ctx->unlooked = 0;
    if (!ctx->progress || !ctx->progress(stage, ctx->share, ctx->progress_user)) return BRIO_OK;
    ctx->stopped = true;
    return brio_fail(ctx, BRIO_ERR_CANCELLED, "cancelled during %s", stage);
}
