/* Output paths, checked before long work begins: an hour of triangulation should not end at a misspelt folder. The
 * writer checks again, since the file system may change meanwhile. */
#include "cli/files/files.h"
#include "platform/program.h"
#include "platform/target.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Copies the folder of a path, "." for a name alone. */
static void copy_folder(const char *path, char folder[BRIO_PATH_MOST]) {
    size_t length = brio_folder_length(path);
    snprintf(folder, BRIO_PATH_MOST, "%.*s", length ? (int)length : 1, length ? path : ".");
}

static brio_status check_folder(run *r, const char *path) {
    char folder[BRIO_PATH_MOST];
    copy_folder(path, folder);
    size_t length = strlen(folder);
    if (length > 1 && folder[length - 1] == '/') folder[length - 1] = 0; /* as it is shown */
    if (brio_may_make_files(folder)) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_WRITE, "%s: cannot write into the folder %s: %s", path, folder, strerror(errno));
}

/* Returns whether two files that are not there yet would be one: the same name in the same folder. */
static bool is_one_new_file(const char *a, const char *b) {
    char folder_a[BRIO_PATH_MOST], folder_b[BRIO_PATH_MOST];
    brio_place_facts of_a, of_b;
    if (strcmp(a + brio_folder_length(a), b + brio_folder_length(b)) != 0) return false;
    copy_folder(a, folder_a);
    copy_folder(b, folder_b);
    if (!brio_find_facts(folder_a, &of_a) || !brio_find_facts(folder_b, &of_b)) return !strcmp(a, b);
    return brio_is_same_file(&of_a, &of_b);
}

bool cli_is_single(const char *path) {
    brio_place_facts found;
    if (!strcmp(path, "-") || brio_path_descriptor(path) >= 0) return true;
    return brio_find_facts(path, &found) && (found.kind == BRIO_IS_CHARACTERS || found.kind == BRIO_IS_BLOCKS);
}

static brio_status check_descriptor(run *r, const char *path, int descriptor) {
    if (brio_is_writable(descriptor)) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_WRITE, "%s: not open for writing", path);
}

/* Checks a name as the writer will use it. A new file is written beside an old one and renamed over it: that takes a
 * writable folder, the one that symbolic links lead to. Pipes, devices and open descriptors are written directly. */
brio_status cli_check_target(run *r, const char *path) {
    brio_place_facts found;
    char end[BRIO_PATH_MOST];
    bool exists = brio_find_facts(path, &found), loop = !exists && errno == ELOOP;
    int descriptor = exists ? brio_path_descriptor(path) : -1;
    if (descriptor >= 0) return check_descriptor(r, path, descriptor);
    if (loop) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(ELOOP));
    if (exists && found.kind == BRIO_IS_FOLDER) return cli_fail(r, BRIO_ERR_WRITE, "%s: is a folder", path);
    if (exists && !brio_may_write(path)) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    if (exists && found.kind != BRIO_IS_FILE) return BRIO_OK;
    return brio_target_path(path, end) ? check_folder(r, end) : BRIO_OK; /* the writer finds out */
}

static bool is_gltf(const char *name) {
    const char *dot = strrchr(name, '.');
    return !strcasecmp(dot ? dot + 1 : name, "gltf");
}

brio_status cli_output_format(run *r, const char *path, const char *extension, brio_format *format) {
    char written[BRIO_FORMAT_LIST];
    *format = brio_format_of(extension ? extension : path);
    const brio_format_info *info = brio_format_facts(*format);
    if (info && is_gltf(extension ? extension : path))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: .gltf files are read, not written; .glb files are", path);
    if (info && !info->written[0])
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s is read, not written", path, info->name);
    if (info) return BRIO_OK;
    brio_format_list(1, 0, written, sizeof written);
    if (extension) return cli_fail_output(r, "--format %s: this version writes %s", extension, written);
    if (!strcmp(path, "-")) return cli_fail(r, BRIO_ERR_ARGUMENT, "-o - needs --format");
    return cli_fail_output(r, "%s: this version writes %s; name one of these with --format", path, written);
}

/* --- files named twice --- */

/* Returns whether two paths lead to one regular file or one pipe, through links and folders by any name; devices may be
 * named twice. */
static bool leads_to_one(const char *a, const char *b) {
    brio_place_facts of_a, of_b;
    char end_a[BRIO_PATH_MOST], end_b[BRIO_PATH_MOST];
    bool has_a = brio_find_facts(a, &of_a), has_b = brio_find_facts(b, &of_b);
    if (has_a && has_b)
        return (of_a.kind == BRIO_IS_FILE || of_a.kind == BRIO_IS_PIPE) && brio_is_same_file(&of_a, &of_b);
    if (has_a || has_b) return false;
    return brio_target_path(a, end_a) && brio_target_path(b, end_b) && is_one_new_file(end_a, end_b);
}

