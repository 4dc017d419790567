/* Signals as a flag that the work reads now and then. The flags, and what is said of scratch files, are the only global
 * state of the program: a signal handler can reach nothing else. */
#include "cli/run/interrupt.h"
#include "cli/report/plain.h"
#include "platform/file.h"
#include "platform/program.h"
#include <stdio.h>

static int requested, writing_now, lost; /* atomic */

enum { INTERRUPTED = 130, NO_MEMORY = 4 /* exit codes */ };

#define LOST "a scratch file was cut from outside, or its disk failed"

static struct {
    char sentence[600];
    bool json;
} scratch;

static void on_stop(void) {
    if (__atomic_load_n(&requested, __ATOMIC_RELAXED) && !__atomic_load_n(&writing_now, __ATOMIC_RELAXED))
        brio_program_end(INTERRUPTED);
    __atomic_store_n(&requested, 1, __ATOMIC_RELAXED);
}

static void say(int file, const char *text) {
    if (!brio_program_say(file, text)) brio_program_end(NO_MEMORY);
}

/* Says it once: several threads may come to pages that are lost, and all but the first wait for the end. */
static void on_lost_page(void) {
    while (__atomic_exchange_n(&lost, 1, __ATOMIC_RELAXED)) brio_wait_milliseconds(1000);
    if (scratch.json) say(BRIO_OUTPUT, "{\"error\": \"" LOST "\", \"exit\": 4}\n");
    say(BRIO_MESSAGES, scratch.sentence);
    brio_program_end(NO_MEMORY);
}

void cli_interrupt_scratch(const char *folder, bool json) {
    char shown[512];
    cli_copy_plain(shown, sizeof shown, folder);
    snprintf(scratch.sentence, sizeof scratch.sentence, "brio: %s: " LOST "\n", shown);
    scratch.json = json;
    brio_program_on_lost_page(on_lost_page);
}

void cli_interrupt_install(void) {
    brio_program_on_stop(on_stop);
}

void cli_interrupt(void) {
    __atomic_store_n(&requested, 1, __ATOMIC_RELAXED);
}

bool cli_interrupted(void) {
    return __atomic_load_n(&requested, __ATOMIC_RELAXED) != 0;
}

void cli_interrupt_writing(bool writing) {
    __atomic_store_n(&writing_now, writing, __ATOMIC_RELAXED);
}
