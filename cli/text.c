/* Facts as aligned lines for people: one fact a line, objects indented, short lists on one line. */
#include "facts.h"

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

static void write_value(FILE *out, const fact *f) {
    switch (f->kind) {
    case FACT_TEXT:
        write_plain(out, f->text);
        break;
    case FACT_BOOL:
        fputs(f->truth ? "yes" : "no", out);
        break;
    case FACT_INTEGER:
        fprintf(out, "%lld", (long long)f->integer);
        break;
    case FACT_COUNT:
        fprintf(out, "%llu", (unsigned long long)f->count);
        break;
    case FACT_BYTES:
        write_bytes(out, f->count);
        break;
    case FACT_REAL:
        fprintf(out, "%.9g", f->real);
        break;
    case FACT_SECONDS:
        fprintf(out, "%.3f", f->real);
        break;
    case FACT_NULL:
        fputc('-', out);
        break;
    case FACT_OBJECT:
    case FACT_LIST:
    case FACT_CLOSE:
        break;
    }
}

/* The members of the list that opens at i, the first few of them; returns where it closes. Lists hold plain values. */
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
            if (item->kind == FACT_LIST)
                i = write_list(out, f, i);
            else
                write_value(out, item);
        }
        fputc('\n', out);
    }
}
