/* Counted memory: small blocks from the allocator, large ones in mappings that grow without copying.
 *
 * Invariants: a block's header tells how it was made; `live` is the sum of the sizes of anonymous blocks; a mapped
 * file is allocated on disk (posix_fallocate) before its pages can be touched, so that a full disk is a status.
 *
 * A fault on a mapped file reads a single page, unless the block is read in sequence: the system would read what its
 * device is set to, up to megabytes, and where memory is short these throw out what is used. What is needed next is
 * asked for where that is known (read_ahead.h). */
#define _GNU_SOURCE
#include "base/memory.h"
#include "base/kept.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

/* The thread sanitizer does not see mremap: pages that moved away would still count as the old block's. */
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define BRIO_COPIES_INSTEAD 1
#endif
#endif
#ifndef BRIO_COPIES_INSTEAD
#define BRIO_COPIES_INSTEAD 0
#endif

enum { HEADER = 64, MAP_FROM = 1 << 20 };

typedef enum { KIND_HEAP, KIND_MAPPED, KIND_FILE } block_kind;

typedef struct {
    size_t size; /* of the whole block, header included */
    int file;    /* descriptor of KIND_FILE */
    block_kind kind;
    bool cleared; /* it is a new mapping, all zero where nothing was written */
} block_header;

static block_header *header_of(void *block) {
    return (block_header *)((char *)block - HEADER);
}

/* --- the account --- */

static bool account_add(brio_context *ctx, size_t bytes) {
    size_t live = __atomic_add_fetch(&ctx->live, bytes, __ATOMIC_RELAXED);
    size_t limit = ctx->machine_limit;
    if (ctx->caller_limit && ctx->caller_limit < limit) limit = ctx->caller_limit;
    if (live > limit) {
        __atomic_sub_fetch(&ctx->live, bytes, __ATOMIC_RELAXED);
        return false;
    }
    size_t peak = __atomic_load_n(&ctx->peak, __ATOMIC_RELAXED);
    while (live > peak &&
           !__atomic_compare_exchange_n(&ctx->peak, &peak, live, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
    brio_kept_make_room(ctx);
    return true;
}

static void account_sub(brio_context *ctx, size_t bytes) {
    __atomic_sub_fetch(&ctx->live, bytes, __ATOMIC_RELAXED);
}

size_t brio_context_memory(const brio_context *ctx) {
    return __atomic_load_n(&ctx->live, __ATOMIC_RELAXED);
}
size_t brio_context_memory_peak(const brio_context *ctx) {
    return __atomic_load_n(&ctx->peak, __ATOMIC_RELAXED);
}

static size_t number_in_file(const char *path) {
    FILE *f = fopen(path, "r");
    unsigned long long bytes = 0;
    if (!f) return SIZE_MAX;
    int read = fscanf(f, "%llu", &bytes);
    fclose(f);
    return read == 1 && bytes ? (size_t)bytes : SIZE_MAX;
}

/* The least limit over the process' memory cgroup and its ancestors. */
static size_t cgroup_memory(void) {
    size_t least = SIZE_MAX;
    char line[512];
    FILE *f = fopen("/proc/self/cgroup", "r");
    if (!f) return least;
    while (fgets(line, sizeof line, f)) {
        char *controllers = strchr(line, ':');
        char *path = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!path) continue;
        *path++ = 0;
        path[strcspn(path, "\n")] = 0;
        bool v2 = controllers[1] == 0;
        if (!v2 && strcmp(controllers + 1, "memory")) continue;
        for (;;) {
            char name[1024];
            snprintf(name, sizeof name,
                     v2 ? "/sys/fs/cgroup%s/memory.max" : "/sys/fs/cgroup/memory%s/memory.limit_in_bytes", path);
            size_t limit = number_in_file(name);
            if (limit < least) least = limit;
            char *slash = strrchr(path, '/');
            if (!slash || path[0] == 0) break;
            *slash = 0;
        }
    }
    fclose(f);
    return least;
}

size_t brio_machine_memory(void) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    size_t machine = pages > 0 && page > 0 ? (size_t)pages * (size_t)page : SIZE_MAX;
    size_t group = cgroup_memory();
    return group < machine ? group : machine;
}

/* --- mapped blocks --- */

static size_t round_up(size_t size, size_t unit) {
    return (size + unit - 1) / unit * unit;
}

static size_t mapped_size(size_t size) {
    return round_up(size, BRIO_PAGE);
}

/* Pages of the usual size: clearing a huge page at its first touch drives everything else out of the caches, which cost
 * the triangulation of four million points a fifth of its time (docs/performance.md). */
static void *map_anonymous(size_t size) {
    void *base = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return base == MAP_FAILED ? NULL : base;
}

