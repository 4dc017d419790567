/* The header of a PLY file: lines of words up to end_header.
 *
 * The reader adds up the least bytes that the announced rows need, with all lists empty. It compares the sum with the
 * size of the file before it allocates anything.
 *
 * Based on: Turk. The PLY polygon file format. Stanford 1994. */
#include "io/ply_header.h"
#include "base/memory.h"
#include "io/limits.h"
#include "io/number.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <string.h>
#include <strings.h>

/* The words of a line that are stored; no valid line has as many. */
enum { MAX_WORDS = 6 };

static const char *const type_names[BRIO_SCALAR_END][2] = {
    {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
    {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};

const char *brio_ply_type_name(brio_scalar type) {
    return type_names[type][0];
}

static brio_scalar type_of(const char *word) {
    for (brio_scalar type = BRIO_SCALAR_INT8; type < BRIO_SCALAR_END; type++)
        if (!strcmp(word, type_names[type][0]) || !strcmp(word, type_names[type][1])) return type;
    return BRIO_SCALAR_END;
}

static brio_status bad_line(brio_stream *s, const char *expected) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s", s->name, s->line, expected);
}

/* Cuts a line into words in place. Words after MAX_WORDS are counted only. */
static size_t split(char *line, char *words[MAX_WORDS]) {
    size_t count = 0;
    for (char *p = brio_skip_blanks(line); *p; p = brio_skip_blanks(p)) {
        if (count < MAX_WORDS) words[count] = p;
        count++;
        while (*p && !brio_is_blank(*p)) p++;
        if (*p) *p++ = 0;
    }
    return count;
}

static brio_status copy_name(brio_stream *s, char name[64], const char *word) {
    if (strlen(word) > 63) return bad_line(s, "a name of at most 63 characters");
    strcpy(name, word);
    return BRIO_OK;
}

static brio_status read_format(brio_stream *s, brio_ply_header *header, char **words, size_t count) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (int i = 0; i < 3 && count == 3; i++) {
        if (strcmp(words[1], names[i]) != 0 || strcmp(words[2], "1.0") != 0) continue;
        header->encoding = (brio_ply_encoding)i;
        return BRIO_OK;
    }
    return bad_line(s, "format ascii, binary_little_endian or binary_big_endian 1.0");
}

static brio_status read_element(brio_stream *s, brio_ply_header *header, char **words, size_t count) {
    brio_ply_element element = {.count = 0};
    const char *digits = count == 3 ? words[2] : "";
    if (count != 3 || !brio_parse_count(&digits, &element.count) || *digits) return bad_line(s, "element NAME COUNT");
    BRIO_FORWARD(copy_name(s, element.name, words[1]));
    BRIO_FORWARD(brio_limit_elements(s->ctx, s->name, s->line, header->num_elements + 1));
    for (size_t i = 0; i < header->num_elements; i++)
        BRIO_EXPECT(s->ctx, strcmp(header->elements[i].name, element.name) != 0, BRIO_ERR_FORMAT,
                    "%s: line %zu: a second element %s", s->name, s->line, brio_excerpt_of(element.name).text);
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, header->elements, header->element_capacity, header->num_elements + 1));
    header->elements[header->num_elements++] = element;
    return BRIO_OK;
}

static brio_status read_property(brio_stream *s, brio_ply_header *header, char **words, size_t count) {
    brio_ply_property p = {.list = count == 5 && !strcmp(words[1], "list")};
    if (!header->num_elements) return bad_line(s, "an element before its properties");
    if (!p.list && count != 3) return bad_line(s, "property TYPE NAME or property list TYPE TYPE NAME");
    p.type = type_of(words[count - 2]);
    p.count_type = p.list ? type_of(words[2]) : p.type;
    if (p.type == BRIO_SCALAR_END || p.count_type == BRIO_SCALAR_END)
        return bad_line(s, "a type char uchar short ushort int uint float double, or int8 uint8 ... float64");
    BRIO_FORWARD(copy_name(s, p.name, words[count - 1]));
    brio_ply_element *e = &header->elements[header->num_elements - 1];
    BRIO_FORWARD(brio_limit_numbers(s->ctx, s->name, s->line, e->num_properties + 1));
    p.offset = e->row_size;
    e->row_size += brio_scalar_size(p.count_type);
    e->has_list |= p.list;
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, e->properties, e->property_capacity, e->num_properties + 1));
    e->properties[e->num_properties++] = p;
    return BRIO_OK;
}

