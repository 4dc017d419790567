/* Waiting for a pipe, a terminal or a device, which may keep its other side waiting for ever. */
#ifndef BRIO_IO_WAIT_H
#define BRIO_IO_WAIT_H

#include "base/context.h"

typedef enum { BRIO_WAIT_READ, BRIO_WAIT_WRITE } brio_wait;

/** Waits until the file can be read or written without blocking, or its other side is gone. Progress is reported at
 *  least ten times a second meanwhile, so that the caller can cancel.
 *  fraction  of the work that is done.   Returns BRIO_OK (the next read or write says what happened) or
 *  BRIO_ERR_CANCELLED. */
brio_status brio_wait_for(brio_context *ctx, int file, brio_wait what, double fraction);

/** Waits a moment for something that the system cannot announce, and reports progress. */
brio_status brio_wait_a_moment(brio_context *ctx, brio_wait what, double fraction);

#endif
