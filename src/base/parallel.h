/* OpenMP directives that vanish where the compiler has no OpenMP. */
#ifndef BRIO_BASE_PARALLEL_H
#define BRIO_BASE_PARALLEL_H

#define BRIO_PRAGMA(directive) _Pragma(#directive)

#ifdef _OPENMP
#define BRIO_OMP(...) BRIO_PRAGMA(omp __VA_ARGS__)
#else
#define BRIO_OMP(...)
#endif

#endif
