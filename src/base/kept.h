/* Mappings that blocks have given back, kept for the next blocks: clearing fresh pages was a tenth of a surface's time. */
#ifndef BRIO_BASE_KEPT_H
#define BRIO_BASE_KEPT_H

#include "base/context.h"

/** Takes a mapping out of those that are kept, off the smallest that has so many bytes, a multiple of BRIO_PAGE; NULL when
 *  there is none. Its bytes are what they were. */
void *brio_kept_take(brio_context *ctx, size_t size);

/** Keeps a mapping that is no longer counted as live, or gives it back to the system. */
void brio_kept_give(brio_context *ctx, void *base, size_t size);

/** Gives back what is kept beyond the peak, now that more is live. */
void brio_kept_make_room(brio_context *ctx);

/** Gives everything back. */
void brio_kept_free(brio_context *ctx);

/** Between these two, which nest, all may be kept that the peak leaves room for; else 64 MiB. */
void brio_keep_begin(brio_context *ctx);
void brio_keep_end(brio_context *ctx);

#endif
