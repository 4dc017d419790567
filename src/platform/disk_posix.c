/* Space on disk by POSIX, with what Linux has besides. */
#define _GNU_SOURCE
#include "platform/disk.h"
#include "platform/file.h"
#include "platform/quiet_signals.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#ifdef __linux__
#include <sys/sysmacros.h>
#endif
#include <unistd.h>

/* --- files without a name --- */

#ifdef __wasi__ /* whose files cannot be removed while they are open */

int brio_open_nameless(const char *folder) {
    (void)folder;
    errno = ENOTSUP;
    return -1;
}

#else

int brio_open_nameless(const char *folder) {
    int file = -1;
    if (!*folder) { /* "" and a slash would be the root folder */
        errno = ENOENT;
        return -1;
    }
#ifdef O_TMPFILE
    file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
#endif
    if (file < 0) {
        char name[BRIO_PATH_MOST];
        snprintf(name, sizeof name, "%s/brio-XXXXXX", folder);
        file = mkostemp(name, O_CLOEXEC);
        if (file >= 0) unlink(name);
    }
    return file;
}

#endif

/* --- space --- */

#ifdef __APPLE__

/* Asks for space behind the file's end, together if the disk has it so, and makes the file as long. */
static int allocate(int file, uint64_t place, uint64_t size) {
    struct stat facts;
    if (fstat(file, &facts) != 0) return errno;
    uint64_t end = place + size, old = (uint64_t)facts.st_size;
    if (end <= old) return 0;
    fstore_t wish = {.fst_flags = F_ALLOCATEALL, .fst_posmode = F_PEOFPOSMODE, .fst_length = (off_t)(end - old)};
    if (fcntl(file, F_PREALLOCATE, &wish) != 0 && errno != ENOTSUP && errno != EINVAL) return errno;
    return ftruncate(file, (off_t)end) == 0 ? 0 : errno;
}

#else

/* Gives space. Where the file system cannot, the C library writes a byte to each block instead. */
static int allocate(int file, uint64_t place, uint64_t size) {
    return posix_fallocate(file, (off_t)place, (off_t)size);
}

#endif

int brio_allocate_space(int file, uint64_t place, uint64_t size) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    int error = allocate(file, place, size);
    brio_signals_restore(&quiet);
    return error;
}

bool brio_set_size(int file, uint64_t size) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    int done;
    while ((done = ftruncate(file, (off_t)size)) != 0 && errno == EINTR) {}
    brio_signals_restore(&quiet);
    return done == 0;
}

/* --- the cache --- */

#ifdef __linux__

int brio_open_direct(int file) {
    char name[64];
    snprintf(name, sizeof name, "/proc/self/fd/%d", file);
    return open(name, O_RDWR | O_DIRECT | O_CLOEXEC);
}

static bool give(int file, uint64_t place, uint64_t size, unsigned flags) {
    return sync_file_range(file, (off_t)place, (off_t)size, flags) == 0 || errno == ESPIPE || errno == EINVAL ||
           errno == ENOSYS;
}

bool brio_start_writing(int file, uint64_t place, uint64_t size) {
    return give(file, place, size, SYNC_FILE_RANGE_WRITE);
}

bool brio_wait_written(int file, uint64_t place, uint64_t size) {
    return give(file, place, size, SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
}

#else

int brio_open_direct(int file) {
    (void)file;
    errno = ENOTSUP;
    return -1;
}

bool brio_start_writing(int file, uint64_t place, uint64_t size) {
    (void)file, (void)place, (void)size;
    return true;
}

bool brio_wait_written(int file, uint64_t place, uint64_t size) {
    (void)file, (void)place, (void)size;
    return true;
}

#endif

#ifdef __linux__

/* Reads the window of the disk that has the folder: of a part of a disk it is that of the whole. */
size_t brio_read_around(const char *folder) {
    static const char *const NAMES[] = {"/sys/class/bdi/%u:%u/read_ahead_kb",
                                        "/sys/dev/block/%u:%u/../queue/read_ahead_kb"};
    struct stat facts;
    size_t kib = 0;
    if (stat(folder, &facts) != 0) return 0;
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES && kib == 0; i++) {
        char name[128];
        snprintf(name, sizeof name, NAMES[i], major(facts.st_dev), minor(facts.st_dev));
        FILE *f = fopen(name, "r");
        if (f && fscanf(f, "%zu", &kib) != 1) kib = 0;
        if (f) fclose(f);
    }
    return kib <= SIZE_MAX / 1024 ? kib * 1024 : 0;
}

#else

size_t brio_read_around(const char *folder) {
    (void)folder;
    return 0;
}

#endif

void brio_advise_cache(int file, uint64_t place, uint64_t size, brio_cache_use use) {
#ifdef POSIX_FADV_RANDOM
    posix_fadvise(file, (off_t)place, (off_t)size,
                  use == BRIO_CACHE_RANDOM ? POSIX_FADV_RANDOM
                  : use == BRIO_CACHE_SOON ? POSIX_FADV_WILLNEED
                                           : POSIX_FADV_DONTNEED);
#else
    (void)file, (void)place, (void)size, (void)use;
#endif
}
