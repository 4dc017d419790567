/* Facts as aligned lines for people: one fact a line, objects indented, short lists on one line, lists of objects as
 * tables. */
#include "facts.h"
#include <string.h>

static void write_bytes(FILE *out, uint64_t bytes) {
    static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB"};
    double number = (double)bytes;
    int unit = 0;
    while (number >= 1024 && unit < 5) {
        number /= 1024;
        unit++;
    }
    fprintf(out, unit ? "%.1f %s" : "%.0f %s", number, units[unit]);
}

/* Control characters in names from files would reach the terminal. */
static void write_plain(FILE *out, const char *text) {
    for (; *text; text++) fputc((unsigned char)*text < 0x20 || *text == 0x7f ? '?' : *text, out);
}

/* False when the fact is no number. */
static bool format_number(const fact *f, char text[32]) {
    switch (f->kind) {
    case FACT_INTEGER:
        return snprintf(text, 32, "%lld", (long long)f->integer) > 0;
    case FACT_COUNT:
        return snprintf(text, 32, "%llu", (unsigned long long)f->count) > 0;
    case FACT_REAL:
        return snprintf(text, 32, "%.9g", f->real) > 0;
    case FACT_SECONDS:
        return snprintf(text, 32, "%.3f", f->real) > 0;
    default:
        return false;
    }
}

static void write_value(FILE *out, const fact *f) {
    char number[32];
    if (format_number(f, number)) fputs(number, out);
    switch (f->kind) {
    case FACT_TEXT:
        write_plain(out, f->text);
        break;
    case FACT_BOOL:
        fputs(f->truth ? "yes" : "no", out);
        break;
    case FACT_BYTES:
        write_bytes(out, f->count);
        break;
    case FACT_NULL:
        fputs(f->text ? f->text : "-", out);
        break;
    default:
        break;
    }
}

/* The members of the list that opens at i, the first few of them; returns where it closes. They are plain values. */
static size_t write_list(FILE *out, const facts *f, size_t i) {
    enum { MOST = 12 };
    size_t members = 0;
    for (i++; i < f->count && f->list[i].kind != FACT_CLOSE; i++) {
        if (members++ == MOST) fputs(" ...", out);
        if (members > MOST) continue;
        if (members > 1) fputc(' ', out);
        write_value(out, &f->list[i]);
    }
    return i;
}

/* A row of names or of numbers, those of the object that opens at i; returns where it closes. */
static size_t write_row(FILE *out, const facts *f, size_t i, bool names) {
    enum { PLACES = 12 };
    char number[32] = "";
    fputs("\n ", out);
    for (i++; i < f->count && f->list[i].kind != FACT_CLOSE; i++) {
        const fact *item = &f->list[i];
        int width = (int)strlen(item->name) > PLACES ? (int)strlen(item->name) : PLACES;
        if (!names) format_number(item, number);
        fprintf(out, " %*s", width, names ? item->name : number);
    }
    return i;
}

/* The members of the list that opens at i, objects of the same numbers; returns where it closes. */
static size_t write_table(FILE *out, const facts *f, size_t i) {
    write_row(out, f, ++i, true);
    while (i < f->count && f->list[i].kind == FACT_OBJECT) i = write_row(out, f, i, false) + 1;
    return i;
}

void cli_text_write(FILE *out, const facts *f) {
    int depth = 0;
    for (size_t i = 0; i < f->count; i++) {
        const fact *item = &f->list[i];
        if (item->kind == FACT_CLOSE) {
            depth--;
            continue;
        }
        fprintf(out, "%*s", 2 * depth, "");
        write_plain(out, item->name);
        if (item->kind == FACT_OBJECT) {
            depth++;
        } else {
            int width = 22 - 2 * depth - (int)snprintf(NULL, 0, "%s", item->name);
            fprintf(out, "%*s", width > 1 ? width : 1, "");
            bool table = item->kind == FACT_LIST && i + 1 < f->count && item[1].kind == FACT_OBJECT;
            if (table)
                i = write_table(out, f, i);
            else if (item->kind == FACT_LIST)
                i = write_list(out, f, i);
            else
                write_value(out, item);
        }
        fputc('\n', out);
    }
}
