/* Scratch files: space on disk, and transfers by system calls.
 *
 * Data that is read or written once, in sequence, does not profit from the system's cache, which costs a copy and
 * memory that other arrays need. So transfers of whole pages bypass the cache, where the file system can do that. Other
 * transfers go through the cache, and their pages are released at once.
 *
 * Somebody else may cut a file, and the next call that grows it fills what is lost with zeros. So each file ends with a
 * mark, which is lost with anything before it, and every call here looks for it after its work. */
#define _GNU_SOURCE
#include "base/scratch_file.h"
#include "base/quiet_signals.h"
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

/* --- transfers --- */

static bool whole_pages(size_t offset, const void *memory, size_t size) {
    return (offset | (uintptr_t)memory | size) % BRIO_SCRATCH_PAGE == 0;
}

/* Bytes to read or to write. */
typedef struct {
    size_t offset, size;
    char *in;        /* destination of a read, or NULL */
    const char *out; /* source of a write, or NULL */
} transfer;

/* Makes one system call, which may move only some of the bytes. */
static ssize_t move_some(int file, const transfer *t) {
    if (t->in) return pread(file, t->in, t->size, (off_t)t->offset);
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    ssize_t n = pwrite(file, t->out, t->size, (off_t)t->offset);
    brio_signals_restore(&quiet);
    return n;
}

/* Moves all bytes.   direct  set to whether they bypassed the cache. */
static brio_status move_all(brio_context *ctx, const brio_scratch_file *f, transfer t, bool *direct) {
    assert(f->cached >= 0 && !t.in != !t.out);
    *direct = f->direct >= 0;
    while (t.size > 0) {
        bool past = f->direct >= 0 && whole_pages(t.offset, t.in ? t.in : t.out, t.size);
        ssize_t n = move_some(past ? f->direct : f->cached, &t);
        if (n < 0 && errno == EINVAL && past) n = move_some(f->cached, &t), past = false;
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot %s a scratch file: %s", ctx->scratch,
                             t.in ? "read" : "write", n ? strerror(errno) : "it ends early");
        assert((size_t)n <= t.size);
        *direct &= past;
        t.offset += (size_t)n, t.size -= (size_t)n;
        if (t.in) t.in += n;
        if (t.out) t.out += n;
    }
    return BRIO_OK;
}

/* --- the mark --- */

static const char MARK[8] = {'b', 'r', 'i', 'o', ' ', 'e', 'n', 'd'};

/* Writes what is behind the file's bytes. */
static brio_status put(brio_context *ctx, const brio_scratch_file *f, const char bytes[sizeof MARK]) {
    bool direct;
    return move_all(ctx, f, (transfer){.offset = f->size, .size = sizeof MARK, .out = bytes}, &direct);
}

brio_status brio_scratch_require_whole(brio_context *ctx, const brio_scratch_file *f) {
    char found[sizeof MARK] = {0};
    ssize_t n = 0;
    for (size_t at = 0; at < sizeof found && (n >= 0 || errno == EINTR); at += n > 0 ? (size_t)n : 0) {
        n = pread(f->cached, found + at, sizeof found - at, (off_t)(f->size + at));
        if (n == 0) break;
    }
    if (!memcmp(found, MARK, sizeof MARK)) return BRIO_OK;
    if (n < 0)
        return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot read a scratch file: %s", ctx->scratch, strerror(errno));
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: a scratch file was cut from outside", ctx->scratch);
}

/* --- size --- */

static brio_status no_room(brio_context *ctx, size_t size, int error) {
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: no room for a scratch file of %zu bytes: %s",
                     ctx->scratch ? ctx->scratch : "scratch", size, strerror(error));
}

/* Opens an empty file without a name. Returns its descriptor, or -1 with errno. */
static int open_nameless(const char *folder) {
    if (!*folder) { /* "" and a slash would be the root folder */
        errno = ENOENT;
        return -1;
    }
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0) {
        char name[4096];
        snprintf(name, sizeof name, "%s/brio-XXXXXX", folder);
        file = mkostemp(name, O_CLOEXEC);
        if (file >= 0) unlink(name);
    }
    return file;
}

brio_status brio_scratch_try(brio_context *ctx, const char *folder) {
    int file = open_nameless(folder);
    if (file < 0)
        return brio_fail(ctx, BRIO_ERR_OPEN, "%s: not a writable folder: %s", *folder ? folder : "\"\"",
                         strerror(errno));
    close(file);
    return BRIO_OK;
}

brio_status brio_scratch_open(brio_context *ctx, size_t size, brio_scratch_file *out) {
    int file = open_nameless(ctx->scratch);
    if (file < 0) return no_room(ctx, size, errno);
    *out = (brio_scratch_file){.cached = file, .direct = -1};
    brio_status status = brio_scratch_grow(ctx, out, size);
    if (status != BRIO_OK) brio_scratch_close(out);
    /* a page fault reads one page unless the block is read in sequence, see memory.c */
    if (status == BRIO_OK) posix_fadvise(file, 0, 0, POSIX_FADV_RANDOM);
    return status;
}

/* Allocates space. The signals are blocked, because a limit on the size of files raises one. Where the file system
 * cannot allocate, the C library writes a byte to each block instead. */
static int allocate(int file, size_t offset, size_t size) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    int error = posix_fallocate(file, (off_t)offset, (off_t)size);
    brio_signals_restore(&quiet);
    return error;
}

/* Shrinks a file. If this fails, the space is lost only until the file is closed. */
static void cut(int file, size_t size) {
    brio_quiet_signals quiet;
    brio_signals_block(&quiet);
    while (ftruncate(file, (off_t)size) != 0 && errno == EINTR) {}
    brio_signals_restore(&quiet);
}

