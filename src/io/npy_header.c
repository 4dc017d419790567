/* Reads the header of an NPY file: a dictionary of Python with the keys descr, fortran_order and shape.
 *
 * Based on: NumPy enhancement proposal 1: a simple file format for NumPy arrays. 2007. */
#include "io/npy_header.h"
#include "base/memory.h"
#include "io/limits.h"
#include "io/little_endian.h"
#include "base/utf8.h"
#include "io/number.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Chosen: the longest header, and the longest row, whatever it has beside numbers. */
enum { MOST_HEADER = 1 << 20, MOST_RECORD = 1 << 24 };

typedef struct {
    brio_stream *stream;
    const char *start, *at; /* the dictionary ends with a 0 */
    uint64_t offset;        /* the byte of the file at which it begins */
} parser;

static brio_status expected(const parser *p, const char *what) {
    return brio_fail(p->stream->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected %s", p->stream->name,
                     p->offset + (uint64_t)(p->at - p->start), what);
}

typedef struct {
    const char *descr; /* where its value begins */
    bool has_shape, fortran;
    uint64_t shape[2]; /* 1 where there are fewer dimensions */
    size_t dimensions;
} dictionary;

/* Moves behind a character, if it is the next one besides blanks. */
static bool take(parser *p, char c) {
    while (*p->at == ' ' || *p->at == '\n') p->at++;
    if (*p->at != c) return false;
    p->at++;
    return true;
}

/* Returns the quote that ends a string, or NULL. Behind a backslash it is one of its characters. */
static const char *end_of_string(const char *at, char quote) {
    while (*at && *at != quote) at += *at == '\\' && at[1] ? 2 : 1;
    return *at ? at : NULL;
}

/* Reads a string in quotes. Of Python's escapes those of a backslash and a quote are known. */
static brio_status take_string(parser *p, char text[64]) {
    char quote = take(p, '\'') ? '\'' : take(p, '"') ? '"' : 0;
    const char *end = quote ? end_of_string(p->at, quote) : NULL;
    size_t n = 0;
    for (; end && p->at < end && n < 63; p->at++) {
        bool escaped = *p->at == '\\';
        if (escaped && !strchr("\\'\"", p->at[1])) break;
        p->at += escaped;
        text[n++] = *p->at;
    }
    if (!end || p->at < end) return expected(p, "a string of at most 63 characters in quotes");
    text[n] = 0;
    p->at = end + 1;
    return BRIO_OK;
}

/* Finds the type of a number such as <f8. Returns false if it is not known. */
static bool find_type(const char *type, brio_npy_field *f) {
    static const struct {
        const char *name;
        brio_scalar type;
        bool wide;
    } types[] = {
        {"b1", BRIO_SCALAR_UINT8, false},   {"i1", BRIO_SCALAR_INT8, false},   {"u1", BRIO_SCALAR_UINT8, false},
        {"i2", BRIO_SCALAR_INT16, false},   {"u2", BRIO_SCALAR_UINT16, false}, {"i4", BRIO_SCALAR_INT32, false},
        {"u4", BRIO_SCALAR_UINT32, false},  {"i8", BRIO_SCALAR_INT32, true},   {"u8", BRIO_SCALAR_UINT32, true},
        {"f4", BRIO_SCALAR_FLOAT32, false}, {"f8", BRIO_SCALAR_FLOAT64, false}};
    size_t i = 0, count = sizeof types / sizeof *types;
    if (!type[0] || !strchr("<>|", type[0])) return false;
    while (i < count && strcmp(type + 1, types[i].name) != 0) i++;
    if (i == count) return false;
    *f = (brio_npy_field){.type = types[i].type, .wide = types[i].wide, .big = type[0] == '>'};
    return true;
}

size_t brio_npy_size(const brio_npy_field *f) {
    return f->wide ? 8 : brio_scalar_size(f->type);
}

static uint64_t wide_bits(const brio_npy_field *f, const char *bytes) {
    return f->big ? __builtin_bswap64(brio_le64(bytes)) : brio_le64(bytes);
}

