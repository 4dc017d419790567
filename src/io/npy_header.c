/* Reads the header of an NPY file: a dictionary of Python with the keys descr, fortran_order and shape.
 *
 * Based on: NumPy enhancement proposal 1: a simple file format for NumPy arrays. 2007. */
#include "io/npy_header.h"
#include "base/memory.h"
#include "io/little_endian.h"
#include "io/number.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Chosen: the longest header, and the most numbers of a row. */
enum { MOST_HEADER = 1 << 20, MOST_COLUMNS = 4096 };

typedef struct {
    brio_stream *stream;
    const char *start, *at; /* the dictionary ends with a 0 */
    uint64_t offset;        /* the byte of the file at which it begins */
} parser;

static brio_status expected(const parser *p, const char *what) {
    return brio_fail(p->stream->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected %s", p->stream->name,
                     p->offset + (uint64_t)(p->at - p->start), what);
}

/* Moves behind a character, if it is the next one besides blanks. */
static bool take(parser *p, char c) {
    while (*p->at == ' ' || *p->at == '\n') p->at++;
    if (*p->at != c) return false;
    p->at++;
    return true;
}

/* Reads a string in quotes. Escapes are not known. */
static brio_status take_string(parser *p, char text[64]) {
    char quote = take(p, '\'') ? '\'' : take(p, '"') ? '"' : 0;
    const char *end = quote ? strchr(p->at, quote) : NULL;
    if (!end || end - p->at > 63 || memchr(p->at, '\\', (size_t)(end - p->at)))
        return expected(p, "a string of at most 63 characters in quotes");
    memcpy(text, p->at, (size_t)(end - p->at));
    text[end - p->at] = 0;
    p->at = end + 1;
    return BRIO_OK;
}

/* Adds a field of a type such as <f8. */
static brio_status add_field(parser *p, brio_npy_header *h, const char *name, const char *type) {
    static const struct {
        const char *name;
        brio_scalar type;
        bool wide;
    } types[] = {
        {"b1", BRIO_SCALAR_UINT8, false},   {"i1", BRIO_SCALAR_INT8, false},   {"u1", BRIO_SCALAR_UINT8, false},
        {"i2", BRIO_SCALAR_INT16, false},   {"u2", BRIO_SCALAR_UINT16, false}, {"i4", BRIO_SCALAR_INT32, false},
        {"u4", BRIO_SCALAR_UINT32, false},  {"i8", BRIO_SCALAR_INT32, true},   {"u8", BRIO_SCALAR_UINT32, true},
        {"f4", BRIO_SCALAR_FLOAT32, false}, {"f8", BRIO_SCALAR_FLOAT64, false}};
    brio_status status = BRIO_OK;
    size_t i = 0, count = sizeof types / sizeof *types;
    while (i < count && (!strchr("<>|", type[0]) || strcmp(type + 1, types[i].name) != 0)) i++;
    if (i == count || !type[0])
        return expected(p, "a type < > or | with b1 i1 u1 i2 u2 i4 u4 i8 u8 f4 or f8 before here");
    if (h->num_fields == MOST_COLUMNS) return expected(p, "at most 4096 numbers in a row");
    BRIO_TRY(BRIO_RESERVE(p->stream->ctx, h->fields, h->capacity, h->num_fields + 1));
    brio_npy_field *f = &h->fields[h->num_fields++];
    *f = (brio_npy_field){.type = types[i].type, .wide = types[i].wide, .big = type[0] == '>', .at = h->record};
    snprintf(f->name, sizeof f->name, "%s", name);
    h->record += types[i].wide ? 8 : brio_scalar_size(types[i].type);
done:
    return status;
}

/* Reads [('x', '<f8'), ...]. A field without a name is padding in NumPy, which writes it as bytes '|V4'. */
static brio_status take_records(parser *p, brio_npy_header *h) {
    brio_status status = BRIO_OK;
    char name[64], type[64];
    uint64_t bytes;
    while (!take(p, ']')) {
        if (!take(p, '(')) return expected(p, "( or ] in the list of fields");
        BRIO_TRY(take_string(p, name));
        if (!take(p, ',')) return expected(p, "a comma");
        BRIO_TRY(take_string(p, type));
        if (!take(p, ')')) return expected(p, ") behind the type: fields of several numbers are not read");
        take(p, ',');
        const char *digits = type + 2;
        if (!strncmp(type, "|V", 2) && brio_parse_count(&digits, &bytes) && bytes < MOST_HEADER)
            h->record += (size_t)bytes;
        else
            BRIO_TRY(add_field(p, h, name, type));
    }
done:
    return status;
}

