/* The help, made of the tables of the commands. */
#ifndef BRIO_CLI_HELP_H
#define BRIO_CLI_HELP_H

#include "cli/run/run.h"

/* --- texts that the manual pages have, too --- */

/** A word or a line, and what is said of it. Lists end with NULL. */
typedef struct manual_entry {
    const char *name, *text;
} manual_entry;

/** Exit codes and what they mean. */
extern const manual_entry cli_exit_codes[];

/** Command lines, and the data that they fit: the short form of docs/which-method.md. */
extern const manual_entry cli_advice[];

/** Titles of the groups of commands, in the order of command_group. */
extern const char *const cli_group_titles[];

/* --- the help --- */

/** Returns the columns to fill: those of the terminal if the stream is one, at most 100; else 80. */
int cli_columns(FILE *out);

/** Prints a text whose lines begin at `indent` and end before `columns`; the first one begins where `at` says.  */
void cli_print_wrapped(FILE *out, const char *text, int at, int indent, int columns);

/** Prints a term at the left and its meaning at the right, below it where there is no room. */
void cli_print_entry(FILE *out, const char *term, const char *meaning, int left, int column);

/** Prints what `brio --help` does: the commands and exit codes. */
void cli_print_help(FILE *out);

/** Prints what `brio help methods` does: which command line fits which points. */
void cli_print_advice(FILE *out);

/** Prints what `brio COMMAND --help` does.   verbose  explains the lines of the report, too. */
void cli_print_command_help(FILE *out, const command *c, bool verbose);

/** Prints what `brio help formats` does: the formats of files, and what each holds.   json  for programs. */
void cli_print_formats(FILE *out, bool json);

#endif