bool brio_npy_is_rounded(const brio_npy_field *f, const char *bytes) {
    if (!f->wide) return false;
    uint64_t bits = wide_bits(f, bytes);
    if (f->type != BRIO_SCALAR_UINT32 && bits >> 63) bits = 0 - bits;
    double value = (double)bits;
    return value >= 0x1p64 || (uint64_t)value != bits;
}

double brio_npy_load(const brio_npy_field *f, const char *bytes) {
    if (!f->wide) return brio_scalar_load(bytes, f->type, f->big == brio_host_is_little());
    uint64_t bits = wide_bits(f, bytes);
    return f->type == BRIO_SCALAR_UINT32 ? (double)bits : (double)(int64_t)bits;
}

/* Adds a field of a type such as <f8. */
static brio_status add_field(parser *p, brio_npy_header *h, const char *name, const char *type) {
    brio_npy_field found;
    if (!find_type(type, &found))
        return expected(p, "a type < > or | with b1 i1 u1 i2 u2 i4 u4 i8 u8 f4 or f8 before here");
    if (h->num_fields == BRIO_MOST_NUMBERS) return expected(p, "at most 4096 numbers in a row");
    BRIO_FORWARD(BRIO_RESERVE(p->stream->ctx, h->fields, h->capacity, h->num_fields + 1));
    brio_npy_field *f = &h->fields[h->num_fields++];
    *f = found;
    f->at = h->record;
    snprintf(f->name, sizeof f->name, "%s", name);
    h->record += brio_npy_size(f);
    return BRIO_OK;
}

/* Returns the bytes of a type that is no number of a property, such as <U8, |S4, <M8[ns] or <f2; 0 if they are not
 * known. */
static size_t size_of_other(const char *type) {
    const char *digits = type + 2;
    uint64_t count;
    if (!type[0] || !strchr("<>|=", type[0]) || !type[1] || !strchr("SaUVMmfciu", type[1])) return 0;
    if (!brio_parse_count(&digits, &count) || count > MOST_HEADER) return 0;
    return (size_t)(type[1] == 'U' ? 4 * count : count);
}

/* Passes over a field that is no number. Padding has no name, and is not missed. */
static brio_status pass_field(parser *p, brio_npy_header *h, const char *name, size_t bytes) {
    h->record += bytes;
    if (h->record > MOST_RECORD) return expected(p, "before here records of at most 2^24 bytes");
    if (!name[0]) return BRIO_OK;
    if (h->num_passed == BRIO_MOST_NUMBERS) return expected(p, "at most 4096 fields of words");
    BRIO_FORWARD(BRIO_RESERVE(p->stream->ctx, h->passed, h->passed_capacity, h->num_passed + 1));
    memcpy(h->passed[h->num_passed++], name, sizeof *h->passed);
    return BRIO_OK;
}

/* Adds the numbers of a field that is an array: x, y and z of positions, otherwise NAME_0, NAME_1, ... */
static brio_status add_array(parser *p, brio_npy_header *h, const char *name, const char *type, uint64_t count) {
    static const char *const positions[] = {"points", "vertices", "xyz", "positions", "position", "coordinates"};
    bool position = false;
    for (size_t i = 0; i < sizeof positions / sizeof *positions; i++)
        position |= count == 3 && !strcasecmp(name, positions[i]);
    for (uint64_t k = 0; k < count; k++) {
        char part[64] = {"xyz"[k % 3]};
        if (!position && count > 1) brio_numbered_name(part, sizeof part, name, (size_t)k);
        BRIO_FORWARD(add_field(p, h, position || count > 1 ? part : name, type));
    }
    return BRIO_OK;
}

/* Reads the shape of a field, (3,), (2, 2) or 3, as the number of its elements. */
static brio_status take_elements(parser *p, uint64_t *count) {
    uint64_t length;
    bool several = take(p, '(');
    take(p, ' ');
    for (*count = 1; !take(p, ')'); take(p, ','), take(p, ' ')) {
        if (!brio_parse_count(&p->at, &length) || length > MOST_HEADER) return expected(p, "a length of a dimension");
        *count *= length;
        if (*count > MOST_HEADER) return expected(p, "before here fewer elements of a field");
        if (!several) break;
    }
    return BRIO_OK;
}

