/* From counts to places: the step between the two passes of every counting sort. */
#ifndef BRIO_BASE_PLACES_H
#define BRIO_BASE_PLACES_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

/** Turns n counts, `stride` apart, into places: each becomes `first` plus the counts before it. Returns `first` plus
 *  all counts: where the next bucket begins. */
static inline size_t brio_counts_to_places(size_t *count, size_t stride, size_t n, size_t first) {
    for (size_t i = 0; i < n; i++) {
        size_t own = count[stride * i];
        assert(own <= SIZE_MAX - first);
        count[stride * i] = first;
        first += own;
    }
    return first;
}

#endif