static void *map_file(brio_context *ctx, size_t size, int *file, brio_status *status) {
    *file = open(ctx->scratch, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (*file < 0) {
        char name[4096];
        snprintf(name, sizeof name, "%s/brio-XXXXXX", ctx->scratch);
        *file = mkstemp(name);
        if (*file >= 0) unlink(name);
    }
    int error = *file < 0 ? errno : posix_fallocate(*file, 0, (off_t)size);
    void *base = error ? MAP_FAILED : mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, *file, 0);
    if (base != MAP_FAILED) {
        madvise(base, size, MADV_RANDOM);
        posix_fadvise(*file, 0, 0, POSIX_FADV_RANDOM);
        return base;
    }
    *status = brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: no room for a scratch file of %zu bytes: %s", ctx->scratch, size,
                        strerror(error ? error : errno));
    if (*file >= 0) close(*file);
    return NULL;
}

/* A mapping, one that was kept where there is one; *cleared: it is new and all zero. NULL when there is no memory. */
static void *map_memory(brio_context *ctx, size_t size, bool *cleared) {
    void *base = brio_kept_take(ctx, size);
    *cleared = !base;
    if (account_add(ctx, size)) {
        if (!base) base = map_anonymous(size);
        if (!base) account_sub(ctx, size);
        return base;
    }
    if (base) brio_kept_give(ctx, base, size);
    return NULL;
}

/* --- one block --- */

static brio_status refuse(brio_context *ctx, size_t size) {
    size_t limit = ctx->machine_limit;
    if (ctx->caller_limit && ctx->caller_limit < limit) limit = ctx->caller_limit;
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "out of memory: %zu bytes more, %zu in use, limit %zu", size,
                     brio_context_memory(ctx), limit);
}

static void *block_new(brio_context *ctx, size_t size, brio_status *status) {
    block_header h = {size, -1, KIND_HEAP, false};
    char *base = NULL;
    if (ctx->custom || size < MAP_FROM) {
        if (account_add(ctx, size)) {
            base = ctx->allocator.alloc(size, ctx->allocator.user);
            if (!base) account_sub(ctx, size);
        }
    } else {
        h.kind = ctx->scratch ? KIND_FILE : KIND_MAPPED;
        h.size = mapped_size(size);
        base = ctx->scratch ? map_file(ctx, h.size, &h.file, status) : map_memory(ctx, h.size, &h.cleared);
    }
    if (!base) {
        if (h.kind != KIND_FILE) *status = refuse(ctx, h.size);
        return NULL;
    }
    memcpy(base, &h, sizeof h);
    return base + HEADER;
}

void brio_release(brio_context *ctx, void *block) {
    if (!block) return;
    block_header h = *header_of(block);
    if (h.kind != KIND_FILE) account_sub(ctx, h.size);
    if (h.kind == KIND_HEAP)
        ctx->allocator.free(header_of(block), ctx->allocator.user);
    else if (h.kind == KIND_MAPPED)
        brio_kept_give(ctx, header_of(block), h.size);
    else
        munmap(header_of(block), h.size);
    if (h.kind == KIND_FILE) close(h.file);
}

void brio_expect_random(const void *block) {
    const block_header *h = (const block_header *)((const char *)block - HEADER);
    if (h->kind == KIND_FILE) madvise((char *)block - HEADER, h->size, MADV_RANDOM);
}

void brio_expect_sequence(const void *block) {
    const block_header *h = (const block_header *)((const char *)block - HEADER);
    if (h->kind == KIND_FILE) madvise((char *)block - HEADER, h->size, MADV_NORMAL);
}

/* One call may move less than it was asked to. */
static brio_status move_bytes(brio_context *ctx, int file, size_t offset, char *in, const char *out, size_t size) {
    while (size > 0) {
        ssize_t n = in ? pread(file, in, size, (off_t)offset) : pwrite(file, out, size, (off_t)offset);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: cannot %s a scratch file: %s", ctx->scratch,
                             in ? "read" : "write", n ? strerror(errno) : "it ends early");
        offset += (size_t)n, size -= (size_t)n;
        if (in) in += n;
        if (out) out += n;
    }
    return BRIO_OK;
}

/* Has the stretch that ends here written, waits for the one before and lets its pages go: what is written in sequence
 * would otherwise fill the memory with pages that have to be written before they can be taken. */
