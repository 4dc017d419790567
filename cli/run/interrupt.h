/* Ctrl-C and its like. The first signal asks the work to stop: the progress callback sees it and the library gives
 * everything back. The second one ends the process at once, unless a file is being written: only the library knows the
 * temporary file beside the target, so its writer is left the moment it needs to remove it. Nothing else of a run lies
 * on disk under a name.
 *
 * What counts as such a signal, and which are left as the caller had them, says platform/program.h. */
#ifndef BRIO_CLI_INTERRUPT_H
#define BRIO_CLI_INTERRUPT_H

#include <stdbool.h>

void cli_interrupt_install(void);

/** Says where scratch files are, from now on. They are mapped: when somebody cuts one, or its disk fails, the next
 *  touch is a fault of the process, in any thread and in the midst of anything. The run ends there with exit code 4
 *  and a message. Neither scratch files nor unfinished outputs have names, so that nothing is left behind.
 *  json  whether standard output carries JSON. */
void cli_interrupt_scratch(const char *folder, bool json);

/** Asks to stop, as the first signal does. */
void cli_interrupt(void);

/** Returns whether a signal asked to stop. */
bool cli_interrupted(void);

/** Tells that a file with a name is being written from now on, or no longer. */
void cli_interrupt_writing(bool writing);

#endif
