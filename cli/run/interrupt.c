/* Signals as a flag that the work reads now and then. The flags, and what is said of scratch files, are the only global
 * state of the program: a signal handler can reach nothing else. */
#include "cli/run/interrupt.h"
#include "cli/report/plain.h"
#include "platform/file.h"
#include "platform/program.h"

static int requested, writing_now; /* atomic */

enum { INTERRUPTED = 130, NO_MEMORY = 4 /* exit codes */ };

#define LOST "a scratch file was cut from outside, or its disk failed"

static struct {
    char folder[512]; /* as it can be shown */
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

static void on_lost_page(void) {
    if (scratch.json) say(BRIO_OUTPUT, "{\"error\": \"" LOST "\", \"exit\": 4}\n");
    say(BRIO_MESSAGES, "brio: ");
    say(BRIO_MESSAGES, scratch.folder);
    say(BRIO_MESSAGES, ": " LOST "\n");
    brio_program_end(NO_MEMORY);
}

void cli_interrupt_scratch(const char *folder, bool json) {
    cli_copy_plain(scratch.folder, sizeof scratch.folder, folder);
    scratch.json = json;
    brio_program_on_lost_page(on_lost_page);
}

void cli_interrupt_install(void) {
    brio_program_on_stop(on_stop);
}

bool cli_interrupted(void) {
    return __atomic_load_n(&requested, __ATOMIC_RELAXED) != 0;
}

void cli_interrupt_writing(bool writing) {
    __atomic_store_n(&writing_now, writing, __ATOMIC_RELAXED);
}
