/* Manual pages in the language of man(7). */
#include "cli/report/glossary.h"
#include "cli/help/help.h"
#include "cli/pages/pages.h"
#include <ctype.h>
#include <string.h>

/* Writes text as it is: no letter of it is a request or a typographic sign. */
static void put(FILE *out, const char *text, size_t length) {
    static const char *const signs[][2] = {{"-", "\\-"},   {"\\", "\\e"},  {"'", "\\(aq"}, {"`", "\\(ga"},
                                           {"^", "\\(ha"}, {"~", "\\(ti"}, {"\"", "\\(dq"}};
    for (size_t i = 0; i < length; i++) {
        const char *sign = NULL;
        for (size_t k = 0; k < sizeof signs / sizeof *signs; k++)
            if (text[i] == signs[k][0][0]) sign = signs[k][1];
        if (sign)
            fputs(sign, out);
        else
            fputc(text[i], out);
    }
}

/* Writes a paragraph, in lines of some sixty letters; a dot at the beginning of a line would be a request. */
static void put_line(FILE *out, const char *text) {
    enum { LONGEST = 60 };
    for (size_t at = 0; *text;) {
        size_t length = strcspn(text, " ");
        if (at > 0 && at + length > LONGEST) {
            fputc('\n', out);
            at = 0;
        } else if (at > 0) {
            fputc(' ', out);
        }
        if (at == 0 && *text == '.') fputs("\\&", out);
        put(out, text, length);
        at += length + 1;
        text += length + strspn(text + length, " ");
    }
    fputc('\n', out);
}

static void put_title(FILE *out, const char *macro, const char *title) {
    fprintf(out, ".%s \"", macro);
    for (const char *t = title; *t; t++) fputc(macro[1] == 'H' ? toupper((unsigned char)*t) : *t, out);
    fputs("\"\n", out);
}

static void put_term(FILE *out, const char *term, const char *meaning) {
    fputs(".TP\n\\fB", out);
    put(out, term, strlen(term));
    fputs("\\fR\n", out);
    put_line(out, meaning);
}

static void put_entries(FILE *out, const manual_entry *entries) {
    for (; entries->name; entries++) put_term(out, entries->name, entries->text);
}

static void put_header(FILE *out, const char *name, const char *date, const char *summary) {
    fputs(".\\\" Made by the build of brio from the tables of the command line.\n.TH \"", out);
    for (const char *n = name; *n; n++) {
        const char upper = (char)toupper((unsigned char)*n);
        put(out, &upper, 1);
    }
    fprintf(out, "\" 1 %s \"brio " BRIO_VERSION "\" \"brio manual\"\n.SH NAME\n", date);
    put(out, name, strlen(name));
    fputs(" \\- ", out);
    put_line(out, summary);
}

/* --- options --- */

static void put_option(FILE *out, const option *row) {
    char choices[512] = "";
    fputs(".TP\n", out);
    if (row->letter) fprintf(out, "\\fB\\-%c\\fR, ", row->letter);
    fputs("\\fB\\-\\-", out);
    put(out, row->name, strlen(row->name));
    fputs("\\fR", out);
    if (row->value) fprintf(out, " \\fI%s\\fR", row->value);
    fputc('\n', out);
    if (cli_has_choices(row) && row[1].kind != OPTION_NOTE) {
        char meaning[1024];
        cli_list_words(cli_choice_name, row, choices, sizeof choices);
        snprintf(meaning, sizeof meaning, "%s; one of %s", row->meaning, choices);
        put_line(out, meaning);
    } else {
        put_line(out, row->meaning);
    }
}

/* Writes what the methods among the choices of a row are good for. Returns whether there are any. */
static bool put_words(FILE *out, const option *row) {
    const char *words;
    option_choice c;
    bool any = false;
    for (size_t i = 0; cli_has_choices(row) && (c = cli_choice(row, i, &words)).name; i++) {
        if (!words) continue;
        if (!any) fputs(".RS\n", out);
        put_term(out, c.name, words);
        any = true;
    }
    return any;
}

static void put_options(FILE *out, const option *rows) {
    bool in_notes = false;
    for (const option *row = rows; row->kind; row++) {
        bool note = row->kind == OPTION_NOTE;
        if (note && !in_notes) fputs(".RS\n", out);
        if (!note && in_notes) fputs(".RE\n", out);
        in_notes = note;
        if (note)
            put_term(out, row->name, row->meaning);
        else if (row->kind == OPTION_TITLE)
            put_title(out, "SS", row->meaning);
        else
            put_option(out, row), in_notes = put_words(out, row);
    }
    if (in_notes) fputs(".RE\n", out);
}

/* --- the report --- */

static bool is_first(const glossary_line *line, const char *name, const char *parent) {
    return cli_glossary_fits(line, name, parent) && cli_glossary_find(name, parent, line->key) == line;
}

