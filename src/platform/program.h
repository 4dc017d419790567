/* What a program of the command line asks of its system: arguments, signals, terminals. libbrio has none of this.
 *
 * The handlers that these functions install call functions of the program, in a thread that may be anywhere in its
 * work: what they call may set a flag, wait, and call brio_program_say and brio_program_end, and nothing else. */
#ifndef BRIO_PLATFORM_PROGRAM_H
#define BRIO_PLATFORM_PROGRAM_H

#include <stdbool.h>
#include <stdio.h>

/** Prepares the process: arguments in UTF-8, streams of bytes, and standard streams that the caller closed get
 *  descriptors that refuse every call. Else a file opened later would get their numbers, and messages would be written
 *  into it.
 *  argc, argv  those of main; replaced where the system has others. */
void brio_program_begin(int *argc, char ***argv);

/** Calls `stop` when the user asks the program to stop: Ctrl-C, the end of the session, and on POSIX SIGINT, SIGTERM
 *  and SIGHUP, each unless the caller had it ignored. A signal ends a call of the system that waits, of a pipe for
 *  example. One that comes just before such a call would be missed by the call: after the first signal an alarm each
 *  second ends what waits. A reader that went away and a limit on the size of files are errors of writing from now
 *  on. */
void brio_program_on_stop(void (*stop)(void));

/** Calls `lost` when a page of a mapped file cannot be read: somebody cut the file, or its disk failed. */
void brio_program_on_lost_page(void (*lost)(void));

/** Writes a text to a descriptor, without a buffer. Returns false if it does not take it. */
bool brio_program_say(int file, const char *text);

/** Ends the process at once. */
void brio_program_end(int code);

/** Returns what `write` writes to a stream, as a text to be freed; NULL without memory or room for it.
 *  object  handed on to `write`. */
char *brio_program_text(void (*write)(FILE *stream, void *object), void *object);

/** Returns whether a descriptor is a terminal. */
bool brio_is_terminal(int file);

/** Returns the columns of the terminal that a stream writes to; 0 if it is none. */
int brio_terminal_columns(FILE *stream);

#endif
