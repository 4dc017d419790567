/* Options of the command line, described by tables: each row names an option, the kind of its value and the field of a
 * struct that receives it. The same rows parse the line and print the help. */
#ifndef BRIO_CLI_OPTIONS_H
#define BRIO_CLI_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef enum option_kind {
    OPTION_END = 0,         /* closes a table */
    OPTION_FLAG,            /* bool, without a value */
    OPTION_TEXT,            /* const char *, a view of the command line */
    OPTION_INPUT,           /* the same: a file that is read */
    OPTION_OUTPUT,          /* the same: a file that is written */
    OPTION_INT,             /* int */
    OPTION_NATURAL,         /* uint64_t: 1000000, also 1e6 */
    OPTION_NUMBER,          /* double, finite */
    OPTION_SIZE,            /* size_t bytes: 500M, 8G, 1.5GiB */
    OPTION_CHOICE,          /* int: a name from a list */
    OPTION_METHOD,          /* int: a method for surfaces, brio_surface_method, or a name from the list */
    OPTION_TITLE,           /* no option: the title, in `meaning`, of the rows up to the next one */
    OPTION_NOTE,            /* no option: what `name`, a choice of the row above, means */
    OPTION_POSITIVE = 0x10, /* added to a kind of number: 0 and less are refused */
    OPTION_OPTIONAL = 0x20  /* added to a kind of number: may stand without a value, which is then 0 */
} option_kind;

/** A name and what it stands for. A list ends with NULL. */
typedef struct option_choice {
    const char *name;
    int value;
} option_choice;

typedef struct option {
    const char *name; /* long name without dashes */
    char letter;      /* short name, 0 for none */
    option_kind kind;
    size_t offset;               /* of the field in the struct of values */
    const char *value, *meaning; /* what the help prints */
    const option_choice *choices;
} option;

/** A table and the struct that its rows fill. */
typedef struct option_group {
    const option *rows;
    void *values;
} option_group;

/** What the line was found to hold. */
typedef struct option_parse {
    const option_group *groups;
    size_t num_groups;
    char **operands; /* moved to the front of the arguments */
    int num_operands;
    bool help;         /* --help was there; nothing else counts then */
    char message[512]; /* why the line is wrong */
} option_parse;

/** Reads the arguments into the groups' structs; false when the line is wrong. Operands may stand between options; what
 *  follows `--` is operands. */
bool cli_parse(option_parse *parse, int argc, char **argv);

/** Returns whether a row is an option, and no title or note. */
bool cli_is_option(const option *row);

/** Returns whether a row is an option that takes one of several names. */
bool cli_has_choices(const option *row);

/** Returns choice i of a row that has them; its name is NULL after the last one.
 *  words  NULL, or receives what a method is good for; NULL for choices that the rows below explain. */
option_choice cli_choice(const option *row, size_t i, const char **words);

/** Returns the name of choice i of a row, as cli_list_words and cli_nearest take it. */
const char *cli_choice_name(const void *row, size_t i);

/** Writes "a, b or c", cut to the size of the array. `next(list, i)` gives word i, NULL at the end. */
void cli_list_words(const char *(*next)(const void *list, size_t i), const void *list, char *text, size_t size);

/** Reads "500M", "8G", "1.5GiB": K M G T are powers of 1024, as KiB ...; KB MB GB TB are powers of 1000. */
bool cli_parse_size(const char *text, size_t *bytes);

/** Returns the name that is closest to `word`, or NULL when none is near. `next(list, i)` gives name i, NULL at the
 *  end. */
const char *cli_nearest(const char *word, const char *(*next)(const void *list, size_t i), const void *list);

#endif
