/* Ctrl-C and its like. The first signal asks the work to stop: the progress callback sees it and the library gives
 * everything back. The second one ends the process at once, unless a file is being written: only the library knows the
 * temporary file beside the target, so its writer is left the moment it needs to remove it. Nothing else of a run lies
 * on disk under a name.
 *
 * A signal ends a call of the system that waits, of a pipe for example. One that comes just before such a call would be
 * missed by the call: after the first signal an alarm each second ends what waits.
 *
 * SIGINT, SIGTERM and SIGHUP are caught unless the caller had them ignored: a shell script does that for SIGINT of what
 * it starts in the background, nohup for SIGHUP. SIGPIPE and SIGXFSZ are ignored, so that a
 * reader that went away and a limit on the file size are errors of writing. */
#ifndef BRIO_CLI_INTERRUPT_H
#define BRIO_CLI_INTERRUPT_H

#include <stdbool.h>

void cli_interrupt_install(void);

/** Says where scratch files are, from now on. They are mapped: when somebody cuts one, or its disk fails, the next
 *  touch is the signal SIGBUS, in any thread and in the midst of anything. The run ends there with exit code 4 and a
 *  message. Neither scratch files nor unfinished outputs have names, so that nothing is left behind.
 *  json  whether standard output carries JSON. */
void cli_interrupt_scratch(const char *folder, bool json);

/** Returns whether a signal asked to stop. */
bool cli_interrupted(void);

/** Tells that a file with a name is being written from now on, or no longer. */
void cli_interrupt_writing(bool writing);

#endif
