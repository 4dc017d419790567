/* The completion of zsh: a table of _arguments for each command. */
#include "cli/pages/pages.h"
#include <string.h>

/* Writes text within single quotes and brackets; a colon would end the text. */
static void put_text(FILE *out, const char *text) {
    for (; *text; text++) {
        if (strchr("[]:\\", *text)) fputc('\\', out);
        if (*text == '\'')
            fputs("'\\''", out);
        else
            fputc(*text, out);
    }
}

/* Writes ply|xyz, of "ply xyz". */
static void put_files(FILE *out, const char *extensions) {
    if (!*extensions) {
        fputs("_files", out);
        return;
    }
    fputs("_files -g \"*.(#i)(", out);
    for (const char *e = extensions; *e; e++) fputc(*e == ' ' ? '|' : *e, out);
    fputs(")(-.)\"", out);
}

/* Writes words in parentheses.   next  as cli_list_words takes it. */
static void put_choices(FILE *out, const char *(*next)(const void *list, size_t i), const void *list) {
    const char *word;
    fputc('(', out);
    for (size_t i = 0; (word = next(list, i)); i++) fprintf(out, "%s%s", i == 0 ? "" : " ", word);
    fputc(')', out);
}

static void put_value(FILE *out, const command *c, const option *row) {
    char extensions[BRIO_FORMAT_LIST];
    if (!row->value) return;
    pages_list_extensions(c, row, extensions);
    fputs(row->kind & OPTION_OPTIONAL ? "::" : ":", out);
    put_text(out, row->value);
    fputc(':', out);
    if (cli_has_choices(row))
        put_choices(out, cli_choice_name, row);
    else if (!strcmp(row->value, "FILE"))
        put_files(out, extensions);
    else if (!strcmp(row->value, "DIR"))
        fputs("_files -/", out);
    else if (!strcmp(row->value, "EXT"))
        fprintf(out, "(%s)", extensions);
    else
        fputc(' ', out);
}

static void put_options(FILE *out, const command *c, const option *rows) {
    for (const option *row = rows; row->kind; row++) {
        if (!cli_is_option(row)) continue;
        if (row->letter) fprintf(out, "            '-%c+[", row->letter), put_text(out, row->meaning), fputc(']', out);
        if (row->letter) put_value(out, c, row), fputs("' \\\n", out);
        fprintf(out, "            '--%s%s[", row->name, row->value ? "=" : "");
        put_text(out, row->meaning);
        fputc(']', out);
        put_value(out, c, row);
        fputs("' \\\n", out);
    }
}

static void put_command(FILE *out, const command *c) {
    char inputs[BRIO_FORMAT_LIST];
    pages_list_inputs(c, inputs);
    fprintf(out, "    %s)\n        _arguments \\\n", c->name);
    put_options(out, c, c->options);
    put_options(out, c, cli_common_options);
    fputs("            '--help[print the help]' \\\n            '*:", out);
    put_text(out, c->operands);
    fputc(':', out);
    if (c->choices)
        put_choices(out, cli_choice_name, &(option){.kind = OPTION_CHOICE, .choices = c->choices});
    else
        put_files(out, inputs);
    fputs("'\n        ;;\n", out);
}

void pages_write_zsh(FILE *out) {
    fputs("#compdef brio\n# Made by the build of brio from the tables of the command line.\n\n"
          "_brio() {\n    local -a commands\n    commands=(\n",
          out);
    for (size_t i = 0; cli_commands[i]; i++) {
        fprintf(out, "        '%s:", cli_commands[i]->name);
        put_text(out, cli_commands[i]->summary);
        fputs("'\n", out);
    }
    fputs("        'help:the help of a command, of methods, or of formats'\n    )\n"
          "    if ((CURRENT == 2)); then\n        _describe command commands\n        return\n    fi\n"
          "    local name=$words[2]\n    shift words\n    ((CURRENT--))\n    case $name in\n"
          "    help) _describe command commands ;;\n",
          out);
    for (size_t i = 0; cli_commands[i]; i++) put_command(out, cli_commands[i]);
    fputs("    esac\n}\n\n_brio \"$@\"\n", out);
}
