/* Folders that get their names when they are complete: see new_file.h.
 *
 * The older folder is the one that the older index names for its first file. Of it, files 0.EXT, 1.EXT and so on are
 * removed, and the folder if it is then empty. */
#include "cli/files/new_file.h"
#include "platform/disk.h"
#include "platform/folder.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 10, HEAD_BYTES = 1 << 14 };

static void name_of(const new_folder *f, int number, char path[BRIO_PATH_MOST]) {
    if (number)
        snprintf(path, BRIO_PATH_MOST, "%s-%d", f->stem, number);
    else
        snprintf(path, BRIO_PATH_MOST, "%s", f->stem);
}

static const char *escape_of(char c) {
    return c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : NULL;
}

void cli_write_attribute(FILE *file, const char *text) {
    for (; *text; text++) {
        if (escape_of(*text))
            fputs(escape_of(*text), file);
        else
            fputc(*text, file);
    }
}

/* Returns whether a text of XML names the file 0.EXT in a folder. */
static bool is_named_in(const char *text, const char *folder, const char *extension) {
    char quoted[6 * BRIO_NAME_MOST + 64] = "=\"", *end = quoted + 2;
    const char *name = folder + brio_folder_length(folder);
    if (strlen(name) >= BRIO_NAME_MOST) return false;
    for (; *name; name++) {
        const char *escape = escape_of(*name);
        end += snprintf(end, 8, "%s", escape ? escape : (char[2]){*name, 0});
    }
    snprintf(end, 64, "/0%s\"", extension);
    return strstr(text, quoted) != NULL;
}

/* Finds the folder of the index that is there now. */
static void find_old(const char *index, new_folder *f) {
    char *head = calloc(1, HEAD_BYTES + 1);
    int file = brio_open_input(index);
    if (head && file >= 0 && brio_read_bytes_at(file, head, HEAD_BYTES, 0) > 0)
        for (int i = 0; i < MOST_NAMES && !*f->old; i++) {
            name_of(f, i, f->old);
            if (!is_named_in(head, f->old, f->extension)) *f->old = 0;
        }
    if (file >= 0) brio_close(file);
    free(head);
}

static void remove_files(const char *folder, const char *extension) {
    char path[BRIO_PATH_MOST + 64];
    bool removed = true;
    for (int i = 0; removed; i++) {
        snprintf(path, sizeof path, "%s/%d%s", folder, i, extension);
        removed = brio_remove_file(path);
    }
    brio_remove_folder(folder);
}

brio_status cli_new_folder_open(run *r, const char *index, const char *extension, new_folder *out) {
    bool made;
    const char *dot = strrchr(index, '.');
    size_t stem = dot ? (size_t)(dot - index) : strlen(index);
    *out = (new_folder){.extension = extension};
    if (stem >= sizeof out->stem) return cli_fail_output(r, "%s: the name is too long", index);
    memcpy(out->stem, index, stem);
    find_old(index, out);
    snprintf(out->path, sizeof out->path, "%s.part", out->stem);
    remove_files(out->path, extension);
    if (!brio_make_folder(out->path, false, &made)) {
        brio_status status = cli_fail(r, BRIO_ERR_WRITE, "%s: cannot make the folder: %s", out->path, strerror(errno));
        *out->path = 0;
        return status;
    }
    return BRIO_OK;
}

brio_status cli_new_folder_name(run *r, new_folder *f) {
    char path[BRIO_PATH_MOST];
    for (int i = 0; i < MOST_NAMES; i++) {
        name_of(f, i, path);
        if (brio_is_there(path)) continue;
        if (!brio_rename_file(f->path, path))
            return cli_fail(r, BRIO_ERR_WRITE, "%s: cannot name it %s: %s", f->path, path, strerror(errno));
        memcpy(f->path, path, sizeof path);
        return BRIO_OK;
    }
    return cli_fail(r, BRIO_ERR_WRITE, "%s, and folders of that name from -1 to -%d: they are there: remove some",
                    f->stem, MOST_NAMES - 1);
}

void cli_new_folder_close(new_folder *f, bool published) {
    const char *goes = published ? f->old : f->path;
    if (*goes) remove_files(goes, f->extension);
    *f->path = 0;
}
