/* Progress and cancel: a callback sees how far the work is, and stops it by returning something other than 0. What was
 * begun is freed, and the context can be used again at once. */
#include "brio/testdata.h"
#include "common.h"

static const size_t NUM_POINTS = 4000;

typedef struct {
    double patience; /* stop at this fraction */
    double last;
    int calls, went_back;
} watcher;

/* Called from long work, in the thread that called the library. A program with a window would draw a bar here. */
static int watch(const char *stage, double fraction, void *user) {
    watcher *w = user;
    (void)stage; /* the name to show beside the bar */
    w->calls++;
    w->went_back |= fraction < w->last;
    w->last = fraction;
    return fraction >= w->patience;
}

int main(void) {
    brio_context *ctx = NULL;
    brio_mesh *cloud = NULL, *surface = NULL;
    CHECK(ctx, brio_context_new(NULL, &ctx));
    CHECK(ctx, brio_generate(ctx, BRIO_KIND_TORUS, NUM_POINTS, NULL, &cloud));
    const size_t held = brio_context_memory(ctx);

    watcher hasty = {.patience = 0.5};
    brio_context_set_progress(ctx, watch, &hasty);
    brio_status status = brio_surface(ctx, cloud->vertices, cloud->num_vertices, NULL, &surface, NULL);
    printf("stopped half way: %s\n", brio_status_string(status));
    printf("no result: %s, all memory given back: %s\n", yes(surface == NULL), yes(brio_context_memory(ctx) == held));

    watcher calm = {.patience = 2};
    brio_context_set_progress(ctx, watch, &calm);
    CHECK(ctx, brio_surface(ctx, cloud->vertices, cloud->num_vertices, NULL, &surface, NULL));
    printf("second run finished: watched: %s, never went back: %s\n", yes(calm.calls > 0), yes(!calm.went_back));

    brio_mesh_free(surface);
    brio_mesh_free(cloud);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
