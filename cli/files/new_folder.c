/* Folders that get their names when they are complete: see new_file.h.
 *
 * The older folder is the one that the older index names for its first file. Of it, the files that the index names are
 * removed, and the folder if it is then empty. A link that has the name of a folder was laid by the user: nothing is
 * removed through it. */
#include "cli/files/files.h"
#include "cli/files/new_file.h"
#include "platform/disk.h"
#include "platform/folder.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { MOST_NAMES = 10, MOST_FILES = 1 << 16, MOST_INDEX = 1 << 28 /* bytes */ };

static const char MARK[] = ".brio-part", ROWS[] = ".rows";

static void name_of(const new_folder *f, int number, char path[BRIO_PATH_MOST]) {
    if (number)
        snprintf(path, BRIO_PATH_MOST, "%s-%d", f->stem, number);
    else
        snprintf(path, BRIO_PATH_MOST, "%s", f->stem);
}

/* Stores how an index has a character of a name.   json  whether it is JSON, else it is XML. */
static void quote(char c, bool json, char quoted[8]) {
    const char *escape = c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : NULL;
    bool space = c == '\t' || c == '\n' || c == '\r'; /* readers of attributes make blanks of them */
    if (json && (unsigned char)c < ' ')
        snprintf(quoted, 8, "\\u%04x", (unsigned char)c);
    else if (json && (c == '"' || c == '\\'))
        snprintf(quoted, 8, "\\%c", c);
    else if (space)
        snprintf(quoted, 8, "&#%d;", c);
    else
        snprintf(quoted, 8, "%s", !json && escape ? escape : (char[2]){c, 0});
}

static void part_of(const new_folder *f, char path[BRIO_PATH_MOST]) {
    snprintf(path, BRIO_PATH_MOST, "%s.part", f->stem);
}

void cli_write_attribute(FILE *file, const char *text) {
    char quoted[8];
    for (; *text; text++) {
        quote(*text, false, quoted);
        fputs(quoted, file);
    }
}

void cli_write_text_of_json(FILE *file, const char *text) {
    char quoted[8];
    for (; *text; text++) {
        quote(*text, true, quoted);
        fputs(quoted, file);
    }
}

/* --- the older output --- */

/* Returns the text behind the name of file `number` in the folder f->old, up to where its extension begins, or NULL if
 * the text of an index does not have it. */
static const char *after_name(const char *text, const new_folder *f, uint32_t number) {
    char quoted[6 * BRIO_NAME_MOST + 64], *end = quoted;
    const char *name = f->old + brio_folder_length(f->old);
    if (strlen(name) >= BRIO_NAME_MOST) return NULL;
    end += snprintf(end, 8, "%s", f->json ? "\"./" : "=\"");
    for (; *name; name++) {
        quote(*name, f->json, end);
        end += strlen(end);
    }
    snprintf(end, 64, "/%u.", number);
    const char *found = strstr(text, quoted);
    return found ? found + strlen(quoted) - 1 : NULL;
}

/* Reads an index. Returns NULL if it cannot be read. */
static char *read_index(const char *index) {
    brio_place_facts of_file;
    int file = brio_open_input(index);
    uint64_t size = 0;
    bool found = file >= 0 && brio_find_facts_open(file, &of_file) && of_file.size < MOST_INDEX;
    char *text = found ? calloc(1, (size_t)of_file.size + 1) : NULL;
    int64_t n = 1;
    while (text && n > 0 && size != of_file.size) {
        n = brio_read_bytes_at(file, text + size, (size_t)(of_file.size - size), size);
        if (n > 0) size += (uint64_t)n;
    }
    if (file >= 0) brio_close(file);
    if (size) return text;
    free(text);
    return NULL;
}

/* Takes the extension that a name in an index goes on with. Returns false if it is another one than that of the files
 * before, or none. */
static bool take_extension(new_folder *f, const char *rest) {
    size_t size = strcspn(rest, "\"");
    if (size >= sizeof f->old_extension || strcspn(rest, "/\\") < size) return false;
    if (!f->num_old) snprintf(f->old_extension, sizeof f->old_extension, "%.*s", (int)size, rest);
    return size == strlen(f->old_extension) && !strncmp(rest, f->old_extension, size);
}

/* Returns whether brio wrote an index. The files that another program's index names are the user's. */
static bool is_of_brio(const char *text, bool json) {
    return json ? !strncmp(text, CLI_JSON_HEAD, strlen(CLI_JSON_HEAD)) : strstr(text, CLI_XML_HEAD) != NULL;
}

