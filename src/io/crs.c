/* Finds the code and the name of a coordinate system. Neither text nor keys are interpreted beyond that: brio computes
 * in the coordinates that the file has.
 *
 * Based on: OGC. Geographic information: well-known text representation of coordinate reference systems. 2019. OGC.
 * GeoTIFF standard 1.1. 2019. */
#include "io/crs.h"
#include "base/utf8.h"
#include "io/little_endian.h"
#include <stdlib.h>
#include <string.h>

enum { TEXT = 128 /* bytes of a code or a name, at most; chosen */ };

/* --- well-known text --- */

/* Returns the byte behind the bracket that closes the one at `open`, or NULL. */
static const char *end_of(const char *open) {
    int depth = 0;
    bool quoted = false;
    for (const char *at = open; *at; at++) {
        if (*at == '"') quoted = !quoted;
        if (quoted) continue;
        if (*at == '[' || *at == '(') depth++;
        if ((*at == ']' || *at == ')') && --depth == 0) return at + 1;
    }
    return NULL;
}

/* Copies what stands in the first quotation marks. Returns whether anything does. */
static bool copy_quoted(const char *at, const char *end, char text[TEXT]) {
    const char *first = memchr(at, '"', (size_t)(end - at));
    const char *last = first ? memchr(first + 1, '"', (size_t)(end - first) - 1) : NULL;
    if (!last || last == first + 1 || last - first > TEXT) return false;
    memcpy(text, first + 1, (size_t)(last - first) - 1);
    text[last - first - 1] = 0;
    return true;
}

static bool is_word(const char *at, const char *word) {
    size_t length = strlen(word);
    return !strncmp(at, word, length) && (at[length] == '[' || at[length] == '(');
}

/* Copies the code of the system between two brackets: from the AUTHORITY[...] or ID[...] of the whole system, not of
 * one of its parts. */
static bool copy_code(const char *open, const char *end, char text[TEXT]) {
    char authority[TEXT];
    int depth = 0;
    bool quoted = false, found = false;
    for (const char *at = open; at < end; at++) {
        if (*at == '"') quoted = !quoted;
        if (quoted) continue;
        if (*at == '[' || *at == '(') depth++;
        if (*at == ']' || *at == ')') depth--;
        if (depth != 1 || !(is_word(at, "AUTHORITY") || is_word(at, "ID")) || !strchr("[(,\n\r\t ", at[-1])) continue;
        const char *number = strchr(at, ',');
        if (!copy_quoted(at, end, authority) || !number || number >= end) continue;
        number += strspn(number, ", \"\t\r\n");
        size_t digits = strspn(number, "0123456789");
        if (!digits || digits > 9) continue;
        found = snprintf(text, TEXT, "%s:%.*s", authority, (int)digits, number) < TEXT;
    }
    return found;
}

/* Finds code and name of the system at `at`; of a compound one without a code its horizontal part has it. */
static void read_text(const char *at, char code[TEXT], char name[TEXT]) {
    static const char *const parts[] = {"PROJCS", "PROJCRS", "GEOGCS", "GEOGCRS", "GEODCRS", "GEOCCS"};
    const char *open = strpbrk(at, "[("), *end = open ? end_of(open) : NULL;
    if (!end) return;
    copy_quoted(open, end, name);
    if (copy_code(open, end, code)) return;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const char *part = strstr(open, parts[i]);
        if (!part || !is_word(part, parts[i])) continue;
        const char *first = part + strlen(parts[i]), *last = end_of(first);
        if (last && copy_code(first, last, code)) return;
    }
}

/* --- keys of GeoTIFF --- */

enum { DIRECTORY = 34735, TEXTS = 34737 };
enum { CITATION = 1026, GEOGRAPHIC = 2048, GEOGRAPHIC_CITATION = 2049, PROJECTED = 3072, PROJECTED_CITATION = 3073 };
enum { HEIGHTS = 4096, USERS_OWN = 32767 };

