/* Folders that get their names when they are complete: see new_file.h.
 *
 * The older folder is the one that the older index names for its first file. Of it, the files that the index names are
 * removed, and the folder if it is then empty. */
#include "cli/files/new_file.h"
#include "platform/disk.h"
#include "platform/folder.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 10, MOST_FILES = 1 << 16, MOST_INDEX = 1 << 24 /* bytes */ };

static const char MARK[] = ".brio-part", ROWS[] = ".rows";

static void name_of(const new_folder *f, int number, char path[BRIO_PATH_MOST]) {
    if (number)
        snprintf(path, BRIO_PATH_MOST, "%s-%d", f->stem, number);
    else
        snprintf(path, BRIO_PATH_MOST, "%s", f->stem);
}

static void part_of(const new_folder *f, char path[BRIO_PATH_MOST]) {
    snprintf(path, BRIO_PATH_MOST, "%s.part", f->stem);
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

/* --- the older output --- */

/* Returns the text behind the name of file `number` in a folder, or NULL if a text of XML does not have it. */
static const char *after_name(const char *text, const char *folder, uint32_t number, const char *extension) {
    char quoted[6 * BRIO_NAME_MOST + 64] = "=\"", *end = quoted + 2;
    const char *name = folder + brio_folder_length(folder);
    if (strlen(name) >= BRIO_NAME_MOST) return NULL;
    for (; *name; name++) {
        const char *escape = escape_of(*name);
        end += snprintf(end, 8, "%s", escape ? escape : (char[2]){*name, 0});
    }
    snprintf(end, 64, "/%u%s\"", number, extension);
    const char *found = strstr(text, quoted);
    return found ? found + strlen(quoted) : NULL;
}

/* Reads an index. Returns NULL if it cannot be read. */
static char *read_index(const char *index) {
    char *text = calloc(1, MOST_INDEX + 1);
    int file = brio_open_input(index);
    uint64_t size = 0;
    for (int64_t n = 1; text && file >= 0 && n > 0 && size<MOST_INDEX; size += n> 0 ? (uint64_t)n : 0)
        n = brio_read_bytes_at(file, text + size, (size_t)(MOST_INDEX - size), size);
    if (file >= 0) brio_close(file);
    if (size) return text;
    free(text);
    return NULL;
}

/* Finds the folder of the index that is there now, and how many files of it the index names. */
static void find_old(const char *index, new_folder *f) {
    char *text = read_index(index);
    for (int i = 0; text && i < MOST_NAMES && !*f->old; i++) {
        name_of(f, i, f->old);
        const char *rest = text;
        while (f->num_old < MOST_FILES && (rest = after_name(rest, f->old, f->num_old, f->extension)) != NULL)
            f->num_old++;
        if (!f->num_old) *f->old = 0;
    }
    free(text);
}

/* --- folders of runs --- */

static void mark_of(const char *folder, char path[BRIO_PATH_MOST + 64]) {
    snprintf(path, BRIO_PATH_MOST + 64, "%s/%s", folder, MARK);
}

/* Removes the files 0.EXT, 1.EXT and so on, those that are there of the first `most`: processes that write them side by
 * side leave gaps. */
static void remove_files(const char *folder, const char *extension, uint32_t most) {
    char path[BRIO_PATH_MOST + 64];
    for (uint32_t i = 0; i < most; i++) {
        snprintf(path, sizeof path, "%s/%u%s", folder, i, extension);
        brio_remove_file(path);
    }
}

/* Removes what a killed run left; nothing of a folder that is another's. */
static void remove_left(const char *folder, const new_folder *f) {
    char mark[BRIO_PATH_MOST + 64];
    mark_of(folder, mark);
    int lock = brio_is_there(mark) ? brio_lock_file(mark) : -1;
    if (lock < 0) return;
    remove_files(folder, f->extension, f->most);
    brio_unlock_file(lock, mark);
    brio_remove_folder(folder);
}

/* Removes all that killed runs left beside an index. */
static void remove_all_left(const new_folder *f) {
    char path[BRIO_PATH_MOST];
    part_of(f, path);
    remove_left(path, f);
    for (int i = 0; i < MOST_NAMES; i++) {
        name_of(f, i, path);
        if (strcmp(path, f->old) != 0) remove_left(path, f);
    }
}

/* --- life --- */

static brio_status fail_folder(run *r, const char *path) {
    if (errno == EEXIST)
        return cli_fail(r, BRIO_ERR_WRITE,
                        "%s: is in the way: it is yours, or that of a run that goes on; move it, or take another -o",
                        path);
    return cli_fail(r, BRIO_ERR_WRITE, "%s: cannot make the folder: %s", path, strerror(errno));
}

static brio_status begin(run *r, const char *index, const char *extension, new_folder *f) {
    const char *dot = strrchr(index, '.');
    size_t stem = dot ? (size_t)(dot - index) : strlen(index);
    *f = (new_folder){.extension = extension, .most = MOST_FILES, .lock = -1};
    if (stem >= sizeof f->stem) return cli_fail_output(r, "%s: the name is too long", index);
    memcpy(f->stem, index, stem);
    find_old(index, f);
    remove_all_left(f);
    return BRIO_OK;
}

/* Finds a name that is free.   path  receives it. */
static brio_status find_name(run *r, const new_folder *f, char path[BRIO_PATH_MOST]) {
    for (int i = 0; i < MOST_NAMES; i++) {
        name_of(f, i, path);
        if (!brio_is_there(path)) return BRIO_OK;
    }
    return cli_fail(r, BRIO_ERR_WRITE, "%s, and folders of that name from -1 to -%d: they are there: remove some",
                    f->stem, MOST_NAMES - 1);
}

/* Fails if the folder STEM.part is there. */
static brio_status check_part(run *r, const new_folder *f) {
    char path[BRIO_PATH_MOST];
    part_of(f, path);
    errno = EEXIST;
    return brio_is_there(path) ? fail_folder(r, path) : BRIO_OK;
}

brio_status cli_new_folder_check(run *r, const char *index, const char *extension) {
    new_folder f;
    char path[BRIO_PATH_MOST];
    FORWARD(begin(r, index, extension, &f));
    FORWARD(find_name(r, &f, path));
    return check_part(r, &f);
}

/* Makes the folder STEM.part. */
static brio_status make_part(run *r, new_folder *out) {
    char mark[BRIO_PATH_MOST + 64];
    bool made;
    part_of(out, out->path);
    mark_of(out->path, mark);
    bool there = brio_make_folder(out->path, false, &made);
    if (there && !made) errno = EEXIST;
    if (there && made) out->lock = brio_lock_file(mark);
    if (out->lock >= 0) return BRIO_OK;
    brio_status status = fail_folder(r, out->path);
    if (made) brio_remove_folder(out->path);
    *out->path = 0;
    return status;
}

brio_status cli_new_folder_open(run *r, const char *index, const char *extension, new_folder *out) {
    FORWARD(begin(r, index, extension, out));
    return make_part(r, out);
}

brio_status cli_new_folder_name(run *r, new_folder *f) {
    char path[BRIO_PATH_MOST], mark[BRIO_PATH_MOST + 64];
    FORWARD(find_name(r, f, path));
    brio_close(f->lock); /* some systems rename no folder with an open file */
    bool renamed = brio_rename_file(f->path, path);
    int error = errno;
    mark_of(renamed ? path : f->path, mark);
    f->lock = brio_lock_file(mark);
    if (!renamed) return cli_fail(r, BRIO_ERR_WRITE, "%s: cannot name it %s: %s", f->path, path, strerror(error));
    memcpy(f->path, path, sizeof path);
    return f->lock >= 0 ? BRIO_OK : cli_fail(r, BRIO_ERR_WRITE, "%s: in use by another process", mark);
}

void cli_new_folder_close(new_folder *f, bool published) {
    char mark[BRIO_PATH_MOST + 64];
    if (f->lock >= 0) {
        if (!published) remove_files(f->path, f->extension, f->most);
        mark_of(f->path, mark);
        brio_unlock_file(f->lock, mark);
        if (!published) brio_remove_folder(f->path);
    }
    if (published && *f->old) {
        remove_files(f->old, f->extension, f->num_old);
        mark_of(f->old, mark);
        brio_remove_file(mark); /* of a run that was killed when its index was there */
        brio_remove_folder(f->old);
    }
    f->lock = -1;
    *f->path = 0;
}

/* --- outputs that are one file --- */

static brio_status begin_for(run *r, const char *output, new_folder *f) {
    char end[BRIO_PATH_MOST];
    *f = (new_folder){.extension = ROWS, .most = 1, .lock = -1};
    if (!brio_target_path(output, end)) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", output, strerror(errno));
    if (strlen(end) >= sizeof f->stem) return cli_fail_output(r, "%s: the name is too long", output);
    strcpy(f->stem, end);
    part_of(f, end);
    remove_left(end, f);
    return BRIO_OK;
}

brio_status cli_new_folder_open_for(run *r, const char *output, new_folder *out) {
    FORWARD(begin_for(r, output, out));
    return make_part(r, out);
}

brio_status cli_new_folder_check_for(run *r, const char *output) {
    new_folder f;
    FORWARD(begin_for(r, output, &f));
    return check_part(r, &f);
}

void cli_new_folder_file(const new_folder *f, char path[BRIO_PATH_MOST + 64]) {
    snprintf(path, BRIO_PATH_MOST + 64, "%s/0%s", f->path, ROWS);
}

brio_status cli_new_folder_adopt(run *r, const new_folder *f, const char *output) {
    char path[BRIO_PATH_MOST + 64];
    brio_target target;
    cli_new_folder_file(f, path);
    bool adopted = brio_target_find(&target, output) && brio_target_adopt(&target, path);
    int error = errno;
    brio_target_close(&target);
    return adopted ? BRIO_OK : cli_fail(r, BRIO_ERR_WRITE, "%s: %s", output, strerror(error));
}
