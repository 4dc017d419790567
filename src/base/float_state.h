/* The floating-point state of a thread: rounding, subnormal numbers, trapped exceptions.
 *
 * The library's results hold for rounding to nearest with subnormal numbers. A host program may have set something
 * else. So every public function that computes begins with BRIO_DOOR, which sets the standard state and restores the
 * host's state when the function returns. The threads of a team set the standard state when they start. */
#ifndef BRIO_BASE_FLOAT_STATE_H
#define BRIO_BASE_FLOAT_STATE_H

#include <float.h>
#include <stdbool.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "brio is exact only without -ffast-math, -ffinite-math-only and -Ofast"
#endif
#if defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "brio is exact only without -funsafe-math-optimizations, -fassociative-math and -freciprocal-math"
#endif
#if FLT_EVAL_METHOD != 0
#error "brio needs doubles that are evaluated as doubles (on 32-bit x86: -msse2 -mfpmath=sse)"
#endif

#if defined(__SSE2__)
#include <xmmintrin.h>
typedef unsigned brio_float_state;
/* all exceptions masked, to nearest, no flush to zero, subnormal numbers kept; bits 0 to 5 are the flags */
enum { BRIO_FLOAT_STANDARD = 0x1f80, BRIO_FLOAT_FLAGS = 0x3f };
static inline brio_float_state brio_float_read(void) {
    return _mm_getcsr();
}
static inline void brio_float_write(brio_float_state state) {
    __asm__ volatile("" ::: "memory"); /* no load from before is used in a computation after */
    _mm_setcsr(state);
    __asm__ volatile("" ::: "memory");
}
#elif defined(__aarch64__)
typedef unsigned long brio_float_state;
/* FPCR: to nearest, no flush to zero, no traps; the flags are in another register */
enum { BRIO_FLOAT_STANDARD = 0, BRIO_FLOAT_FLAGS = 0 };
static inline brio_float_state brio_float_read(void) {
    brio_float_state state;
    __asm__ volatile("mrs %0, fpcr" : "=r"(state)::"memory");
    return state;
}
static inline void brio_float_write(brio_float_state state) {
    __asm__ volatile("msr fpcr, %0" ::"r"(state) : "memory");
}
#else
#include <fenv.h>
typedef int brio_float_state; /* here only the rounding mode can be read */
enum { BRIO_FLOAT_STANDARD = FE_TONEAREST, BRIO_FLOAT_FLAGS = 0 };
static inline brio_float_state brio_float_read(void) {
    return fegetround();
}
static inline void brio_float_write(brio_float_state state) {
    fesetround(state);
}
#endif

/** Returns whether the thread's state is the standard one, whatever its flags. */
static inline bool brio_float_is_standard(void) {
    return (brio_float_read() & ~(brio_float_state)BRIO_FLOAT_FLAGS) == BRIO_FLOAT_STANDARD;
}

/** Sets the standard state, if another one is set. Returns the state that was set. */
static inline brio_float_state brio_float_enter(void) {
    brio_float_state host = brio_float_read();
    if ((host & ~(brio_float_state)BRIO_FLOAT_FLAGS) != BRIO_FLOAT_STANDARD) brio_float_write(BRIO_FLOAT_STANDARD);
    return host;
}

/** Restores the host's state, with the exception flags that the host had. */
static inline void brio_float_leave(const brio_float_state *host) {
    if (brio_float_read() != *host) brio_float_write(*host);
}

/** The first statement of every public function that computes. */
#define BRIO_DOOR brio_float_state brio_door __attribute__((unused, cleanup(brio_float_leave))) = brio_float_enter()

#endif
