/* Folders of POSIX. */
#define _GNU_SOURCE
#include "platform/folder.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#ifndef __wasi__
#include <sys/file.h>
#include <sys/statvfs.h>
#endif

#ifdef __wasi__ /* which has one user and one process */

bool brio_free_bytes(const char *path, uint64_t *bytes) {
    (void)path, (void)bytes;
    return false;
}

static bool is_ours(const char *path) {
    (void)path;
    return true;
}

int brio_lock_file(const char *path) {
    return open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
}

void brio_unlock_file(int file, const char *path) {
    close(file);
    unlink(path);
}

#else

/* Returns false where a file system does not count its blocks: in memory without a limit, or behind a program. */
bool brio_free_bytes(const char *path, uint64_t *bytes) {
    struct statvfs facts;
    if (statvfs(path, &facts) != 0 || facts.f_blocks == 0) return false;
    if (__builtin_mul_overflow((uint64_t)facts.f_bavail, (uint64_t)facts.f_frsize, bytes)) *bytes = UINT64_MAX;
    return true;
}

/* Returns whether a path is a folder of this user, and no link. */
static bool is_ours(const char *path) {
    struct stat facts;
    if (lstat(path, &facts) != 0) return false;
    errno = S_ISDIR(facts.st_mode) ? EACCES : ENOTDIR;
    return S_ISDIR(facts.st_mode) && facts.st_uid == geteuid();
}

/* Returns whether a path is still the name of an open file. */
static bool has_name(int file, const char *path) {
    struct stat open, named;
    return fstat(file, &open) == 0 && lstat(path, &named) == 0 && open.st_dev == named.st_dev &&
           open.st_ino == named.st_ino;
}

/* Opens and locks; begins again if another process removed the file between the two calls, for such a lock locks
 * nothing. */
int brio_lock_file(const char *path) {
    for (;;) {
        int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (file < 0) return -1;
        bool locked = flock(file, LOCK_EX | LOCK_NB) == 0;
        if (locked && has_name(file, path)) return file;
        int error = errno;
        close(file);
        errno = error;
        if (!locked) return -1;
    }
}

void brio_unlock_file(int file, const char *path) {
    unlink(path);
    close(file);
}

#endif

bool brio_make_folder(const char *path, bool ours, bool *made) {
    *made = mkdir(path, ours ? 0700 : 0777) == 0;
    return *made || (errno == EEXIST && (!ours || is_ours(path)));
}

int brio_make_file(const char *path) {
    return open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
}

bool brio_rename_file(const char *from, const char *to) {
    return rename(from, to) == 0;
}

bool brio_remove_file(const char *path) {
    return unlink(path) == 0;
}

void brio_empty_folder(const char *path, const char *kept) {
    DIR *folder = opendir(path);
    if (!folder) return;
    for (struct dirent *e; (e = readdir(folder)) != NULL;)
        if (strcmp(e->d_name, ".") && strcmp(e->d_name, "..") && strcmp(e->d_name, kept))
            unlinkat(dirfd(folder), e->d_name, 0);
    closedir(folder);
}

bool brio_remove_folder(const char *path) {
    return rmdir(path) == 0;
}
