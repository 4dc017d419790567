/* A folder for the files of a fuzzer, in memory where there is such a place. */
#ifndef BRIO_TESTS_FUZZ_FOLDER_H
#define BRIO_TESTS_FUZZ_FOLDER_H

#include "fuzz.h"
#include <sys/stat.h>
#include <unistd.h>

/** The path of a file in the folder; valid until the fourth next call. */
static inline const char *fuzz_path(const char *name) {
    static char folder[64], paths[4][128];
    static int next;
    char *path = paths[next++ & 3];
    if (!*folder) {
        snprintf(folder, sizeof folder, "%s/brio-fuzz-XXXXXX", access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
        FUZZ_EXPECT(mkdtemp(folder), "%s", folder);
    }
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static inline void fuzz_remove(const char *name) {
    unlink(fuzz_path(name));
}

/** Removes the folder, which must be empty. */
static inline void fuzz_leave_folder(void) {
    rmdir(fuzz_path(""));
}

#endif
