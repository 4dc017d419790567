/* Signals as a flag that the work reads now and then. The two flags are the only global state of the program: a signal
 * handler can reach nothing else. */
#include "interrupt.h"
#include <signal.h>
#include <stddef.h>
#include <unistd.h>

static volatile sig_atomic_t requested, writing_now;

enum { SECONDS_BETWEEN = 1 };

static void on_signal(int number) {
    (void)number;
    if (requested && !writing_now) _exit(130);
    requested = 1;
    alarm(SECONDS_BETWEEN);
}

static void on_alarm(int number) {
    (void)number;
    alarm(SECONDS_BETWEEN);
}

/* Without SA_RESTART: a read that waits for a pipe must return for the flag to be seen. */
static void handle(int number, void (*handler)(int)) {
    struct sigaction action = {0};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, NULL);
}

void cli_interrupt_install(void) {
    struct sigaction hangup;
    handle(SIGINT, on_signal);
    handle(SIGTERM, on_signal);
    handle(SIGALRM, on_alarm);
    if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN) handle(SIGHUP, on_signal);
    handle(SIGPIPE, SIG_IGN);
    handle(SIGXFSZ, SIG_IGN);
}

bool cli_interrupted(void) {
    return requested;
}

void cli_interrupt_writing(bool writing) {
    writing_now = writing;
}