/* Allocates in pieces of PIECE bytes (chosen). A signal that the process handles ends a call early, and some file
 * systems then give back all that the call had allocated. With one call for all bytes, the signals of a timer could
 * keep it from ever ending. */
static int allocate_pieces(int file, size_t from, size_t to) {
    enum { PIECE = 1 << 24 };
    while (from < to) {
        size_t piece = to - from < PIECE ? to - from : PIECE;
        int error = allocate(file, from, piece);
        if (error && error != EINTR) return error;
        if (!error) from += piece;
    }
    return 0;
}

/* Puts a mark behind the grown file, and zeros where the old one was. */
static brio_status move_mark(brio_context *ctx, const brio_scratch_file *f, const brio_scratch_file *grown) {
    BRIO_FORWARD(put(ctx, grown, MARK));
    if (f->size) BRIO_FORWARD(brio_scratch_require_whole(ctx, f));
    if (f->size) BRIO_FORWARD(put(ctx, f, (const char[sizeof MARK]){0}));
    return BRIO_OK;
}

brio_status brio_scratch_grow(brio_context *ctx, brio_scratch_file *f, size_t size) {
    assert(size >= f->size);
    brio_scratch_file grown = *f;
    grown.size = size;
    int error = allocate_pieces(f->cached, f->size ? f->size + sizeof MARK : 0, size + sizeof MARK);
    brio_status status = error ? no_room(ctx, size, error) : move_mark(ctx, f, &grown);
    if (status == BRIO_OK)
        *f = grown;
    else if (f->size)
        cut(f->cached, f->size + sizeof MARK);
    return status;
}

brio_status brio_scratch_shrink(brio_context *ctx, brio_scratch_file *f, size_t size) {
    assert(size <= f->size || f->size == 0); /* 0: the header was lost */
    brio_scratch_file shrunk = *f;
    shrunk.size = size;
    bool marked = put(ctx, &shrunk, MARK) == BRIO_OK;
    brio_status status = brio_scratch_require_whole(ctx, f);
    if (status != BRIO_OK || !marked) return status;
    cut(f->cached, size + sizeof MARK);
    *f = shrunk;
    return brio_scratch_require_whole(ctx, f);
}

void brio_scratch_close(brio_scratch_file *f) {
    assert(f->cached >= 0);
    close(f->cached);
    if (f->direct >= 0) close(f->direct);
}

void brio_scratch_direct(brio_scratch_file *f, bool direct) {
    char name[64];
    if (direct == (f->direct >= 0)) return;
    snprintf(name, sizeof name, "/proc/self/fd/%d", f->cached);
    if (!direct) close(f->direct);
    f->direct = direct ? open(name, O_RDWR | O_DIRECT | O_CLOEXEC) : -1;
}

/* --- reading and writing --- */

/* Makes the disk take bytes. A failure must not be lost: pages that the disk did not take are clean afterwards, and
 * what is read later is something else. Returns whether there was none. */
static bool give(int file, size_t offset, size_t size, unsigned flags) {
    return sync_file_range(file, (off_t)offset, (off_t)size, flags) == 0 || errno == ESPIPE || errno == EINVAL ||
           errno == ENOSYS;
}

/* Starts writing each stretch that ends between `begin` and `end`, waits for the stretch before it, and releases that
 * stretch's pages. Otherwise sequential writes would fill memory with pages that cannot be reused before they are
 * written. STRETCH is chosen. */
static brio_status write_behind(brio_context *ctx, int file, size_t begin, size_t end) {
    enum { STRETCH = 1 << 22 };
    const unsigned wait = SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER;
    assert(begin <= end);
    for (size_t at = (begin / STRETCH + 1) * STRETCH; at <= end; at += STRETCH) {
        bool taken = give(file, at - STRETCH, STRETCH, SYNC_FILE_RANGE_WRITE);
        if (taken && at >= 2 * (size_t)STRETCH) {
            size_t before = at - 2 * (size_t)STRETCH;
            taken = give(file, before, STRETCH, wait);
            posix_fadvise(file, (off_t)before, STRETCH, POSIX_FADV_DONTNEED);
        }
        if (!taken)
            return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot write a scratch file: %s", ctx->scratch,
                             strerror(errno));
    }
    return BRIO_OK;
}

brio_status brio_scratch_read(brio_context *ctx, const brio_scratch_file *f, size_t offset, void *to, size_t size) {
    bool direct = true;
    brio_status status = move_all(ctx, f, (transfer){.offset = offset, .size = size, .in = to}, &direct);
    if (status == BRIO_OK) status = brio_scratch_require_whole(ctx, f);
    if (!direct) posix_fadvise(f->cached, (off_t)offset, (off_t)size, POSIX_FADV_DONTNEED);
    return status;
}

brio_status brio_scratch_write(brio_context *ctx, const brio_scratch_file *f, size_t offset, const void *from,
                               size_t size) {
    bool direct = true;
    brio_status status = move_all(ctx, f, (transfer){.offset = offset, .size = size, .out = from}, &direct);
    if (status == BRIO_OK) status = brio_scratch_require_whole(ctx, f);
    if (status == BRIO_OK && !direct) status = write_behind(ctx, f->cached, offset, offset + size);
    return status;
}

void brio_scratch_expect(const brio_scratch_file *f, size_t offset, size_t size) {
    posix_fadvise(f->cached, (off_t)offset, (off_t)size, POSIX_FADV_WILLNEED);
}
