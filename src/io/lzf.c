/* LZF: runs of bytes as they are, and copies of earlier output.
 *
 * A control byte below 32 announces that many bytes and one. Otherwise its upper three bits are a length (7: the next
 * byte adds to it), and its lower five bits and the next byte the distance. Copies may overlap what they make.
 *
 * The compressor remembers where it last saw each three bytes, by a hash of them, and copies from there if they are the same.
 *
 * Based on: Lehmann. LibLZF's format. 2000. */
#include "io/lzf.h"
#include <string.h>

bool brio_lzf_decompress(const uint8_t *bytes, size_t count, uint8_t *out, size_t size) {
    size_t at = 0, made = 0;
    while (at < count) {
        size_t control = bytes[at++], length = control + 1;
        if (control < 32) {
            if (length > count - at || length > size - made) return false;
            memcpy(out + made, bytes + at, length);
            at += length;
            made += length;
            continue;
        }
        length = (control >> 5) + 2;
        if (length == 9 && at < count) length += bytes[at++];
        if (at == count) return false;
        size_t distance = ((control & 31) << 8 | bytes[at++]) + 1;
        if (distance > made || length > size - made) return false;
        for (size_t i = 0; i < length; i++, made++) out[made] = out[made - distance];
    }
    return made == size;
}

/* A control byte has 5 bits for a run's length, and 13 bits with the next one for a distance. */
enum { LONGEST_RUN = 32, LONGEST_COPY = 264, FARTHEST = 1 << 13, LEAST_COPY = 3 };

static uint32_t hash_of(const uint8_t *p) {
    uint32_t three = (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
    return three * UINT32_C(2654435761) >> 18; /* a multiplicative hash to the 14 bits of the table */
}

/* Writes bytes as they are. Returns the new size of the output. */
static size_t put_run(const uint8_t *bytes, size_t count, uint8_t *out, size_t size) {
    while (count) {
        size_t length = count < LONGEST_RUN ? count : LONGEST_RUN;
        out[size++] = (uint8_t)(length - 1);
        memcpy(out + size, bytes, length);
        size += length;
        bytes += length;
        count -= length;
    }
    return size;
}

static size_t put_copy(size_t distance, size_t length, uint8_t *out, size_t size) {
    size_t code = length - 2, far = distance - 1;
    out[size++] = (uint8_t)((code < 7 ? code : 7) << 5 | far >> 8);
    if (code >= 7) out[size++] = (uint8_t)(code - 7);
    out[size++] = (uint8_t)far;
    return size;
}

size_t brio_lzf_compress(const uint8_t *bytes, size_t count, uint8_t *out, uint32_t *table) {
    size_t size = 0, run = 0, at = 0; /* bytes run .. at - 1 are not yet written */
    memset(table, 0, BRIO_LZF_TABLE * sizeof *table);
    while (at + LEAST_COPY <= count) {
        uint32_t hash = hash_of(bytes + at), before = table[hash]; /* a place plus 1 */
        table[hash] = (uint32_t)at + 1;
        size_t distance = before ? at + 1 - before : 0, length = 0, most = count - at;
        if (most > LONGEST_COPY) most = LONGEST_COPY;
        if (distance && distance <= FARTHEST)
            while (length < most && bytes[at + length] == bytes[at + length - distance]) length++;
        if (length < LEAST_COPY) {
            at++;
            continue;
        }
        size = put_run(bytes + run, at - run, out, size);
        size = put_copy(distance, length, out, size);
        at += length;
        run = at;
    }
    return put_run(bytes + run, count - run, out, size);
}
