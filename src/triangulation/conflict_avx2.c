/* Conflict tests four at a time, AVX2; see conflict_lanes.h. */
#include "triangulation/conflict.h"

#if defined(__AVX2__)
#include "triangulation/lanes_avx2.h"

#include "triangulation/conflict_lanes.h"

brio_conflicts_fn brio_conflicts_avx2(bool weighted) {
    return weighted ? conflicts_weighted : conflicts_plain;
}

#else

brio_conflicts_fn brio_conflicts_avx2(bool weighted) {
    (void)weighted;
    return NULL;
}

#endif
