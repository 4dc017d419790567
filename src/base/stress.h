/* What a build for tests of parallel work can do, with the option BRIO_STRESS of CMake, where the environment has
 * BRIO_STRESS: threads give way at random where they meet, and little work is divided among threads, too. Nothing in
 * any other build. */
#ifndef BRIO_BASE_STRESS_H
#define BRIO_BASE_STRESS_H

#include <stdbool.h>

#ifdef BRIO_STRESS

#include "platform/thread.h"
#include <stdint.h>
#include <stdlib.h>

static inline bool brio_is_stressed(void) {
    static _Thread_local int stressed; /* 1: no, 2: yes, once it is known */
    if (!stressed) stressed = getenv("BRIO_STRESS") ? 2 : 1;
    return stressed == 2;
}

/** Gives way to other threads, or sleeps for some microseconds, now and then. */
static inline void brio_stress(void) {
    static _Thread_local uint64_t random;
    if (!brio_is_stressed()) return;
    if (!random) random = (uint64_t)(uintptr_t)&random | 1; /* another one in each thread */
    random ^= random << 13;
    random ^= random >> 7;
    random ^= random << 17;
    if (random % 8 == 0) brio_yield();
    if (random % 256 == 1) brio_sleep(1e-9 * (double)(random >> 48));
}

#else

static inline bool brio_is_stressed(void) {
    return false;
}

static inline void brio_stress(void) {}

#endif
#endif
