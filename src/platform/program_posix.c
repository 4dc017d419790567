/* Programs of POSIX: signals by handlers. */
#define _GNU_SOURCE
#include "platform/program.h"
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifndef __wasi__
#include <signal.h>
#include <sys/ioctl.h>
#endif

/* Opens what refuses every call as the first free descriptor: /dev/null the wrong way round; in a root without devices,
 * a folder. Returns whether that is `stream`. Where no file can be opened, no output will get the number later. */
static bool takes_refusing(int stream) {
    int file = open("/dev/null", stream ? O_RDONLY : O_WRONLY);
    return (file == -1 ? open("/", O_RDONLY) : file) == stream;
}

void brio_program_begin(int *argc, char ***argv) {
    (void)argc, (void)argv;
#ifdef __wasi__ /* where a program begins in no folder */
    const char *here = getenv("PWD");
    if (here) (void)!chdir(here);
#endif
    for (int stream = 0; stream < 3; stream++)
        if (fcntl(stream, F_GETFL) == -1 && !takes_refusing(stream)) return; /* WASI answers F_GETFD for any number */
}

bool brio_program_say(int file, const char *text) {
    return write(file, text, strlen(text)) >= 0;
}

void brio_program_end(int code) {
    _exit(code);
}

char *brio_program_text(void (*write)(FILE *stream, void *object), void *object) {
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (!memory) return NULL;
    write(memory, object);
    bool whole = !ferror(memory);
    if (fclose(memory) == 0 && whole) return text;
    free(text);
    return NULL;
}

bool brio_is_terminal(int file) {
    return isatty(file);
}

#ifdef __wasi__ /* no signals, no sizes of terminals */

void brio_program_on_stop(void (*stop)(void)) {
    (void)stop;
}

void brio_program_on_lost_page(void (*lost)(void)) {
    (void)lost;
}

int brio_terminal_columns(FILE *stream) {
    (void)stream;
    return 0;
}

#else

enum { SECONDS_BETWEEN = 1 };

/* --- what the handlers call: a handler can reach nothing but what is global --- */

static void (*program_stop)(void), (*program_lost)(void);

static void on_signal(int number) {
    (void)number;
    program_stop();
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

void brio_program_on_stop(void (*stop)(void)) {
    static const int stops[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction given;
    program_stop = stop;
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++)
        if (sigaction(stops[i], NULL, &given) == 0 && given.sa_handler != SIG_IGN) handle(stops[i], on_signal);
    handle(SIGALRM, on_alarm);
    handle(SIGPIPE, SIG_IGN);
    handle(SIGXFSZ, SIG_IGN);
}

/* Answers a page of a mapped file that is not there. Other reasons of the signal are none of ours. */
static void on_lost_page(int number, siginfo_t *facts, void *context) {
    (void)context;
    if (facts->si_code != BUS_ADRERR) {
        signal(number, SIG_DFL);
        return;
    }
    program_lost();
}

void brio_program_on_lost_page(void (*lost)(void)) {
    struct sigaction action = {.sa_sigaction = on_lost_page, .sa_flags = SA_SIGINFO};
    program_lost = lost;
    sigemptyset(&action.sa_mask);
    sigaction(SIGBUS, &action, NULL);
}

int brio_terminal_columns(FILE *stream) {
    struct winsize size;
    return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

#endif
