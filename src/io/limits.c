/* The limits of what a file can claim: see limits.h. */
#include "io/limits.h"
#include <inttypes.h>
#include <stdio.h>

/* Writes where a text says something: ": line N", or nothing. */
static void write_place(char place[40], size_t line) {
    place[0] = 0;
    if (line) snprintf(place, 40, ": line %zu", line);
}

brio_status brio_limit_numbers(brio_context *ctx, const char *name, size_t line, uint64_t numbers) {
    char place[40];
    if (numbers <= BRIO_MOST_NUMBERS) return BRIO_OK;
    write_place(place, line);
    return brio_fail(ctx, BRIO_ERR_FORMAT, "%s%s: %" PRIu64 " numbers in a row, expected at most %d", name, place,
                     numbers, BRIO_MOST_NUMBERS);
}

brio_status brio_limit_elements(brio_context *ctx, const char *name, size_t line, uint64_t elements) {
    char place[40];
    if (elements <= BRIO_MOST_ELEMENTS) return BRIO_OK;
    write_place(place, line);
    return brio_fail(ctx, BRIO_ERR_FORMAT, "%s%s: %" PRIu64 " elements, expected at most %d", name, place, elements,
                     BRIO_MOST_ELEMENTS);
}

brio_status brio_limit_levels(brio_context *ctx, const char *name, const char *what, uint64_t levels) {
    if (levels <= BRIO_MOST_LEVELS) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_FORMAT, "%s: %s has %" PRIu64 " levels, the most are %d", name, what, levels,
                     BRIO_MOST_LEVELS);
}

/* Returns most + factor * by. */
static uint64_t sum_of(uint64_t most, uint64_t factor, uint64_t by) {
    return by < (UINT64_MAX - most) / factor ? most + factor * by : UINT64_MAX;
}

brio_status brio_limit_lacking(brio_context *ctx, const char *name, size_t line, uint64_t lacking, uint64_t there) {
    if (lacking <= sum_of(BRIO_MOST_LACKING, BRIO_LACKING_BY_ONE, there)) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_FORMAT,
                     "%s: line %zu: up to here rows lack %" PRIu64 " numbers of their columns and have %" PRIu64
                     ": the first row has far more columns than most",
                     name, line, lacking, there);
}

brio_status brio_limit_expansion(brio_context *ctx, const char *name, const char *what, uint64_t numbers,
                                 uint64_t bytes) {
    uint64_t most = sum_of(BRIO_MOST_EXPANDED, BRIO_EXPANDED_BY_ONE, bytes);
    if (numbers <= most) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_FORMAT,
                     "%s: %s would be %" PRIu64 " numbers from %" PRIu64 " bytes, expected at most %" PRIu64, name,
                     what, numbers, bytes, most);
}
