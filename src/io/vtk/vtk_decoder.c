/* The bytes of arrays.
 *
 * In front of an array stands its size in bytes, in front of a compressed one the number of its blocks, their size when
 * inflated, the size of the last one (0 if it is as large), and the size of each in the file. In base 64 the numbers in
 * front of a compressed array are a text of their own. Each block is a stream of zlib.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include "io/vtk/vtk.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* --- zlib --- */

/* Blocks of bytes compressed by zlib, whose memory is counted as all other.
 *
 * Based on: Deutsch, Gailly. ZLIB compressed data format specification version 3.3. RFC 1950, 1996. */

#ifdef BRIO_HAS_ZLIB
#include <limits.h>
#include <zlib.h>

/* Level 5 of 9 is that of VTK. */
enum { LEVEL = 5 };

struct brio_vtk_zlib {
    z_stream stream;
};

static void *take_memory(void *ctx, unsigned count, unsigned size) {
    brio_status status = BRIO_OK;
    return brio_resize(ctx, NULL, count, size, &status);
}

static void give_memory(void *ctx, void *block) {
    brio_release(ctx, block);
}

bool brio_vtk_has_zlib(void) {
    return true;
}

/* Begins a block.   z  NULL before the first one; freed by brio_vtk_zlib_free.   name  of the file.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (brio was built without zlib), BRIO_ERR_NO_MEMORY. */
static brio_status vtk_inflate_begin(brio_context *ctx, const char *name, brio_vtk_zlib **z) {
    brio_status status = BRIO_OK;
    (void)name;
    if (*z) {
        inflateReset(&(*z)->stream);
        return BRIO_OK;
    }
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, *z, 1));
    (*z)->stream = (z_stream){.zalloc = take_memory, .zfree = give_memory, .opaque = ctx};
    if (inflateInit(&(*z)->stream) == Z_OK) return BRIO_OK;
    brio_release(ctx, *z);
    *z = NULL;
    status = BRIO_ERR_NO_MEMORY; /* the message is that of take_memory */
done:
    return status;
}

brio_status brio_vtk_inflate(brio_vtk_zlib *z, brio_vtk_span *span, bool *ended) {
    unsigned in = span->in_left < UINT_MAX ? (unsigned)span->in_left : UINT_MAX;
    unsigned out = span->out_left < UINT_MAX ? (unsigned)span->out_left : UINT_MAX;
    z->stream.next_in = (Bytef *)(uintptr_t)span->in;
    z->stream.avail_in = in;
    z->stream.next_out = (Bytef *)span->out;
    z->stream.avail_out = out;
    int result = inflate(&z->stream, Z_NO_FLUSH);
    span->in = (const char *)z->stream.next_in; /* there may be no input: NULL */
    span->in_left -= in - z->stream.avail_in;
    span->out = (char *)z->stream.next_out;
    span->out_left -= out - z->stream.avail_out;
    *ended = result == Z_STREAM_END;
    if (result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR) return BRIO_OK;
    return result == Z_MEM_ERROR ? BRIO_ERR_NO_MEMORY : BRIO_ERR_FORMAT;
}

void brio_vtk_zlib_free(brio_context *ctx, brio_vtk_zlib *z) {
    if (z) inflateEnd(&z->stream);
    brio_release(ctx, z);
}

size_t brio_vtk_deflate_bound(size_t size) {
    return compressBound(size);
}

brio_status brio_vtk_deflate(brio_context *ctx, const void *bytes, size_t size, void *packed, size_t *packed_size) {
    z_stream stream = {.zalloc = take_memory, .zfree = give_memory, .opaque = ctx};
    if (deflateInit(&stream, LEVEL) != Z_OK) return BRIO_ERR_NO_MEMORY;
    stream.next_in = (Bytef *)(uintptr_t)bytes;
    stream.avail_in = (unsigned)size;
    stream.next_out = packed;
    stream.avail_out = (unsigned)*packed_size;
    int result = deflate(&stream, Z_FINISH);
    *packed_size = stream.total_out;
    deflateEnd(&stream);
    return result == Z_STREAM_END ? BRIO_OK : brio_fail(ctx, BRIO_ERR_INTERNAL, "zlib: no room for a block");
}

#else

bool brio_vtk_has_zlib(void) {
    return false;
}

static brio_status vtk_inflate_begin(brio_context *ctx, const char *name, brio_vtk_zlib **z) {
    *z = NULL;
    return brio_fail(ctx, BRIO_ERR_FORMAT,
                     "%s: the arrays are compressed, and this brio was built without zlib, which inflates them", name);
}

