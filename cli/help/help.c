/* The help, made of the tables of the commands: their options, extensions, examples, and the lines of their reports. */
#include "cli/help/help.h"
#include "cli/run/commands.h"
#include "cli/report/glossary.h"
#include "platform/program.h"
#include <string.h>

const manual_entry cli_exit_codes[] = {
    {"0", "done"},
    {"1", "wrong usage"},
    {"2", "an input is missing, unreadable or malformed"},
    {"3", "the input has no answer, as the surface of three points has none"},
    {"4", "not enough memory, or over --max-memory"},
    {"5", "the result, or the file of `brio check`, does not check"},
    {"6", "the output could not be written"},
    {"130", "interrupted: at most half a second of processor time after the signal"},
    {NULL, NULL},
};

const manual_entry cli_advice[] = {
    {"brio surface IN -o OUT", "points of a surface, noisy or not; open where they end; no normals needed. Start here"},
    {"brio surface IN --method cocone -o OUT", "an open surface: a shell, a part of an object; clean points"},
    {"brio surface IN --closed -o OUT", "a scan with holes, to be closed all over"},
    {"brio surface IN --noise smooth -o OUT", "noise that you see but the report does not (`smoothed`)"},
    {"brio surface IN --sharp -R 0.4 -o OUT", "machine parts whose sharp edges have no points on them"},
    {"brio surface IN --method tight-cocone -o OUT", "clean, dense points of a closed object: all of them vertices"},
    {"brio surface IN --method cocone --pieces 30 -o OUT", "more points than memory; clean ones"},
    {"brio delaunay IN --plane xy -o OUT", "terrain: one height at each place, as from the air"},
    {"brio alpha IN --alpha auto -o OUT", "points throughout a volume, not only on its surface"},
    {"brio hull IN -o OUT", "the convex hull"},
    {"brio iso MAP --level L -o OUT", "values on a grid, or atoms, and not points of a surface"},
    {"brio medial IN -o OUT", "the medial axis: the balls that fill the object"},
    {"brio balls AXIS -o OUT", "the union of these balls: its volume, its area, its surface"},
    {"brio offset IN --distance D -o OUT", "the surface at a distance from the object"},
    {NULL, NULL},
};

const char *const cli_group_titles[] = {"meshes and files", "surfaces", "triangulations and cells", NULL};

/* --- lines --- */

enum { USUAL = 80, MOST = 100, FEWEST = 30, COLUMN = 28, NARROW = 60 };

int cli_columns(FILE *out) {
    int columns = brio_terminal_columns(out);
    return columns == 0 ? USUAL : columns > MOST ? MOST : columns < FEWEST ? FEWEST : columns;
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

void cli_print_entry(FILE *out, const char *term, const char *meaning, int left, int column) {
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
    for (; entries->name; entries++) cli_print_entry(out, entries->name, entries->text, 2, column);
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
    cli_print_entry(out, left, meaning, 2, COLUMN);
}

/* Prints what the methods among the choices of a row are good for. */
static void print_words(FILE *out, const option *row) {
    const char *words;
    option_choice c;
    for (size_t i = 0; cli_has_choices(row) && (c = cli_choice(row, i, &words)).name; i++)
        if (words) cli_print_entry(out, c.name, words, 6, COLUMN);
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
            cli_print_entry(out, row->name, row->meaning, indent, COLUMN);
        else
            print_option(out, row), print_words(out, row);
    }
}

/* --- one command --- */

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
        cli_print_entry(out, label, line->meaning, left, COLUMN);
        if (!parent) print_glossary(out, name, line->key, left + 2);
    }
}

void cli_print_command_help(FILE *out, const command *c, bool verbose) {
    char usage[128], inputs[BRIO_FORMAT_LIST], outputs[BRIO_FORMAT_LIST];
    const char *output = !c->has_output ? "" : c->output_optional ? " [-o FILE]" : " -o FILE";
    snprintf(usage, sizeof usage, "usage: brio %s %s%s [options]", c->name, c->operands, output);
    cli_print_wrapped(out, usage, 0, 4, cli_columns(out));
    fputc('\n', out);
    cli_print_wrapped(out, c->summary, 0, 0, cli_columns(out));
    if (c->description) {
        fputc('\n', out);
        cli_print_wrapped(out, c->description, 0, 0, cli_columns(out));
    }
    fputc('\n', out);
    cli_list_inputs(c, inputs);
    cli_list_outputs(c, outputs);
    if (*inputs) cli_print_entry(out, "reads:", inputs, 0, 10);
    if (*outputs) cli_print_entry(out, "writes:", outputs, 0, 10);
    print_options(out, "options", c->options);
    print_options(out, "options of every command", cli_common_options);
    cli_print_entry(out, "-h, --help", "print this", 2, COLUMN);
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
            cli_print_entry(out, cli_commands[i]->name, cli_commands[i]->summary, 2, 15);
}

void cli_print_help(FILE *out) {
    static const int order[] = {GROUP_SURFACES, GROUP_TRIANGULATIONS, GROUP_FILES};
    fputs("brio " BRIO_VERSION ": exact Delaunay triangulations, and surfaces from points\n\n"
          "usage: brio COMMAND [options] INPUT\n",
          out);
    for (int i = 0; i < 3; i++) print_commands(out, order[i]);
    fputs("\nhelp:\n", out);
    cli_print_entry(out, "brio help COMMAND", "the options of a command, with examples; also brio COMMAND --help", 2,
                    COLUMN);
    cli_print_entry(out, "brio help methods", "which command and method fits which points", 2, COLUMN);
    cli_print_entry(out, "brio help formats", "the formats of files, and what each holds; with --json for programs", 2,
                    COLUMN);
    cli_print_entry(out, "brio --version", "the version; also brio -V", 2, COLUMN);
    print_entries(out, "exit codes", cli_exit_codes, 8);
    fputc('\n', out);
    cli_print_wrapped(out,
                      "An input or output of - is standard input or output. For a first surface: brio surface "
                      "points.ply -o surface.ply",
                      0, 0, cli_columns(out));
}

void cli_print_advice(FILE *out) {
    fputs("Which command and method fits which points:\n\n", out);
    for (const manual_entry *e = cli_advice; e->name; e++) cli_print_entry(out, e->name, e->text, 2, 8);
    fputc('\n', out);
    cli_print_wrapped(out,
                      "What each guarantees, what it costs and how often it is right is in which-method.md, among "
                      "the documents that come with brio (docs/).",
                      0, 0, cli_columns(out));
}
