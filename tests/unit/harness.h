/* The whole test harness: a file is a SUITE, whose body runs its tests and returns what `harness_end` says; RUN names a test;
 * EXPECT reports and counts. A suite that cannot run here prints why and returns HARNESS_SKIP.
 * All suites are one program, since each program takes a link of the whole library: `unit_tests test_sort` runs one. */
#ifndef BRIO_TESTS_HARNESS_H
#define BRIO_TESTS_HARNESS_H

#include "brio/brio.h"
#include <stdio.h>
#include <stdlib.h>

enum { HARNESS_SKIP = 77 };

/* Whether to take fewer inputs, as make check does; make check-all takes all. */
#ifdef BRIO_SHORT_TESTS
enum { SHORT_TESTS = 1 };
#else
enum { SHORT_TESTS = 0 };
#endif

/* Whether to take fewer still, as make check does under the sanitizers, where all takes several times as long. */
#if defined(BRIO_SHORT_TESTS) && defined(BRIO_SLOW_BUILD)
enum { BRIEF_TESTS = 1 };
#else
enum { BRIEF_TESTS = 0 };
#endif

/* Whether only tests of threads are of use, as in make check under the thread sanitizer. */
#if defined(BRIO_SHORT_TESTS) && defined(BRIO_WATCHES_THREADS)
enum { THREADS_ONLY = 1 };
#else
enum { THREADS_ONLY = 0 };
#endif

static int harness_failures, harness_checks;

/* A suite has the name of its file. argc and argv are those of a program of that name. */
#define SUITE(name)                                                                                                    \
    int name(int argc, char **argv);                                                                                   \
    int name(int argc __attribute__((unused)), char **argv __attribute__((unused)))

#define EXPECT(condition, ...)                                                                                         \
    do {                                                                                                               \
        harness_checks++;                                                                                              \
        if (!(condition)) {                                                                                            \
            if (harness_failures++ < 20) {                                                                             \
                fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition);                                        \
                fprintf(stderr, " " __VA_ARGS__);                                                                      \
                fputc('\n', stderr);                                                                                   \
            }                                                                                                          \
        }                                                                                                              \
    } while (0)

#define RUN(test)                                                                                                      \
    do {                                                                                                               \
        int before = harness_failures;                                                                                 \
        test();                                                                                                        \
        fprintf(stderr, "%s %s\n", harness_failures == before ? "ok    " : "FAILED", #test);                           \
    } while (0)

/* Runs a test in which no threads work side by side. */
#define RUN_ALONE(test)                                                                                                \
    do {                                                                                                               \
        if (!THREADS_ONLY) RUN(test);                                                                                  \
    } while (0)

static inline int harness_end(void) {
    fprintf(stderr, "%d checks, %d failures\n", harness_checks, harness_failures);
    return harness_failures ? 1 : 0;
}

#endif
