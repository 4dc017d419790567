/* Counted memory: small blocks from the allocator, large blocks in mappings that grow without copying.
 *
 * I1  The header of a block, the 64 bytes before it, says how the block was made.
 * I2  A mapped block starts at a page.
 * I3  `live` is the sum of the sizes of all blocks outside scratch files.
 *
 * A page fault on a scratch file reads the window that the disk is set to, if that is small: rows that are near in
 * space lie near each other, so a page is seldom needed alone. Windows of megabytes, which some machines have, would
 * displace pages in use where memory is short: then a fault reads one page, unless the block is read in sequence. Code
 * that knows what it needs next asks for that (read_ahead.h, team.h). */
#include "base/memory.h"
#include "base/kept.h"
#include "base/poison.h"
#include "base/scratch_file.h"
#include "platform/pages.h"
#include <assert.h>
#include <errno.h>
#include <string.h>

/* HEADER: a cache line. FRONT: the bytes before a mapped block. LEAST_FILE, SHARE: a block of
 * these bytes, and of more than one in SHARE bytes of the memory, is in a scratch file, where there are such files;
 * chosen. */
enum { HEADER = BRIO_BLOCK_HEADER, FRONT = BRIO_SCRATCH_PAGE, MAP_FROM = BRIO_MAP_FROM };
enum { LEAST_FILE = 1 << 16, SHARE = 64 };

/* KIND_LOST is what is left of a header in a scratch file that somebody cut: zeros. Not even the size of such a block
 * is known, so that its mapping and its file stay. */
typedef enum { KIND_LOST, KIND_HEAP, KIND_MAPPED, KIND_FILE } block_kind;

typedef struct {
    size_t size;            /* bytes of the block and of what is in front of it */
    size_t used;            /* bytes that the caller requested; maintained if BRIO_POISON */
    brio_scratch_file file; /* of KIND_FILE */
    block_kind kind;
    bool cleared; /* a new mapping, all zero where nothing was written; never set if BRIO_POISON */
} block_header;

static block_header *header_of(const void *block) {
    assert(block && (uintptr_t)block % _Alignof(block_header) == 0);
    return (block_header *)((char *)block - HEADER);
}

/* Returns the bytes in front of a block: its header and, in mappings, the rest of the page. */
static size_t front_of(block_kind kind) {
    assert((unsigned)kind <= KIND_FILE); /* I1: a header, not any bytes */
    return kind == KIND_HEAP ? HEADER : FRONT;
}

static char *base_of(const void *block) {
    return (char *)block - front_of(header_of(block)->kind);
}

/* --- the account --- */

size_t brio_memory_limit(const brio_context *ctx) {
    assert(ctx->machine_limit > 0);
    return ctx->caller_limit && ctx->caller_limit < ctx->machine_limit ? ctx->caller_limit : ctx->machine_limit;
}

size_t brio_waiting_bytes(const brio_context *ctx, size_t files, size_t least, size_t most, size_t all) {
    size_t share = brio_memory_limit(ctx) / SHARE, each = (share < all ? share : all) / files;
    return each < least ? least : each < most ? each : most;
}

static bool account_add(brio_context *ctx, size_t bytes) {
    size_t live = __atomic_add_fetch(&ctx->live, bytes, __ATOMIC_RELAXED);
    assert(live >= bytes);
    if (live > brio_memory_limit(ctx)) {
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
    assert(__atomic_load_n(&ctx->live, __ATOMIC_RELAXED) >= bytes); /* I3 */
    __atomic_sub_fetch(&ctx->live, bytes, __ATOMIC_RELAXED);
}

size_t brio_context_memory(const brio_context *ctx) {
    return __atomic_load_n(&ctx->live, __ATOMIC_RELAXED);
}
size_t brio_context_memory_peak(const brio_context *ctx) {
    return __atomic_load_n(&ctx->peak, __ATOMIC_RELAXED);
}

/* --- mapped blocks --- */

static size_t round_up(size_t size, size_t unit) {
    assert(unit > 0 && size <= SIZE_MAX - unit);
    return (size + unit - 1) / unit * unit;
}

/* Returns whether a block of `size` bytes, header included, is a mapping. Where memory is little, a dozen blocks just
 * below MAP_FROM fill it, and only the pages of files can be given to others. */
static bool is_mapped(const brio_context *ctx, size_t size) {
    bool large = ctx->scratch && size >= LEAST_FILE && size > brio_memory_limit(ctx) / SHARE;
    return !ctx->custom && (large || size >= MAP_FROM);
}

/* Returns the bytes of a mapping for a block of `size` bytes, header included. */
static size_t mapped_size(size_t size) {
    assert(size >= HEADER);
    return round_up(size - HEADER + FRONT, BRIO_PAGE);
}

static void *map_file(brio_context *ctx, size_t size, brio_scratch_file *file, brio_status *status) {
    *status = brio_scratch_open(ctx, size, file);
    if (*status != BRIO_OK) return NULL;
    void *base = brio_pages_map_file(file->cached, size);
    if (base) {
        if (!file->in_runs) brio_pages_advise(base, size, BRIO_PAGES_RANDOM);
        return base;
    }
    *status = brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: a scratch file of %zu bytes cannot be mapped: %s",
                        brio_scratch_name(ctx), size, strerror(errno));
    brio_scratch_close(file);
    return NULL;
}