brio_status brio_vtk_inflate(brio_vtk_zlib *z, brio_vtk_span *span, bool *ended) {
    (void)z, (void)span;
    *ended = false;
    return BRIO_ERR_FORMAT;
}

void brio_vtk_zlib_free(brio_context *ctx, brio_vtk_zlib *z) {
    (void)ctx, (void)z;
}

size_t brio_vtk_deflate_bound(size_t size) {
    return size;
}

brio_status brio_vtk_deflate(brio_context *ctx, const void *bytes, size_t size, void *packed, size_t *packed_size) {
    (void)bytes, (void)size, (void)packed, (void)packed_size;
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "this brio was built without zlib, which compresses");
}

#endif

/* --- an array --- */

/* MOST_DIGITS: characters of a number in a text. Both chosen. */
enum { INPUT = 1 << 16, MOST_DIGITS = 100 };

static brio_status bad(const brio_vtk_decoder *d, const char *what) {
    return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": array %s %s", d->stream->name,
                     brio_stream_offset(d->stream), d->array->name, what);
}

/* --- bytes as they are in the file --- */

static brio_status take_encoded(brio_vtk_decoder *d, void *to, size_t size) {
    char *out = to;
    brio_stream *s = d->stream;
    if (d->encoding == BRIO_VTK_BASE64) return brio_base64_take(&d->base64, s, to, size);
    while (size) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        size_t part = brio_stream_left(s) < size ? brio_stream_left(s) : size;
        if (!part) return brio_stream_truncated(s);
        memcpy(out, s->buffer + s->begin, part);
        s->begin += part;
        out += part;
        size -= part;
    }
    return BRIO_OK;
}

static brio_status take_word(brio_vtk_decoder *d, uint64_t *word) {
    char bytes[8];
    uint32_t narrow = 0;
    brio_status status = take_encoded(d, bytes, d->header->word);
    if (status != BRIO_OK) return status;
    bool wide = d->header->word == 8;
    brio_scalar_gather(wide ? (void *)word : (void *)&narrow, bytes, 1, 0, d->header->word, d->header->swap);
    if (!wide) *word = narrow;
    return BRIO_OK;
}

/* Returns the most bytes that the rest of the file can hold of an array. */
static uint64_t most_left(const brio_vtk_decoder *d) {
    const brio_stream *s = d->stream;
    uint64_t at = brio_stream_offset(s), left = s->size > at ? s->size - at : 0;
    if (s->size == BRIO_SIZE_UNKNOWN) return UINT64_MAX;
    return d->encoding == BRIO_VTK_BASE64 ? left / 4 * 3 + 3 : left;
}

static brio_status expect(const brio_vtk_decoder *d, uint64_t bytes) {
    if (bytes <= most_left(d) && bytes != UINT64_MAX) return BRIO_OK; /* which stands for a text, of unknown size */
    return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": array %s promises %" PRIu64 " bytes, the file has at most %" PRIu64,
                     d->stream->name, brio_stream_offset(d->stream), d->array->name, bytes, most_left(d));
}

/* --- blocks --- */

/* Reads the sizes of the blocks. Their number is held against the file before there is memory for them. */
static brio_status take_sizes(brio_vtk_decoder *d, uint64_t *packed) {
    brio_vtk_blocks *b = &d->blocks;
    uint64_t bytes;
    if (__builtin_mul_overflow(b->count, d->header->word, &bytes)) bytes = UINT64_MAX;
    BRIO_FORWARD(expect(d, bytes));
    for (uint64_t i = 0; i < b->count; i++) {
        BRIO_FORWARD(BRIO_RESERVE(d->stream->ctx, b->packed, b->capacity, i + 1));
        BRIO_FORWARD(take_word(d, &b->packed[i]));
        if (__builtin_add_overflow(*packed, b->packed[i], packed)) return bad(d, "has blocks of over 2^64 bytes");
    }
    return expect(d, *packed);
}

