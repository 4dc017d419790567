/* Texts that the help and the manual pages share, besides the tables of the commands. */
#ifndef BRIO_CLI_MANUAL_H
#define BRIO_CLI_MANUAL_H

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

#endif
