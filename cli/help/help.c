/* The help, made of the tables of the commands: their options, extensions, examples, and the lines of their reports. */
#include "cli/help/help.h"
#include "cli/run/commands.h"
#include "cli/report/glossary.h"
#include "cli/help/manual.h"
#include <string.h>
#include <sys/ioctl.h>

enum { USUAL = 80, MOST = 100, FEWEST = 30, COLUMN = 28, NARROW = 60 };

int cli_columns(FILE *out) {
    struct winsize size;
    if (ioctl(fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return USUAL;
    return size.ws_col > MOST ? MOST : size.ws_col < FEWEST ? FEWEST : size.ws_col;
}

void cli_print_wrapped(FILE *out, const char *text, int at, int indent, int columns) {
    bool first = true;
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (!first && at + 1 + length > columns) {
            fprintf(out, "\n%*s", indent, "");
            at = indent;
        } else if (!first) {
            fputc(' ', out);
            at++;
        }
        fwrite(text, 1, (size_t)length, out);
        at += length;
        text += length + (text[length] == ' ');
        first = false;
    }
    fputc('\n', out);
}

/* Prints a term at the left and its meaning at the right, below it where there is no room. */
static void print_entry(FILE *out, const char *term, const char *meaning, int left, int column) {
    int columns = cli_columns(out), length = left + (int)strlen(term);
    if (columns < NARROW) column = left + 6;
    fprintf(out, "%*s%s", left, "", term);
    if (length + 2 > column)
        fprintf(out, "\n%*s", column, "");
    else
        fprintf(out, "%*s", column - length, "");
    cli_print_wrapped(out, meaning, column, column, columns);
}

static void print_entries(FILE *out, const char *title, const manual_entry *entries, int column) {
    fprintf(out, "\n%s:\n", title);
    for (; entries->name; entries++) print_entry(out, entries->name, entries->text, 2, column);
}

/* --- options --- */

static void print_title(FILE *out, const char *title) {
    char line[128];
    snprintf(line, sizeof line, "%s:", title);
    fputc('\n', out);
    cli_print_wrapped(out, line, 0, 0, cli_columns(out));
}

static void print_option(FILE *out, const option *row) {
    char left[128], meaning[1024], choices[512] = "";
    const char letter[] = {'-', row->letter, ',', ' ', 0};
    bool explained = row[1].kind == OPTION_NOTE;
    snprintf(left, sizeof left, "%s--%s%s%s", row->letter ? letter : "", row->name, row->value ? " " : "",
             row->value ? row->value : "");
    if (cli_has_choices(row) && !explained) cli_list_words(cli_choice_name, row, choices, sizeof choices);
    snprintf(meaning, sizeof meaning, "%s%s%s%s", row->meaning, *choices ? "; one of " : "", choices,
             explained ? ":" : "");
    print_entry(out, left, meaning, 2, COLUMN);
}

/* Prints what the methods among the choices of a row are good for. */
static void print_words(FILE *out, const option *row) {
    const char *words;
    option_choice c;
    for (size_t i = 0; cli_has_choices(row) && (c = cli_choice(row, i, &words)).name; i++)
        if (words) print_entry(out, c.name, words, 6, COLUMN);
}

static void print_options(FILE *out, const char *title, const option *rows) {
    if (!rows->kind) return;
    if (rows->kind != OPTION_TITLE) print_title(out, title);
    int indent = 2; /* of notes: below an option they stand farther in */
    for (const option *row = rows; row->kind; row++) {
        indent = row->kind == OPTION_TITLE ? 2 : row->kind == OPTION_NOTE ? indent : 6;
        if (row->kind == OPTION_TITLE)
            print_title(out, row->meaning);
        else if (row->kind == OPTION_NOTE)
            print_entry(out, row->name, row->meaning, indent, COLUMN);
        else
            print_option(out, row), print_words(out, row);
    }
}

/* --- one command --- */

static void print_extensions(FILE *out, const char *title, const char *extensions) {
    char list[256];
    size_t used = 0;
    for (const char *e = extensions; *e && used + 2 < sizeof list; e++) {
        if (e == extensions || e[-1] == ' ') list[used++] = '.';
        list[used++] = *e;
    }
    list[used] = 0;
    print_entry(out, title, list, 0, 10);
}

static void print_examples(FILE *out, const char *examples) {
    fputs("\nexamples:\n", out);
    for (bool is_line = true; *examples; is_line = !is_line) {
        size_t length = strcspn(examples, "\n");
        fprintf(out, is_line ? "  %.*s\n" : "      %.*s\n", (int)length, examples);
        examples += length + (examples[length] == '\n');
    }
}

static void print_glossary(FILE *out, const char *name, const char *parent, int left) {
    for (const glossary_line *line = cli_glossary; line->key; line++) {
        char label[64];
        bool hidden = line->level == LINE_JSON || !cli_glossary_fits(line, name, parent);
        if (hidden || cli_glossary_find(name, parent, line->key) != line) continue;
        cli_glossary_label(line, line->key, label, sizeof label);
        print_entry(out, label, line->meaning, left, COLUMN);
        if (!parent) print_glossary(out, name, line->key, left + 2);
    }
}

void cli_print_command_help(FILE *out, const command *c, bool verbose) {
    char usage[128];
    const char *output = !c->outputs ? "" : c->output_optional ? " [-o FILE]" : " -o FILE";
    snprintf(usage, sizeof usage, "usage: brio %s %s%s [options]", c->name, c->operands, output);
    cli_print_wrapped(out, usage, 0, 4, cli_columns(out));
    fputc('\n', out);
    cli_print_wrapped(out, c->summary, 0, 0, cli_columns(out));
    if (c->description) {
        fputc('\n', out);
        cli_print_wrapped(out, c->description, 0, 0, cli_columns(out));
    }
    fputc('\n', out);
    if (!c->choices) print_extensions(out, "reads:", c->inputs ? c->inputs : CLI_INPUTS);
    if (c->outputs) print_extensions(out, "writes:", c->outputs);
    print_options(out, "options", c->options);
    print_options(out, "options of every command", cli_common_options);
    print_entry(out, "-h, --help", "print this", 2, COLUMN);
    if (c->examples) print_examples(out, c->examples);
    fputc('\n', out);
    if (verbose) {
        fputs("lines of the report, in JSON with underscores for blanks:\n", out);
        print_glossary(out, c->name, NULL, 2);
    } else {
        fprintf(out, "brio %s --help --verbose explains the lines of the report.\n", c->name);
    }
}

/* --- all commands --- */

static void print_commands(FILE *out, int group) {
    fprintf(out, "\n%s:\n", cli_group_titles[group]);
    for (size_t i = 0; cli_commands[i]; i++)
        if ((int)cli_commands[i]->group == group)
            print_entry(out, cli_commands[i]->name, cli_commands[i]->summary, 2, 15);
}

void cli_print_help(FILE *out) {
    static const int order[] = {GROUP_SURFACES, GROUP_TRIANGULATIONS, GROUP_FILES};
    fputs("brio " BRIO_VERSION ": exact Delaunay triangulations, and surfaces from points\n\n"
          "usage: brio COMMAND [options] INPUT\n",
          out);
    for (int i = 0; i < 3; i++) print_commands(out, order[i]);
    fputs("\nhelp:\n", out);
    print_entry(out, "brio help COMMAND", "the options of a command, with examples; also brio COMMAND --help", 2,
                COLUMN);
    print_entry(out, "brio help methods", "which command and method fits which points", 2, COLUMN);
    print_entry(out, "brio --version", "the version; also brio -V", 2, COLUMN);
    print_entries(out, "exit codes", cli_exit_codes, 8);
    fputc('\n', out);
    cli_print_wrapped(out,
                      "An input or output of - is standard input or output. For a first surface: brio surface "
                      "points.ply -o surface.ply",
                      0, 0, cli_columns(out));
}

void cli_print_advice(FILE *out) {
    fputs("Which command and method fits which points:\n\n", out);
    for (const manual_entry *e = cli_advice; e->name; e++) print_entry(out, e->name, e->text, 2, 8);
    fputc('\n', out);
    cli_print_wrapped(out,
                      "What each guarantees, what it costs and how often it is right is in which-method.md, among "
                      "the documents that come with brio (docs/).",
                      0, 0, cli_columns(out));
}
