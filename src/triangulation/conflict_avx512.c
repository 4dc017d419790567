/* Conflict tests eight at a time, AVX-512; see conflict_lanes.h. */
#include "triangulation/conflict.h"

#if defined(__AVX512F__)
#include "triangulation/lanes_avx512.h"

#include "triangulation/conflict_lanes.h"

brio_conflicts_fn brio_conflicts_avx512(bool weighted) {
    return weighted ? conflicts_weighted : conflicts_plain;
}

#else

brio_conflicts_fn brio_conflicts_avx512(bool weighted) {
    (void)weighted;
    return NULL;
}

#endif
