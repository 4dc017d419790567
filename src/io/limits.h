/* What a file can claim, and how much of it is believed: one limit and one function for each count that costs more than
 * the bytes that claim it. A reader asks before it acts on the claim, so that time and memory stay linear in the size
 * of the file. Counts of rows need no limit here: brio_stream_expect compares them with the size of the file.
 *
 * All limits are chosen: far above what programs write, far below what hurts.
 *
 * All functions return BRIO_OK or BRIO_ERR_FORMAT, with a message that has the number and the limit. */
#ifndef BRIO_IO_LIMITS_H
#define BRIO_IO_LIMITS_H

#include "base/context.h"

enum {
    BRIO_MOST_NUMBERS = 4096, /* of a row of any kind, coordinates included; also properties of a point, without them */
    BRIO_MOST_ELEMENTS = 256, /* kinds of rows that a header declares */
    BRIO_MOST_LEVELS = 64,    /* of texts that nest */
    BRIO_MOST_LACKING =
        1 << 23, /* numbers that rows of a text lack, beside BRIO_LACKING_BY_ONE for each that is there */
    BRIO_LACKING_BY_ONE = 64,
    BRIO_MOST_EXPANDED = 1 << 26, /* numbers of meshes shown many times, beside BRIO_EXPANDED_BY_ONE for each byte */
    BRIO_EXPANDED_BY_ONE = 256
};

/** Refuses rows of more numbers than BRIO_MOST_NUMBERS.
 *  name   the file's name.   line  where the text says so, or 0. */
brio_status brio_limit_numbers(brio_context *ctx, const char *name, size_t line, uint64_t numbers);

/** Refuses more kinds of rows than BRIO_MOST_ELEMENTS. */
brio_status brio_limit_elements(brio_context *ctx, const char *name, size_t line, uint64_t elements);

/** Refuses texts that nest deeper than BRIO_MOST_LEVELS.   what  such as "the JSON". */
brio_status brio_limit_levels(brio_context *ctx, const char *name, const char *what, uint64_t levels);

/** Refuses a text whose rows lack far more numbers than are there, which a few wide rows among many short ones cause:
 *  each number that is lacking takes as much memory as one that is there. */
brio_status brio_limit_lacking(brio_context *ctx, const char *name, size_t line, uint64_t lacking, uint64_t there);

/** Refuses a file of `bytes` bytes whose parts, used several times, make too many numbers.   what  has the numbers. */
brio_status brio_limit_expansion(brio_context *ctx, const char *name, const char *what, uint64_t numbers,
                                 uint64_t bytes);

#endif
