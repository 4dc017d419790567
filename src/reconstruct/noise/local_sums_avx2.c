/* Sums over a neighbourhood in AVX2, four doubles in a register. */
#if defined(__x86_64__)
#define LOCAL_SUMS brio_local_sums_avx2
#include "reconstruct/noise/local_sums_lanes.h"
#else
typedef int brio_no_local_sums_avx2;
#endif
