/* Warnings and hints of a run. */
#include "cli/run/notes.h"
#include "cli/report/plain.h"
#include "cli/run/run.h"
#include <stdarg.h>
#include <string.h>

static void keep(notes *n, const char *format, va_list arguments) {
    size_t room = sizeof n->text - n->used;
    int length = vsnprintf(n->text + n->used, room, format, arguments);
    if (length > 0 && (size_t)length < room) n->used += (size_t)length + 1;
}

void cli_warn(run *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    keep(&r->warnings, format, arguments);
    va_end(arguments);
}

void cli_hint(run *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    keep(&r->hints, format, arguments);
    va_end(arguments);
}

void cli_notes_report(facts *f, const char *name, const notes *n) {
    if (n->used == 0) return;
    cli_fact_open(f, name, FACT_LIST);
    for (size_t i = 0; i < n->used; i += strlen(n->text + i) + 1) cli_fact_text(f, NULL, n->text + i);
    cli_fact_close(f);
}

void cli_notes_print(FILE *out, const char *kind, const notes *n) {
    for (size_t i = 0; i < n->used; i += strlen(n->text + i) + 1) {
        fprintf(out, "brio: %s: ", kind);
        cli_print_plain(out, n->text + i);
        fputc('\n', out);
    }
}
