/* A scratch file: room on disk without a name, for arrays that do not fit in memory.
 *
 * It is mapped (memory.c), and can be read and written by whole calls. */
#ifndef BRIO_BASE_SCRATCH_FILE_H
#define BRIO_BASE_SCRATCH_FILE_H

#include "base/context.h"

enum { BRIO_SCRATCH_PAGE = 4096 }; /* what transfers past the system's cache are aligned to */

typedef struct {
    int cached,
        direct; /* descriptors; direct is -1 until it is wanted, and where the file system has no such transfers */
} brio_scratch_file;

/** A file of so many bytes in the context's scratch folder, allocated on disk, so that a full disk is a status. */
brio_status brio_scratch_open(brio_context *ctx, size_t size, brio_scratch_file *out);

/** Allocates a file up to `size` bytes; on failure the file keeps its size. A limit on the size of files (RLIMIT_FSIZE)
 *  is BRIO_ERR_NO_MEMORY like a full disk, and raises no signal. */
brio_status brio_scratch_grow(brio_context *ctx, const brio_scratch_file *f, size_t size);

/** Gives back what is behind `size` bytes, which nothing may have mapped. */
void brio_scratch_shrink(const brio_scratch_file *f, size_t size);

void brio_scratch_close(brio_scratch_file *f);

/** Whether, from here on, transfers of whole pages pass the system's cache by. */
void brio_scratch_direct(brio_scratch_file *f, bool direct);

/** Bytes come and go by whole calls, without a fault for each page, and do not stay in memory. */
brio_status brio_scratch_read(brio_context *ctx, const brio_scratch_file *f, size_t offset, void *to, size_t size);
brio_status brio_scratch_write(brio_context *ctx, const brio_scratch_file *f, size_t offset, const void *from,
                               size_t size);

/** These bytes will be read soon. */
void brio_scratch_expect(const brio_scratch_file *f, size_t offset, size_t size);

#endif
