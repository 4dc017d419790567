/* Reads the header of a PCD file: lines of a key and its words, up to DATA.
 *
 * Based on: Rusu Cousins. 3D is here: Point Cloud Library. ICRA 2011; PCL's description of the format, version 0.7. */
#include "io/pcd_header.h"
#include "base/memory.h"
#include "io/number.h"
#include "io/textrow.h"
#include <ctype.h>
#include <inttypes.h>
#include <string.h>

/* --- compressed columns --- */

/* LZF: runs of bytes as they are, and copies of earlier output.
 *
 * A control byte below 32 announces that many bytes and one. Otherwise its upper three bits are a length (7: the next
 * byte adds to it), and its lower five bits and the next byte the distance. Copies may overlap what they make.
 *
 * The compressor remembers where it last saw each three bytes, by a hash of them, and copies from there if they are the
 * same.
 *
 * Based on: Lehmann. LibLZF's format. 2000. */

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

/* --- the header --- */

static brio_status bad_line(brio_stream *s, const char *expected) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s", s->name, s->line, expected);
}

/* Returns the next word of a line, which ends with a 0 then, or NULL. */
static char *next_word(char **line) {
    char *word = brio_skip_blanks(*line), *end = word;
    while (*end && !brio_is_blank(*end)) end++;
    *line = *end ? end + 1 : end;
    *end = 0;
    return *word ? word : NULL;
}

static bool next_count(char **line, uint64_t *value) {
    const char *word = next_word(line);
    return word && brio_parse_count(&word, value) && !*word;
}

static brio_status read_fields(brio_stream *s, brio_pcd_header *h, char *line) {
    if (h->num_fields) return bad_line(s, "FIELDS once");
    for (char *word = next_word(&line); word; word = next_word(&line)) {
        if (strlen(word) > 63 || h->num_fields == BRIO_PCD_MOST_NUMBERS)
            return bad_line(s, "at most 4096 fields with names of at most 63 characters");
        BRIO_FORWARD(BRIO_RESERVE(s->ctx, h->fields, h->capacity, h->num_fields + 1));
        brio_pcd_field *f = &h->fields[h->num_fields++];
        *f = (brio_pcd_field){.type = 'F', .size = 4, .count = 1};
        strcpy(f->name, word);
    }
    return BRIO_OK;
}

/* Reads SIZE or COUNT: a number for each field. */
static brio_status read_counts(brio_stream *s, brio_pcd_header *h, char *line, bool sizes) {
    const char *expected = sizes ? "a size 1, 2, 4 or 8 for each field" : "a count 0 to 4096 for each field";
    for (size_t i = 0; i < h->num_fields; i++) {
        uint64_t value;
        /* of a field of no numbers, which drivers of lidars write, there is nothing */
        if (!next_count(&line, &value) || value > (sizes ? 8 : BRIO_PCD_MOST_NUMBERS) ||
            (sizes && (!value || (value & (value - 1)))))
            return bad_line(s, expected);
        *(sizes ? &h->fields[i].size : &h->fields[i].count) = (unsigned)value;
    }
    return next_word(&line) ? bad_line(s, expected) : BRIO_OK;
}

static brio_status read_types(brio_stream *s, brio_pcd_header *h, char *line) {
    for (size_t i = 0; i < h->num_fields; i++) {
        const char *word = next_word(&line);
        if (!word || strlen(word) != 1 || !strchr("IUFiuf", *word))
            return bad_line(s, "a type I, U or F for each field");
        h->fields[i].type = (char)toupper((unsigned char)*word);
    }
    return next_word(&line) ? bad_line(s, "a type I, U or F for each field") : BRIO_OK;
}

static brio_status read_data(brio_stream *s, brio_pcd_header *h, char *line) {
    static const char *const names[] = {"ascii", "binary", "binary_compressed"};
    const char *word = next_word(&line);
    for (int i = 0; i < 3 && word; i++) {
        if (strcmp(word, names[i]) != 0) continue;
        h->data = (brio_pcd_data)i;
        return BRIO_OK;
    }
    return bad_line(s, "DATA ascii, binary or binary_compressed");
}

typedef struct {
    uint64_t width, height, points;
    bool has_width, has_points;
} pcd_size;