/* Returns a kept mapping or a new one; NULL if there is no memory.   cleared  set to true if it is new and all zero. */
static void *map_memory(brio_context *ctx, size_t size, bool *cleared) {
    void *base = brio_kept_take(ctx, size);
    *cleared = !base && !BRIO_POISON;
    if (account_add(ctx, size)) {
        if (!base) base = brio_pages_map(size);
        if (!base) account_sub(ctx, size);
        return base;
    }
    if (base) brio_kept_give(ctx, base, size);
    return NULL;
}

/* --- one block --- */

static size_t bytes_in(const void *block) {
    return header_of(block)->size - front_of(header_of(block)->kind);
}

/* Makes the first `used` bytes usable, and hides the rest of a mapping. Fills new bytes with the pattern of
 * poison.h. */
static void settle(void *block, size_t used) {
    if (!BRIO_POISON) return;
    block_header *h = header_of(block);
    /* a header in a file may be lost meanwhile */
    assert((h->kind != KIND_HEAP && h->kind != KIND_MAPPED) || used <= bytes_in(block));
    if (used > h->used) brio_poison_fill((char *)block + h->used, used - h->used);
    if (h->kind != KIND_HEAP) brio_poison_hide((char *)block + used, bytes_in(block) - used);
    h->used = used;
}

static brio_status refuse(brio_context *ctx, size_t size) {
    brio_block_is(ctx, size);
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "out of memory: %zu bytes more, %zu in use, limit %zu", size,
                     brio_context_memory(ctx), brio_memory_limit(ctx));
}

/* Makes a block of `size` bytes, header included. The block is in a scratch file if the context has a folder for them,
 * unless `in_memory` or too small. */
static void *block_new(brio_context *ctx, size_t size, bool in_memory, brio_status *status) {
    block_header h = {.size = size, .file = {.cached = -1, .direct = -1}, .kind = KIND_HEAP};
    char *base = NULL;
    if (ctx->custom || (!in_memory && !is_mapped(ctx, size))) {
        if (account_add(ctx, size)) {
            base = ctx->allocator.alloc(size, ctx->allocator.user);
            if (!base) account_sub(ctx, size);
        }
    } else {
        bool file = ctx->scratch && !in_memory;
        h.kind = file ? KIND_FILE : KIND_MAPPED;
        h.size = mapped_size(size);
        base = file ? map_file(ctx, h.size, &h.file, status) : map_memory(ctx, h.size, &h.cleared);
    }
    if (!base) {
        if (h.kind != KIND_FILE) *status = refuse(ctx, h.size);
        return NULL;
    }
    assert(h.size >= size && (h.kind == KIND_HEAP || h.size % BRIO_PAGE == 0));
    char *block = base + front_of(h.kind);
    assert(h.kind == KIND_HEAP || (uintptr_t)block % FRONT == 0); /* I2 */
    memcpy(block - HEADER, &h, sizeof h);
    settle(block, size - HEADER);
    return block;
}

static void unmap_file(void *base, size_t size) {
    brio_poison_show(base, size);
    brio_pages_unmap_file(base, size);
}

void brio_release(brio_context *ctx, void *block) {
    if (!block) return;
    block_header h = *header_of(block);
    if (h.kind == KIND_LOST) return;
    assert(h.kind == KIND_FILE || h.size >= front_of(h.kind));                                   /* I1 */
    assert(h.kind != KIND_MAPPED || (h.size % BRIO_PAGE == 0 && (uintptr_t)block % FRONT == 0)); /* I2 */
    if (h.kind != KIND_FILE) account_sub(ctx, h.size);
    if (h.kind == KIND_HEAP)
        ctx->allocator.free(base_of(block), ctx->allocator.user);
    else if (h.kind == KIND_MAPPED)
        brio_kept_give(ctx, base_of(block), h.size);
    else
        unmap_file(base_of(block), h.size);
    if (h.kind == KIND_FILE) brio_scratch_close(&h.file);
}