/* Reads [('x', '<f8'), ...]. Names are Latin-1 in versions 1.0 and 2.0, UTF-8 in 3.0 and as brio 0.1 wrote them:
 * builder.h takes either. A field without a name is padding in NumPy, which writes it as bytes '|V4'. A field with a
 * title has both as a pair. */
static brio_status take_records(parser *p, brio_npy_header *h) {
    char name[64], type[64];
    brio_npy_field number;
    while (!take(p, ']')) {
        uint64_t count = 1;
        if (!take(p, '(')) return expected(p, "( or ] in the list of fields");
        bool titled = take(p, '(');
        BRIO_FORWARD(take_string(p, name));
        if (!take(p, ',')) return expected(p, "a comma");
        if (titled) BRIO_FORWARD(take_string(p, name));
        if (titled && !(take(p, ')') && take(p, ','))) return expected(p, ") and a comma behind title and name");
        BRIO_FORWARD(take_string(p, type));
        if (take(p, ',')) BRIO_FORWARD(take_elements(p, &count));
        if (!take(p, ')')) return expected(p, ") behind the type and the shape of a field");
        take(p, ',');
        if (find_type(type, &number))
            BRIO_FORWARD(add_array(p, h, name, type, count));
        else if (size_of_other(type))
            BRIO_FORWARD(pass_field(p, h, name, size_of_other(type) * (size_t)count));
        else
            return expected(p, "before here a type < > or | with b1 i1 u1 i2 u2 i4 u4 i8 u8 f4 f8, or of words");
    }
    return BRIO_OK;
}

/* Reads a shape: (), (rows,), (rows, columns) or one of more dimensions. */
static brio_status take_shape(parser *p, dictionary *d) {
    uint64_t length;
    d->shape[0] = d->shape[1] = 1;
    d->dimensions = 0;
    if (!take(p, '(')) return expected(p, "(");
    while (!take(p, ')')) {
        take(p, ' ');
        if (!brio_parse_count(&p->at, &length)) return expected(p, "a length of a dimension");
        if (d->dimensions < 2) d->shape[d->dimensions] = length;
        d->dimensions++;
        take(p, ',');
    }
    return BRIO_OK;
}

/* Passes over a value: a string, or brackets with anything in them. */
static brio_status skip_value(parser *p) {
    size_t depth = 0;
    take(p, ' ');
    do {
        char c = *p->at;
        if (!c) return expected(p, "the end of the value of descr");
        if (c == '\'' || c == '"') {
            const char *end = end_of_string(p->at + 1, c);
            if (!end) return expected(p, "a string that ends");
            p->at = end;
        }
        depth += c == '(' || c == '[' || c == '{';
        if (c == ')' || c == ']' || c == '}') {
            if (!depth) return expected(p, "a value of descr");
            depth--;
        }
        p->at++;
    } while (depth || (*p->at && *p->at != ',' && *p->at != '}'));
    return BRIO_OK;
}

/* Makes the fields of an array of rows. */
static brio_status make_columns(parser *p, brio_npy_header *h, const char *type, const uint64_t *shape,
                                size_t dimensions) {
    if (dimensions != 2 || shape[1] < 3 || shape[1] > BRIO_MOST_NUMBERS)
        return expected(p, "before here the shape (rows, columns) with 3 to 4096 columns");
    for (uint64_t i = 0; i < shape[1]; i++) {
        char name[64];
        snprintf(name, sizeof name, i < 3 ? "%c" : "column%d", i < 3 ? "xyz"[i] : (int)i + 1);
        BRIO_FORWARD(add_field(p, h, name, type));
    }
    return BRIO_OK;
}

