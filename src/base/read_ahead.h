/* Reading ahead in scratch files, in stretches of 32 KiB.
 *
 * A page fault reads one page and waits for the disk (memory.h). Code that knows the next address passes it to
 * brio_expect, and the system reads that stretch meanwhile. A stretch is requested again only after others that fill
 * one in BRIO_STRETCH_SHARE bytes of the memory: until then it is likely to be there. */
#ifndef BRIO_BASE_READ_AHEAD_H
#define BRIO_BASE_READ_AHEAD_H

#include "base/memory.h"
#include "platform/pages.h"
#include <stdint.h>
#include <string.h>

/* All chosen. */
enum { BRIO_STRETCH_BITS = 15, BRIO_STRETCHES = 2048, BRIO_STRETCH_SHARE = 8 };

typedef struct {
    bool active;    /* whether arrays are in scratch files */
    uint32_t now;   /* the number of requests */
    uint32_t keeps; /* requests after which a stretch is requested again */
    /* a hash table: the stretch that was requested last at each place, and the request that it was */
    uint32_t when[BRIO_STRETCHES];
    uintptr_t asked[BRIO_STRETCHES];
} brio_read_ahead;

/** Prepares *r. brio_expect has no effect if the context has no scratch folder. */
static inline void brio_read_ahead_start(brio_read_ahead *r, const brio_context *ctx) {
    memset(r, 0, sizeof *r);
    r->active = ctx->scratch != NULL;
    r->keeps = (uint32_t)(brio_memory_limit(ctx) / BRIO_STRETCH_SHARE >> BRIO_STRETCH_BITS);
}

/** Announces that the memory at an address will be needed soon. */
static inline void brio_expect(brio_read_ahead *r, const void *address) {
    if (!r->active) return;
    uintptr_t stretch = (uintptr_t)address >> BRIO_STRETCH_BITS;
    size_t i = stretch % BRIO_STRETCHES;
    if (r->asked[i] == stretch && r->now - r->when[i] < r->keeps) return;
    r->asked[i] = stretch;
    r->when[i] = r->now++;
    brio_pages_advise((void *)(stretch << BRIO_STRETCH_BITS), (size_t)1 << BRIO_STRETCH_BITS, BRIO_PAGES_SOON);
}

#endif