/* Finds the folder of the index that is there now, and how many files of it the index names. */
static void find_old(new_folder *f) {
    char *text = brio_is_link(f->index) ? NULL : read_index(f->index);
    bool ours = text && is_of_brio(text, f->json);
    for (int i = 0; ours && i < MOST_NAMES && !*f->old; i++) {
        name_of(f, i, f->old);
        const char *rest = text;
        while (f->num_old < MOST_FILES && (rest = after_name(rest, f, f->num_old)) != NULL && take_extension(f, rest))
            f->num_old++;
        if (!f->num_old || brio_is_link(f->old)) *f->old = 0;
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

/* Makes the mark of a folder, which says how many files of which extension there may be, and locks it. Returns -1 if it
 * cannot. */
static int make_mark(const char *mark, const char *extension, uint32_t files) {
    char text[48];
    int lock = brio_lock_file(mark);
    int length = snprintf(text, sizeof text, "%5" PRIu32 " %-15s", files, extension);
    if (lock >= 0) (void)brio_write_bytes_at(lock, text, (size_t)length, 0);
    return lock;
}

/* Removes what a killed run left; nothing of a folder that is another's.   f  says how many files of which extension
 * there may be where the run was killed before its mark did. */
static void remove_left(const char *folder, const new_folder *f) {
    char mark[BRIO_PATH_MOST + 64], text[48] = "", of_run[16] = "";
    uint32_t files = 0;
    mark_of(folder, mark);
    int lock = brio_is_there(mark) && !brio_is_link(folder) ? brio_lock_file(mark) : -1;
    if (lock < 0) return;
    (void)brio_read_bytes_at(lock, text, sizeof text - 1, 0);
    bool known = sscanf(text, "%" SCNu32 " %15s", &files, of_run) == 2 && *of_run == '.' && !strchr(of_run, '/');
    if (!known || files > MOST_FILES) files = f->most_files;
    remove_files(folder, known ? of_run : f->extension, files);
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

/* Returns the extension of a path's name with its dot, or the end of the path. */
static const char *extension_of(const char *path) {
    const char *name = path + brio_folder_length(path), *dot = strrchr(name, '.');
    return dot && dot > name ? dot : name + strlen(name);
}

static brio_status begin(run *r, const char *index, const char *extension, new_folder *f) {
    const char *given = extension_of(index);
    *f = (new_folder){
        .extension = extension, .most_files = MOST_FILES, .lock = -1, .json = !strcasecmp(given, CLI_JSON_INDEX)};
    if (!brio_target_path(index, f->index)) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", index, strerror(errno));
    const char *end = extension_of(f->index);
    size_t stem = (size_t)(end - f->index);
    if (strcasecmp(given, end) != 0)
        return cli_fail_output(r, "%s: a link to %s, which is no name of a %s file", index, f->index, given);
    if (stem >= sizeof f->stem) return cli_fail_output(r, "%s: the name is too long", index);
    memcpy(f->stem, f->index, stem);
    find_old(f);
    remove_all_left(f);
    return BRIO_OK;
}

/* Finds a name that is free.   path  receives it. */
static brio_status find_name(run *r, const new_folder *f, char path[BRIO_PATH_MOST]) {
    for (int i = 0; i < MOST_NAMES; i++) {
        name_of(f, i, path);
        if (!brio_is_there(path) && !brio_is_link(path)) return BRIO_OK;
    }
    return cli_fail(r, BRIO_ERR_WRITE, "%s, and folders of that name from -1 to -%d: they are there: remove some",
                    f->stem, MOST_NAMES - 1);
}

/* Refuses inputs that are in the folder of the older output, which goes when the new one is complete. */
static brio_status refuse_old_inputs(run *r, const new_folder *f) {
    char input[BRIO_PATH_MOST], folder[BRIO_PATH_MOST];
    brio_place_facts old, of_input;
    if (!*f->old || !brio_find_facts(f->old, &old)) return BRIO_OK;
    for (int i = r->command->first_input; i < r->num_operands; i++) {
        if (!brio_target_path(r->operands[i], input)) continue; /* the reader finds out */
        size_t length = brio_folder_length(input);
        snprintf(folder, sizeof folder, "%.*s", length ? (int)length : 1, length ? input : ".");
        if (brio_find_facts(folder, &of_input) && brio_is_same_file(&old, &of_input))
            return cli_fail(r, BRIO_ERR_ARGUMENT,
                            "%s: a file of the older output that -o replaces; take another name for the new one",
                            r->operands[i]);
    }
    return BRIO_OK;
}

/* Fails if the folder STEM.part is there. */
static brio_status check_part(run *r, const new_folder *f) {
    char path[BRIO_PATH_MOST];
    part_of(f, path);
    if (!brio_is_there(path) && !brio_is_link(path)) return BRIO_OK;
    errno = EEXIST;
    return fail_folder(r, path);
}

brio_status cli_new_folder_check(run *r, const char *index, const char *extension) {
    new_folder f;
    char path[BRIO_PATH_MOST];
    FORWARD(cli_check_target(r, index));
    FORWARD(begin(r, index, extension, &f));
    FORWARD(refuse_old_inputs(r, &f));
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
    if (there && made) out->lock = make_mark(mark, out->extension, out->most_files);
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
    f->lock = make_mark(mark, f->extension, MOST_FILES);
    if (!renamed) return cli_fail(r, BRIO_ERR_WRITE, "%s: cannot name it %s: %s", f->path, path, strerror(error));
    memcpy(f->path, path, sizeof path);
    if (f->lock < 0) return cli_fail(r, BRIO_ERR_WRITE, "%s: in use by another process", mark);
    if (!*f->old) return BRIO_OK;
    mark_of(f->old, mark); /* if the run is killed when its index is there, the next one removes the older files */
    int old = make_mark(mark, f->old_extension, f->num_old);
    if (old >= 0) brio_close(old);
    f->marked = old >= 0;
    return BRIO_OK;
}

void cli_new_folder_close(new_folder *f, bool published) {
    char mark[BRIO_PATH_MOST + 64];
    if (f->lock >= 0) {
        if (!published) remove_files(f->path, f->extension, f->most_files);
        mark_of(f->path, mark);
        brio_unlock_file(f->lock, mark);
        if (!published) brio_remove_folder(f->path);
    }
    mark_of(f->old, mark);
    if (!published && f->marked) brio_remove_file(mark); /* the older output stays */
    if (published && *f->old) {
        remove_files(f->old, f->old_extension, f->num_old);
        brio_remove_file(mark); /* of a run that was killed when its index was there */
        brio_remove_folder(f->old);
    }
    f->lock = -1;
    *f->path = 0;
}

/* --- outputs that are one file --- */

static brio_status begin_for(run *r, const char *output, new_folder *f) {
    char end[BRIO_PATH_MOST];
    *f = (new_folder){.extension = ROWS, .most_files = 1, .lock = -1};
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
