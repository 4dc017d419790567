/* Signals as a flag that the work reads now and then. The flags, and what is said of scratch files, are the only global
 * state of the program: a signal handler can reach nothing else. */
#include "cli/run/interrupt.h"
#include "cli/report/plain.h"
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t requested, writing_now;

enum { SECONDS_BETWEEN = 1, NO_MEMORY = 4 /* exit code */ };

#define LOST "a scratch file was cut from outside, or its disk failed"

static struct {
    char folder[512]; /* as it can be shown */
    bool json;
} scratch;

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

/* Sets a handler. Without SA_RESTART: a read that waits for a pipe must return for the flag to be seen. */
static void handle(int number, void (*handler)(int)) {
    struct sigaction action = {0};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, NULL);
}

static void say(int file, const char *text) {
    if (write(file, text, strlen(text)) < 0) _exit(NO_MEMORY);
}

/* Answers a page of a mapped file that is not there. Other reasons of the signal are none of ours. */
static void on_lost_page(int number, siginfo_t *facts, void *context) {
    (void)context;
    if (facts->si_code != BUS_ADRERR) {
        signal(number, SIG_DFL);
        return;
    }
    if (scratch.json) say(STDOUT_FILENO, "{\"error\": \"" LOST "\", \"exit\": 4}\n");
    say(STDERR_FILENO, "brio: ");
    say(STDERR_FILENO, scratch.folder);
    say(STDERR_FILENO, ": " LOST "\n");
    _exit(NO_MEMORY);
}

void cli_interrupt_scratch(const char *folder, bool json) {
    struct sigaction action = {.sa_sigaction = on_lost_page, .sa_flags = SA_SIGINFO};
    cli_copy_plain(scratch.folder, sizeof scratch.folder, folder);
    scratch.json = json;
    sigemptyset(&action.sa_mask);
    sigaction(SIGBUS, &action, NULL);
}

void cli_interrupt_install(void) {
    static const int stops[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction given;
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++)
        if (sigaction(stops[i], NULL, &given) == 0 && given.sa_handler != SIG_IGN) handle(stops[i], on_signal);
    handle(SIGALRM, on_alarm);
    handle(SIGPIPE, SIG_IGN);
    handle(SIGXFSZ, SIG_IGN);
}

bool cli_interrupted(void) {
    return requested;
}

void cli_interrupt_writing(bool writing) {
    writing_now = writing;
}
