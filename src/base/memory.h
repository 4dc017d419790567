/* All memory of the library comes from here and is counted against the context's limit.
 *
 * Small blocks come from the context's allocator. Large ones (from 1 MiB on, with the system's allocator) are mappings
 * of their own, or of an unlinked file in the scratch folder; they grow by mremap, which moves pages and copies
 * nothing. Mappings that are given back are kept for later blocks (kept.h). A header of 64 bytes before each block holds its
 * size, so the block stays aligned to a cache line; large blocks start a page. */
#ifndef BRIO_BASE_MEMORY_H
#define BRIO_BASE_MEMORY_H

#include "base/context.h"

/** Makes block hold count elements of `size` bytes, keeping what it held; NULL makes a new one. On failure *status
 *  tells and the old block stays. New bytes are not set. */
void *brio_resize(brio_context *ctx, void *block, size_t count, size_t size, brio_status *status);

/** Frees a block; NULL is accepted. */
void brio_release(brio_context *ctx, void *block);

/** Memory that this process may use: the least of the machine's and its cgroups' (v1 and v2). */
size_t brio_machine_memory(void);

/** The same for a context, which may allow less. */
size_t brio_memory_limit(const brio_context *ctx);

/** The block will be read from its beginning to its end: a fault on its scratch file then reads on. Other blocks' faults
 *  read a single page. Nothing for blocks in memory. */
void brio_expect_sequence(const void *block);

/** What holds for every block at first, again. */
void brio_expect_random(const void *block);

/** Copies the bytes [offset, offset + size) of a block. Those of a scratch file come and go by whole calls, without a
 *  fault for each page, and do not stay in memory: for what is read or written in sequence. The other side is memory. */
brio_status brio_block_read(brio_context *ctx, const void *block, size_t offset, void *to, size_t size);
brio_status brio_block_write(brio_context *ctx, void *block, size_t offset, const void *from, size_t size);

/** Whether, from here on, copies of whole pages, which start at a page of the block and of the memory on the other side,
 *  pass the system's cache by. Nothing for blocks in memory. */
void brio_block_direct(void *block, bool direct);

/** These bytes will be read soon. */
void brio_block_expect(const void *block, size_t offset, size_t size);

static inline brio_status brio_resize_to(brio_context *ctx, void *pointer_to_block, size_t count, size_t size) {
    brio_status status = BRIO_OK;
    void *block;
    __builtin_memcpy(&block, pointer_to_block, sizeof block);
    block = brio_resize(ctx, block, count, size, &status);
    if (status == BRIO_OK) __builtin_memcpy(pointer_to_block, &block, sizeof block);
    return status;
}

brio_status brio_zeroed(brio_context *ctx, void *pointer_to_block, size_t count, size_t size);
brio_status brio_in_memory(brio_context *ctx, void *pointer_to_block, size_t count, size_t size);

/** p = room for count elements of *p; bytes not set. */
#define BRIO_ALLOC(ctx, p, count) ((p) = NULL, brio_resize_to(ctx, &(p), count, sizeof *(p)))
/** The same in memory, even where big arrays are in scratch files, and from a page on: for workspace of a bounded
 *  size, which is not resized. */
#define BRIO_ALLOC_IN_MEMORY(ctx, p, count) ((p) = NULL, brio_in_memory(ctx, &(p), count, sizeof *(p)))
/** p = room for count elements of *p, all bytes 0. */
#define BRIO_ALLOC_ZERO(ctx, p, count) ((p) = NULL, brio_zeroed(ctx, &(p), count, sizeof *(p)))
/** p = the same block with room for count elements. */
#define BRIO_RESIZE(ctx, p, count) brio_resize_to(ctx, &(p), count, sizeof *(p))

/** Makes room for at least `need` elements in a growing array: doubles *capacity as often as needed. */
#define BRIO_RESERVE(ctx, p, capacity, need)                                                                           \
    ((size_t)(need) <= (size_t)(capacity) ? BRIO_OK : brio_reserve(ctx, &(p), &(capacity), need, sizeof *(p)))
brio_status brio_reserve(brio_context *ctx, void *pointer_to_block, size_t *capacity, size_t need, size_t size);

#endif