static brio_status open_blocks(brio_vtk_decoder *d, uint64_t *bytes) {
    brio_status status = BRIO_OK;
    brio_vtk_blocks *b = &d->blocks;
    uint64_t packed = 0, most;
    b->next = 0;
    b->open = false;
    BRIO_REQUIRE(d->stream->ctx, !strcmp(d->header->compressor, "vtkZLibDataCompressor"), BRIO_ERR_FORMAT,
                 "%s: the arrays are compressed by %s; expected vtkZLibDataCompressor or none: write the file again "
                 "with one of these",
                 d->stream->name, brio_excerpt_of(d->header->compressor).text);
    BRIO_TRY(vtk_inflate_begin(d->stream->ctx, d->stream->name, &d->zlib));
    BRIO_TRY(take_word(d, &b->count));
    BRIO_TRY(take_word(d, &b->block_size));
    BRIO_TRY(take_word(d, &b->last_size));
    BRIO_TRY(take_sizes(d, &packed));
    *bytes = 0;
    if (b->count && (__builtin_mul_overflow(b->count - (b->last_size > 0), b->block_size, bytes) ||
                     __builtin_add_overflow(*bytes, b->last_size, bytes)))
        *bytes = UINT64_MAX;
    if (__builtin_mul_overflow(packed, BRIO_VTK_MOST_INFLATED, &most)) most = UINT64_MAX;
    BRIO_REQUIRE(d->stream->ctx, *bytes <= most && *bytes != UINT64_MAX, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": array %s promises %" PRIu64 " bytes, which are not in %" PRIu64
                 " compressed bytes",
                 d->stream->name, brio_stream_offset(d->stream), d->array->name, *bytes, packed);
done:
    d->base64 = (brio_base64){.used = 0};
    return status;
}

static brio_status begin_block(brio_vtk_decoder *d) {
    brio_vtk_blocks *b = &d->blocks;
    uint64_t i = b->next++;
    b->in_left = b->packed[i];
    b->out_left = i + 1 == b->count && b->last_size ? b->last_size : b->block_size;
    b->open = true;
    return vtk_inflate_begin(d->stream->ctx, d->stream->name, &d->zlib);
}

/* Finds compressed bytes of the present block. */
static brio_status find_input(brio_vtk_decoder *d, brio_vtk_span *span) {
    brio_stream *s = d->stream;
    uint64_t left = d->blocks.in_left;
    span->in_left = 0;
    if (!left) return BRIO_OK;
    if (d->encoding == BRIO_VTK_RAW) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        if (!brio_stream_left(s)) return brio_stream_truncated(s);
        span->in = s->buffer + s->begin;
        span->in_left = brio_stream_left(s) < left ? brio_stream_left(s) : (size_t)left;
        return BRIO_OK;
    }
    if (!d->input) BRIO_FORWARD(BRIO_ALLOC(s->ctx, d->input, INPUT));
    if (d->input_begin == d->input_end) {
        d->input_begin = 0;
        d->input_end = left < INPUT ? (size_t)left : INPUT;
        BRIO_FORWARD(brio_base64_take(&d->base64, s, d->input, d->input_end));
    }
    span->in = d->input + d->input_begin;
    span->in_left = d->input_end - d->input_begin;
    return BRIO_OK;
}

/* Marks compressed bytes as used. */
static void use_input(brio_vtk_decoder *d, size_t used) {
    d->blocks.in_left -= used;
    if (d->encoding == BRIO_VTK_RAW)
        d->stream->begin += used;
    else
        d->input_begin += used;
}

/* Inflates into the room of the span and, when all bytes of the block were inflated, sees to it that it ends there. */
static brio_status inflate_some(brio_vtk_decoder *d, brio_vtk_span *span) {
    brio_status status = BRIO_OK;
    brio_vtk_blocks *b = &d->blocks;
    bool ended = false;
    char beyond;
    for (;;) {
        brio_vtk_span part = {.out = span->out, .out_left = span->out_left};
        if (part.out_left > b->out_left) part.out_left = (size_t)b->out_left;
        if (!b->out_left) part = (brio_vtk_span){.out = &beyond, .out_left = 1};
        size_t room = part.out_left;
        BRIO_TRY(find_input(d, &part));
        size_t input = part.in_left;
        status = brio_vtk_inflate(d->zlib, &part, &ended);
        if (status == BRIO_ERR_FORMAT) return bad(d, "has a block that zlib cannot inflate");
        if (status != BRIO_OK) return status;
        use_input(d, input - part.in_left);
        size_t made = room - part.out_left;
        if (!b->out_left && made) return bad(d, "has a block of more bytes than its size says");
        span->out += made;
        span->out_left -= made;
        b->out_left -= made;
        if (ended && (b->out_left || b->in_left)) return bad(d, "has a block that ends before its size says");
        if (ended || (!span->out_left && b->out_left)) break;
        if (!b->in_left && !made) return bad(d, "has a block that does not end where its size says");
    }
    b->open = !ended;
done:
    return status;
}

