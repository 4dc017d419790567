/* A scratch file: space on disk without a name, for arrays that do not fit in memory. It is mapped (memory.c), and can
 * be read and written by system calls. */
#ifndef BRIO_BASE_SCRATCH_FILE_H
#define BRIO_BASE_SCRATCH_FILE_H

#include "base/context.h"

enum { BRIO_SCRATCH_PAGE = 4096 }; /* transfers that bypass the system's cache are aligned to this */

typedef struct {
    int cached, direct; /* descriptors; direct is -1 unless brio_scratch_direct opened it */
    size_t size;        /* bytes; the mark behind them is lost if somebody else cuts the file */
    bool in_runs;       /* missing pages are read with those about them */
} brio_scratch_file;

/** Makes an empty file in a folder, as brio_scratch_open does, and closes it.
 *  Returns BRIO_OK, or BRIO_ERR_OPEN if the folder takes no files. */
brio_status brio_scratch_try(brio_context *ctx, const char *folder);

/** Finds how many bytes the context's scratch folder has room for. Returns false if that is not known, or there is no
 *  such folder. */
bool brio_scratch_room(const brio_context *ctx, uint64_t *bytes);

/** Makes a file of `size` bytes in the context's scratch folder. Its space is allocated on disk, so that a full disk
 *  fails here.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_scratch_open(brio_context *ctx, size_t size, brio_scratch_file *out);

/** Grows a file to `size` bytes; on failure the file keeps its size. Raises no signal.
 *  Returns BRIO_OK, or BRIO_ERR_NO_MEMORY for a full disk, a limit on the size of files (RLIMIT_FSIZE), or a file that
 *  was cut. */
brio_status brio_scratch_grow(brio_context *ctx, brio_scratch_file *f, size_t size);

/** Shrinks a file to `size` bytes, or leaves it as it is where the disk does not take its new end. No mapping may
 *  extend beyond them.
 *  Returns BRIO_OK, or BRIO_ERR_NO_MEMORY for a file that was cut. */
brio_status brio_scratch_shrink(brio_context *ctx, brio_scratch_file *f, size_t size);

void brio_scratch_close(brio_scratch_file *f);

/** Sets whether transfers of whole pages bypass the system's cache from now on. No effect where the file system has no
 *  such transfers. */
void brio_scratch_direct(brio_scratch_file *f, bool direct);

/** Reads or writes bytes by system calls, without a page fault for each page. The bytes do not stay in memory. A file
 *  that was cut is an error, also if the write has grown it again, with zeros for what is lost.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_scratch_read(brio_context *ctx, const brio_scratch_file *f, size_t offset, void *to, size_t size);
brio_status brio_scratch_write(brio_context *ctx, const brio_scratch_file *f, size_t offset, const void *from,
                               size_t size);

/** Fails if somebody else has cut a file, even if it has grown again.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_scratch_require_whole(brio_context *ctx, const brio_scratch_file *f);

/** Has the disk begin to write bytes. Returns BRIO_OK, or BRIO_ERR_NO_MEMORY where it does not. */
brio_status brio_scratch_settle(brio_context *ctx, const brio_scratch_file *f, size_t offset, size_t size);

/** Announces that these bytes will be read soon. */
void brio_scratch_expect(const brio_scratch_file *f, size_t offset, size_t size);

/** Returns how sentences name the folder of scratch files. Its name is put aside while tiles are in memory. */
static inline const char *brio_scratch_name(const brio_context *ctx) {
    return ctx->scratch ? ctx->scratch : "scratch";
}

#endif
