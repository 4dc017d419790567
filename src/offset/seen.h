/* What was found out about sets of four samples, for the next round. */
#ifndef BRIO_OFFSET_SEEN_H
#define BRIO_OFFSET_SEEN_H

#include "base/memory.h"

/** A hash table from sets of four numbers to a byte. */
typedef struct brio_seen {
    uint32_t (*key)[4]; /* ascending; BRIO_SEEN_NONE first in an empty place */
    uint8_t *value;
    size_t places; /* a power of two, or 0 */
} brio_seen;

#define BRIO_SEEN_NONE UINT32_MAX

/** Makes a table with room for `count` sets.   out  freed with brio_seen_free, also after a failure. */
brio_status brio_seen_new(brio_context *ctx, size_t count, brio_seen *out);
void brio_seen_free(brio_context *ctx, brio_seen *seen);

/** Returns where a set's value is, or NULL. Any thread may call this while nothing is added. */
const uint8_t *brio_seen_find(const brio_seen *seen, const uint32_t set[4]);

/** Adds a set that is not in the table, which has room for it. */
void brio_seen_add(brio_seen *seen, const uint32_t set[4], uint8_t value);

#endif
