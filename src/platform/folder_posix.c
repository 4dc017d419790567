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
#endif

bool brio_make_folder(const char *path, bool ours, bool *made) {
    *made = mkdir(path, ours ? 0700 : 0777) == 0;
    return *made || errno == EEXIST;
}

int brio_lock_file(const char *path) {
    int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
#ifndef __wasi__ /* which has one process */
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) != 0) {
        int error = errno;
        close(file);
        errno = error;
        return -1;
    }
#endif
    return file;
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
