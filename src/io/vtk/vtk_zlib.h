/* Blocks of bytes compressed by zlib. A build without zlib has these functions, and they fail with a sentence. */
#ifndef BRIO_IO_VTK_ZLIB_H
#define BRIO_IO_VTK_ZLIB_H

#include "base/context.h"

typedef struct brio_vtk_zlib brio_vtk_zlib;

/* No byte of a block stands for more than this many: a match of 258 bytes takes two bits at least. */
enum { BRIO_VTK_MOST_INFLATED = 1032 };

/** Begins a block.   z  NULL before the first one; freed by brio_vtk_zlib_free.   name  of the file.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (brio was built without zlib), BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_inflate_begin(brio_context *ctx, const char *name, brio_vtk_zlib **z);

/* Where to read and write. */
typedef struct brio_vtk_span {
    const char *in;
    size_t in_left;
    char *out;
    size_t out_left;
} brio_vtk_span;

/** Inflates until the input or the room is used up, or the block ends.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (without a message) if the bytes are damaged, BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_inflate(brio_vtk_zlib *z, brio_vtk_span *span, bool *ended);
void brio_vtk_zlib_free(brio_context *ctx, brio_vtk_zlib *z);

/** Returns the most bytes that a block of `size` bytes is compressed to. */
size_t brio_vtk_deflate_bound(size_t size);
/** Compresses a block. Threads may call this together.   packed  room for `packed_size` bytes, which must be
 *  brio_vtk_deflate_bound(size) at least; receives the size.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_deflate(brio_context *ctx, const void *bytes, size_t size, void *packed, size_t *packed_size);

#endif
