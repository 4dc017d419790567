/* Facts as one JSON object (RFC 8259): names in the order of the facts, numbers in their shortest exact form, text
 * always valid UTF-8, whatever bytes a file's name is made of. */
#include "facts.h"
#include "glossary.h"
#include <stdlib.h>

void cli_format_real(double real, char text[32]) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, real);
        if (strtod(text, NULL) == real) return;
    }
}

/* Length of the well-formed UTF-8 sequence at s, 0 when there is none (Unicode 15, table 3-7). */
static int sequence_length(const unsigned char *s) {
    int length = s[0] < 0x80 ? 1 : s[0] < 0xc2 ? 0 : s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : s[0] < 0xf5 ? 4 : 0;
    for (int i = 1; i < length; i++)
        if ((s[i] & 0xc0) != 0x80) return 0;
    bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
    bool surrogate = s[0] == 0xed && s[1] > 0x9f, beyond = s[0] == 0xf4 && s[1] > 0x8f;
    return length > 1 && (overlong || surrogate || beyond) ? 0 : length;
}

static void write_string(FILE *out, const char *text) {
    fputc('"', out);
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        int length = sequence_length(s);
        if (length == 0) {
            fputs("\\ufffd", out);
            length = 1;
        } else if (*s == '"' || *s == '\\') {
            fprintf(out, "\\%c", *s);
        } else if (*s < 0x20 || *s == 0x7f) {
            fprintf(out, "\\u%04x", *s);
        } else {
            fwrite(s, 1, (size_t)length, out);
        }
        s += length;
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

/* One fact with all that is in it. Objects and lists nest; a bit for each open one tells which bracket closes it. */
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
