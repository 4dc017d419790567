/* The libraries behind brio_decoder. Without a library its brio_..._coder functions are not there. */
#ifndef BRIO_IO_COMPRESSED_CODERS_H
#define BRIO_IO_COMPRESSED_CODERS_H

#include "io/compressed/decoder.h"

typedef enum {
    BRIO_CODER_OK,
    BRIO_CODER_END /* of a member or frame */,
    BRIO_CODER_DAMAGED,
    BRIO_CODER_NO_MEMORY
} brio_coder_result;

/** A library's decoder. step decodes until the input is used up, the room is full, or a member ends; *why receives a
 *  sentence of the library for damage, or NULL. */
typedef struct brio_coder {
    void *state;
    brio_coder_result (*step)(void *state, brio_decoder_io *io, const char **why);
    void (*free)(brio_context *ctx, void *state);
} brio_coder;

#ifdef BRIO_HAS_ZLIB
brio_status brio_zlib_coder(brio_context *ctx, bool gzip, brio_coder *out);
#endif
#ifdef BRIO_HAS_ZSTD
brio_status brio_zstd_coder(brio_context *ctx, brio_coder *out);
#endif

#endif
