/* Bytes as text in base 64. */
#ifndef BRIO_IO_BASE64_H
#define BRIO_IO_BASE64_H

#include "io/stream.h"

/* Bytes that were decoded with those before them and not yet taken: four characters are three bytes. */
typedef struct brio_base64 {
    uint8_t spare[3];
    int used, count; /* spare[used] to spare[count - 1] are left */
} brio_base64;

/** Decodes the next `size` bytes of the stream. Blanks are passed over; a padded end may be followed by more text, as
 *  where two texts were put one behind the other.
 *  b  {0} where a text begins.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (the byte offset of what is no base 64, or where the file ends), and as
 *  brio_stream_fill. */
brio_status brio_base64_take(brio_base64 *b, brio_stream *s, void *to, size_t size);

/** Decodes a text of `length` characters.   to  room for 3 / 4 of them.   size  receives the number of bytes.
 *  Returns false if the text is no base 64. */
bool brio_base64_decode(const char *text, size_t length, uint8_t *to, size_t *size);

#endif
