/* Waiting with progress. A signal also ends the wait at once, because the progress callback may depend on its
 * handler. */
#include "io/wait.h"
#include <errno.h>
#include <poll.h>

enum { TURN = 100, MOMENT = 20 /* milliseconds; chosen: too short to notice after Ctrl-C */ };

static brio_status report(brio_context *ctx, brio_wait what, double fraction) {
    return brio_progress(ctx, what == BRIO_WAIT_READ ? "read" : "write", fraction);
}

brio_status brio_wait_for(brio_context *ctx, int file, brio_wait what, double fraction) {
    for (;;) {
        struct pollfd one = {.fd = file, .events = what == BRIO_WAIT_READ ? POLLIN : POLLOUT};
        int ready = poll(&one, 1, TURN);
        if (ready > 0 || (ready < 0 && errno != EINTR)) return BRIO_OK;
        BRIO_FORWARD(report(ctx, what, fraction));
    }
    return BRIO_OK;
}

brio_status brio_wait_a_moment(brio_context *ctx, brio_wait what, double fraction) {
    poll(NULL, 0, MOMENT);
    return report(ctx, what, fraction);
}
