/* Output files without a name, or under a temporary one, until they are complete.
 *
 * Symbolic links are followed here, one at a time, from folder to folder, because realpath refuses a link that leads to
 * no file. A shell's redirection writes through such a link and creates the file that it names. This code does the
 * same, and the link stays a link.
 *
 * The temporary name begins with at most BRIO_NAME_IN_TEMPORARY bytes of the name. So it is not too long for a file
 * system even if the name has the greatest length. */
#define _GNU_SOURCE
#include "io/target.h"
#include "base/memory.h"
#include "base/rng.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/vfs.h>
#include <unistd.h>

#define OPEN_FILE "/proc/self/fd/%d" /* the name of an open file */

enum { NAME_TRIES = 100, MOST_LINKS = 40 /* as many as Linux follows */, PATH_BYTES = 32 };
enum { NAME_BYTES = BRIO_NAME_IN_TEMPORARY + 32, EXCHANGE = 2 /* RENAME_EXCHANGE, which not all C libraries know */ };
enum { PROCESSES = 0x9fa0 /* PROC_SUPER_MAGIC, the type of the process file system */ };

static brio_status fail(brio_context *ctx, const char *shown, int error) {
    return brio_fail(ctx, BRIO_ERR_WRITE, "%s: %s", shown, strerror(error));
}

/* --- links --- */

/* Returns the bytes of a path's folder with the slash at its end, or 0 for a name without a folder. */
static size_t folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* Opens the folder of a path and copies its name. The path is relative to target->folder, which the new folder
 * replaces. */
static brio_status step_to(brio_target *target, brio_context *ctx, const char *path, const char *shown) {
    brio_status status = BRIO_OK;
    size_t length = folder_length(path);
    char *folder = NULL, *name = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, folder, length + 2));
    BRIO_TRY(BRIO_ALLOC(ctx, name, strlen(path + length) + 1));
    strcpy(name, path + length);
    memcpy(folder, path, length);
    strcpy(folder + length, length ? "" : ".");
    int from = target->folder >= 0 ? target->folder : AT_FDCWD;
    int opened = openat(from, folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    BRIO_REQUIRE(ctx, opened >= 0, BRIO_ERR_WRITE, "%s: %s", shown, strerror(errno));
    if (target->folder >= 0) close(target->folder);
    target->folder = opened;
    brio_release(ctx, target->name);
    target->name = name;
    name = NULL;
    BRIO_REQUIRE(ctx, target->name[0], BRIO_ERR_WRITE, "%s: %s", shown, strerror(length ? EISDIR : ENOENT));
done:
    brio_release(ctx, folder);
    brio_release(ctx, name);
    return status;
}

static bool is_of_processes(int folder) {
    struct statfs facts;
    return fstatfs(folder, &facts) == 0 && facts.f_type == PROCESSES;
}

brio_status brio_target_find(brio_target *target, brio_context *ctx, const char *path, const char *shown) {
    char link[PATH_MAX];
    *target = (brio_target){.folder = -1};
    BRIO_FORWARD(step_to(target, ctx, path, shown));
    for (int links = 0;; links++) {
        ssize_t length = readlinkat(target->folder, target->name, link, sizeof link - 1);
        if (length >= 0 && is_of_processes(target->folder)) return BRIO_OK;
        if (length < 0) return errno == EINVAL || errno == ENOENT ? BRIO_OK : fail(ctx, shown, errno);
        if (links == MOST_LINKS) return fail(ctx, shown, ELOOP);
        link[length] = 0;
        BRIO_FORWARD(step_to(target, ctx, link, shown));
    }
    return BRIO_OK;
}

bool brio_target_is_open_file(const brio_target *target) {
    char link[1];
    return is_of_processes(target->folder) && readlinkat(target->folder, target->name, link, sizeof link) >= 0;
}

int brio_target_descriptor(const brio_target *target) {
    struct stat named, open;
    char *end;
    if (!brio_target_is_open_file(target)) return -1;
    long number = strtol(target->name, &end, 10);
    if (*end || number < 0 || number > INT_MAX) return -1;
    if (fstatat(target->folder, target->name, &named, 0) != 0 || fstat((int)number, &open) != 0) return -1;
    return named.st_dev == open.st_dev && named.st_ino == open.st_ino ? (int)number : -1;
}

int brio_open_descriptor(brio_context *ctx, const char *path) {
    brio_target target;
    if (!strcmp(path, "-")) return STDOUT_FILENO;
    int found = brio_target_find(&target, ctx, path, path) == BRIO_OK ? brio_target_descriptor(&target) : -1;
    brio_target_close(&target, ctx);
    return found;
}

/* --- the new file --- */

/* Returns how many bytes of a name the temporary name begins with: whole UTF-8 characters, as some file systems
 * require. */
static int kept_bytes(const char *name) {
    size_t length = strlen(name);
    if (length <= BRIO_NAME_IN_TEMPORARY) return (int)length;
    length = BRIO_NAME_IN_TEMPORARY;
    while (length > 0 && ((unsigned char)name[length] & 0xc0) == 0x80) length--;
    return (int)length;
}

