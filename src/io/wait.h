/* Waiting for a pipe, a terminal or a device, whose other side may never be ready. */
#ifndef BRIO_IO_WAIT_H
#define BRIO_IO_WAIT_H

#include "base/context.h"

typedef enum { BRIO_WAIT_READ, BRIO_WAIT_WRITE } brio_wait;

/** Waits until the file can be read or written without blocking, or its other side is gone. Reports progress at least
 *  ten times a second, so that the caller can cancel.
 *  fraction  of the work that is done.
 *  Returns BRIO_OK or BRIO_ERR_CANCELLED. After BRIO_OK the next read or write says what happened. */
brio_status brio_wait_for(brio_context *ctx, int file, brio_wait what, double fraction);

/** Waits 20 ms for something that the system cannot announce, and reports progress. Returns BRIO_OK or
 *  BRIO_ERR_CANCELLED. */
brio_status brio_wait_a_moment(brio_context *ctx, brio_wait what, double fraction);

#endif
