/* What the decoders share: members one after the other, places of errors, and the sentences for libraries that this
 * build lacks. */
#include "io/compressed/coders.h"
#include "base/memory.h"
#include <inttypes.h>
#include <string.h>

struct brio_decoder {
    brio_context *ctx;
    const char *name;
    brio_packing packing;
    brio_coder coder;
    uint64_t taken; /* compressed bytes that were decoded */
    bool open;      /* a member has begun and not ended */
    bool ended;     /* a member has ended */
};

static const char *const names[] = {"", "gzip", "zstd", "deflate"};

brio_packing brio_packing_of(const char *bytes, size_t size) {
    const uint8_t *b = (const uint8_t *)bytes;
    if (size < BRIO_PACKING_LOOK_AT) return BRIO_PACKING_NONE;
    /* the method is 8, and the upper three flags are 0: no number in single precision of a usual size begins so */
    if (b[0] == 0x1f && b[1] == 0x8b && b[2] == 8 && b[3] < 0x20) return BRIO_PACKING_GZIP;
    if (!memcmp(b, "\x28\xb5\x2f\xfd", 4)) return BRIO_PACKING_ZSTD;
    if ((b[0] & 0xf0) == 0x50 && !memcmp(b + 1, "\x2a\x4d\x18", 3)) return BRIO_PACKING_ZSTD; /* a skippable frame */
    return BRIO_PACKING_NONE;
}

static brio_status make_coder(brio_context *ctx, const char *name, brio_packing packing, brio_coder *coder) {
    const char *library = packing == BRIO_PACKING_ZSTD ? "libzstd" : "zlib";
#ifdef BRIO_HAS_ZLIB
    if (packing != BRIO_PACKING_ZSTD) return brio_zlib_coder(ctx, packing == BRIO_PACKING_GZIP, coder);
#endif
#ifdef BRIO_HAS_ZSTD
    if (packing == BRIO_PACKING_ZSTD) return brio_zstd_coder(ctx, coder);
#endif
    (void)coder;
    return brio_fail(ctx, BRIO_ERR_FORMAT,
                     "%s: compressed by %s, which this build of brio cannot read: it was built without %s", name,
                     names[packing], library);
}

brio_status brio_decoder_new(brio_context *ctx, const char *name, brio_packing packing, brio_decoder **out) {
    brio_status status = BRIO_OK;
    brio_decoder *d = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, d, 1));
    d->ctx = ctx;
    d->name = name;
    d->packing = packing;
    BRIO_TRY(make_coder(ctx, name, packing, &d->coder));
    *out = d;
    d = NULL;
done:
    brio_release(ctx, d);
    return status;
}

void brio_decoder_free(brio_decoder *d) {
    if (!d) return;
    if (d->coder.free) d->coder.free(d->ctx, d->coder.state);
    brio_release(d->ctx, d);
}

/* Passes over the zeros with which tapes pad gzip, between members. */
static void skip_zeros(brio_decoder *d, brio_decoder_io *io) {
    if (d->packing != BRIO_PACKING_GZIP || d->open || !d->ended) return;
    while (io->in_left && !*io->in) {
        io->in++;
        io->in_left--;
        d->taken++;
    }
}

static brio_status fail(const brio_decoder *d, brio_coder_result result, const char *why) {
    if (result == BRIO_CODER_NO_MEMORY) return BRIO_ERR_NO_MEMORY; /* the message is there */
    bool behind = d->ended && !d->open;
    return brio_fail(d->ctx, BRIO_ERR_FORMAT, "%s: %s near byte %" PRIu64 " of the compressed file%s%s%s", d->name,
                     behind ? "what follows the compressed data is none" : "the compressed data is damaged", d->taken,
                     why ? " (" : "", why ? why : "", why ? ")" : "");
}

brio_status brio_decode(brio_decoder *d, brio_decoder_io *io) {
    for (;;) {
        skip_zeros(d, io);
        if (!d->open && !io->in_left) return BRIO_OK;
        if (!d->open && d->ended && d->packing == BRIO_PACKING_DEFLATE) return fail(d, BRIO_CODER_DAMAGED, NULL);
        const char *why = NULL;
        size_t in_left = io->in_left, room = io->room;
        brio_coder_result result = d->coder.step(d->coder.state, io, &why);
        d->taken += in_left - io->in_left;
        if (result == BRIO_CODER_DAMAGED || result == BRIO_CODER_NO_MEMORY) return fail(d, result, why);
        d->open = result != BRIO_CODER_END;
        d->ended |= result == BRIO_CODER_END;
        bool stuck = in_left == io->in_left && room == io->room;
        if (stuck && in_left && room && d->open) return fail(d, BRIO_CODER_DAMAGED, "no progress");
        if (!io->room || (d->open && !io->in_left)) return BRIO_OK;
    }
}

brio_status brio_decoder_check_end(const brio_decoder *d) {
    if (!d->open) return BRIO_OK;
    return brio_fail(d->ctx, BRIO_ERR_FORMAT,
                     "%s: the compressed data breaks off: the file ends at byte %" PRIu64 ", within it", d->name,
                     d->taken);
}
