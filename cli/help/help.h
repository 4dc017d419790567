/* The help, made of the tables of the commands. */
#ifndef BRIO_CLI_HELP_H
#define BRIO_CLI_HELP_H

#include "cli/run/run.h"

/** Returns the columns to fill: those of the terminal if the stream is one, at most 100; else 80. */
int cli_columns(FILE *out);

/** Prints a text whose lines begin at `indent` and end before `columns`; the first one begins where `at` says.  */
void cli_print_wrapped(FILE *out, const char *text, int at, int indent, int columns);

/** Prints what `brio --help` does: the commands and exit codes. */
void cli_print_help(FILE *out);

/** Prints what `brio help methods` does: which command line fits which points. */
void cli_print_advice(FILE *out);

/** Prints what `brio COMMAND --help` does.   verbose  explains the lines of the report, too. */
void cli_print_command_help(FILE *out, const command *c, bool verbose);

#endif
