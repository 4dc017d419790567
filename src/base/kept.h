/* Mappings that blocks have given back, kept for later blocks. Measured: without them, clearing fresh pages took a
 * tenth of the time of a surface. */
#ifndef BRIO_BASE_KEPT_H
#define BRIO_BASE_KEPT_H

#include "base/context.h"

/** Unmaps memory; the system may then reuse the addresses. */
void brio_unmap(void *base, size_t size);

/** Takes `size` bytes, a multiple of BRIO_PAGE, off the smallest kept mapping that has as many. Returns NULL if there
 *  is none. The bytes have the values that they had. */
void *brio_kept_take(brio_context *ctx, size_t size);

/** Keeps a mapping, or unmaps it if there is no room, or if mappings do not divide here. The caller has already
 *  subtracted it from the live bytes. */
void brio_kept_give(brio_context *ctx, void *base, size_t size);

/** Unmaps what is kept beyond the limit, after more bytes have become live. */
void brio_kept_make_room(brio_context *ctx);

/** Unmaps all kept mappings. */
void brio_kept_free(brio_context *ctx);

/** Start and end a stretch in which the context keeps up to peak - live bytes. Outside of all stretches, which may be
 *  nested, it keeps at most 64 MiB. */
void brio_keep_begin(brio_context *ctx);
void brio_keep_end(brio_context *ctx);

#endif
