/* Writes that cannot end the process: SIGPIPE and SIGXFSZ are blocked during a call and removed after it. */
#define _GNU_SOURCE
#include "platform/quiet_signals.h"
#include <errno.h>
#include <stddef.h>
#include <time.h>

static const int QUIET[] = {SIGPIPE, SIGXFSZ};

enum { NUM_QUIET = sizeof QUIET / sizeof *QUIET };

void brio_signals_block(brio_quiet_signals *quiet) {
    sigset_t both;
    sigemptyset(&both);
    for (int i = 0; i < NUM_QUIET; i++) sigaddset(&both, QUIET[i]);
    sigpending(&quiet->pending);
    pthread_sigmask(SIG_BLOCK, &both, &quiet->mask);
}

/* Removes one pending signal. Does not wait, because another thread may have received a signal that was sent to the
 * process. macOS has sigwait alone, which waits: the signal is pending for this thread, so that it returns at once. */
static void take_back(int signal) {
    sigset_t one;
    sigemptyset(&one);
    sigaddset(&one, signal);
#ifdef __APPLE__
    int taken;
    sigwait(&one, &taken);
#else
    const struct timespec no_time = {0, 0};
    while (sigtimedwait(&one, NULL, &no_time) < 0 && errno == EINTR) {}
#endif
}

void brio_signals_restore(const brio_quiet_signals *quiet) {
    int error = errno;
    sigset_t now;
    sigpending(&now);
    for (int i = 0; i < NUM_QUIET; i++)
        if (sigismember(&now, QUIET[i]) == 1 && sigismember(&quiet->pending, QUIET[i]) != 1) take_back(QUIET[i]);
    pthread_sigmask(SIG_SETMASK, &quiet->mask, NULL);
    errno = error;
}