typedef struct {
    const char *bytes;
    size_t size;
} span;

bool brio_record_next(const brio_metadata *records, size_t *at, const char **header, size_t *size) {
    if (records->size - *at < BRIO_RECORD_HEADER) return false;
    *header = records->bytes + *at;
    uint64_t bytes = brio_le64(*header + BRIO_RECORD_SIZE), room = records->size - *at - BRIO_RECORD_HEADER;
    if (bytes > room) return false;
    *size = (size_t)bytes;
    *at += BRIO_RECORD_HEADER + *size;
    return true;
}

/* Finds the record of an id, the last one if there are several. */
static span record_of(const brio_metadata *records, unsigned id) {
    span found = {NULL, 0};
    const char *header = NULL;
    for (size_t at = 0, size = 0; brio_record_next(records, &at, &header, &size);)
        if (brio_le16(header + BRIO_RECORD_ID) == id) found = (span){header + BRIO_RECORD_HEADER, size};
    return found;
}

/* Returns the value of a key that is one number, or 0. */
static unsigned key_of(span keys, unsigned id) {
    for (size_t at = 8; at + 8 <= keys.size; at += 8)
        if (brio_le16(keys.bytes + at) == id && !brio_le16(keys.bytes + at + 2)) return brio_le16(keys.bytes + at + 6);
    return 0;
}

/* Copies the text of a key. Texts end with a bar. */
static bool copy_text(span keys, span texts, unsigned id, char text[TEXT]) {
    for (size_t at = 8; at + 8 <= keys.size; at += 8) {
        size_t count = brio_le16(keys.bytes + at + 4), first = brio_le16(keys.bytes + at + 6);
        if (brio_le16(keys.bytes + at) != id || brio_le16(keys.bytes + at + 2) != TEXTS) continue;
        if (first > texts.size || count > texts.size - first || count >= TEXT) continue;
        memcpy(text, texts.bytes + first, count);
        text[count] = 0;
        text[strcspn(text, "|")] = 0;
        return text[0] != 0;
    }
    return false;
}

static void read_keys(const brio_metadata *records, char code[TEXT], char name[TEXT]) {
    static const unsigned citations[] = {PROJECTED_CITATION, CITATION, GEOGRAPHIC_CITATION};
    span keys = record_of(records, DIRECTORY), texts = record_of(records, TEXTS);
    unsigned system = key_of(keys, PROJECTED), heights = key_of(keys, HEIGHTS);
    if (!system) system = key_of(keys, GEOGRAPHIC);
    for (size_t i = 0; i < sizeof citations / sizeof *citations && !name[0]; i++)
        copy_text(keys, texts, citations[i], name);
    if (!name[0] && texts.size && texts.size < TEXT) { /* a text that no key names */
        memcpy(name, texts.bytes, texts.size);
        name[strcspn(name, "|")] = 0;
    }
    if (!system || system >= USERS_OWN) return;
    int length = snprintf(code, TEXT, "EPSG:%u", system);
    if (heights && heights < USERS_OWN) snprintf(code + length, TEXT - (size_t)length, "+%u", heights);
}

static brio_status add_text(brio_mesh *mesh, const char *name, const char *text) {
    char clean[2 * TEXT];
    if (!text[0]) return BRIO_OK;
    brio_utf8_copy(clean, sizeof clean, text);
    return brio_mesh_set_metadata(mesh, name, clean, strlen(clean));
}

brio_status brio_crs_describe(brio_mesh *mesh) {
    const brio_metadata *text = brio_mesh_metadata(mesh, "crs.wkt"), *keys = brio_mesh_metadata(mesh, "crs.geokeys");
    char code[TEXT] = "", name[TEXT] = "";
    if (text) read_text(text->bytes, code, name);
    if (!text && keys) read_keys(keys, code, name);
    brio_status status = add_text(mesh, "crs.code", code);
    return status == BRIO_OK ? add_text(mesh, "crs.name", name) : status;
}
