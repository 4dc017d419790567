/* Targets of outputs by POSIX, with what Linux has besides: files without names, names exchanged, and links to open
 * files.
 *
 * Symbolic links are followed here, one at a time, from folder to folder, because realpath refuses a link that leads to
 * no file. A shell's redirection writes through such a link and creates the file that it names. This code does the
 * same, and the link stays a link. */
#define _GNU_SOURCE
#include "platform/target.h"
#include "platform/thread.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/syscall.h>
#include <sys/vfs.h>
#endif
#ifdef __APPLE__
#include <sys/random.h>
#endif
#ifndef O_PATH
#define O_PATH O_RDONLY
#endif

#define OPEN_FILE "/proc/self/fd/%d" /* the name of an open file */

enum { NAME_TRIES = 100, MOST_LINKS = 40 /* as many as Linux follows */, OPEN_FILE_BYTES = 32 };

/* --- links --- */

/* Opens the folder of a path and copies its name. The path is relative to target->folder, which the new folder
 * replaces. */
static bool step_to(brio_target *target, const char *path) {
    char folder[BRIO_PATH_MOST];
    size_t length = brio_folder_length(path);
    if (length >= sizeof folder || strlen(path + length) >= sizeof target->name) {
        errno = ENAMETOOLONG;
        return false;
    }
    memcpy(folder, path, length);
    strcpy(folder + length, length ? "" : ".");
    int from = target->folder >= 0 ? target->folder : AT_FDCWD;
    int opened = openat(from, folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (opened < 0) return false;
    if (target->folder >= 0) close(target->folder);
    target->folder = opened;
    strcpy(target->name, path + length);
    errno = length ? EISDIR : ENOENT;
    return target->name[0] != 0;
}

#ifdef __linux__

enum { PROCESSES = 0x9fa0 /* PROC_SUPER_MAGIC, the type of the process file system */ };

static bool is_of_processes(int folder) {
    struct statfs facts;
    return fstatfs(folder, &facts) == 0 && facts.f_type == PROCESSES;
}

static bool path_is_of_processes(const char *folder) {
    struct statfs facts;
    return statfs(folder, &facts) == 0 && facts.f_type == PROCESSES;
}

#else

static bool is_of_processes(int folder) {
    (void)folder;
    return false;
}

static bool path_is_of_processes(const char *folder) {
    (void)folder;
    return false;
}

#endif

bool brio_target_find(brio_target *target, const char *path) {
    char link[BRIO_PATH_MOST];
    *target = (brio_target){.folder = -1};
    if (!step_to(target, path)) return false;
    for (int links = 0;; links++) {
        ssize_t length = readlinkat(target->folder, target->name, link, sizeof link - 1);
        if (length >= 0 && is_of_processes(target->folder)) return true;
        if (length < 0) return errno == EINVAL || errno == ENOENT;
        if (links == MOST_LINKS) {
            errno = ELOOP;
            return false;
        }
        link[length] = 0;
        if (!step_to(target, link)) return false;
    }
}

/* Returns whether a path is a link of the process file system. It leads to an open file; what it says is no path. */
static bool leads_to_open_file(char *path) {
    char *slash = strrchr(path, '/');
    if (!slash) return path_is_of_processes(".");
    *slash = 0;
    bool found = path_is_of_processes(slash > path ? path : "/");
    *slash = '/';
    return found;
}

bool brio_target_path(const char *path, char end[BRIO_PATH_MOST]) {
    char link[BRIO_PATH_MOST];
    if (strlen(path) >= BRIO_PATH_MOST) return false;
    strcpy(end, path);
    for (int links = 0; links <= MOST_LINKS; links++) {
        ssize_t length = readlink(end, link, sizeof link - 1);
        if (length < 0 || leads_to_open_file(end)) return true;
        link[length] = 0;
        size_t folder = link[0] == '/' ? 0 : brio_folder_length(end);
        if (folder + (size_t)length >= BRIO_PATH_MOST) return false;
        memcpy(end + folder, link, (size_t)length + 1);
    }
    return false;
}

/* --- what is there --- */

bool brio_target_is_open_file(const brio_target *target) {
    char link[1];
    return is_of_processes(target->folder) && readlinkat(target->folder, target->name, link, sizeof link) >= 0;
}

/* Finds the descriptors of Linux by their links, those of other systems as the devices that they are there. */
int brio_target_descriptor(const brio_target *target) {
    struct stat named, open;
    char *end;
#ifdef __APPLE__
    static const char *const names[] = {"stdin", "stdout", "stderr"};
    struct stat folder, devices;
    if (fstat(target->folder, &folder) != 0) return -1;
    if (stat("/dev", &devices) == 0 && folder.st_dev == devices.st_dev && folder.st_ino == devices.st_ino)
        for (int i = 0; i < 3; i++)
            if (!strcmp(target->name, names[i])) return i;
    if (stat("/dev/fd", &devices) != 0 || folder.st_dev != devices.st_dev || folder.st_ino != devices.st_ino) return -1;
#else
    if (!brio_target_is_open_file(target)) return -1;
#endif
    long number = strtol(target->name, &end, 10);
    if (end == target->name || *end || number < 0 || number > INT_MAX) return -1;
    if (fstatat(target->folder, target->name, &named, 0) != 0 || fstat((int)number, &open) != 0) return -1;
    return named.st_dev == open.st_dev && named.st_ino == open.st_ino ? (int)number : -1;
}

bool brio_target_facts(const brio_target *target, brio_place_facts *facts) {
    struct stat s;
    if (fstatat(target->folder, target->name, &s, 0) != 0) return false;
    *facts = (brio_place_facts){.kind = S_ISREG(s.st_mode) ? BRIO_IS_FILE : BRIO_IS_OTHER,
                                .volume = (uint64_t)s.st_dev,
                                .number = (uint64_t)s.st_ino};
    return true;
}

bool brio_target_may_write(const brio_target *target) {
    return faccessat(target->folder, target->name, W_OK, 0) == 0;
}

/* --- the new file --- */

/* Fills a number with bits that nobody can guess. Returns false if the system has none. The C library of an older Linux
 * lacks the function for it. */
static bool take_entropy(uint64_t *seed) {
#ifdef __linux__
    return syscall(SYS_getrandom, seed, sizeof *seed, 0) == (long)sizeof *seed;
#else
    return getentropy(seed, sizeof *seed) == 0;
#endif
}

uint64_t brio_unguessable(void) {
    uint64_t seed;
    if (take_entropy(&seed)) return seed;
    return (uint64_t)brio_process_number() << 32 ^ (uint64_t)(brio_seconds() * 1e9);
}

/* Copies the permissions of a file. Permissions beyond read, write and execute depend on the owner, and are copied only
 * if the owner could be. */
static bool take_permissions(int file, const struct stat *old) {
#ifdef __wasi__ /* which has none */
    (void)file, (void)old;
    return true;
#else
    mode_t kept = fchown(file, old->st_uid, old->st_gid) == 0 ? 07777 : 0777;
    return fchmod(file, old->st_mode & kept) == 0;
#endif
}

/* Makes a file without a name. Returns -1 where the file system has no such files, or where there is no /proc, through
 * which one gets its name. */
static int create_nameless(const brio_target *target) {
#ifdef O_TMPFILE
    char path[OPEN_FILE_BYTES];
    struct stat facts, found;
    int file = openat(target->folder, ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (file < 0) return -1;
    snprintf(path, sizeof path, OPEN_FILE, file);
    if (fstat(file, &facts) == 0 && stat(path, &found) == 0 && found.st_ino == facts.st_ino) return file;
    close(file);
#else
    (void)target;
#endif
    return -1;
}

static int create_named(brio_target *target) {
    int file = -1;
    for (unsigned i = 0; i < NAME_TRIES && file < 0; i++) {
        brio_target_temporary(target);
        file = openat(target->folder, target->temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file < 0 && errno != EEXIST && errno != EINTR) break;
    }
    target->is_named = file >= 0;
    return file;
}

bool brio_target_create(brio_target *target, int *file) {
    struct stat old;
    bool exists = fstatat(target->folder, target->name, &old, 0) == 0;
    target->replaces = exists;
    *file = -1;
    if (!exists && errno != ENOENT) return false;
    *file = create_nameless(target);
    if (*file < 0) *file = create_named(target);
    target->is_new = *file >= 0;
    return *file >= 0 && (!exists || take_permissions(*file, &old));
}

/* Gives a nameless file the name, if no other file has it, or else a temporary name: no call makes it replace a
 * file. */
static bool give_name(brio_target *target, int file) {
    char path[OPEN_FILE_BYTES];
    snprintf(path, sizeof path, OPEN_FILE, file);
    target->published = linkat(AT_FDCWD, path, target->folder, target->name, AT_SYMLINK_FOLLOW) == 0;
    for (unsigned i = 0; i < NAME_TRIES && !target->published && !target->is_named && errno == EEXIST; i++) {
        brio_target_temporary(target);
        target->is_named = linkat(AT_FDCWD, path, target->folder, target->temporary, AT_SYMLINK_FOLLOW) == 0;
    }
    return target->published || target->is_named;
}

/* Exchanges the names of two files. */
static bool exchange_names(int folder, const char *a, const char *b) {
#if defined(__linux__)
    enum { EXCHANGE = 2 /* RENAME_EXCHANGE, which not all C libraries know */ };
    return syscall(SYS_renameat2, folder, a, folder, b, EXCHANGE) == 0;
#elif defined(__APPLE__)
    return renameatx_np(folder, a, folder, b, RENAME_SWAP) == 0;
#else
    (void)folder, (void)a, (void)b;
    errno = ENOSYS;
    return false;
#endif
}

/* Gives the target's name to the file of the temporary name, or exchanges the two names. */
static bool rename_file(brio_target *target, bool exchanges) {
    int folder = target->folder;
    target->published = exchanges ? exchange_names(folder, target->temporary, target->name)
                                  : renameat(folder, target->temporary, folder, target->name) == 0;
    if (target->published && !exchanges) target->is_named = false;
    return target->published;
}

bool brio_target_publish(brio_target *target, int file) {
    if (!target->is_new) return true;
    if (!target->is_named && !give_name(target, file)) return false;
    return target->published || rename_file(target, false);
}

bool brio_target_adopt(brio_target *target, const char *path) {
    struct stat old;
    if (fstatat(target->folder, target->name, &old, 0) == 0) {
        int file = open(path, O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
        bool taken = file >= 0 && take_permissions(file, &old);
        if (file >= 0) close(file);
        if (!taken) return false;
    }
    return renameat(AT_FDCWD, path, target->folder, target->name) == 0;
}

bool brio_target_exchange(brio_target *target, int file) {
    if (!target->is_new) return true;
    if (!target->is_named && !give_name(target, file)) return false;
    if (target->published || rename_file(target, true)) return true;
    return rename_file(target, false); /* no old file, or names cannot be exchanged */
}

void brio_target_undo(brio_target *target) {
    if (!target->published) return;
    if (target->is_named)
        rename_file(target, true);
    else if (!target->replaces)
        unlinkat(target->folder, target->name, 0);
    target->published = false;
}

void brio_target_close(brio_target *target) {
    if (target->is_named) unlinkat(target->folder, target->temporary, 0);
    if (target->folder >= 0) close(target->folder);
    *target = (brio_target){.folder = -1};
}
