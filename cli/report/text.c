/* Facts as aligned lines for people: one fact a line, objects indented, short lists on one line, lists of objects as
 * tables. The glossary says in which order lines stand, what they are called, and which ones only --verbose shows. */
#include "cli/report/facts.h"
#include "cli/report/glossary.h"
#include "cli/report/plain.h"
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

/* Writes a number. Returns false when the fact is no number. */
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
        cli_print_plain(out, f->text);
        break;
    case FACT_BOOL:
        fputs(f->truth ? "yes" : "no", out);
        break;
    case FACT_BYTES:
        write_bytes(out, f->count);
        break;
    case FACT_NULL:
        fputs(f->text ? f->text : "none", out);
        break;
    default:
        break;
    }
}

/* Writes the members of the list that opens at i, the first few of them; returns where it closes. They are plain
 * values. */
static size_t write_list(FILE *out, const facts *f, size_t i) {
    enum { MOST = 12 };
    size_t members = 0;
    for (i++; i < f->count && f->list[i].kind != FACT_CLOSE; i++) {
        if (members++ == MOST) fputs(" ...", out);
        if (members > MOST) continue;
        if (members > 1) fputc(' ', out);
        write_value(out, &f->list[i]);
    }
    if (members == 0) fputs("none", out);
    return i;
}

/* Writes a row of names or of numbers, those of the object that opens at i; returns where it closes. */
static size_t write_row(FILE *out, const facts *f, size_t i, bool names) {
    enum { PLACES = 12 };
    char number[32] = "";
    fputs("\n ", out);
    for (i++; i < f->count && f->list[i].kind != FACT_CLOSE; i++) {
        const fact *item = &f->list[i];
        int width = (int)strlen(item->name) > PLACES ? (int)strlen(item->name) : PLACES;
        if (!names) format_number(item, number);
        fprintf(out, " %*s", width - (names ? (int)strlen(item->name) : 0), names ? "" : number);
        if (names) cli_print_plain(out, item->name);
    }
    return i;
}

/* Writes the members of the list that opens at i, objects of the same numbers; returns where it closes. */
static size_t write_table(FILE *out, const facts *f, size_t i) {
    write_row(out, f, ++i, true);
    while (i < f->count && f->list[i].kind == FACT_OBJECT) i = write_row(out, f, i, false) + 1;
    return i;
}

/* --- lines --- */

typedef struct writer {
    FILE *out;
    const facts *facts;
    const char *command;
    bool verbose;
} writer;

/* The members of an object, or all facts: those from begin to end. */
typedef struct members {
    const char *parent; /* NULL: all facts */
    size_t begin, end;
    int depth;
} members;

/* Returns whether a fact is zero, absent, or a list of at most one member: nothing that people miss. */
static bool is_empty(const facts *f, size_t i) {
    const fact *item = &f->list[i];
    if (item->kind == FACT_LIST) return cli_fact_after(f, i) <= i + 3;
    return item->kind == FACT_NULL || ((item->kind == FACT_COUNT || item->kind == FACT_INTEGER) && item->count == 0);
}

static bool is_shown(const writer *w, const glossary_line *line, size_t i) {
    if (!line) return true;
    if (line->level == LINE_JSON) return false;
    if (w->verbose) return true;
    return line->level == LINE_PLAIN && !(line->style == STYLE_UNLESS_ZERO && is_empty(w->facts, i));
}

/* Writes the name at the left.   value  leaves room up to the column of the values. */
static void write_label(const writer *w, const glossary_line *line, const char *key, int depth, bool value) {
    enum { COLUMN = 24 };
    char label[96];
    cli_glossary_label(line, key, label, sizeof label);
    int width = COLUMN - 2 * depth - (int)strlen(label);
    fprintf(w->out, "%*s", 2 * depth, "");
    cli_print_plain(w->out, label);
    if (value) fprintf(w->out, "%*s", width > 1 ? width : 1, "");
}

static void write_single(const writer *w, const glossary_line *line, size_t i) {
    const fact *item = &w->facts->list[i];
    if (item->kind == FACT_LIST && i + 1 < w->facts->count && item[1].kind == FACT_OBJECT)
        write_table(w->out, w->facts, i);
    else if (item->kind == FACT_LIST)
        write_list(w->out, w->facts, i);
    else if (line && line->style == STYLE_PER_CENT && item->kind == FACT_REAL)
        fprintf(w->out, "%.3g %%", 100 * item->real);
    else if (line && line->style == STYLE_SPACINGS && item->kind == FACT_REAL)
        fprintf(w->out, "%.3g spacings", item->real);
    else if (line && line->style == STYLE_COUNTED && item->kind == FACT_NULL)
        fputs("not counted", w->out);
    else
        write_value(w->out, item);
}

static void write_members(const writer *w, const members *m);

/* Writes a fact. The seconds of a run are one line, their total, which is the last of them; with --verbose an object as
 * others are. */
static void write_fact(const writer *w, const members *m, const glossary_line *line, size_t i) {
    const fact *item = &w->facts->list[i];
    size_t end = cli_fact_after(w->facts, i);
    bool is_total = !w->verbose && !m->parent && !strcmp(item->name, "seconds");
    bool empty = item->kind == FACT_OBJECT && end == i + 2, nested = item->kind == FACT_OBJECT && !empty && !is_total;
    write_label(w, line, item->name, m->depth, !nested);
    if (empty)
        fputs("none", w->out);
    else if (is_total)
        write_value(w->out, &w->facts->list[end - 2]);
    else if (!nested)
        write_single(w, line, i);
    fputc('\n', w->out);
    if (nested) write_members(w, &(members){item->name, i + 1, end - 1, m->depth + 1});
}

/* Writes the facts that a line of the glossary is for; NULL: those that it knows nothing of. */
static void write_matching(const writer *w, const members *m, const glossary_line *line) {
    for (size_t i = m->begin; i < m->end; i = cli_fact_after(w->facts, i)) {
        const char *name = w->facts->list[i].name;
        if (cli_glossary_find(w->command, m->parent, name) == line && is_shown(w, line, i)) write_fact(w, m, line, i);
    }
}

static void write_lines(const writer *w, const members *m, bool internal) {
    for (const glossary_line *line = cli_glossary; line->key; line++)
        if ((line->level == LINE_INTERNAL) == internal && cli_glossary_fits(line, w->command, m->parent))
            write_matching(w, m, line);
}

static void write_members(const writer *w, const members *m) {
    write_lines(w, m, false);
    write_matching(w, m, NULL);
}

static bool has_internals(const writer *w) {
    for (size_t i = 0; i < w->facts->count; i = cli_fact_after(w->facts, i))
        if (cli_is_internal(w->command, w->facts->list[i].name)) return true;
    return false;
}

void cli_text_write(FILE *out, const facts *f, const char *command, bool verbose) {
    const writer w = {out, f, command, verbose};
    write_members(&w, &(members){NULL, 0, f->count, 0});
    if (!verbose || !has_internals(&w)) return;
    fputs("internals\n", out);
    write_lines(&w, &(members){NULL, 0, f->count, 1}, true);
}
