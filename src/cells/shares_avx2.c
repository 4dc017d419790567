/* Computes shares in AVX2, four doubles in a register. */
#if defined(__x86_64__)
#include "predicates/lanes_avx2.h"

#define SHARES brio_shares_avx2
#include "cells/share_lanes.h"
#else
typedef int brio_no_shares_avx2;
#endif
