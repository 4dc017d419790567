/* Blocks of bytes compressed by zlib, whose memory is counted as all other.
 *
 * Based on: Deutsch, Gailly. ZLIB compressed data format specification version 3.3. RFC 1950, 1996. */
#include "io/vtk/vtk_zlib.h"
#include "base/memory.h"
#include "io/formats.h"

#ifdef BRIO_HAS_ZLIB
#include <limits.h>
#include <zlib.h>

/* Level 5 of 9 is that of VTK. */
enum { LEVEL = 5 };

struct brio_vtk_zlib {
    z_stream stream;
};

static void *take_memory(void *ctx, unsigned count, unsigned size) {
    brio_status status = BRIO_OK;
    return brio_resize(ctx, NULL, count, size, &status);
}

static void give_memory(void *ctx, void *block) {
    brio_release(ctx, block);
}

bool brio_vtk_has_zlib(void) {
    return true;
}

brio_status brio_vtk_inflate_begin(brio_context *ctx, const char *name, brio_vtk_zlib **z) {
    brio_status status = BRIO_OK;
    (void)name;
    if (*z) {
        inflateReset(&(*z)->stream);
        return BRIO_OK;
    }
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, *z, 1));
    (*z)->stream = (z_stream){.zalloc = take_memory, .zfree = give_memory, .opaque = ctx};
    if (inflateInit(&(*z)->stream) == Z_OK) return BRIO_OK;
    brio_release(ctx, *z);
    *z = NULL;
    status = BRIO_ERR_NO_MEMORY; /* the message is that of take_memory */
done:
    return status;
}

brio_status brio_vtk_inflate(brio_vtk_zlib *z, brio_vtk_span *span, bool *ended) {
    unsigned in = span->in_left < UINT_MAX ? (unsigned)span->in_left : UINT_MAX;
    unsigned out = span->out_left < UINT_MAX ? (unsigned)span->out_left : UINT_MAX;
    z->stream.next_in = (Bytef *)(uintptr_t)span->in;
    z->stream.avail_in = in;
    z->stream.next_out = (Bytef *)span->out;
    z->stream.avail_out = out;
    int result = inflate(&z->stream, Z_NO_FLUSH);
    span->in = (const char *)z->stream.next_in; /* there may be no input: NULL */
    span->in_left -= in - z->stream.avail_in;
    span->out = (char *)z->stream.next_out;
    span->out_left -= out - z->stream.avail_out;
    *ended = result == Z_STREAM_END;
    if (result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR) return BRIO_OK;
    return result == Z_MEM_ERROR ? BRIO_ERR_NO_MEMORY : BRIO_ERR_FORMAT;
}

void brio_vtk_zlib_free(brio_context *ctx, brio_vtk_zlib *z) {
    if (z) inflateEnd(&z->stream);
    brio_release(ctx, z);
}

size_t brio_vtk_deflate_bound(size_t size) {
    return compressBound(size);
}

brio_status brio_vtk_deflate(brio_context *ctx, const void *bytes, size_t size, void *packed, size_t *packed_size) {
    z_stream stream = {.zalloc = take_memory, .zfree = give_memory, .opaque = ctx};
    if (deflateInit(&stream, LEVEL) != Z_OK) return BRIO_ERR_NO_MEMORY;
    stream.next_in = (Bytef *)(uintptr_t)bytes;
    stream.avail_in = (unsigned)size;
    stream.next_out = packed;
    stream.avail_out = (unsigned)*packed_size;
    int result = deflate(&stream, Z_FINISH);
    *packed_size = stream.total_out;
    deflateEnd(&stream);
    return result == Z_STREAM_END ? BRIO_OK : brio_fail(ctx, BRIO_ERR_INTERNAL, "zlib: no room for a block");
}

#else

bool brio_vtk_has_zlib(void) {
    return false;
}

brio_status brio_vtk_inflate_begin(brio_context *ctx, const char *name, brio_vtk_zlib **z) {
    *z = NULL;
    return brio_fail(ctx, BRIO_ERR_FORMAT,
                     "%s: the arrays are compressed, and this brio was built without zlib, which inflates them", name);
}

brio_status brio_vtk_inflate(brio_vtk_zlib *z, brio_vtk_span *span, bool *ended) {
    (void)z, (void)span;
    *ended = false;
    return BRIO_ERR_FORMAT;
}

void brio_vtk_zlib_free(brio_context *ctx, brio_vtk_zlib *z) {
    (void)ctx, (void)z;
}

size_t brio_vtk_deflate_bound(size_t size) {
    return size;
}

brio_status brio_vtk_deflate(brio_context *ctx, const void *bytes, size_t size, void *packed, size_t *packed_size) {
    (void)bytes, (void)size, (void)packed, (void)packed_size;
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "this brio was built without zlib, which compresses");
}

#endif
