/* brio-pages FOLDER DATE: writes man1/brio.1 and its like, bash/brio and zsh/_brio below a folder that has these three
 * folders. It is built and run with brio and not installed. */
#include "cli/pages/pages.h"
#include <errno.h>
#include <string.h>

/* Takes the dots off a list of extensions. */
static void drop_dots(char *text) {
    char *to = text;
    for (const char *from = text; *from; from++)
        if (*from != '.') *to++ = *from;
    *to = 0;
}

void pages_list_inputs(const command *c, char *text) {
    cli_list_inputs(c, text);
    drop_dots(text);
}

void pages_list_extensions(const command *c, const option *row, char *text) {
    text[0] = 0;
    if (!strcmp(row->name, "output") || !strcmp(row->name, "format")) cli_list_outputs(c, text);
    if (!strcmp(row->name, "input-format")) cli_list_inputs(c, text);
    drop_dots(text);
}

/* Opens a page. Returns NULL, with a message, when the file cannot be written. */
static FILE *open_page(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *out = fopen(path, "w");
    if (!out) fprintf(stderr, "brio-pages: %s: %s\n", path, strerror(errno));
    return out;
}

static bool close_page(FILE *out) {
    bool written = !ferror(out);
    if (fclose(out) == 0 && written) return true;
    fprintf(stderr, "brio-pages: %s\n", strerror(errno));
    return false;
}

static bool write_manuals(const char *folder, const char *date) {
    FILE *out = open_page(folder, "man1/brio.1");
    if (!out) return false;
    pages_write_manual(out, date);
    bool written = close_page(out);
    for (size_t i = 0; cli_commands[i] && written; i++) {
        char name[64];
        snprintf(name, sizeof name, "man1/brio-%s.1", cli_commands[i]->name);
        out = open_page(folder, name);
        if (!out) return false;
        pages_write_command_manual(out, cli_commands[i], date);
        written = close_page(out);
    }
    return written;
}

static bool write_completion(const char *folder, const char *name, void (*write)(FILE *out)) {
    FILE *out = open_page(folder, name);
    if (!out) return false;
    write(out);
    return close_page(out);
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fputs("usage: brio-pages FOLDER DATE\n", stderr);
        return 1;
    }
    bool written = write_manuals(argv[1], argv[2]) && write_completion(argv[1], "bash/brio", pages_write_bash) &&
                   write_completion(argv[1], "zsh/_brio", pages_write_zsh);
    return written ? 0 : 1;
}
