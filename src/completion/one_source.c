/* A completion with one source: all steps of completion.h, in their order.
 *
 * The questions of a round are asked BRIO_COMPLETION_BALLS at a time, so that balls need the same memory however many
 * questions there are. */
#include "base/memory.h"
#include "completion/completion.h"

/* Asks the source of a task the questions of a round. */
static brio_status ask_source(const brio_completion_task *task, brio_completion *c, size_t questions, brio_ball *balls,
                              brio_found *found) {
    found->count = 0;
    for (size_t first = 0; first < questions; first += BRIO_COMPLETION_BALLS) {
        size_t n = questions - first < BRIO_COMPLETION_BALLS ? questions - first : BRIO_COMPLETION_BALLS;
        BRIO_FORWARD(brio_completion_balls(c, first, n, balls));
        BRIO_FORWARD(task->source(task->source_user, balls, n, found));
        for (size_t i = 0; i < n; i++)
            if (balls[i].is_free) brio_completion_is_free(c, first + i);
    }
    return brio_completion_take(c, found->point, found->count);
}

brio_status brio_complete(brio_context *ctx, const brio_completion_task *task, uint8_t *is_vertex,
                          brio_completion_stats *stats) {
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(ctx);
    brio_completion *c = NULL;
    brio_ball *balls = NULL;
    brio_found found = {.ctx = ctx};
    *stats = (brio_completion_stats){.dimension = -1};
    BRIO_TRY(brio_completion_new(ctx, task, &c));
    BRIO_TRY(BRIO_ALLOC(ctx, balls, BRIO_COMPLETION_BALLS));
    for (bool goes_on = true; goes_on;) {
        size_t questions;
        BRIO_TRY(brio_completion_begin(c, &questions));
        BRIO_TRY(ask_source(task, c, questions, balls, &found));
        BRIO_TRY(brio_completion_end(c, &goes_on));
    }
    *stats = *brio_completion_facts(c);
    if (is_vertex) brio_completion_vertices(c, is_vertex);
done:
    brio_completion_delete(c);
    brio_release(ctx, balls);
    brio_release(ctx, found.point);
    brio_progress_part(ctx, bar, 0, 1);
    return status;
}

brio_status brio_found_add(brio_found *found, const brio_set_point *point) {
    BRIO_FORWARD(BRIO_RESERVE(found->ctx, found->point, found->capacity, found->count + 1));
    found->point[found->count++] = *point;
    return BRIO_OK;
}