/* Reads a shape: (rows,) or (rows, columns). */
static brio_status take_shape(parser *p, uint64_t *shape, size_t *dimensions) {
    *dimensions = 0;
    if (!take(p, '(')) return expected(p, "(");
    while (!take(p, ')')) {
        take(p, ' ');
        if (*dimensions == 2 || !brio_parse_count(&p->at, &shape[*dimensions]))
            return expected(p, "a shape of one or two dimensions");
        ++*dimensions;
        take(p, ',');
    }
    return BRIO_OK;
}

/* Makes the fields of an array of rows. */
static brio_status make_columns(parser *p, brio_npy_header *h, const char *type, const uint64_t *shape,
                                size_t dimensions) {
    brio_status status = BRIO_OK;
    if (dimensions != 2 || shape[1] < 3 || shape[1] > MOST_COLUMNS)
        return expected(p, "before here the shape (rows, columns) with 3 to 4096 columns");
    for (uint64_t i = 0; i < shape[1]; i++) {
        char name[64];
        snprintf(name, sizeof name, i < 3 ? "%c" : "column%d", i < 3 ? "xyz"[i] : (int)i + 1);
        BRIO_TRY(add_field(p, h, name, type));
    }
done:
    return status;
}

static brio_status parse(parser *p, brio_npy_header *h) {
    brio_status status = BRIO_OK;
    char key[64], type[64] = "";
    uint64_t shape[2] = {0};
    size_t dimensions = 0;
    if (!take(p, '{')) return expected(p, "{");
    while (!take(p, '}')) {
        BRIO_TRY(take_string(p, key));
        if (!take(p, ':')) return expected(p, ":");
        if (!strcmp(key, "descr")) {
            BRIO_TRY(take(p, '[') ? take_records(p, h) : take_string(p, type));
        } else if (!strcmp(key, "shape")) {
            BRIO_TRY(take_shape(p, shape, &dimensions));
        } else if (!strcmp(key, "fortran_order")) {
            take(p, ' ');
            h->fortran = *p->at == 'T';
            p->at += strspn(p->at, "TrueFals");
        } else {
            return expected(p, "before here the key descr, fortran_order or shape");
        }
        take(p, ',');
    }
    h->rows = shape[0];
    if (*type) return make_columns(p, h, type, shape, dimensions);
    if (!h->num_fields || dimensions != 1) return expected(p, "before here fields, and a shape of one dimension");
    h->fortran = false; /* one dimension: the orders are the same */
done:
    return status;
}

brio_status brio_npy_header_read(brio_stream *s, brio_npy_header *h) {
    brio_status status = BRIO_OK;
    const char *bytes = NULL;
    char *text = NULL;
    *h = (brio_npy_header){.num_fields = 0};
    brio_stream_element(s, "header", 1);
    BRIO_TRY(brio_stream_take(s, 8, &bytes));
    BRIO_REQUIRE(s->ctx, !memcmp(bytes, "\x93NUMPY", 6) && bytes[6] >= 1 && bytes[6] <= 3, BRIO_ERR_FORMAT,
                 "%s: byte 0: expected \\x93NUMPY and a version 1 to 3", s->name);
    bool wide = bytes[6] > 1;
    BRIO_TRY(brio_stream_take(s, wide ? 4 : 2, &bytes));
    size_t size = wide ? brio_le32(bytes) : brio_le16(bytes);
    BRIO_REQUIRE(s->ctx, size <= MOST_HEADER, BRIO_ERR_FORMAT, "%s: byte 8: a header of %zu bytes, expected at most %d",
                 s->name, size, MOST_HEADER);
    BRIO_TRY(brio_stream_take(s, size, &bytes));
    BRIO_TRY(BRIO_ALLOC(s->ctx, text, size + 1));
    memcpy(text, bytes, size);
    text[size] = 0;
    parser p = {s, text, text, wide ? 12 : 10};
    BRIO_TRY(parse(&p, h));
done:
    brio_release(s->ctx, text);
    return status;
}

void brio_npy_header_free(brio_context *ctx, brio_npy_header *h) {
    brio_release(ctx, h->fields);
    h->fields = NULL;
}
