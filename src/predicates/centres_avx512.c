/* Computes centres in AVX-512, eight doubles in a register. */
#if defined(__x86_64__)
#include "predicates/lanes_avx512.h"

#define CENTRES brio_centres_avx512
#include "predicates/centre_lanes.h"
#else
typedef int brio_no_centres_avx512;
#endif
