/* The completion of bash: commands, options, the words that options take, files by extension. It needs bash 4 and
 * nothing else. */
#include "cli/pages/pages.h"
#include <string.h>

static const char HEAD[] =
    "# bash completion of brio, made by its build from the tables of the command line.\n\n"
    "# Files with one of these extensions, and folders; without extensions all files.\n"
    "_brio_files() {\n"
    "    local file extension\n"
    "    compopt -o filenames 2>/dev/null\n"
    "    while IFS= read -r file; do\n"
    "        extension=${file##*.}\n"
    "        [[ -d ${file/#\\~/$HOME} || -z $1 || \" $1 \" == *\" ${extension,,} \"* ]] && COMPREPLY+=(\"$file\")\n"
    "    done < <(compgen -f -- \"$cur\")\n"
    "}\n\n"
    "_brio_folders() {\n"
    "    compopt -o filenames 2>/dev/null\n"
    "    mapfile -t COMPREPLY < <(compgen -d -- \"$cur\")\n"
    "}\n\n"
    "_brio_words() {\n"
    "    mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$cur\")\n"
    "}\n\n"
    "_brio() {\n"
    "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}\n"
    "    COMPREPLY=()\n"
    "    if [[ $cur == = ]]; then\n"
    "        cur=\n"
    "    elif [[ $prev == = ]]; then\n"
    "        prev=${COMP_WORDS[COMP_CWORD - 2]}\n"
    "    fi\n";

static void write_commands(FILE *out) {
    for (size_t i = 0; cli_commands[i]; i++) fprintf(out, "%s ", cli_commands[i]->name);
}

/* Writes what stands behind an option that takes a value. */
static void write_values(FILE *out, const command *c, const option *row) {
    char extensions[BRIO_FORMAT_LIST];
    pages_list_extensions(c, row, extensions);
    if (!row->value || row->kind & OPTION_OPTIONAL) return; /* a file may stand behind it */
    fprintf(out, "    %s:--%s", c->name, row->name);
    if (row->letter) fprintf(out, " | %s:-%c", c->name, row->letter);
    fputs(") ", out);
    if (cli_has_choices(row)) {
        const char *word;
        fputs("_brio_words \"", out);
        for (size_t i = 0; (word = cli_choice_name(row, i)); i++) fprintf(out, "%s ", word);
        fputs("\"", out);
    } else if (!strcmp(row->value, "EXT")) {
        fprintf(out, "_brio_words \"%s\"", extensions);
    } else if (!strcmp(row->value, "DIR")) {
        fputs("_brio_folders", out);
    } else if (!strcmp(row->value, "FILE")) {
        fprintf(out, "_brio_files \"%s\"", extensions);
    } else {
        fputs(":", out);
    }
    fputs("; return ;;\n", out);
}

static void write_all_values(FILE *out, const command *c, const option *rows) {
    for (; rows->kind; rows++)
        if (cli_is_option(rows)) write_values(out, c, rows);
}

static void write_names(FILE *out, const option *rows) {
    for (; rows->kind; rows++)
        if (cli_is_option(rows)) fprintf(out, "--%s ", rows->name);
}

/* Writes a command: options where a dash was typed, else operands. */
static void write_command(FILE *out, const command *c) {
    fprintf(out, "    %s)\n        if [[ $cur == -* ]]; then\n            _brio_words \"", c->name);
    write_names(out, c->options);
    write_names(out, cli_common_options);
    fputs("--help\"\n        else\n            ", out);
    if (c->choices) {
        fputs("_brio_words \"", out);
        for (const option_choice *choice = c->choices; choice->name; choice++) fprintf(out, "%s ", choice->name);
        fputs("\"\n", out);
    } else {
        char inputs[BRIO_FORMAT_LIST];
        pages_list_inputs(c, inputs);
        fprintf(out, "_brio_files \"%s\"\n", inputs);
    }
    fputs("        fi\n        ;;\n", out);
}

void pages_write_bash(FILE *out) {
    fputs(HEAD, out);
    fputs("    if ((COMP_CWORD == 1)); then\n        _brio_words \"", out);
    write_commands(out);
    fputs("help --help --version\"\n        return\n    fi\n    case ${COMP_WORDS[1]}:$prev in\n", out);
    for (size_t i = 0; cli_commands[i]; i++) {
        write_all_values(out, cli_commands[i], cli_commands[i]->options);
        write_all_values(out, cli_commands[i], cli_common_options);
    }
    fputs("    esac\n    case ${COMP_WORDS[1]} in\n    help) _brio_words \"", out);
    write_commands(out);
    fputs("methods formats\" ;;\n", out);
    for (size_t i = 0; cli_commands[i]; i++) write_command(out, cli_commands[i]);
    fputs("    esac\n}\n\ncomplete -F _brio brio\n", out);
}
