/* Facts as one JSON object (RFC 8259): names in the order of the facts, numbers in their shortest exact form, text
 * always valid UTF-8, whatever bytes a file's name is made of. */
#include "cli/report/facts.h"
#include "cli/report/glossary.h"
#include "cli/report/plain.h"
#include <stdlib.h>

void cli_format_real(double real, char text[32]) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, real);
        if (strtod(text, NULL) == real) return;
    }
}

static void write_string(FILE *out, const char *text) {
    fputc('"', out);
    for (size_t length; *text; text += length) {
        uint32_t character = cli_character(text, &length);
        if (character == NO_CHARACTER || cli_is_control(character))
            fprintf(out, "\\u%04x", (unsigned)character);
        else if (*text == '"' || *text == '\\')
            fprintf(out, "\\%c", *text);
        else
            fwrite(text, 1, length, out);
    }
    fputc('"', out);
}

static void write_value(FILE *out, const fact *f) {
    char number[32];
    switch (f->kind) {
    case FACT_TEXT:
        write_string(out, f->text);
        break;
    case FACT_BOOL:
        fputs(f->truth ? "true" : "false", out);
        break;
    case FACT_INTEGER:
        fprintf(out, "%lld", (long long)f->integer);
        break;
    case FACT_COUNT:
    case FACT_BYTES:
        fprintf(out, "%llu", (unsigned long long)f->count);
        break;
    case FACT_REAL:
    case FACT_SECONDS:
        cli_format_real(f->real, number);
        fputs(number, out);
        break;
    case FACT_NULL:
        fputs("null", out);
        break;
    case FACT_OBJECT:
        fputc('{', out);
        break;
    case FACT_LIST:
        fputc('[', out);
        break;
    case FACT_CLOSE:
        break;
    }
}

/* Writes one fact with all that is in it. Objects and lists nest; a bit for each open one tells which bracket closes
 * it. */
static void write_fact(FILE *out, const facts *f, size_t i, bool first) {
    uint64_t lists = 0;
    for (size_t end = cli_fact_after(f, i); i < end; i++) {
        const fact *item = &f->list[i];
        if (item->kind == FACT_CLOSE) {
            fputc(lists & 1 ? ']' : '}', out);
            lists >>= 1;
            first = false;
            continue;
        }
        if (!first) fputs(", ", out);
        if (item->name) {
            write_string(out, item->name);
            fputs(": ", out);
        }
        write_value(out, item);
        first = item->kind == FACT_OBJECT || item->kind == FACT_LIST;
        if (first) lists = lists << 1 | (item->kind == FACT_LIST);
    }
}

/* Returns how many facts there were. */
static size_t write_those(FILE *out, const facts *f, const char *command, bool internal) {
    size_t count = 0;
    for (size_t i = 0; i < f->count; i = cli_fact_after(f, i))
        if (cli_is_internal(command, f->list[i].name) == internal) {
            if (internal && count == 0) fputs(", \"internals\": {", out);
            write_fact(out, f, i, count++ == 0);
        }
    return count;
}

void cli_json_write(FILE *out, const facts *f, const char *command) {
    fputc('{', out);
    write_those(out, f, command, false);
    if (write_those(out, f, command, true)) fputc('}', out);
    fputs("}\n", out);
}
