/* All memory of the library comes from here and is counted against the context's limit.
 *
 * Small blocks come from the context's allocator. With the system's allocator, blocks from 1 MiB on are mappings,
 * anonymous or of unlinked files in the scratch folder. Mappings grow by brio_pages_remap, which on Linux moves pages
 * and copies nothing. Anonymous mappings that are released are kept for later blocks (kept.h). Before each block is a
 * header of 64 bytes, so blocks are aligned to a cache line. Mapped blocks start at a page. */
#ifndef BRIO_BASE_MEMORY_H
#define BRIO_BASE_MEMORY_H

#include "base/context.h"

/** Bytes from which blocks are mappings; chosen. Tests set less, so that small inputs have mappings. */
#ifndef BRIO_MAP_FROM
#define BRIO_MAP_FROM (1 << 20)
#endif

/** Bytes before each block, which count as its own. */
enum { BRIO_BLOCK_HEADER = 64 };

/** Resizes a block to count elements of `size` bytes and keeps its contents; block NULL makes a new block. New bytes
 *  are not set. Returns the block. On failure sets *status, returns NULL and leaves the old block as it was. */
void *brio_resize(brio_context *ctx, void *block, size_t count, size_t size, brio_status *status);

/** Frees a block; NULL is accepted. */
void brio_release(brio_context *ctx, void *block);

/** Returns the lesser of the machine's memory (brio_system_memory, when the context was made) and the caller's
 *  limit. */
size_t brio_memory_limit(const brio_context *ctx);

/** Returns how many bytes wait for each of some files, to be written together: with all files at most `all` bytes and
 *  one in 64 of the memory limit, as far as each has `least`.
 *  least, most  bytes of a file.   files  greater than 0. */
size_t brio_waiting_bytes(const brio_context *ctx, size_t files, size_t least, size_t most, size_t all);

/** Announces that the block will be read from its beginning to its end: a page fault on its scratch file then reads
 *  ahead, as far as the disk is set to. No effect on blocks in memory. */
void brio_expect_sequence(const void *block);

/** Ends brio_expect_sequence: a page fault reads what it does for new blocks. */
void brio_expect_random(const void *block);

/** Copies the bytes [offset, offset + size) of a block from or to memory, for data that is used once, in sequence. A
 *  scratch file is read or written by system calls, without a page fault for each page, and its bytes do not stay in
 *  memory.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_block_read(brio_context *ctx, const void *block, size_t offset, void *to, size_t size);
brio_status brio_block_write(brio_context *ctx, void *block, size_t offset, const void *from, size_t size);

/** Sets whether brio_block_read and brio_block_write bypass the system's cache from now on, where block and memory both
 *  start at a page and whole pages are copied. No effect on blocks in memory. */
void brio_block_direct(void *block, bool direct);

/** Announces that these bytes will be read soon. */
void brio_block_expect(const void *block, size_t offset, size_t size);

/** Has the disk begin to write these bytes, so that their pages can be used for others soon. No effect on blocks in
 *  memory. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_block_settle(brio_context *ctx, const void *block, size_t offset, size_t size);

/* Resizes the block of the pointer that `pointer_to_block` points to, of any type. This function and the next two leave
 * the pointer as it was on failure, except brio_in_memory, which sets it to NULL. */
static inline brio_status brio_resize_to(brio_context *ctx, void *pointer_to_block, size_t count, size_t size) {
    brio_status status = BRIO_OK;
    void *block;
    __builtin_memcpy(&block, pointer_to_block, sizeof block);
    block = brio_resize(ctx, block, count, size, &status);
    if (status == BRIO_OK) __builtin_memcpy(pointer_to_block, &block, sizeof block);
    return status;
}

/* Resizes a block and sets its elements to 0 (brio_zeroed); makes a new block that is not in a scratch file
 * (brio_in_memory). */
brio_status brio_zeroed(brio_context *ctx, void *pointer_to_block, size_t count, size_t size);
brio_status brio_in_memory(brio_context *ctx, void *pointer_to_block, size_t count, size_t size);

/** Sets p to a new block of count elements of *p. The bytes are not set. On failure p is NULL. */
#define BRIO_ALLOC(ctx, p, count) ((p) = NULL, brio_resize_to(ctx, &(p), count, sizeof *(p)))
/** BRIO_ALLOC in memory, not in a scratch file: a mapping, which starts at a page, whatever its size. For workspace of
 *  bounded size, which is not resized. */
#define BRIO_ALLOC_IN_MEMORY(ctx, p, count) ((p) = NULL, brio_in_memory(ctx, &(p), count, sizeof *(p)))
/** BRIO_ALLOC with all bytes 0. */
#define BRIO_ALLOC_ZERO(ctx, p, count) ((p) = NULL, brio_zeroed(ctx, &(p), count, sizeof *(p)))
/** Resizes the block p to count elements of *p. */
#define BRIO_RESIZE(ctx, p, count) brio_resize_to(ctx, &(p), count, sizeof *(p))

/** Makes room for at least `need` elements in a growing array: doubles *capacity until it suffices, starting from
 *  16. */
#define BRIO_RESERVE(ctx, p, capacity, need)                                                                           \
    ((size_t)(need) <= (size_t)(capacity) ? BRIO_OK : brio_reserve(ctx, &(p), &(capacity), need, sizeof *(p)))
brio_status brio_reserve(brio_context *ctx, void *pointer_to_block, size_t *capacity, size_t need, size_t size);

#endif
