/* Sentences beside the report and the error of a run: warnings about a result that is there, hints what to try after a
 * failure. They are kept during the run and printed at its end, each in one form. */
#ifndef BRIO_CLI_NOTES_H
#define BRIO_CLI_NOTES_H

#include "cli/report/facts.h"
#include "cli/run/sentences.h"

/** Sentences one after the other, each ended by a zero. Zeroed to begin with. What does not fit is left out. */
typedef struct notes {
    char text[8192];
    size_t used;
} notes;

struct run;

/** Keeps a sentence about a result: something in it may not be what the user expects. */
void cli_warn(struct run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Keeps a sentence that says what to try after a failure. */
void cli_hint(struct run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Adds the sentences to the facts as a list of that name; nothing where there are none. */
void cli_notes_report(facts *f, const char *name, const notes *n);

/** Prints a line for each sentence: `brio: KIND: SENTENCE`. */
void cli_notes_print(FILE *out, const char *kind, const notes *n);

#endif
