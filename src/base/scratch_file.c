/* Scratch files: space on disk, and transfers by system calls.
 *
 * Data that is read or written once, in sequence, does not profit from the system's cache, which costs a copy and
 * memory that other arrays need. So transfers of whole pages bypass the cache, where the file system can do that. Other
 * transfers go through the cache, and their pages are released at once.
 *
 * Somebody else may cut a file, and the next call that grows it fills what is lost with zeros. So each file ends with a
 * mark, which is lost with anything before it, and every call here looks for it after its work. */
#include "base/scratch_file.h"
#include "platform/disk.h"
#include "platform/file.h"
#include "platform/folder.h"
#include <assert.h>
#include <errno.h>
#include <stdint.h>
#include <string.h>

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
static int64_t move_some(int file, const transfer *t) {
    return t->in ? brio_read_bytes_at(file, t->in, t->size, t->offset)
                 : brio_write_bytes_at(file, t->out, t->size, t->offset);
}

/* Moves all bytes.   direct  set to whether they bypassed the cache. */
static brio_status move_all(brio_context *ctx, const brio_scratch_file *f, transfer t, bool *direct) {
    assert(f->cached >= 0 && !t.in != !t.out);
    *direct = f->direct >= 0;
    while (t.size > 0) {
        bool past = f->direct >= 0 && whole_pages(t.offset, t.in ? t.in : t.out, t.size);
        int64_t n = move_some(past ? f->direct : f->cached, &t);
        if (n < 0 && errno == EINVAL && past) n = move_some(f->cached, &t), past = false;
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot %s a scratch file: %s", brio_scratch_name(ctx),
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
    int64_t n = 0;
    for (size_t at = 0; at < sizeof found && (n >= 0 || errno == EINTR); at += n > 0 ? (size_t)n : 0) {
        n = brio_read_bytes_at(f->cached, found + at, sizeof found - at, f->size + at);
        if (n == 0) break;
    }
    if (!memcmp(found, MARK, sizeof MARK)) return BRIO_OK;
    if (n < 0)
        return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot read a scratch file: %s", brio_scratch_name(ctx),
                         strerror(errno));
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: a scratch file was cut from outside", brio_scratch_name(ctx));
}

/* --- size --- */

static brio_status no_room(brio_context *ctx, size_t size, int error) {
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: no room for a scratch file of %zu bytes: %s", brio_scratch_name(ctx),
                     size, strerror(error));
}

brio_status brio_scratch_try(brio_context *ctx, const char *folder) {
    int file = brio_open_nameless(folder);
    if (file < 0)
        return brio_fail(ctx, BRIO_ERR_OPEN, "%s: not a writable folder: %s", *folder ? folder : "\"\"",
                         strerror(errno));
    brio_close(file);
    return BRIO_OK;
}

bool brio_scratch_room(const brio_context *ctx, uint64_t *bytes) {
    return ctx->scratch && brio_free_bytes(ctx->scratch, bytes);
}

brio_status brio_scratch_open(brio_context *ctx, size_t size, brio_scratch_file *out) {
    int file = brio_open_nameless(ctx->scratch);
    if (file < 0) return no_room(ctx, size, errno);
    *out = (brio_scratch_file){.cached = file, .direct = -1, .in_runs = ctx->scratch_in_runs};
    brio_status status = brio_scratch_grow(ctx, out, size);
    if (status != BRIO_OK) brio_scratch_close(out);
    /* a system call reads what it asks for; page faults see memory.c */
    if (status == BRIO_OK) brio_advise_cache(file, 0, 0, BRIO_CACHE_RANDOM);
    return status;
}

/* Allocates in pieces of PIECE bytes (chosen). A signal that the process handles ends a call early, and some file
 * systems then give back all that the call had allocated. With one call for all bytes, the signals of a timer could
 * keep it from ever ending. */
static int allocate_pieces(int file, size_t from, size_t to) {
    enum { PIECE = 1 << 24 };
    while (from < to) {
        size_t piece = to - from < PIECE ? to - from : PIECE;
        int error = brio_allocate_space(file, from, piece);
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
        brio_set_size(f->cached, f->size + sizeof MARK);
    return status;
}

brio_status brio_scratch_shrink(brio_context *ctx, brio_scratch_file *f, size_t size) {
    assert(size <= f->size || f->size == 0); /* 0: the header was lost */
    brio_scratch_file shrunk = *f;
    shrunk.size = size;
    bool marked = put(ctx, &shrunk, MARK) == BRIO_OK;
    brio_status status = brio_scratch_require_whole(ctx, f);
    if (status != BRIO_OK || !marked) return status;
    brio_set_size(f->cached, size + sizeof MARK); /* if this fails, the space is lost until the file is closed */
    *f = shrunk;
    return brio_scratch_require_whole(ctx, f);
}

void brio_scratch_close(brio_scratch_file *f) {
    assert(f->cached >= 0);
    brio_close(f->cached);
    if (f->direct >= 0) brio_close(f->direct);
}

void brio_scratch_direct(brio_scratch_file *f, bool direct) {
    if (direct == (f->direct >= 0)) return;
    if (!direct) brio_close(f->direct);
    f->direct = direct ? brio_open_direct(f->cached) : -1;
}

/* --- reading and writing --- */

/* Starts writing each stretch that ends between `begin` and `end`, waits for the stretch before it, and releases that
 * stretch's pages. Otherwise sequential writes would fill memory with pages that cannot be reused before they are
 * written. A failure must not be lost: pages that the disk did not take are clean afterwards, and what is read later is
 * something else. STRETCH is chosen. */
static brio_status write_behind(brio_context *ctx, int file, size_t begin, size_t end) {
    enum { STRETCH = 1 << 22 };
    assert(begin <= end);
    for (size_t at = (begin / STRETCH + 1) * STRETCH; at <= end; at += STRETCH) {
        bool taken = brio_start_writing(file, at - STRETCH, STRETCH);
        if (taken && at >= 2 * (size_t)STRETCH) {
            size_t before = at - 2 * (size_t)STRETCH;
            taken = brio_wait_written(file, before, STRETCH);
            brio_advise_cache(file, before, STRETCH, BRIO_CACHE_NEVER);
        }
        if (!taken)
            return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot write a scratch file: %s", brio_scratch_name(ctx),
                             strerror(errno));
    }
    return BRIO_OK;
}

brio_status brio_scratch_read(brio_context *ctx, const brio_scratch_file *f, size_t offset, void *to, size_t size) {
    bool direct = true;
    brio_status status = move_all(ctx, f, (transfer){.offset = offset, .size = size, .in = to}, &direct);
    if (status == BRIO_OK) status = brio_scratch_require_whole(ctx, f);
    if (!direct) brio_advise_cache(f->cached, offset, size, BRIO_CACHE_NEVER);
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

brio_status brio_scratch_settle(brio_context *ctx, const brio_scratch_file *f, size_t offset, size_t size) {
    if (brio_start_writing(f->cached, offset, size)) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot write a scratch file: %s", brio_scratch_name(ctx),
                     strerror(errno));
}

void brio_scratch_expect(const brio_scratch_file *f, size_t offset, size_t size) {
    brio_advise_cache(f->cached, offset, size, BRIO_CACHE_SOON);
}
