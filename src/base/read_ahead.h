/* Reading ahead in scratch files, by stretches of 32 KiB.
 *
 * A fault reads one page and waits for the disk (memory.h). Who knows what comes next says so here, and it is read
 * meanwhile. A stretch that was asked for a short while ago is not asked for again. */
#ifndef BRIO_BASE_READ_AHEAD_H
#define BRIO_BASE_READ_AHEAD_H

#include "base/context.h"
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>

enum { BRIO_STRETCH_BITS = 15, BRIO_STRETCHES = 2048, BRIO_STRETCH_KEEPS = 1 << 14 };

typedef struct {
    bool active;  /* arrays are in scratch files */
    uint32_t now; /* counts the steps of the work */
    uint32_t when[BRIO_STRETCHES];
    uintptr_t asked[BRIO_STRETCHES];
} brio_read_ahead;

static inline void brio_read_ahead_start(brio_read_ahead *r, const brio_context *ctx) {
    memset(r, 0, sizeof *r);
    r->active = ctx->scratch != NULL;
}

/** What is at the address will be needed soon. */
static inline void brio_expect(brio_read_ahead *r, const void *address) {
    if (!r->active) return;
    uintptr_t stretch = (uintptr_t)address >> BRIO_STRETCH_BITS;
    size_t i = stretch % BRIO_STRETCHES;
    if (r->asked[i] == stretch && r->now - r->when[i] < BRIO_STRETCH_KEEPS) return;
    r->asked[i] = stretch;
    r->when[i] = r->now;
    madvise((void *)(stretch << BRIO_STRETCH_BITS), (size_t)1 << BRIO_STRETCH_BITS, MADV_WILLNEED);
}

#endif
