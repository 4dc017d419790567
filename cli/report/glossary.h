/* What the lines of reports mean: one table that orders and names the lines that people read, that says which facts are
 * internals of a method, and of which the manual is made. */
#ifndef BRIO_CLI_GLOSSARY_H
#define BRIO_CLI_GLOSSARY_H

#include <stdbool.h>
#include <stddef.h>

typedef enum line_level {
    LINE_PLAIN,    /* always shown */
    LINE_VERBOSE,  /* people see it with --verbose */
    LINE_INTERNAL, /* likewise; in JSON a member of the object `internals` */
    LINE_JSON      /* in JSON only */
} line_level;

typedef enum line_style {
    STYLE_PLAIN,
    STYLE_PER_CENT,    /* a share, shown in per cent */
    STYLE_SPACINGS,    /* a length in spacings of the points */
    STYLE_UNLESS_ZERO, /* shown when it is not 0, or with --verbose */
    STYLE_COUNTED      /* null is shown as "not counted" */
} line_style;

/** One line. The rows stand in the order in which people read the lines. */
typedef struct glossary_line {
    const char *commands; /* their names, with blanks between; NULL: all commands */
    const char *parent;   /* the object that the fact stands in, NULL for none */
    const char *key;      /* the name in JSON */
    const char *label;    /* the name for people; NULL: the key, with blanks for underscores */
    const char *meaning;
    line_level level;
    line_style style;
} glossary_line;

/** The table, closed by a row without a key. */
extern const glossary_line cli_glossary[];

/** Returns whether a row is for this command and this parent. The members of an object that has no rows itself need
 *  none. */
bool cli_glossary_fits(const glossary_line *line, const char *command, const char *parent);

/** Returns the first row for a fact, NULL when there is none. */
const glossary_line *cli_glossary_find(const char *command, const char *parent, const char *key);

/** Returns whether a fact of a command is an internal of its method. */
bool cli_is_internal(const char *command, const char *key);

/** Writes the name of a line for people, cut to the size of the array.   line  NULL: the key as it is. */
void cli_glossary_label(const glossary_line *line, const char *key, char *label, size_t size);

#endif
