/* Waiting with progress. A signal also ends the wait at once, because the progress callback may depend on its
 * handler. */
#include "io/wait.h"
#include "platform/file.h"

enum { TURN = 100, MOMENT = 20 /* milliseconds; chosen: too short to notice after Ctrl-C */ };

static brio_status report(brio_context *ctx, brio_wait what, double fraction) {
    return brio_progress(ctx, what == BRIO_WAIT_READ ? "read" : "write", fraction);
}

brio_status brio_wait_for(brio_context *ctx, int file, brio_wait what, double fraction) {
    for (;;) {
        if (brio_wait_ready(file, what == BRIO_WAIT_WRITE, TURN)) return BRIO_OK;
        BRIO_FORWARD(report(ctx, what, fraction));
    }
    return BRIO_OK;
}

brio_status brio_wait_a_moment(brio_context *ctx, brio_wait what, double fraction) {
    brio_wait_milliseconds(MOMENT);
    return report(ctx, what, fraction);
}
