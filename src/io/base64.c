/* Bytes as text in base 64: four characters of six bits each are three bytes.
 *
 * Based on: Josefsson. The base16, base32, and base64 data encodings. RFC 4648, 2006. */
#include "io/base64.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <string.h>

/* clang-format off */
/* Six bits for each character of ASCII; 64 where it is not in the alphabet. */
static const uint8_t alphabet[128] = {
    64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64,
    64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 62, 64, 64, 64, 63, 52, 53, 54, 55, 56, 57, 58, 59,
    60, 61, 64, 64, 64, 64, 64, 64, 64, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21,
    22, 23, 24, 25, 64, 64, 64, 64, 64, 64, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43,
    44, 45, 46, 47, 48, 49, 50, 51, 64, 64, 64, 64, 64};
/* clang-format on */

static uint8_t six_bits(char c) {
    return (unsigned char)c < sizeof alphabet ? alphabet[(unsigned char)c] : 64;
}

/* Decodes four characters. Returns the number of bytes, 1 to 3, or 0 if they are no base 64. */
static int decode_four(const char *text, uint8_t *to) {
    uint32_t bits = 0;
    int count = text[3] != '=' ? 3 : text[2] != '=' ? 2 : 1;
    for (int i = 0; i < 4; i++) {
        uint8_t six = i <= count ? six_bits(text[i]) : 0;
        if (six > 63) return 0;
        bits = bits << 6 | six;
    }
    for (int i = 0; i < count; i++) to[i] = (uint8_t)(bits >> (16 - 8 * i));
    return count;
}

/* Reads four characters between blanks. */
static brio_status next_four(brio_stream *s, char *text) {
    for (int i = 0; i < 4;) {
        const char *c = NULL;
        BRIO_FORWARD(brio_stream_take(s, 1, &c));
        if (!brio_is_blank(*c)) text[i++] = *c;
    }
    return BRIO_OK;
}

static brio_status refill(brio_base64 *b, brio_stream *s) {
    char text[5] = "";
    BRIO_FORWARD(next_four(s, text));
    b->used = 0;
    b->count = decode_four(text, b->spare);
    BRIO_EXPECT(s->ctx, b->count, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected base64 of %s, found \"%s\"", s->name,
                brio_stream_offset(s), s->element, brio_excerpt_of(text).text);
    return BRIO_OK;
}

/* Decodes what lies in the stream's buffer without blanks and padding. Returns the number of bytes. */
static size_t take_plain(brio_stream *s, uint8_t *to, size_t size) {
    size_t done = 0;
    while (size - done >= 3 && brio_stream_left(s) >= 4) {
        const char *text = s->buffer + s->begin;
        if (text[3] == '=' || decode_four(text, to + done) != 3) break;
        done += 3;
        s->begin += 4;
    }
    return done;
}

brio_status brio_base64_take(brio_base64 *b, brio_stream *s, void *to, size_t size) {
    uint8_t *out = to;
    while (size) {
        if (b->used < b->count) {
            *out++ = b->spare[b->used++];
            size--;
            continue;
        }
        if (brio_stream_left(s) < 4) BRIO_FORWARD(brio_stream_fill(s, 4));
        size_t plain = take_plain(s, out, size);
        out += plain;
        size -= plain;
        if (size) BRIO_FORWARD(refill(b, s));
    }
    return BRIO_OK;
}

bool brio_base64_decode(const char *text, size_t length, uint8_t *to, size_t *size) {
    *size = 0;
    if (length % 4) return false;
    for (size_t i = 0; i < length; i += 4) {
        int count = decode_four(text + i, to + *size);
        if (count < 1 || (count < 3 && i + 4 < length)) return false;
        *size += (size_t)count;
    }
    return true;
}
