/* The facts of a run, in the order in which they became known: names with values, objects and lists inside objects.
 * One list serves both readers: json.c prints it for programs, text.c for people. */
#ifndef BRIO_CLI_FACTS_H
#define BRIO_CLI_FACTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef enum fact_kind {
    FACT_OBJECT, /* opens an object; FACT_CLOSE closes it */
    FACT_LIST,   /* opens a list; its members have no name */
    FACT_CLOSE,
    FACT_TEXT,
    FACT_BOOL,
    FACT_INTEGER,
    FACT_COUNT,
    FACT_BYTES, /* a count that people read in units */
    FACT_REAL,
    FACT_SECONDS,
    FACT_NULL
} fact_kind;

typedef struct fact {
    fact_kind kind;
    char *name; /* NULL in lists */
    union {
        char *text;
        bool truth;
        int64_t integer;
        uint64_t count;
        double real;
    };
} fact;

/** Zeroed to begin with. Memory that could not be had is remembered in `failed`, so that callers need not ask after
 *  each fact. */
typedef struct facts {
    fact *list;
    size_t count, capacity;
    bool failed;
    fact nowhere; /* takes what could not be kept */
} facts;

void cli_fact_text(facts *f, const char *name, const char *text);
void cli_fact_bool(facts *f, const char *name, bool truth);
void cli_fact_integer(facts *f, const char *name, int64_t integer);
void cli_fact_count(facts *f, const char *name, uint64_t count);
void cli_fact_bytes(facts *f, const char *name, uint64_t bytes);
/** Adds a checksum, as 16 hexadecimal digits. */
void cli_fact_checksum(facts *f, const char *name, uint64_t checksum);
/** Adds a number. NaN and infinities are kept as null. */
void cli_fact_real(facts *f, const char *name, double real);
void cli_fact_seconds(facts *f, const char *name, double seconds);
void cli_fact_null(facts *f, const char *name);
/** Adds a fact that is not there: null for programs; people read the reason. */
void cli_fact_missing(facts *f, const char *name, const char *reason);
void cli_fact_open(facts *f, const char *name, fact_kind object_or_list);
void cli_fact_close(facts *f);
void cli_facts_free(facts *f);

/** Returns the index behind fact i with all that is in it. */
size_t cli_fact_after(const facts *f, size_t i);

/** Writes the shortest decimal form that reads back as the same double. */
void cli_format_real(double real, char text[32]);

/** Writes one JSON object and a newline; facts->failed is left to the caller. What the glossary calls internal is in an
 *  object
 *  `internals`, at the end.   command  the name of the command that found the facts. */
void cli_json_write(FILE *out, const facts *f, const char *command);

/** Writes aligned lines for people.   verbose  shows every fact. */
void cli_text_write(FILE *out, const facts *f, const char *command, bool verbose);

#endif