/* Keeps the text of a comment that is a part of the coordinate system. */
static brio_status keep_crs(brio_stream *s, brio_ply_header *header, const char *line) {
    static const char begins[] = "comment crs ";
    if (strncmp(line, begins, strlen(begins)) != 0) return BRIO_OK;
    size_t length = strlen(line) - strlen(begins);
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, header->crs, header->crs_capacity, header->crs_length + length + 1));
    strcpy(header->crs + header->crs_length, line + strlen(begins));
    header->crs_length += length;
    return BRIO_OK;
}

/* Reads one line between the first and the last line of the header. */
static brio_status read_line(brio_stream *s, brio_ply_header *header, char *line, bool *format, bool *end) {
    char *words[MAX_WORDS];
    brio_status status = keep_crs(s, header, line);
    if (status != BRIO_OK) return status;
    size_t count = split(line, words);
    const char *key = count ? words[0] : "";
    if (!strcmp(key, "comment") && count > 1) header->textures |= !strcasecmp(words[1], "TextureFile");
    if (!*key || !strcmp(key, "comment") || !strcmp(key, "obj_info")) return BRIO_OK;
    if (!strcmp(key, "end_header")) {
        *end = true;
        return *format ? BRIO_OK : bad_line(s, "a format line before the end of the header");
    }
    if (!strcmp(key, "format")) {
        *format = true;
        return read_format(s, header, words, count);
    }
    if (!strcmp(key, "element")) return read_element(s, header, words, count);
    if (!strcmp(key, "property")) return read_property(s, header, words, count);
    return bad_line(s, "format, element, property, comment, obj_info or end_header");
}

static brio_status check_promise(brio_stream *s, const brio_ply_header *header) {
    uint64_t bytes = 0;
    for (size_t i = 0; i < header->num_elements; i++) {
        const brio_ply_element *e = &header->elements[i];
        uint64_t rows, row = header->encoding == BRIO_PLY_ASCII ? 2 * e->num_properties : e->row_size;
        if (__builtin_mul_overflow(e->count, row, &rows) || __builtin_add_overflow(bytes, rows, &bytes))
            bytes = UINT64_MAX;
    }
    /* nothing need follow the last number of a text */
    if (header->encoding == BRIO_PLY_ASCII && bytes) bytes--;
    return brio_stream_expect(s, bytes, 1, "the header");
}

brio_status brio_ply_header_read(brio_stream *s, bool may_end_early, brio_ply_header *header) {
    char *line;
    bool format = false, end = false;
    *header = (brio_ply_header){.num_elements = 0};
    BRIO_FORWARD(brio_stream_line(s, &line));
    if (!line || strncmp(line, "ply", 3) != 0 || *brio_skip_blanks(line + 3)) {
        s->line = 1;
        return bad_line(s, "ply");
    }
    while (!end) {
        BRIO_FORWARD(brio_stream_line(s, &line));
        if (!line) return bad_line(s, "end_header behind this line");
        BRIO_FORWARD(read_line(s, header, line, &format, &end));
    }
    if (!may_end_early) BRIO_FORWARD(check_promise(s, header));
    return BRIO_OK;
}

void brio_ply_header_free(brio_context *ctx, brio_ply_header *header) {
    for (size_t i = 0; i < header->num_elements; i++) brio_release(ctx, header->elements[i].properties);
    brio_release(ctx, header->elements);
    brio_release(ctx, header->crs);
    *header = (brio_ply_header){.num_elements = 0};
}