static brio_status parse(parser *p, dictionary *d) {
    char key[64];
    if (!take(p, '{')) return expected(p, "{");
    while (!take(p, '}')) {
        BRIO_FORWARD(take_string(p, key));
        if (!take(p, ':')) return expected(p, ":");
        if (!strcmp(key, "descr")) {
            take(p, ' ');
            d->descr = p->at;
            BRIO_FORWARD(skip_value(p));
        } else if (!strcmp(key, "shape")) {
            BRIO_FORWARD(take_shape(p, d));
            d->has_shape = true;
        } else if (!strcmp(key, "fortran_order")) {
            take(p, ' ');
            d->fortran = *p->at == 'T';
            p->at += strspn(p->at, "TrueFals");
        } else {
            return expected(p, "before here the key descr, fortran_order or shape");
        }
        take(p, ',');
    }
    if (!d->descr || !d->has_shape) return expected(p, "before here the keys descr and shape");
    return BRIO_OK;
}

/* Makes the fields of an array of points. */
static brio_status make_fields(parser *p, const dictionary *d, brio_npy_header *h) {
    char type[64];
    p->at = d->descr;
    h->rows = d->shape[0];
    h->fortran = d->fortran;
    if (!take(p, '[')) {
        BRIO_FORWARD(take_string(p, type));
        return make_columns(p, h, type, d->shape, d->dimensions);
    }
    BRIO_FORWARD(take_records(p, h));
    if (!h->num_fields || d->dimensions != 1) return expected(p, "before here fields, and a shape of one dimension");
    h->fortran = false; /* one dimension: the orders are the same */
    return BRIO_OK;
}

/* Reads the text of the header into *text, which the caller owns, and begins to parse it. */
static brio_status read_text(brio_stream *s, char **text, parser *p) {
    const char *bytes = NULL;
    brio_stream_element(s, "header", 1);
    BRIO_FORWARD(brio_stream_take(s, 8, &bytes));
    BRIO_EXPECT(s->ctx, !memcmp(bytes, "\x93NUMPY", 6) && bytes[6] >= 1 && bytes[6] <= 3, BRIO_ERR_FORMAT,
                "%s: byte 0: expected \\x93NUMPY and a version 1 to 3", s->name);
    bool wide = bytes[6] > 1;
    BRIO_FORWARD(brio_stream_take(s, wide ? 4 : 2, &bytes));
    size_t size = wide ? brio_le32(bytes) : brio_le16(bytes);
    BRIO_EXPECT(s->ctx, size <= MOST_HEADER, BRIO_ERR_FORMAT, "%s: byte 8: a header of %zu bytes, expected at most %d",
                s->name, size, MOST_HEADER);
    BRIO_FORWARD(brio_stream_take(s, size, &bytes));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, *text, size + 1));
    memcpy(*text, bytes, size);
    (*text)[size] = 0;
    *p = (parser){s, *text, *text, wide ? 12 : 10};
    return BRIO_OK;
}

brio_status brio_npy_header_read(brio_stream *s, brio_npy_header *h) {
    brio_status status = BRIO_OK;
    char *text = NULL;
    parser p;
    dictionary d = {.descr = NULL};
    *h = (brio_npy_header){.num_fields = 0};
    BRIO_TRY(read_text(s, &text, &p));
    BRIO_TRY(parse(&p, &d));
    BRIO_TRY(make_fields(&p, &d, h));
done:
    brio_release(s->ctx, text);
    return status;
}

brio_status brio_npy_array_read(brio_stream *s, brio_npy_array *array) {
    brio_status status = BRIO_OK;
    char *text = NULL, type[64];
    parser p;
    dictionary d = {.descr = NULL};
    *array = (brio_npy_array){.known = false};
    BRIO_TRY(read_text(s, &text, &p));
    BRIO_TRY(parse(&p, &d));
    memcpy(array->shape, d.shape, sizeof d.shape);
    array->dimensions = d.dimensions;
    array->fortran = d.fortran && d.dimensions == 2;
    array->records = *d.descr == '[';
    p.at = d.descr;
    if (!array->records) {
        BRIO_TRY(take_string(&p, type));
        array->known = find_type(type, &array->element);
    }
done:
    brio_release(s->ctx, text);
    return status;
}

void brio_npy_header_free(brio_context *ctx, brio_npy_header *h) {
    brio_release(ctx, h->fields);
    brio_release(ctx, h->passed);
    h->fields = NULL;
    h->passed = NULL;
}
