/* Files by POSIX: Linux, macOS, WASI. */
#define _GNU_SOURCE
#include "platform/file.h"
#include "platform/quiet_signals.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- what is there --- */

static void take_facts(const struct stat *s, brio_place_facts *facts) {
    mode_t mode = s->st_mode;
    *facts = (brio_place_facts){
        .kind = S_ISREG(mode)    ? BRIO_IS_FILE
                : S_ISDIR(mode)  ? BRIO_IS_FOLDER
                : S_ISFIFO(mode) ? BRIO_IS_PIPE
                : S_ISCHR(mode)  ? BRIO_IS_CHARACTERS
                : S_ISBLK(mode)  ? BRIO_IS_BLOCKS
                                 : BRIO_IS_OTHER,
        .volume = (uint64_t)s->st_dev,
        .number = (uint64_t)s->st_ino,
        .size = s->st_size > 0 ? (uint64_t)s->st_size : 0,
#ifdef __APPLE__
        .seconds = (int64_t)s->st_mtimespec.tv_sec,
        .nanoseconds = (int64_t)s->st_mtimespec.tv_nsec,
#else
        .seconds = (int64_t)s->st_mtim.tv_sec,
        .nanoseconds = (int64_t)s->st_mtim.tv_nsec,
#endif
    };
}

bool brio_find_facts(const char *path, brio_place_facts *facts) {
    struct stat s;
    if (stat(path, &s) != 0) return false;
    take_facts(&s, facts);
    return true;
}

bool brio_find_facts_open(int file, brio_place_facts *facts) {
    struct stat s;
    if (fstat(file, &s) != 0) return false;
    take_facts(&s, facts);
    return true;
}

bool brio_is_there(const char *path) {
    return access(path, F_OK) == 0;
}
bool brio_may_write(const char *path) {
    return access(path, W_OK) == 0;
}
bool brio_may_make_files(const char *folder) {
    return access(folder, W_OK | X_OK) == 0;
}

bool brio_is_link(const char *path) {
    struct stat s;
    return lstat(path, &s) == 0 && S_ISLNK(s.st_mode);
}

size_t brio_folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* --- descriptors --- */

int brio_open_input(const char *path) {
    struct stat facts;
    bool special = stat(path, &facts) == 0 && !S_ISREG(facts.st_mode);
    return open(path, O_RDONLY | O_CLOEXEC | (special ? O_NONBLOCK : 0));
}

int brio_open_device(const char *path) {
    return open(path, O_WRONLY | O_CLOEXEC | O_NONBLOCK);
}

int brio_open_end(const char *path) {
    return open(path, O_WRONLY | O_CLOEXEC | O_APPEND);
}

bool brio_is_writable(int file) {
    int flags = fcntl(file, F_GETFL);
    if (flags >= 0 && (flags & O_ACCMODE) == O_RDONLY) errno = EBADF;
    return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

int brio_copy_descriptor(int file) {
#ifdef __wasi__ /* which has no copies */
    (void)file;
    errno = ENOTSUP;
    return -1;
#else
    return fcntl(file, F_DUPFD_CLOEXEC, 0);
#endif
}

FILE *brio_stream_of(int file) {
    return fdopen(file, "w");
}
int brio_descriptor_of(FILE *stream) {
    return fileno(stream);
}
FILE *brio_open_stream(const char *path, const char *mode) {
    return fopen(path, mode);
}

bool brio_close(int file) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    int closed = close(file);
    brio_signals_restore(&quiet);
    return closed == 0 || errno == EINTR;
}

/* --- bytes --- */

int64_t brio_read_bytes(int file, void *bytes, size_t size) {
    return read(file, bytes, size);
}

int64_t brio_read_bytes_at(int file, void *bytes, size_t size, uint64_t place) {
    return pread(file, bytes, size, (off_t)place);
}

int64_t brio_write_bytes(int file, const void *bytes, size_t size) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    ssize_t done = write(file, bytes, size);
    brio_signals_restore(&quiet);
    return done;
}

int64_t brio_write_bytes_at(int file, const void *bytes, size_t size, uint64_t place) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    ssize_t done = pwrite(file, bytes, size, (off_t)place);
    brio_signals_restore(&quiet);
    return done;
}

int64_t brio_place_in(int file) {
    return lseek(file, 0, SEEK_CUR);
}

size_t brio_pipe_room(void) {
#ifdef PIPE_BUF
    return PIPE_BUF;
#else
    return 512; /* what POSIX promises */
#endif
}

bool brio_wait_ready(int file, bool writes, int milliseconds) {
    struct pollfd one = {.fd = file, .events = writes ? POLLOUT : POLLIN};
    int ready = poll(&one, 1, milliseconds);
    return ready > 0 || (ready < 0 && errno != EINTR);
}

void brio_wait_milliseconds(int milliseconds) {
    poll(NULL, 0, milliseconds);
}

bool brio_flush_to_disk(int file) {
    while (fsync(file) != 0)
        if (errno != EINTR) return false;
    return true;
}
