/* The caller's points as records. */
#ifndef BRIO_TRIANGULATION_RECORDS_H
#define BRIO_TRIANGULATION_RECORDS_H

#include "order/order.h"
#include "triangulation/tetrahedra.h"

/** Makes a private copy of the input as records; -0 becomes 0. Reads each number once: the input may change meanwhile,
 *  and what the call refuses or copies is what it read.
 *  order  the input's index of each record; NULL for the input's own order.
 *  room   further records at the end, which are 0.
 *  hash   receives the hash of what was read (base/points_hash.h), or NULL.
 *  out    owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE (the message names the first bad point), BRIO_ERR_NO_MEMORY. */
brio_status brio_records_new(brio_context *ctx, const brio_input *input, const uint32_t *order, size_t room,
                             uint64_t *hash, brio_record **out);

#endif
