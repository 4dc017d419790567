/* Deflate by zlib, with or without the header of gzip. CMake leaves this file out where there is no zlib. zlib checks
 * the length and the checksum of a member. */
#include "base/memory.h"
#include "io/compressed/coders.h"
#include <limits.h>
#define ZLIB_CONST /* the input is not written to */
#include <zlib.h>

enum { WITH_GZIP = 31, RAW = -15 /* bits of the window, as zlib encodes the kind of header */ };

static void *allocate(void *ctx, uInt count, uInt size) {
    brio_status status = BRIO_OK;
    return brio_resize(ctx, NULL, count, size, &status);
}

static void release(void *ctx, void *block) {
    brio_release(ctx, block);
}

/* Sets the lengths that zlib can take at once: its counts have 32 bits. */
static uInt at_once(size_t count) {
    return count < UINT_MAX ? (uInt)count : UINT_MAX;
}

static brio_coder_result step(void *state, brio_decoder_io *io, const char **why) {
    z_stream *z = state;
    uInt in = at_once(io->in_left), room = at_once(io->room);
    z->next_in = (const Bytef *)io->in;
    z->avail_in = in;
    z->next_out = (Bytef *)io->out;
    z->avail_out = room;
    int result = inflate(z, Z_NO_FLUSH);
    io->in += in - z->avail_in;
    io->in_left -= in - z->avail_in;
    io->out += room - z->avail_out;
    io->room -= room - z->avail_out;
    *why = z->msg;
    if (result == Z_STREAM_END) return inflateReset(z) == Z_OK ? BRIO_CODER_END : BRIO_CODER_DAMAGED;
    if (result == Z_MEM_ERROR) return BRIO_CODER_NO_MEMORY;
    return result == Z_OK || result == Z_BUF_ERROR ? BRIO_CODER_OK : BRIO_CODER_DAMAGED;
}

static void free_state(brio_context *ctx, void *state) {
    inflateEnd(state);
    brio_release(ctx, state);
}

brio_status brio_zlib_coder(brio_context *ctx, bool gzip, brio_coder *out) {
    brio_status status = BRIO_OK;
    z_stream *z = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, z, 1));
    z->zalloc = allocate;
    z->zfree = release;
    z->opaque = ctx;
    int result = inflateInit2(z, gzip ? WITH_GZIP : RAW);
    if (result == Z_MEM_ERROR) status = BRIO_ERR_NO_MEMORY; /* allocate() has said why */
    BRIO_TRY(status);
    BRIO_REQUIRE(ctx, result == Z_OK, BRIO_ERR_INTERNAL, "zlib %s is of another kind than %s", zlibVersion(),
                 ZLIB_VERSION);
    *out = (brio_coder){z, step, free_state};
    z = NULL;
done:
    brio_release(ctx, z);
    return status;
}
