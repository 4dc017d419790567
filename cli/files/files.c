/* Output paths, checked before long work begins: an hour of triangulation should not end at a misspelt folder. The
 * writer checks again, since the file system may change meanwhile. */
#include "cli/files/files.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

enum { MOST_LINKS = 40, PROCESSES = 0x9fa0 /* PROC_SUPER_MAGIC, the type of the process file system */ };

static brio_status check_folder(run *r, const char *path) {
    char *folder = strdup(path);
    brio_status status = BRIO_OK;
    if (!folder) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory");
    char *slash = strrchr(folder, '/');
    if (slash) slash[slash == folder] = 0;
    const char *name = slash ? folder : ".";
    if (access(name, W_OK | X_OK) != 0)
        status = cli_fail(r, BRIO_ERR_WRITE, "%s: cannot write into the folder %s: %s", path, name, strerror(errno));
    free(folder);
    return status;
}

/* Returns whether a path is a link of the process file system. It leads to an open file; what it says is no path. */
static bool leads_to_open_file(char *path) {
    struct statfs info;
    char *slash = strrchr(path, '/');
    if (!slash) return statfs(".", &info) == 0 && info.f_type == PROCESSES;
    *slash = 0;
    bool found = statfs(slash > path ? path : "/", &info) == 0 && info.f_type == PROCESSES;
    *slash = '/';
    return found;
}

/* Returns the path that a chain of symbolic links leads to, to be freed; a file need not be there. NULL without memory,
 * and of more links than the system follows. */
static char *follow_links(const char *path) {
    char link[PATH_MAX], *at = strdup(path);
    for (int links = 0; at && links <= MOST_LINKS; links++) {
        ssize_t length = readlink(at, link, sizeof link - 1);
        if (length < 0 || leads_to_open_file(at)) return at;
        link[length] = 0;
        char *slash = link[0] == '/' ? NULL : strrchr(at, '/'), *next = NULL;
        size_t folder = slash ? (size_t)(slash - at) + 1 : 0;
        next = malloc(folder + (size_t)length + 1);
        if (next) {
            memcpy(next, at, folder);
            memcpy(next + folder, link, (size_t)length + 1);
        }
        free(at);
        at = next;
    }
    free(at);
    return NULL;
}

/* Returns whether two files that are not there yet would be one: the same name in the same folder. */
static bool is_one_new_file(const char *a, const char *b) {
    const char *slash_a = strrchr(a, '/'), *slash_b = strrchr(b, '/');
    char folder_a[PATH_MAX], folder_b[PATH_MAX];
    struct stat of_a, of_b;
    if (strcmp(slash_a ? slash_a + 1 : a, slash_b ? slash_b + 1 : b) != 0) return false;
    snprintf(folder_a, sizeof folder_a, "%.*s", slash_a ? (int)(slash_a - a) + 1 : 1, slash_a ? a : ".");
    snprintf(folder_b, sizeof folder_b, "%.*s", slash_b ? (int)(slash_b - b) + 1 : 1, slash_b ? b : ".");
    if (stat(folder_a, &of_a) != 0 || stat(folder_b, &of_b) != 0) return !strcmp(a, b);
    return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

/* Returns the descriptor whose link is `name` in a folder of the process file system. */
static int descriptor_of(const char *path, const char *name) {
    struct stat named, open;
    char *end;
    long number = strtol(name, &end, 10);
    if (end == name || *end || number < 0 || number > INT_MAX) return -1;
    if (stat(path, &named) != 0 || fstat((int)number, &open) != 0) return -1;
    return named.st_dev == open.st_dev && named.st_ino == open.st_ino ? (int)number : -1;
}

int cli_open_descriptor(const char *path) {
    char *at = follow_links(path);
    const char *slash = at ? strrchr(at, '/') : NULL;
    int found = at && leads_to_open_file(at) ? descriptor_of(at, slash ? slash + 1 : at) : -1;
    free(at);
    return found;
}

bool cli_is_single(const char *path) {
    struct stat info;
    if (!strcmp(path, "-") || cli_open_descriptor(path) >= 0) return true;
    return stat(path, &info) == 0 && (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode));
}

static brio_status check_descriptor(run *r, const char *path, int descriptor) {
    int flags = fcntl(descriptor, F_GETFL);
    if (flags >= 0 && (flags & O_ACCMODE) != O_RDONLY) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_WRITE, "%s: not open for writing", path);
}

/* Checks a name as the writer will use it. A new file is written beside an old one and renamed over it: that takes a
 * writable folder, the one that symbolic links lead to. Pipes, devices and open descriptors are written directly. */
brio_status cli_check_target(run *r, const char *path) {
    struct stat info;
    bool exists = stat(path, &info) == 0;
    int descriptor = exists ? cli_open_descriptor(path) : -1;
    if (descriptor >= 0) return check_descriptor(r, path, descriptor);
    if (!exists && errno == ELOOP) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    if (exists && S_ISDIR(info.st_mode)) return cli_fail(r, BRIO_ERR_WRITE, "%s: is a folder", path);
    if (exists && access(path, W_OK) != 0) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    if (exists && !S_ISREG(info.st_mode)) return BRIO_OK;
    char *end = follow_links(path);
    brio_status status = end ? check_folder(r, end) : BRIO_OK; /* the writer finds out */
    free(end);
    return status;
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
    struct stat of_a, of_b;
    bool has_a = stat(a, &of_a) == 0, has_b = stat(b, &of_b) == 0;
    if (has_a && has_b)
        return (S_ISREG(of_a.st_mode) || S_ISFIFO(of_a.st_mode)) && of_a.st_dev == of_b.st_dev &&
               of_a.st_ino == of_b.st_ino;
    if (has_a || has_b) return false;
    char *end_a = follow_links(a), *end_b = follow_links(b);
    bool same = end_a && end_b && is_one_new_file(end_a, end_b);
    free(end_a);
    free(end_b);
    return same;
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
    struct stat file, out;
    if (!path || !strcmp(path, "-")) return path != NULL;
    if (stat(path, &file) != 0 || fstat(STDOUT_FILENO, &out) != 0) return false;
    if (S_ISCHR(out.st_mode) && !isatty(STDOUT_FILENO)) return false;
    return file.st_dev == out.st_dev && file.st_ino == out.st_ino;
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

static bool find_info(const named_file *f, struct stat *info) {
    if (strcmp(f->path, "-")) return stat(f->path, info) == 0;
    return fstat(f->written ? STDOUT_FILENO : STDIN_FILENO, info) == 0;
}

/* Returns whether a standard stream is the other file. Of a file that is read as standard input the output replaces the
 * name only; a pipe would wait for what the run itself writes into it. */
static bool is_one_stream(const named_file *a, const named_file *b) {
    struct stat of_a, of_b;
    const named_file *input = a->written ? b : a;
    if (a->written == b->written || (strcmp(a->path, "-") && strcmp(b->path, "-"))) return false;
    if (!find_info(a, &of_a) || !find_info(b, &of_b)) return false;
    if (of_a.st_dev != of_b.st_dev || of_a.st_ino != of_b.st_ino) return false;
    return S_ISFIFO(of_a.st_mode) || (S_ISREG(of_a.st_mode) && strcmp(input->path, "-") != 0);
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