/* Returns the .node file of a set of TetGen's files, to be freed; NULL for other names, and without memory. */
static char *node_of(const char *path) {
    static const char *const set[] = {".node", ".ele", ".neigh", ".face", ".edge"};
    const char *dot = strrchr(path, '.');
    size_t i = 0, count = sizeof set / sizeof *set;
    while (dot && i < count && strcasecmp(dot, set[i]) != 0) i++;
    if (!dot || i == count) return NULL;
    char *name = malloc((size_t)(dot - path) + sizeof ".node");
    if (name) sprintf(name, "%.*s.node", (int)(dot - path), path);
    return name;
}

bool cli_goes_to_stdout(const char *path) {
    brio_place_facts file, out;
    if (!path || !strcmp(path, "-")) return path != NULL;
    if (!brio_find_facts(path, &file) || !brio_find_facts_open(BRIO_OUTPUT, &out)) return false;
    if (out.kind == BRIO_IS_CHARACTERS && !brio_is_terminal(BRIO_OUTPUT)) return false;
    return brio_is_same_file(&file, &out);
}

bool cli_same_file(const char *a, const char *b) {
    if (!strcmp(a, "-") || !strcmp(b, "-")) return false;
    if (leads_to_one(a, b)) return true;
    char *node_a = node_of(a), *node_b = node_of(b);
    bool same = node_a && node_b && leads_to_one(node_a, node_b);
    free(node_a);
    free(node_b);
    return same;
}

/* A file that the command line names, and how. */
typedef struct {
    const char *path;
    const option *option; /* NULL: an operand */
    bool written;
} named_file;

static bool find_facts(const named_file *f, brio_place_facts *found) {
    if (strcmp(f->path, "-")) return brio_find_facts(f->path, found);
    return brio_find_facts_open(f->written ? BRIO_OUTPUT : BRIO_INPUT, found);
}

/* Returns whether a standard stream is the other file. Of a file that is read as standard input the output replaces the
 * name only; a pipe would wait for what the run itself writes into it. */
static bool is_one_stream(const named_file *a, const named_file *b) {
    brio_place_facts of_a, of_b;
    const named_file *input = a->written ? b : a;
    if (a->written == b->written || (strcmp(a->path, "-") && strcmp(b->path, "-"))) return false;
    if (!find_facts(a, &of_a) || !find_facts(b, &of_b) || !brio_is_same_file(&of_a, &of_b)) return false;
    return of_a.kind == BRIO_IS_PIPE || (of_a.kind == BRIO_IS_FILE && strcmp(input->path, "-") != 0);
}

enum { MOST_NAMED = 16 };

static size_t name_options(const option *rows, const void *values, named_file *files, size_t count) {
    for (const option *row = rows; row->kind; row++) {
        if (row->kind != OPTION_INPUT && row->kind != OPTION_OUTPUT) continue;
        const char *path;
        memcpy(&path, (const char *)values + row->offset, sizeof path);
        if (path && count < MOST_NAMED) files[count++] = (named_file){path, row, row->kind == OPTION_OUTPUT};
    }
    return count;
}

static void describe(const option *row, char text[40]) {
    if (!row)
        snprintf(text, 40, "the input");
    else if (row->letter)
        snprintf(text, 40, "-%c", row->letter);
    else
        snprintf(text, 40, "--%s", row->name);
}

static brio_status refuse_pair(run *r, const named_file *a, const named_file *b) {
    char first[40], second[40];
    describe(a->option, first);
    describe(b->option, second);
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s and %s name the same file", a->path, first, second);
}

brio_status cli_check_named_twice(run *r) {
    named_file files[MOST_NAMED];
    size_t count = name_options(cli_common_options, &r->common, files, 0);
    count = name_options(r->command->options, r->arguments, files, count);
    for (int i = r->command->first_input; i < r->num_operands && count < MOST_NAMED; i++)
        files[count++] = (named_file){r->operands[i], NULL, false};
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++)
            if ((files[i].written || files[j].written) &&
                (cli_same_file(files[i].path, files[j].path) || is_one_stream(&files[i], &files[j])))
                return refuse_pair(r, &files[i], &files[j]);
    return BRIO_OK;
}

static brio_status refuse_standard_output(run *r, const char *name, const char *path) {
    if (!cli_goes_to_stdout(path)) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s: a file, not standard output", name);
}

brio_status cli_check_beside(run *r, const char *name, const char *path) {
    FORWARD(refuse_standard_output(r, name, path));
    return cli_check_target(r, path);
}

brio_status cli_check_mesh_beside(run *r, const char *name, const char *path, cli_holds holds) {
    brio_format format;
    FORWARD(refuse_standard_output(r, name, path));
    FORWARD(cli_output_format(r, path, NULL, &format));
    if ((brio_format_facts(format)->holds & holds) != holds)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a file of this format cannot hold what --%s writes", path, name);
    return cli_check_target(r, path);
}
