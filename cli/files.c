/* Output paths, checked before long work begins: an hour of triangulation should not end at a misspelt folder. The
 * writer checks again, since the file system may change meanwhile. */
#include "files.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

/* A new file is written beside an old one and renamed over it: that takes a writable folder. Pipes and devices are
 * written directly. */
brio_status cli_check_target(run *r, const char *path) {
    struct stat info;
    bool exists = stat(path, &info) == 0;
    if (exists && S_ISDIR(info.st_mode)) return cli_fail(r, BRIO_ERR_WRITE, "%s: is a folder", path);
    if (exists && access(path, W_OK) != 0) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    return exists && !S_ISREG(info.st_mode) ? BRIO_OK : check_folder(r, path);
}

brio_status cli_output_format(run *r, const char *path, const char *extension, brio_format *format) {
    *format = brio_format_of(extension ? extension : path);
    if (*format != BRIO_FORMAT_AUTO) return BRIO_OK;
    if (extension)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--format %s: this version writes .ply .xyz .obj .off .vtu .vtp .node",
                        extension);
    if (!strcmp(path, "-")) return cli_fail(r, BRIO_ERR_ARGUMENT, "-o - needs --format");
    return cli_fail(r, BRIO_ERR_ARGUMENT,
                    "%s: this version writes .ply .xyz .obj .off .vtu .vtp .node; name one of these with --format",
                    path);
}