static void put_lines(FILE *out, const char *name, const char *parent, line_level level) {
    for (const glossary_line *line = cli_glossary; line->key; line++) {
        char label[64];
        if (!is_first(line, name, parent) || (line->level != level && !(parent && level != LINE_JSON))) continue;
        cli_glossary_label(line, line->key, label, sizeof label);
        fputs(".TP\n\\fB", out);
        put(out, label, strlen(label));
        fputs("\\fR", out);
        if (strcmp(label, line->key)) fprintf(out, ", in JSON \\fB%s\\fR", line->key);
        fputc('\n', out);
        put_line(out, line->meaning);
        if (parent || (strcmp(line->key, "certificate") && strcmp(line->key, "sampling"))) continue;
        fputs(".RS\n", out);
        put_lines(out, name, line->key, level);
        fputs(".RE\n", out);
    }
}

static bool has_lines(const char *name, line_level level) {
    for (const glossary_line *line = cli_glossary; line->key; line++)
        if (line->level == level && is_first(line, name, NULL)) return true;
    return false;
}

static void put_report(FILE *out, const char *name) {
    static const struct {
        line_level level;
        const char *title;
    } parts[] = {{LINE_PLAIN, "Always"},
                 {LINE_VERBOSE, "With \\-\\-verbose, and in JSON"},
                 {LINE_INTERNAL, "With \\-\\-verbose; in JSON members of the object internals"},
                 {LINE_JSON, "In JSON only"}};
    put_title(out, "SH", "Report");
    fputs("The report of a run stands on standard output,\nwarnings and hints on standard error.\n", out);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (!has_lines(name, parts[i].level)) continue;
        put_title(out, "SS", parts[i].title);
        put_lines(out, name, NULL, parts[i].level);
    }
}

/* --- pages --- */

static void put_extensions(FILE *out, const char *title, const char *extensions) {
    if (!*extensions) return;
    fprintf(out, ".PP\n%s\n", title);
    put_line(out, extensions);
}

static void put_examples(FILE *out, const char *examples) {
    put_title(out, "SH", "Examples");
    for (bool is_line = true; *examples; is_line = !is_line) {
        size_t length = strcspn(examples, "\n");
        if (is_line) fputs(".TP\n\\fB", out);
        put(out, examples, length);
        fputs(is_line ? "\\fR\n" : "\n", out);
        examples += length + (examples[length] == '\n');
    }
}

void pages_write_command_manual(FILE *out, const command *c, const char *date) {
    char name[64], inputs[BRIO_FORMAT_LIST], outputs[BRIO_FORMAT_LIST];
    cli_list_inputs(c, inputs);
    cli_list_outputs(c, outputs);
    snprintf(name, sizeof name, "brio-%s", c->name);
    put_header(out, name, date, c->summary);
    fprintf(out, ".SH SYNOPSIS\n.B brio %s\n.I %s\n", c->name, c->operands);
    if (c->has_output) fputs(c->output_optional ? "[\\fB\\-o\\fR \\fIFILE\\fR]\n" : ".B \\-o\n.I FILE\n", out);
    fputs("[options]\n.SH DESCRIPTION\n", out);
    put_line(out, c->description ? c->description : c->summary);
    put_extensions(out, "Reads", inputs);
    put_extensions(out, "Writes", outputs);
    if (c->options[0].kind) put_title(out, "SH", "Options");
    put_options(out, c->options);
    put_title(out, "SH", "Options of every command");
    put_options(out, cli_common_options);
    put_term(out, "-h, --help", "print the help");
    put_report(out, c->name);
    if (c->examples) put_examples(out, c->examples);
    put_title(out, "SH", "Exit status");
    fputs("See\n.BR brio (1).\n.SH SEE ALSO\n.BR brio (1)\n", out);
}

void pages_write_manual(FILE *out, const char *date) {
    put_header(out, "brio", date, "exact Delaunay triangulations, and surfaces from points");
    fputs(".SH SYNOPSIS\n.B brio\n.I COMMAND\n[options]\n.I INPUT\n.PP\n.B brio "
          "help\n[\\fICOMMAND\\fR|methods|formats]\n",
          out);
    put_title(out, "SH", "Commands");
    for (size_t i = 0; cli_commands[i]; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s", cli_commands[i]->name);
        put_term(out, name, cli_commands[i]->summary);
    }
    put_title(out, "SH", "Which command for which points");
    put_entries(out, cli_advice);
    put_title(out, "SH", "Options of every command");
    put_options(out, cli_common_options);
    put_term(out, "-h, --help", "print the help of a command");
    put_title(out, "SH", "Exit status");
    put_entries(out, cli_exit_codes);
    put_title(out, "SH", "Environment");
    put_term(out, "BRIO_INSTRUCTIONS",
             "plain, avx2 or avx512: the largest instruction set to use; results are the same");
    fputs(".SH SEE ALSO\n", out);
    for (size_t i = 0; cli_commands[i]; i++)
        fprintf(out, ".BR brio\\-%s (1)%s\n", cli_commands[i]->name, cli_commands[i + 1] ? "," : "");
}
