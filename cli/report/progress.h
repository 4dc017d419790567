/* The progress bar on standard error: stage, per cent, time left. */
#ifndef BRIO_CLI_PROGRESS_H
#define BRIO_CLI_PROGRESS_H

#include "platform/thread.h"
#include <stdbool.h>

/** Zeroed to begin with, but for the first two. */
typedef struct progress {
    bool shown;     /* whether there is a bar at all */
    bool terminal;  /* one line drawn over and over, else a line for each change */
    bool drawn;     /* something stands on the line now */
    char stage[48]; /* of the last drawing */
    int per_cent;
    double last_drawn; /* clock, seconds */
    double started;    /* when the running piece of work began */
    double fraction;   /* last seen; a step back begins a new piece of work */
} progress;

/** Draws when something changed, at most ten times a second. */
void cli_progress_show(progress *bar, const char *stage, double fraction);

/** Clears the bar's line, so that other text can follow. */
void cli_progress_end(progress *bar);

/** Seconds of a monotonic clock. */
static inline double cli_clock(void) {
    return brio_seconds();
}

#endif
