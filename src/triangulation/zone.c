/* Zones: see zone.h.
 *
 * Taking a segment synchronizes with the thread that gave it back: what that one wrote to tetrahedra with a vertex
 * there is seen. */
#include "triangulation/zone.h"
#include "base/memory.h"
#include "base/stress.h"
#include <assert.h>

enum { SEGMENTS_KEPT = 8 };

brio_status brio_zone_new(brio_context *ctx, const uint32_t *rank, int shift, size_t segments, uint8_t *taken,
                          brio_zone *out) {
    assert(0 <= shift && shift < 32 && segments > 0);
    *out = (brio_zone){.rank = rank, .shift = shift, .taken = taken, .now = 1};
    brio_status status = BRIO_ALLOC_ZERO(ctx, out->held, segments);
    return status == BRIO_OK ? BRIO_ALLOC(ctx, out->segment, segments) : status;
}

void brio_zone_free(brio_context *ctx, brio_zone *zone) {
    brio_release(ctx, zone->held);
    brio_release(ctx, zone->segment);
    *zone = (brio_zone){0};
}

bool brio_zone_take(brio_zone *zone, uint32_t segment) {
    uint8_t *taken = &zone->taken[segment], none = 0;
    assert(zone->held[segment] == 0);
    brio_stress();
    if (__atomic_load_n(taken, __ATOMIC_RELAXED)) return false;
    if (!__atomic_compare_exchange_n(taken, &none, 1, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED)) return false;
    zone->segment[zone->count++] = segment;
    return true;
}

static void give_back(brio_zone *zone, uint32_t segment) {
    assert(__atomic_load_n(&zone->taken[segment], __ATOMIC_RELAXED) == 1); /* only its holder gives it back */
    zone->held[segment] = 0;
    brio_stress();
    __atomic_store_n(&zone->taken[segment], 0, __ATOMIC_RELEASE);
}

bool brio_zone_tidy(brio_zone *zone) {
    assert(zone->now != 0);
    size_t kept = 0, count = zone->count;
    uint8_t now = zone->now++;
    if (zone->now == 0) zone->now = 1;
    if (count <= SEGMENTS_KEPT) return false;
    for (size_t i = 0; i < count; i++) {
        if (zone->held[zone->segment[i]] == now)
            zone->segment[kept++] = zone->segment[i];
        else
            give_back(zone, zone->segment[i]);
    }
    zone->count = kept;
    return kept < count;
}

void brio_zone_leave(brio_zone *zone) {
    while (zone->count) give_back(zone, zone->segment[--zone->count]);
}
