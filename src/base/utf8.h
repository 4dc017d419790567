/* Texts in UTF-8 [Unicode 15, table 3-7]. */
#ifndef BRIO_BASE_UTF8_H
#define BRIO_BASE_UTF8_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/** Returns how many bytes the well-formed character at s has, 0 if there is none. */
static inline size_t brio_utf8_length(const char *s) {
    const unsigned char *b = (const unsigned char *)s;
    size_t length = b[0] < 0x80 ? 1 : b[0] < 0xc2 ? 0 : b[0] < 0xe0 ? 2 : b[0] < 0xf0 ? 3 : b[0] < 0xf5 ? 4 : 0;
    for (size_t i = 1; i < length; i++)
        if ((b[i] & 0xc0) != 0x80) return 0;
    int overlong = (b[0] == 0xe0 && b[1] < 0xa0) || (b[0] == 0xf0 && b[1] < 0x90);
    int surrogate = b[0] == 0xed && b[1] > 0x9f, beyond = b[0] == 0xf4 && b[1] > 0x8f;
    return overlong || surrogate || beyond ? 0 : length;
}

/** Copies a text; bytes that are no well-formed UTF-8 are taken for Latin-1. What does not fit in `room` bytes, the 0
 *  at the end included, is left out, in whole characters.
 *  Returns whether all of it fits. */
static inline bool brio_utf8_copy(char *to, size_t room, const char *from) {
    size_t n = 0;
    assert(room > 0);
    while (*from) {
        char latin[2] = {(char)(0xc0 | (unsigned char)*from >> 6), (char)(0x80 | (*from & 0x3f))};
        size_t length = brio_utf8_length(from), copied = length ? length : sizeof latin;
        if (n + copied >= room) break;
        memcpy(to + n, length ? from : latin, copied);
        n += copied;
        from += length ? length : 1;
    }
    to[n] = 0;
    return !*from;
}

/** Makes NAME_NUMBER, NAME cut so that the whole fits in `room` bytes, more than 24. */
static inline void brio_numbered_name(char *to, size_t room, const char *name, size_t number) {
    char end[24];
    assert(room > sizeof end);
    size_t length = (size_t)snprintf(end, sizeof end, "_%zu", number);
    brio_utf8_copy(to, room - length, name);
    strcat(to, end);
}

#endif
