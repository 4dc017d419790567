/* Output paths, checked before long work begins: an hour of triangulation should not end at a misspelt folder. The
 * writer checks again, since the file system may change meanwhile. */
#include "files.h"
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_LINKS = 40 };

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

/* The path that a chain of symbolic links leads to, to be freed; a file need not be there. NULL without memory, and of
 * more links than the system follows. */
static char *follow_links(const char *path) {
    char link[PATH_MAX], *at = strdup(path);
    for (int links = 0; at && links <= MOST_LINKS; links++) {
        ssize_t length = readlink(at, link, sizeof link - 1);
        if (length < 0) return at;
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

/* A new file is written beside an old one and renamed over it: that takes a writable folder, the one that symbolic links lead
 * to. Pipes and devices are written directly. */
brio_status cli_check_target(run *r, const char *path) {
    struct stat info;
    bool exists = stat(path, &info) == 0;
    if (!exists && errno == ELOOP) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    if (exists && S_ISDIR(info.st_mode)) return cli_fail(r, BRIO_ERR_WRITE, "%s: is a folder", path);
    if (exists && access(path, W_OK) != 0) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    if (exists && !S_ISREG(info.st_mode)) return BRIO_OK;
    char *end = follow_links(path);
    brio_status status = end ? check_folder(r, end) : BRIO_OK; /* the writer finds out */
    free(end);
    return status;
}

brio_status cli_output_format(run *r, const char *path, const char *extension, brio_format *format) {
    *format = brio_format_of(extension ? extension : path);
    if (*format == BRIO_FORMAT_LAZ || *format == BRIO_FORMAT_PCD || *format == BRIO_FORMAT_PTX)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: LAZ, PCD and PTX files are read, not written", path);
    if (*format != BRIO_FORMAT_AUTO) return BRIO_OK;
    if (extension)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--format %s: this version writes .ply .xyz .obj .off .vtu .vtp .node .las .stl .npy",
                        extension);
    if (!strcmp(path, "-")) return cli_fail(r, BRIO_ERR_ARGUMENT, "-o - needs --format");
    return cli_fail(
        r, BRIO_ERR_ARGUMENT,
        "%s: this version writes .ply .xyz .obj .off .vtu .vtp .node .las .stl .npy; name one of these with --format",
        path);
}

bool cli_same_file(const char *a, const char *b) {
    struct stat of_a, of_b;
    if (!strcmp(a, "-") || !strcmp(b, "-")) return false;
    if (stat(a, &of_a) != 0 || stat(b, &of_b) != 0) return !strcmp(a, b);
    return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

brio_status cli_check_beside(run *r, const char *name, const char *path, const brio_format *formats) {
    const char *output = r->common.output;
    brio_format format;
    brio_status status = BRIO_OK;
    if (!strcmp(path, "-")) TRY(cli_fail(r, BRIO_ERR_ARGUMENT, "--%s: a file, not standard output", name));
    if (output && cli_same_file(path, output))
        TRY(cli_fail(r, BRIO_ERR_ARGUMENT, "%s: --%s and -o name the same file", path, name));
    if (formats) TRY(cli_output_format(r, path, NULL, &format));
    for (; formats && *formats != format; formats++)
        if (*formats == BRIO_FORMAT_AUTO)
            TRY(cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a file of this format cannot hold what --%s writes", path, name));
    TRY(cli_check_target(r, path));
done:
    return status;
}
