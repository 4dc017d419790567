/* The whole test harness: EXPECT reports and counts, RUN names a test, and main returns what `harness_end` says.
 * A program that cannot run here prints why and returns HARNESS_SKIP. */
#ifndef BRIO_TESTS_HARNESS_H
#define BRIO_TESTS_HARNESS_H

#include "brio/brio.h"
#include <stdio.h>
#include <stdlib.h>

enum { HARNESS_SKIP = 77 };

/* Whether to take fewer inputs: under the sanitizers, which take many times as long and look for what most inputs show. */
#ifdef BRIO_SHORT_TESTS
enum { SHORT_TESTS = 1 };
#else
enum { SHORT_TESTS = 0 };
#endif

static int harness_failures, harness_checks;

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

static inline int harness_end(void) {
    fprintf(stderr, "%d checks, %d failures\n", harness_checks, harness_failures);
    return harness_failures ? 1 : 0;
}

#endif
