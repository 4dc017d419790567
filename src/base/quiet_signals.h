/* Writes that cannot end the process.
 *
 * A write to a pipe without a reader sends SIGPIPE to the thread that writes; growth of a file beyond the process' limit
 * (RLIMIT_FSIZE) sends SIGXFSZ. Both end the process unless its owner handles them, and handlers belong to the owner, not
 * to a library. So the thread blocks both signals for the time of the call, takes back what the call itself made pending,
 * and restores its mask. The call's errno says what went wrong: EPIPE or EFBIG.
 *
 * Use, without a return in between:
 *     brio_quiet_signals quiet;
 *     brio_signals_block(&quiet);
 *     ssize_t n = write(...);
 *     brio_signals_restore(&quiet); */
#ifndef BRIO_BASE_QUIET_SIGNALS_H
#define BRIO_BASE_QUIET_SIGNALS_H

#include <signal.h>

typedef struct {
    sigset_t mask;    /* the thread's mask before the call */
    sigset_t pending; /* the signals that were pending before the call: these stay pending */
} brio_quiet_signals;

/** Blocks SIGPIPE and SIGXFSZ in the calling thread. */
void brio_signals_block(brio_quiet_signals *quiet);

/** Takes back the two signals where the call made them pending, and restores the mask. Keeps errno. */
void brio_signals_restore(const brio_quiet_signals *quiet);

#endif