static brio_status take_inflated(brio_vtk_decoder *d, void *to, size_t size) {
    brio_vtk_span span = {.out = to, .out_left = size};
    while (span.out_left) {
        if (!d->blocks.open) BRIO_FORWARD(begin_block(d));
        BRIO_FORWARD(inflate_some(d, &span));
    }
    return BRIO_OK;
}

/* --- text --- */

/* Reads the next word. Its length is 0 where the text ends. */
static brio_status next_word(brio_stream *s, char word[MOST_DIGITS + 1], size_t *length) {
    *length = 0;
    for (;;) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        if (!brio_stream_left(s)) return brio_stream_truncated(s);
        char c = s->buffer[s->begin];
        if (c == '<' || (brio_is_blank(c) && *length)) break;
        if (*length == MOST_DIGITS) return brio_xml_bad(s, "a number of at most 100 characters");
        if (!brio_is_blank(c)) word[(*length)++] = c;
        s->begin++;
    }
    word[*length] = 0;
    return BRIO_OK;
}

/* Parses an integer of 64 bits exactly. */
static bool parse_wide(const char *word, int type, void *to) {
    const char *p = word + (*word == '-');
    uint64_t value;
    if (!brio_parse_count(&p, &value) || *p) return false;
    if (*word == '-') {
        if (type == BRIO_VTK_UINT64 || value > (uint64_t)INT64_MAX + 1) return false;
        value = 0 - value;
    } else if (type == BRIO_VTK_INT64 && value > INT64_MAX) {
        return false;
    }
    memcpy(to, &value, sizeof value);
    return true;
}

bool brio_vtk_parse(const char *word, int type, void *to) {
    const char *p = word;
    double value;
    if (type >= BRIO_SCALAR_END) return parse_wide(word, type, to);
    return brio_parse_number(&p, &value) && !*p && brio_scalar_store(to, (brio_scalar)type, value);
}

static brio_status take_text(brio_vtk_decoder *d, char *to, size_t size, size_t *got) {
    char word[MOST_DIGITS + 1];
    size_t length, number = brio_vtk_type_size(d->array->type);
    for (*got = 0; *got + number <= size; *got += number) {
        BRIO_FORWARD(next_word(d->stream, word, &length));
        if (!length) return BRIO_OK;
        BRIO_EXPECT(d->stream->ctx, brio_vtk_parse(word, d->array->type, to + *got), BRIO_ERR_FORMAT,
                    "%s: byte %" PRIu64 ": array %s: expected a number of type %s, found \"%s\"", d->stream->name,
                    brio_stream_offset(d->stream), d->array->name, brio_vtk_type_name(d->array->type),
                    brio_excerpt_of(word).text);
    }
    return BRIO_OK;
}

/* --- arrays --- */

static bool has_no_content(const brio_vtk_array *array) {
    return array->empty && !array->appended;
}

brio_status brio_vtk_decoder_open(brio_vtk_decoder *d, const brio_vtk_array *array, brio_vtk_encoding encoding,
                                  uint64_t *bytes) {
    d->array = array;
    d->encoding = encoding;
    d->base64 = (brio_base64){.used = 0};
    d->input_begin = d->input_end = 0;
    d->swap = encoding != BRIO_VTK_TEXT && d->header->swap;
    *bytes = encoding == BRIO_VTK_TEXT ? UINT64_MAX : 0;
    if (encoding != BRIO_VTK_TEXT && !has_no_content(array)) {
        BRIO_FORWARD(d->header->compressed ? open_blocks(d, bytes) : take_word(d, bytes));
        if (!d->header->compressed) BRIO_FORWARD(expect(d, *bytes));
    }
    d->left = *bytes;
    return BRIO_OK;
}

brio_status brio_vtk_decoder_take(brio_vtk_decoder *d, void *to, size_t size, size_t *got) {
    *got = 0;
    if (has_no_content(d->array)) return BRIO_OK;
    if (d->encoding == BRIO_VTK_TEXT) return take_text(d, to, size, got);
    if (size > d->left) size = (size_t)d->left;
    brio_status status = d->header->compressed ? take_inflated(d, to, size) : take_encoded(d, to, size);
    if (status != BRIO_OK) return status;
    d->left -= size;
    *got = size;
    return BRIO_OK;
}

void brio_vtk_decoder_free(brio_vtk_decoder *d) {
    brio_release(d->stream->ctx, d->blocks.packed);
    brio_release(d->stream->ctx, d->input);
    brio_vtk_zlib_free(d->stream->ctx, d->zlib);
}
