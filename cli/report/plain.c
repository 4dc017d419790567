/* Texts without controls: see plain.h. Well-formed sequences are those of Unicode 15, table 3-7. */
#include "cli/report/plain.h"
#include <string.h>

uint32_t cli_character(const char *text, size_t *length) {
    const unsigned char *s = (const unsigned char *)text;
    static const unsigned char first_bits[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
    size_t n = s[0] < 0x80 ? 1 : s[0] < 0xc2 ? 0 : s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : s[0] < 0xf5 ? 4 : 0;
    uint32_t character = s[0] & first_bits[n];
    bool well_formed = n > 0;
    for (size_t i = 1; i < n && well_formed; i++) {
        well_formed = (s[i] & 0xc0) == 0x80;
        character = character << 6 | (s[i] & 0x3f);
    }
    bool overlong = (n == 3 && character < 0x800) || (n == 4 && character < 0x10000);
    bool surrogate = character >= 0xd800 && character < 0xe000;
    if (overlong || surrogate || character > 0x10ffff) well_formed = false;
    *length = well_formed ? n : 1;
    return well_formed ? character : NO_CHARACTER;
}

bool cli_is_control(uint32_t c) {
    if (c < 0x20 || (c >= 0x7f && c < 0xa0)) return true;
    return (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/* Returns whether the bytes at `text` are shown as they are. A character U+FFFD that stands in the text is. */
static bool is_shown(const char *text, size_t *length) {
    uint32_t c = cli_character(text, length);
    return !cli_is_control(c) && (c != NO_CHARACTER || *length > 1);
}

void cli_print_plain(FILE *out, const char *text) {
    for (size_t length; *text; text += length)
        if (is_shown(text, &length))
            fwrite(text, 1, length, out);
        else
            fputc('?', out);
}

void cli_copy_plain(char *to, size_t room, const char *text) {
    size_t n = 0;
    for (size_t length; *text; text += length) {
        bool shown = is_shown(text, &length);
        size_t bytes = shown ? length : 1;
        if (n + bytes >= room) break;
        memcpy(to + n, shown ? text : "?", bytes);
        n += bytes;
    }
    to[n] = 0;
}