/* --- blocks in scratch files --- */

static brio_status lost(brio_context *ctx) {
    return brio_fail(ctx, BRIO_ERR_NO_MEMORY, "%s: a scratch file was cut from outside", brio_scratch_name(ctx));
}

void brio_expect_random(const void *block) {
    const block_header *h = header_of(block);
    if (h->kind == KIND_FILE && !h->file.in_runs) brio_pages_advise(base_of(block), h->size, BRIO_PAGES_RANDOM);
}

void brio_expect_sequence(const void *block) {
    const block_header *h = header_of(block);
    if (h->kind == KIND_FILE) brio_pages_advise(base_of(block), h->size, BRIO_PAGES_SEQUENCE);
}

void brio_block_direct(void *block, bool direct) {
    block_header *h = header_of(block);
    if (h->kind == KIND_FILE) brio_scratch_direct(&h->file, direct);
}

void brio_block_expect(const void *block, size_t offset, size_t size) {
    const block_header *h = header_of(block);
    if (h->kind == KIND_FILE) brio_scratch_expect(&h->file, FRONT + offset, size);
}

brio_status brio_block_settle(brio_context *ctx, const void *block, size_t offset, size_t size) {
    const block_header *h = header_of(block);
    return h->kind == KIND_FILE ? brio_scratch_settle(ctx, &h->file, FRONT + offset, size) : BRIO_OK;
}

brio_status brio_block_read(brio_context *ctx, const void *block, size_t offset, void *to, size_t size) {
    const block_header *h = header_of(block);
    if (h->kind == KIND_LOST) return lost(ctx);
    brio_scratch_file file = h->file; /* the header may be lost in the midst of the call */
    if (h->kind == KIND_FILE) return brio_scratch_read(ctx, &file, FRONT + offset, to, size);
    assert(h->kind == KIND_LOST || (offset <= bytes_in(block) && size <= bytes_in(block) - offset));
    memcpy(to, (const char *)block + offset, size);
    return BRIO_OK;
}

brio_status brio_block_write(brio_context *ctx, void *block, size_t offset, const void *from, size_t size) {
    const block_header *h = header_of(block);
    if (h->kind == KIND_LOST) return lost(ctx);
    brio_scratch_file file = h->file;
    if (h->kind == KIND_FILE) return brio_scratch_write(ctx, &file, FRONT + offset, from, size);
    assert(h->kind == KIND_LOST || (offset <= bytes_in(block) && size <= bytes_in(block) - offset));
    memcpy((char *)block + offset, from, size);
    return BRIO_OK;
}

/* --- blocks that grow --- */

/* Grows a mapping, or shrinks that of a file or of a system whose mappings do not divide. */
static void *block_remap(brio_context *ctx, void *block, size_t target, brio_status *status) {
    block_header h = *header_of(block);
    bool grows = target > h.size, file = h.kind == KIND_FILE;
    assert(h.kind != KIND_HEAP && target % BRIO_PAGE == 0);
    assert(grows || file || !brio_pages_divide());
    if (file && grows) {
        *status = brio_scratch_grow(ctx, &h.file, target);
        if (*status != BRIO_OK) return NULL;
    }
    if (!file && grows && !account_add(ctx, target - h.size)) {
        *status = refuse(ctx, target - h.size);
        return NULL;
    }
    brio_poison_show(base_of(block), h.size); /* the pages may move away from these addresses */
    char *base = brio_pages_remap(base_of(block), h.size, target, file ? h.file.cached : -1);
    if (!base) {
        if (!file && grows) account_sub(ctx, target - h.size);
        if (file && grows) brio_scratch_shrink(ctx, &h.file, h.size);
        header_of(block)->file = h.file;
        *status = refuse(ctx, target);
        return NULL;
    }
    assert((uintptr_t)base % FRONT == 0); /* I2 */
    if (!file && !grows) account_sub(ctx, h.size - target);
    header_of(base + FRONT)->size = target;
    brio_status shrunk = file && !grows ? brio_scratch_shrink(ctx, &h.file, target) : BRIO_OK;
    header_of(base + FRONT)->file = h.file;
    if (shrunk == BRIO_OK) return base + FRONT;
    *status = shrunk;
    return NULL;
}

