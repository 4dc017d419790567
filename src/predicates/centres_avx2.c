/* Computes centres in AVX2, four doubles in a register. */
#if defined(__x86_64__)
#include "predicates/lanes_avx2.h"

#define CENTRES brio_centres_avx2
#include "predicates/centre_lanes.h"
#else
typedef int brio_no_centres_avx2;
#endif
