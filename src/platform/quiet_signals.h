/* Writes that cannot end the process.
 *
 * A write to a pipe without a reader sends SIGPIPE to the writing thread. A file that grows beyond the process' limit
 * (RLIMIT_FSIZE) sends SIGXFSZ. Both end the process unless the program handles them, and handlers belong to the
 * program, not to a library. So the thread blocks both signals during the call, removes those that the call made
 * pending, and restores its mask. The call's errno says what went wrong: EPIPE or EFBIG.
 *
 * Use, without a return in between:
 *     brio_quiet_signals quiet;
 *     brio_signals_block(&quiet);
 *     ssize_t n = write(...);
 *     brio_signals_restore(&quiet); */
#ifndef BRIO_PLATFORM_QUIET_SIGNALS_H
#define BRIO_PLATFORM_QUIET_SIGNALS_H

#ifdef __wasi__ /* no signals */
typedef int brio_quiet_signals;
static inline void brio_signals_block(brio_quiet_signals *quiet) {
    *quiet = 0;
}
static inline void brio_signals_restore(const brio_quiet_signals *quiet) {
    (void)quiet;
}
#else

#include <signal.h>

typedef struct {
    sigset_t mask;    /* the thread's mask before the call */
    sigset_t pending; /* the signals that were pending before the call and stay pending */
} brio_quiet_signals;

/** Blocks SIGPIPE and SIGXFSZ in the calling thread. */
void brio_signals_block(brio_quiet_signals *quiet);

/** Removes the two signals if the call made them pending, and restores the mask. Keeps errno. */
void brio_signals_restore(const brio_quiet_signals *quiet);

#endif
#endif
