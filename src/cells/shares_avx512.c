/* Computes shares in AVX-512, eight doubles in a register. */
#if defined(__x86_64__)
#include "predicates/lanes_avx512.h"

#define SHARES brio_shares_avx512
#include "cells/share_lanes.h"
#else
typedef int brio_no_shares_avx512;
#endif