static void *block_move(brio_context *ctx, void *block, size_t size, brio_status *status) {
    size_t old = BRIO_POISON ? header_of(block)->used : bytes_in(block);
    brio_scratch_file file = header_of(block)->file;
    bool is_file = header_of(block)->kind == KIND_FILE;
    if (is_file && (*status = brio_scratch_require_whole(ctx, &file)) != BRIO_OK) return NULL;
    void *moved = block_new(ctx, size, false, status);
    if (!moved) return NULL;
    memcpy(moved, block, old < size - HEADER ? old : size - HEADER);
    brio_release(ctx, block);
    return moved;
}

static void *block_resize_mapped(brio_context *ctx, void *block, size_t size, brio_status *status) {
    block_header *h = header_of(block);
    size_t target = mapped_size(size);
    assert(h->kind != KIND_HEAP);
    if (target == h->size) return block;
    if (target > h->size || h->kind == KIND_FILE || !brio_pages_divide())
        return block_remap(ctx, block, target, status);
    assert(h->kind == KIND_MAPPED && target < h->size);
    account_sub(ctx, h->size - target);
    brio_kept_give(ctx, base_of(block) + target, h->size - target);
    h->size = target;
    return block;
}

static void *block_realloc(brio_context *ctx, void *block, size_t size, brio_status *status) {
    size_t old = header_of(block)->size;
    assert(header_of(block)->kind == KIND_HEAP && size >= HEADER);
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

/* Computes the bytes of a block, header included. Returns false if they overflow. */
static bool block_bytes(brio_context *ctx, size_t count, size_t size, size_t *bytes, brio_status *status) {
    bool fits = !__builtin_mul_overflow(count, size, bytes) && *bytes <= SIZE_MAX / 2;
    if (!fits) *status = brio_fail(ctx, BRIO_ERR_NO_MEMORY, "out of memory: %zu objects of %zu bytes", count, size);
    *bytes += HEADER;
    return fits;
}

void *brio_resize(brio_context *ctx, void *block, size_t count, size_t size, brio_status *status) {
    size_t bytes;
    if (!block_bytes(ctx, count, size, &bytes, status)) return NULL;
    if (!block) return block_new(ctx, bytes, false, status);
    block_kind kind = header_of(block)->kind;
    if (kind == KIND_LOST) {
        *status = lost(ctx);
        return NULL;
    }
    bool mapped = is_mapped(ctx, bytes);
    /* the sanitizers of threads and memory do not see mremap: their shadow memory would stay at the old addresses */
    if (kind != KIND_HEAP && mapped && !BRIO_TSAN && !BRIO_MSAN)
        block = block_resize_mapped(ctx, block, bytes, status);
    else if (kind == KIND_HEAP && !mapped)
        block = block_realloc(ctx, block, bytes, status);
    else
        return block_move(ctx, block, bytes, status);
    if (block) settle(block, bytes - HEADER);
    return block;
}

brio_status brio_in_memory(brio_context *ctx, void *pointer_to_block, size_t count, size_t size) {
    brio_status status = BRIO_OK;
    size_t bytes;
    void *block = block_bytes(ctx, count, size, &bytes, &status) ? block_new(ctx, bytes, true, &status) : NULL;
    memcpy(pointer_to_block, &block, sizeof block);
    return status;
}

brio_status brio_zeroed(brio_context *ctx, void *pointer_to_block, size_t count, size_t size) {
    brio_status status = brio_resize_to(ctx, pointer_to_block, count, size);
    if (status != BRIO_OK) return status;
    void *block;
    memcpy(&block, pointer_to_block, sizeof block);
    block_header *h = header_of(block);
    if (BRIO_POISON || (h->kind != KIND_FILE && !h->cleared)) memset(block, 0, count * size);
    return BRIO_OK;
}

brio_status brio_reserve(brio_context *ctx, void *pointer_to_block, size_t *capacity, size_t need, size_t size) {
    assert(size > 0 && need > *capacity);
    size_t target = *capacity ? *capacity : 16;
    while (target < need) target = target > SIZE_MAX / 4 ? need : target * 2;
    brio_status status = brio_resize_to(ctx, pointer_to_block, target, size);
    assert(target >= need);
    if (status == BRIO_OK) *capacity = target;
    return status;
}