/* Copies the permissions of a file. Permissions beyond read, write and execute depend on the owner, and are copied only
 * if the owner could be. */
static bool take_permissions(int file, const struct stat *old) {
    mode_t kept = fchown(file, old->st_uid, old->st_gid) == 0 ? 07777 : 0777;
    return fchmod(file, old->st_mode & kept) == 0;
}

/* Returns a number that others cannot guess, so that they cannot take the temporary names before. Where the system has
 * none to give, the name is merely new: it is created, never opened. */
static uint64_t unguessable(void) {
    uint64_t seed;
    if (getentropy(&seed, sizeof seed) == 0) return seed;
    return (uint64_t)getpid() << 32 ^ (uint64_t)(brio_seconds() * 1e9);
}

/* Makes a temporary name. */
static void make_name(brio_target *target) {
    snprintf(target->temporary, NAME_BYTES, "%.*s.part-%016" PRIx64, kept_bytes(target->name), target->name,
             brio_mix(unguessable()));
}

/* Makes a file without a name. Returns -1 where the file system has no such files, or where there is no /proc, through
 * which one gets its name. */
static int create_nameless(const brio_target *target) {
    char path[PATH_BYTES];
    struct stat facts, found;
    int file = openat(target->folder, ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (file < 0) return -1;
    snprintf(path, sizeof path, OPEN_FILE, file);
    if (fstat(file, &facts) == 0 && stat(path, &found) == 0 && found.st_ino == facts.st_ino) return file;
    close(file);
    return -1;
}

static int create_named(brio_target *target) {
    int file = -1;
    for (unsigned i = 0; i < NAME_TRIES && file < 0; i++) {
        make_name(target);
        file = openat(target->folder, target->temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file < 0 && errno != EEXIST && errno != EINTR) break;
    }
    target->is_named = file >= 0;
    return file;
}

brio_status brio_target_create(brio_target *target, brio_context *ctx, const char *shown, int *file) {
    brio_status status = BRIO_OK;
    struct stat old;
    bool exists = fstatat(target->folder, target->name, &old, 0) == 0;
    target->replaces = exists;
    *file = -1;
    if (!exists && errno != ENOENT) return fail(ctx, shown, errno);
    BRIO_TRY(BRIO_ALLOC(ctx, target->temporary, NAME_BYTES));
    *file = create_nameless(target);
    if (*file < 0) *file = create_named(target);
    target->is_new = *file >= 0;
    if (*file < 0 || (exists && !take_permissions(*file, &old))) status = fail(ctx, shown, errno);
done:
    return status;
}

/* Gives a nameless file the name, if no other file has it, or else a temporary name: no call makes it replace a
 * file. */
static bool give_name(brio_target *target, int file) {
    char path[PATH_BYTES];
    snprintf(path, sizeof path, OPEN_FILE, file);
    target->published = linkat(AT_FDCWD, path, target->folder, target->name, AT_SYMLINK_FOLLOW) == 0;
    for (unsigned i = 0; i < NAME_TRIES && !target->published && !target->is_named && errno == EEXIST; i++) {
        make_name(target);
        target->is_named = linkat(AT_FDCWD, path, target->folder, target->temporary, AT_SYMLINK_FOLLOW) == 0;
    }
    return target->published || target->is_named;
}

/* Gives the target's name to the file of the temporary name, or exchanges the two names. */
static bool rename_file(brio_target *target, bool exchanges) {
    int folder = target->folder;
    target->published = exchanges
                            ? syscall(SYS_renameat2, folder, target->temporary, folder, target->name, EXCHANGE) == 0
                            : renameat(folder, target->temporary, folder, target->name) == 0;
    if (target->published && !exchanges) target->is_named = false;
    return target->published;
}

brio_status brio_target_publish(brio_target *target, brio_context *ctx, const char *shown, int file) {
    if (!target->is_new) return BRIO_OK;
    if (!target->is_named && !give_name(target, file)) return fail(ctx, shown, errno);
    return target->published || rename_file(target, false) ? BRIO_OK : fail(ctx, shown, errno);
}

brio_status brio_target_exchange(brio_target *target, brio_context *ctx, const char *shown, int file) {
    if (!target->is_new) return BRIO_OK;
    if (!target->is_named && !give_name(target, file)) return fail(ctx, shown, errno);
    if (target->published || rename_file(target, true)) return BRIO_OK;
    return rename_file(target, false) ? BRIO_OK
                                      : fail(ctx, shown, errno); /* no old file, or names cannot be exchanged */
}

void brio_target_undo(brio_target *target) {
    if (!target->published) return;
    if (target->is_named)
        rename_file(target, true);
    else if (!target->replaces)
        unlinkat(target->folder, target->name, 0);
    target->published = false;
}

void brio_target_close(brio_target *target, brio_context *ctx) {
    if (target->is_named) unlinkat(target->folder, target->temporary, 0);
    if (target->folder >= 0) close(target->folder);
    brio_release(ctx, target->temporary);
    brio_release(ctx, target->name);
    *target = (brio_target){.folder = -1};
}