static void write_behind(int file, size_t begin, size_t end) {
    enum { STRETCH = 1 << 22 };
    for (size_t at = round_up(begin + 1, STRETCH); at <= end; at += STRETCH) {
        sync_file_range(file, (off_t)(at - STRETCH), STRETCH, SYNC_FILE_RANGE_WRITE);
        if (at < 2 * (size_t)STRETCH) continue;
        off_t before = (off_t)(at - 2 * (size_t)STRETCH);
        sync_file_range(file, before, STRETCH,
                        SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
        posix_fadvise(file, before, STRETCH, POSIX_FADV_DONTNEED);
    }
}

void brio_block_expect(const void *block, size_t offset, size_t size) {
    const block_header *h = (const block_header *)((const char *)block - HEADER);
    if (h->kind == KIND_FILE) posix_fadvise(h->file, (off_t)(HEADER + offset), (off_t)size, POSIX_FADV_WILLNEED);
}

brio_status brio_block_read(brio_context *ctx, const void *block, size_t offset, void *to, size_t size) {
    const block_header *h = (const block_header *)((const char *)block - HEADER);
    brio_status status = BRIO_OK;
    if (h->kind == KIND_FILE) {
        status = move_bytes(ctx, h->file, HEADER + offset, to, NULL, size);
        posix_fadvise(h->file, (off_t)(HEADER + offset), (off_t)size, POSIX_FADV_DONTNEED);
    } else {
        memcpy(to, (const char *)block + offset, size);
    }
    return status;
}

brio_status brio_block_write(brio_context *ctx, void *block, size_t offset, const void *from, size_t size) {
    const block_header *h = header_of(block);
    brio_status status = BRIO_OK;
    if (h->kind == KIND_FILE) {
        status = move_bytes(ctx, h->file, HEADER + offset, NULL, from, size);
        write_behind(h->file, HEADER + offset, HEADER + offset + size);
    } else {
        memcpy((char *)block + offset, from, size);
    }
    return status;
}

/* Grows a mapping, or shrinks that of a file, in place of copying it. */
static void *block_remap(brio_context *ctx, void *block, size_t target, brio_status *status) {
    block_header h = *header_of(block);
    bool grows = target > h.size, file = h.kind == KIND_FILE;
    int error = file && grows ? posix_fallocate(h.file, 0, (off_t)target) : 0;
    if (error) {
        *status = brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: no room for a scratch file of %zu bytes: %s",
                            ctx->scratch ? ctx->scratch : "scratch", target, strerror(error));
        return NULL;
    }
    if (!file && !account_add(ctx, target - h.size)) {
        *status = refuse(ctx, target - h.size);
        return NULL;
    }
    char *base = mremap(header_of(block), h.size, target, MREMAP_MAYMOVE);
    if (base == MAP_FAILED) {
        if (!file) account_sub(ctx, target - h.size);
        *status = refuse(ctx, target);
        return NULL;
    }
    if (file && !grows && ftruncate(h.file, (off_t)target) != 0) errno = 0;
    ((block_header *)base)->size = target;
    return base + HEADER;
}

static void *block_move(brio_context *ctx, void *block, size_t size, brio_status *status) {
    size_t old = header_of(block)->size;
    void *moved = block_new(ctx, size, status);
    if (!moved) return NULL;
    memcpy(moved, block, (old < size ? old : size) - HEADER);
    brio_release(ctx, block);
    return moved;
}

static void *block_resize_mapped(brio_context *ctx, void *block, size_t size, brio_status *status) {
    block_header *h = header_of(block);
    size_t target = mapped_size(size);
    if (target == h->size) return block;
    if (target > h->size || h->kind == KIND_FILE) return block_remap(ctx, block, target, status);
    account_sub(ctx, h->size - target);
    brio_kept_give(ctx, (char *)h + target, h->size - target);
    h->size = target;
    return block;
}

static void *block_realloc(brio_context *ctx, void *block, size_t size, brio_status *status) {
    size_t old = header_of(block)->size;
    if (size > old && !account_add(ctx, size - old)) {
        *status = refuse(ctx, size - old);
        return NULL;
    }
    char *base = ctx->allocator.realloc(header_of(block), size, ctx->allocator.user);
    if (!base) {
        if (size > old) account_sub(ctx, size - old);
        *status = refuse(ctx, size);
        return NULL;
    }
    if (size < old) account_sub(ctx, old - size);
    ((block_header *)base)->size = size;
    return base + HEADER;
}

void *brio_resize(brio_context *ctx, void *block, size_t count, size_t size, brio_status *status) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2) {
        *status = brio_fail(ctx, BRIO_ERR_NO_MEMORY, "out of memory: %zu objects of %zu bytes", count, size);
        return NULL;
    }
    bytes += HEADER;
    if (!block) return block_new(ctx, bytes, status);
    block_kind kind = header_of(block)->kind;
    bool mapped = !ctx->custom && bytes >= MAP_FROM;
    if (kind != KIND_HEAP && mapped && !BRIO_COPIES_INSTEAD) return block_resize_mapped(ctx, block, bytes, status);
    if (kind == KIND_HEAP && !mapped) return block_realloc(ctx, block, bytes, status);
    return block_move(ctx, block, bytes, status);
}

brio_status brio_zeroed(brio_context *ctx, void *pointer_to_block, size_t count, size_t size) {
    brio_status status = brio_resize_to(ctx, pointer_to_block, count, size);
    if (status != BRIO_OK) return status;
    void *block;
    memcpy(&block, pointer_to_block, sizeof block);
    block_header *h = header_of(block);
    if (h->kind != KIND_FILE && !h->cleared) memset(block, 0, count * size);
    return BRIO_OK;
}

brio_status brio_reserve(brio_context *ctx, void *pointer_to_block, size_t *capacity, size_t need, size_t size) {
    size_t target = *capacity ? *capacity : 16;
    while (target < need) target = target > SIZE_MAX / 4 ? need : target * 2;
    brio_status status = brio_resize_to(ctx, pointer_to_block, target, size);
    if (status == BRIO_OK) *capacity = target;
    return status;
}
