/* What the examples share: every status is checked, and a failure ends the program with the library's sentence. */
#ifndef BRIO_EXAMPLES_COMMON_H
#define BRIO_EXAMPLES_COMMON_H

#include <brio/brio.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(ctx, call) check(ctx, call, #call)

static inline void check(const brio_context *ctx, brio_status status, const char *call) {
    if (status == BRIO_OK) return;
    fprintf(stderr, "%s\n  %s: %s\n", call, brio_status_string(status), ctx ? brio_message(ctx) : "");
    exit(EXIT_FAILURE);
}

static inline const char *yes(int condition) {
    return condition ? "yes" : "no";
}

#endif