/* Reads the numbers of a viewpoint. What is no viewpoint is no reason to refuse the points. */
static brio_status read_viewpoint(brio_pcd_header *h, char *line) {
    int count = 0;
    const char *word;
    while (count < 7 && (word = next_word(&line)) != NULL)
        if (!brio_parse_number(&word, &h->viewpoint[count++])) return BRIO_OK;
    h->has_place = count == 7;
    return BRIO_OK;
}

static brio_status read_line(brio_stream *s, brio_pcd_header *h, char *line, pcd_size *size, bool *end) {
    const char *key = next_word(&line);
    if (!key || *key == '#' || !strcmp(key, "VERSION")) return BRIO_OK;
    if (!strcmp(key, "VIEWPOINT")) return read_viewpoint(h, line);
    if (!strcmp(key, "FIELDS") || !strcmp(key, "COLUMNS")) return read_fields(s, h, line);
    bool of_fields = !strcmp(key, "SIZE") || !strcmp(key, "COUNT") || !strcmp(key, "TYPE");
    if (of_fields && !h->num_fields) return bad_line(s, "FIELDS before this line");
    if (!strcmp(key, "SIZE")) return read_counts(s, h, line, true);
    if (!strcmp(key, "COUNT")) return read_counts(s, h, line, false);
    if (!strcmp(key, "TYPE")) return read_types(s, h, line);
    if (!strcmp(key, "DATA")) {
        *end = true;
        return read_data(s, h, line);
    }
    uint64_t *target = !strcmp(key, "WIDTH") ? &size->width : !strcmp(key, "HEIGHT") ? &size->height : NULL;
    size->has_width |= target == &size->width;
    if (!strcmp(key, "POINTS")) {
        target = &size->points;
        size->has_points = true;
    }
    if (!target) return bad_line(s, "VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA");
    return next_count(&line, target) ? BRIO_OK : bad_line(s, "a whole number");
}

/* Sums up the fields, and checks them. */
static brio_status finish(brio_stream *s, brio_pcd_header *h, const pcd_size *size) {
    if (!size->has_points && !size->has_width) return bad_line(s, "WIDTH or POINTS before this line");
    if (__builtin_mul_overflow(size->width, size->height, &h->points)) h->points = UINT64_MAX;
    BRIO_EXPECT(s->ctx, !size->has_points || !size->has_width || size->points == h->points, BRIO_ERR_FORMAT,
                "%s: %" PRIu64 " points, WIDTH times HEIGHT is %" PRIu64, s->name, size->points, h->points);
    if (size->has_points) h->points = size->points;
    h->height = size->height;
    static const double nowhere[7] = {0, 0, 0, 1, 0, 0, 0};
    h->placed = h->has_place && memcmp(h->viewpoint, nowhere, sizeof nowhere) != 0;
    h->has_place &= size->height > 1 || h->placed;
    for (size_t i = 0; i < h->num_fields; i++) {
        brio_pcd_field *f = &h->fields[i];
        f->at = h->record;
        h->record += (size_t)f->size * f->count;
        h->numbers += f->count;
        BRIO_EXPECT(s->ctx, f->type != 'F' || f->size >= 4, BRIO_ERR_FORMAT,
                    "%s: field %s is a floating-point number of %u bytes, expected 4 or 8", s->name, f->name, f->size);
    }
    BRIO_EXPECT(s->ctx, h->numbers && h->numbers <= BRIO_PCD_MOST_NUMBERS, BRIO_ERR_FORMAT,
                "%s: %zu numbers for each point, expected 1 to %d", s->name, h->numbers, BRIO_PCD_MOST_NUMBERS);
    return BRIO_OK;
}

brio_status brio_pcd_header_read(brio_stream *s, brio_pcd_header *h) {
    pcd_size size = {.height = 1};
    bool end = false;
    char *line;
    *h = (brio_pcd_header){.num_fields = 0};
    while (!end) {
        BRIO_FORWARD(brio_stream_line(s, &line));
        if (!line) return bad_line(s, "DATA behind this line");
        BRIO_FORWARD(read_line(s, h, line, &size, &end));
    }
    return finish(s, h, &size);
}

void brio_pcd_header_free(brio_context *ctx, brio_pcd_header *h) {
    brio_release(ctx, h->fields);
    h->fields = NULL;
}
