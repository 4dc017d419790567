/* A growing list of facts. Texts and names are copied, since messages and property names do not outlive the run. */
#include "cli/report/facts.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *copy_text(facts *f, const char *text) {
    char *copy = text ? strdup(text) : NULL;
    if (text && !copy) f->failed = true;
    return copy;
}

static fact *add(facts *f, const char *name, fact_kind kind) {
    if (f->count == f->capacity) {
        size_t capacity = f->capacity ? 2 * f->capacity : 64;
        fact *list = realloc(f->list, capacity * sizeof *list);
        if (!list) {
            f->failed = true;
            return &f->nowhere;
        }
        f->list = list;
        f->capacity = capacity;
    }
    fact *new = &f->list[f->count++];
    memset(new, 0, sizeof *new);
    new->kind = kind;
    new->name = copy_text(f, name);
    return new;
}

void cli_fact_text(facts *f, const char *name, const char *text) {
    if (!text) {
        cli_fact_null(f, name);
        return;
    }
    fact *new = add(f, name, FACT_TEXT);
    if (!f->failed) new->text = copy_text(f, text);
}

void cli_fact_checksum(facts *f, const char *name, uint64_t checksum) {
    char text[17];
    snprintf(text, sizeof text, "%016" PRIx64, checksum);
    cli_fact_text(f, name, text);
}

void cli_fact_bool(facts *f, const char *name, bool truth) {
    add(f, name, FACT_BOOL)->truth = truth;
}
void cli_fact_integer(facts *f, const char *name, int64_t integer) {
    add(f, name, FACT_INTEGER)->integer = integer;
}
void cli_fact_count(facts *f, const char *name, uint64_t count) {
    add(f, name, FACT_COUNT)->count = count;
}
void cli_fact_bytes(facts *f, const char *name, uint64_t bytes) {
    add(f, name, FACT_BYTES)->count = bytes;
}
void cli_fact_seconds(facts *f, const char *name, double seconds) {
    add(f, name, FACT_SECONDS)->real = seconds;
}
void cli_fact_null(facts *f, const char *name) {
    add(f, name, FACT_NULL);
}

void cli_fact_missing(facts *f, const char *name, const char *reason) {
    fact *new = add(f, name, FACT_NULL);
    if (!f->failed) new->text = copy_text(f, reason);
}

void cli_fact_real(facts *f, const char *name, double real) {
    if (isfinite(real))
        add(f, name, FACT_REAL)->real = real;
    else
        cli_fact_null(f, name);
}

void cli_fact_open(facts *f, const char *name, fact_kind object_or_list) {
    add(f, name, object_or_list);
}
void cli_fact_close(facts *f) {
    add(f, NULL, FACT_CLOSE);
}

void cli_facts_free(facts *f) {
    for (size_t i = 0; i < f->count; i++) {
        free(f->list[i].name);
        if (f->list[i].kind == FACT_TEXT || f->list[i].kind == FACT_NULL) free(f->list[i].text);
    }
    free(f->list);
    memset(f, 0, sizeof *f);
}

size_t cli_fact_after(const facts *f, size_t i) {
    int depth = 0;
    do {
        fact_kind kind = f->list[i++].kind;
        depth += (kind == FACT_OBJECT || kind == FACT_LIST) - (kind == FACT_CLOSE);
    } while (depth > 0 && i < f->count);
    return i;
}
