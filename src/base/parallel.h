/* OpenMP directives that vanish where the compiler has no OpenMP. */
#ifndef BRIO_BASE_PARALLEL_H
#define BRIO_BASE_PARALLEL_H

#include <stddef.h>

#define BRIO_PRAGMA(directive) _Pragma(#directive)

#ifdef _OPENMP
#define BRIO_OMP(...) BRIO_PRAGMA(omp __VA_ARGS__)
#else
#define BRIO_OMP(...)
#endif

#ifdef _OPENMP
#include <omp.h>
#endif

/* Number of this thread in its team; 0 is the one that the caller came with. */
static inline int brio_thread(void) {
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

/* Threads of the running team, which may be fewer than were asked for. */
static inline int brio_team_size(void) {
#ifdef _OPENMP
    return omp_get_num_threads();
#else
    return 1;
#endif
}

/* Where part i of n equal parts of [0, size) begins. */
static inline size_t brio_part(size_t size, int i, int n) {
    return size / (size_t)n * (size_t)i + size % (size_t)n * (size_t)i / (size_t)n;
}

#endif
