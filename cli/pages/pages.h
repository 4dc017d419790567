/* The manual pages and the completions of shells, written from the tables of the command line when brio is built. */
#ifndef BRIO_CLI_PAGES_H
#define BRIO_CLI_PAGES_H

#include "cli/run/commands.h"

/** Writes brio(1): the commands, options of every command, which method fits which points, exit codes.
 *  date  of the page, YYYY-MM-DD. */
void pages_write_manual(FILE *out, const char *date);

/** Writes brio-COMMAND(1). */
void pages_write_command_manual(FILE *out, const command *c, const char *date);

/** Writes the completion of bash. */
void pages_write_bash(FILE *out);

/** Writes the completion of zsh. */
void pages_write_zsh(FILE *out);

/** Lists extensions without dots, "ply vtu": of the files that a command reads, and of those that an option names; ""
 *  where that is no file, or any file.   text  of BRIO_FORMAT_LIST bytes, receives the list. */
void pages_list_inputs(const command *c, char *text);
void pages_list_extensions(const command *c, const option *row, char *text);

#endif
