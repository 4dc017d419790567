/* Zstandard by libzstd; CMake leaves this file out where there is none. The window of a frame may be as long as the
 * memory limit lets it. */
#define ZSTD_STATIC_LINKING_ONLY /* for memory functions of the caller's */
#include "base/memory.h"
#include "io/compressed/coders.h"
#include <zstd.h>
#include <zstd_errors.h>

enum { LONGEST_WINDOW = sizeof(size_t) > 4 ? 31 : 30 /* its logarithm: the most that the format's --long makes */ };

static void *allocate(void *ctx, size_t size) {
    brio_status status = BRIO_OK;
    return brio_resize(ctx, NULL, size, 1, &status);
}

static void release(void *ctx, void *block) {
    brio_release(ctx, block);
}

static brio_coder_result step(void *state, brio_decoder_io *io, const char **why) {
    ZSTD_inBuffer in = {io->in, io->in_left, 0};
    ZSTD_outBuffer out = {io->out, io->room, 0};
    size_t result = ZSTD_decompressStream(state, &out, &in);
    io->in += in.pos;
    io->in_left -= in.pos;
    io->out += out.pos;
    io->room -= out.pos;
    if (!ZSTD_isError(result)) return result == 0 ? BRIO_CODER_END : BRIO_CODER_OK;
    *why = ZSTD_getErrorName(result);
    return ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation ? BRIO_CODER_NO_MEMORY : BRIO_CODER_DAMAGED;
}

static void free_state(brio_context *ctx, void *state) {
    (void)ctx;
    ZSTD_freeDStream(state);
}

brio_status brio_zstd_coder(brio_context *ctx, brio_coder *out) {
    brio_status status = BRIO_OK;
    ZSTD_DStream *z = ZSTD_createDStream_advanced((ZSTD_customMem){allocate, release, ctx});
    if (!z) status = BRIO_ERR_NO_MEMORY; /* allocate() has said why */
    BRIO_TRY(status);
    ZSTD_DCtx_setParameter(z, ZSTD_d_windowLogMax, LONGEST_WINDOW);
    *out = (brio_coder){z, step, free_state};
done:
    return status;
}
