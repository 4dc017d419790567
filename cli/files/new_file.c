/* Files that appear when they are complete: see new_file.h. */
#define _GNU_SOURCE
#include "cli/files/new_file.h"
#include "cli/run/interrupt.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OPEN_FILE "/proc/self/fd/%d" /* the name of an open file */

enum { PATH_BYTES = 32, NAME_TRIES = 100 };

static brio_status fail(run *r, const char *path) {
    return cli_fail(r, errno == ENOMEM ? BRIO_ERR_NO_MEMORY : BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
}

/* Finds the target and the temporary name. */
static bool find_names(const char *path, new_file *f) {
    static const char end[] = ".part-XXXXXX";
    f->target = realpath(path, NULL); /* where a symbolic link leads */
    if (!f->target && errno == ENOENT) f->target = strdup(path);
    f->temporary = f->target ? malloc(strlen(f->target) + sizeof end) : NULL;
    if (!f->temporary) return false;
    strcpy(f->temporary, f->target);
    strcat(f->temporary, end);
    return true;
}

/* Makes a file without a name in the target's folder. Returns -1 where there are none, or no /proc to name them by. */
static int create_nameless(const new_file *f) {
    char path[PATH_BYTES], *slash = strrchr(f->temporary, '/');
    char after = slash ? slash[1] : 0;
    if (slash) slash[1] = 0;
    int file = open(slash ? f->temporary : ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (slash) slash[1] = after;
    snprintf(path, sizeof path, OPEN_FILE, file);
    if (file < 0 || access(path, F_OK) == 0) return file;
    close(file);
    return -1;
}

/* Makes a file with a temporary name, and the permissions of any new file. */
static int create_named(new_file *f) {
    mode_t mask = umask(0);
    umask(mask);
    int file = mkostemp(f->temporary, O_CLOEXEC);
    f->is_named = file >= 0;
    if (file >= 0 && fchmod(file, 0666 & ~mask) == 0) return file;
    if (file >= 0) close(file);
    return -1;
}

brio_status cli_new_file_open(run *r, const char *path, new_file *out) {
    *out = (new_file){0};
    cli_interrupt_writing(true);
    if (!find_names(path, out)) return fail(r, path);
    int file = create_nameless(out);
    if (file < 0) file = create_named(out);
    if (file < 0) return fail(r, path);
    out->file = fdopen(file, "w");
    if (out->file) return BRIO_OK;
    brio_status status = fail(r, path);
    close(file);
    return status;
}

/* Gives a nameless file the target's name, if no file has it, or else the temporary one. */
static bool give_name(new_file *f, bool *published) {
    char path[PATH_BYTES];
    snprintf(path, sizeof path, OPEN_FILE, fileno(f->file));
    *published = linkat(AT_FDCWD, path, AT_FDCWD, f->target, AT_SYMLINK_FOLLOW) == 0;
    for (int i = 0; i < NAME_TRIES && !*published && !f->is_named && errno == EEXIST; i++) {
        unsigned number = (unsigned)getpid() + (unsigned)i;
        (void)!getentropy(&number, sizeof number); /* one that others cannot guess, if the system has any */
        sprintf(strrchr(f->temporary, '-') + 1, "%06x", number & 0xffffff);
        f->is_named = linkat(AT_FDCWD, path, AT_FDCWD, f->temporary, AT_SYMLINK_FOLLOW) == 0;
    }
    return *published || f->is_named;
}

static bool is_on_disk(int file) {
    while (fsync(file) != 0)
        if (errno != EINTR) return false;
    return true;
}

brio_status cli_new_file_publish(run *r, const char *path, new_file *f) {
    bool published = false;
    if (fflush(f->file) != 0 || !is_on_disk(fileno(f->file))) return fail(r, path);
    if (!f->is_named && !give_name(f, &published)) return fail(r, path);
    if (!published && rename(f->temporary, f->target) != 0) return fail(r, path);
    f->is_named = false;
    return BRIO_OK;
}

void cli_new_file_close(new_file *f) {
    if (f->file) fclose(f->file);
    if (f->is_named) unlink(f->temporary);
    free(f->temporary);
    free(f->target);
    cli_interrupt_writing(false);
}
