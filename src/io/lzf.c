/* Decompresses LZF: runs of bytes as they are, and copies of earlier output.
 *
 * A control byte below 32 announces that many bytes and one. Otherwise its upper three bits are a length (7: the next
 * byte adds to it), and its lower five bits and the next byte the distance. Copies may overlap what they make.
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
