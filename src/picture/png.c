/* Writes PNG files, without a library, so that a picture has the same bytes wherever it is made.
 *
 * Each row is replaced by its differences from what its neighbours foretell: of five filters the one whose
 * differences have the least sum. Runs of equal bytes become matches at the distance 1, and each block brings the
 * Huffman codes that suit it.
 *
 * Based on: Deutsch. DEFLATE compressed data format specification. RFC 1951, 1996.
 *           Huffman. A method for the construction of minimum-redundancy codes. Proc. IRE 1952.
 * Differs from them: matches at other distances are not looked for; the lengths of codes are written in four bits
 * each. */
#include "base/memory.h"
#include "io/crc32.h"
#include "io/output.h"
#include "picture/picture.h"
#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* SYMBOLS: bytes, the end of a block, lengths of matches. END: the end. LONGEST: bits of a code. SHORTEST_RUN,
 * LONGEST_RUN: bytes of a match. BLOCK: tokens of a block; chosen. FILTERS: of PNG. ADLER: modulus of the checksum of
 * zlib. */
enum { SYMBOLS = 286, END = 256, LONGEST = 15, SHORTEST_RUN = 3, LONGEST_RUN = 258, BLOCK = 1 << 16, FILTERS = 5 };
static const uint32_t ADLER = 65521;

/* The symbols of lengths from 257 on: the least length, and how many bits say how much longer it is. */
static const uint16_t LENGTH[29] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                    31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
static const uint8_t EXTRA[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                  2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};

typedef struct {
    brio_context *ctx;
    uint8_t *bytes; /* what is packed so far */
    size_t used, capacity;
    uint64_t bits; /* that make no byte yet */
    int num_bits;
    uint16_t *token; /* of the block: a byte, or END + the length of a run */
    size_t num_tokens;
} packer;

static brio_status put_bits(packer *p, uint32_t value, int count) {
    p->bits |= (uint64_t)value << p->num_bits;
    p->num_bits += count;
    for (; p->num_bits >= 8; p->num_bits -= 8, p->bits >>= 8) {
        BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->bytes, p->capacity, p->used + 1));
        p->bytes[p->used++] = (uint8_t)p->bits;
    }
    return BRIO_OK;
}

/* --- codes --- */

static int symbol_of(uint16_t token, int *length) {
    int i = 28;
    *length = token > END ? token - END : 0;
    if (token <= END) return token;
    while (LENGTH[i] > *length) i--;
    return END + 1 + i;
}

/* Finds the depths of the leaves of Huffman's tree: the two least weights are joined until one is left. Returns the
 * greatest depth. */
static int find_depths(const uint32_t *weight, uint8_t *depth) {
    uint32_t of[2 * SYMBOLS];
    int parent[2 * SYMBOLS], open[2 * SYMBOLS], count = 0, next = SYMBOLS, deepest = 0;
    for (int s = 0; s < SYMBOLS; s++)
        if ((of[s] = weight[s]) > 0) open[count++] = s;
    while (count > 1) {
        int least[2];
        for (int k = 0; k < 2; k++) {
            int best = 0;
            for (int i = 1; i < count; i++)
                if (of[open[i]] < of[open[best]]) best = i;
            least[k] = open[best];
            open[best] = open[--count];
        }
        of[next] = of[least[0]] + of[least[1]];
        parent[least[0]] = parent[least[1]] = next;
        open[count++] = next++;
    }
    for (int s = 0; s < SYMBOLS; s++) {
        depth[s] = 0;
        for (int at = s; weight[s] && at != next - 1; at = parent[at]) depth[s]++;
        if (depth[s] > deepest) deepest = depth[s];
    }
    return deepest;
}

static uint32_t reversed(uint32_t code, int length) {
    uint32_t out = 0;
    for (int i = 0; i < length; i++) out |= (code >> i & 1) << (length - 1 - i);
    return out;
}

/* Finds the codes: those of one length ascend with their symbols. Weights are halved until no code is too long. */
static void find_codes(uint32_t *weight, uint8_t *depth, uint32_t *code) {
    uint32_t next = 0;
    weight[END] = 1;
    weight[0] += !weight[0]; /* a tree of two leaves at least */
    while (find_depths(weight, depth) > LONGEST)
        for (int s = 0; s < SYMBOLS; s++) weight[s] = weight[s] ? weight[s] / 2 + 1 : 0;
    for (int length = 1; length <= LONGEST; length++, next <<= 1)
        for (int s = 0; s < SYMBOLS; s++)
            if (depth[s] == length) code[s] = reversed(next++, length);
}

/* Writes the lengths of the codes, each by a code of four bits, and that of the one distance, 1. */
static brio_status put_depths(packer *p, const uint8_t *depth) {
    enum { LITERALS = SYMBOLS - 257, DISTANCES = 0, CODES = 19 - 4, UNUSED = 3 }; /* 16 to 18 repeat: not used */
    BRIO_FORWARD(put_bits(p, LITERALS, 5));
    BRIO_FORWARD(put_bits(p, DISTANCES, 5));
    BRIO_FORWARD(put_bits(p, CODES, 4));
    for (int i = 0; i < 19; i++) BRIO_FORWARD(put_bits(p, i < UNUSED ? 0 : 4, 3));
    for (int s = 0; s < SYMBOLS; s++) BRIO_FORWARD(put_bits(p, reversed(depth[s], 4), 4));
    return put_bits(p, reversed(1, 4), 4);
}

static brio_status end_block(packer *p, bool last) {
    uint32_t weight[SYMBOLS] = {0}, code[SYMBOLS] = {0};
    uint8_t depth[SYMBOLS];
    int length;
    for (size_t i = 0; i < p->num_tokens; i++) weight[symbol_of(p->token[i], &length)]++;
    find_codes(weight, depth, code);
    BRIO_FORWARD(put_bits(p, last ? 5 : 4, 3)); /* whether it is the last one; it brings its codes */
    BRIO_FORWARD(put_depths(p, depth));
    for (size_t i = 0; i < p->num_tokens; i++) {
        int s = symbol_of(p->token[i], &length);
        assert(depth[s] > 0);
        BRIO_FORWARD(put_bits(p, code[s], depth[s]));
        if (!length) continue;
        BRIO_FORWARD(put_bits(p, (uint32_t)length - LENGTH[s - END - 1], EXTRA[s - END - 1]));
        BRIO_FORWARD(put_bits(p, 0, 1)); /* the distance */
    }
    p->num_tokens = 0;
    return put_bits(p, code[END], depth[END]);
}

static brio_status put_token(packer *p, uint16_t token) {
    if (p->num_tokens == BLOCK) BRIO_FORWARD(end_block(p, false));
    p->token[p->num_tokens++] = token;
    return BRIO_OK;
}

/* Packs a row: bytes, and runs of the byte before. */
static brio_status put_row(packer *p, const uint8_t *row, size_t size) {
    for (size_t i = 0; i < size;) {
        size_t run = 0;
        while (i > 0 && i + run < size && run < LONGEST_RUN && row[i + run] == row[i - 1]) run++;
        BRIO_FORWARD(put_token(p, run < SHORTEST_RUN ? row[i] : (uint16_t)(END + run)));
        i += run < SHORTEST_RUN ? 1 : run;
    }
    return BRIO_OK;
}

/* --- rows --- */

static int foretold(int filter, int left, int above, int corner) {
    int sum = left + above - corner, a = abs(sum - left), b = abs(sum - above), c = abs(sum - corner);
    switch (filter) {
    case 1:
        return left;
    case 2:
        return above;
    case 3:
        return (left + above) / 2;
    case 4:
        return a <= b && a <= c ? left : b <= c ? above : corner;
    default:
        return 0;
    }
}

/* Writes a row as a filter makes it, behind the filter's number. Returns the sum of the differences. */
static uint64_t filter_row(int filter, const uint8_t *row, const uint8_t *above, size_t size, uint8_t *out) {
    uint64_t sum = 0;
    out[0] = (uint8_t)filter;
    for (size_t i = 0; i < size; i++) {
        int left = i < 3 ? 0 : row[i - 3], up = above ? above[i] : 0, corner = above && i >= 3 ? above[i - 3] : 0;
        out[i + 1] = (uint8_t)(row[i] - foretold(filter, left, up, corner));
        sum += out[i + 1] < 128 ? out[i + 1] : 256 - out[i + 1];
    }
    return sum;
}

static void add_to_checksum(uint32_t *low, uint32_t *high, const uint8_t *bytes, size_t size) {
    for (size_t i = 0; i < size; i++) {
        *low = (*low + bytes[i]) % ADLER;
        *high = (*high + *low) % ADLER;
    }
}

static brio_status pack_rows(packer *p, const brio_raster *r, uint8_t *best, uint8_t *tried) {
    size_t size = 3 * (size_t)r->width;
    uint32_t low = 1, high = 0;
    BRIO_FORWARD(put_bits(p, 0x0178, 16)); /* of zlib: deflate, a window of 256 bytes would do */
    for (size_t y = 0; y < (size_t)r->height; y++) {
        const uint8_t *row = r->pixels + y * size, *above = y ? row - size : NULL;
        uint64_t least = filter_row(0, row, above, size, best);
        for (int f = 1; f < FILTERS; f++) {
            uint64_t sum = filter_row(f, row, above, size, tried);
            if (sum >= least) continue;
            least = sum;
            memcpy(best, tried, size + 1);
        }
        add_to_checksum(&low, &high, best, size + 1);
        BRIO_FORWARD(put_row(p, best, size + 1));
        BRIO_FORWARD(brio_look(p->ctx, size));
    }
    BRIO_FORWARD(end_block(p, true));
    BRIO_FORWARD(put_bits(p, 0, (8 - p->num_bits) % 8));
    for (int k = 0; k < 4; k++) BRIO_FORWARD(put_bits(p, ((high << 16 | low) >> (24 - 8 * k)) & 255, 8));
    return BRIO_OK;
}

/* --- the file --- */

static void put_word(uint8_t *to, uint32_t x) {
    for (int k = 0; k < 4; k++) to[k] = (uint8_t)(x >> (24 - 8 * k));
}

static brio_status put_chunk(brio_output *out, const char *name, const uint8_t *bytes, size_t size) {
    brio_crc32 sum;
    uint8_t word[4];
    brio_crc32_begin(&sum);
    brio_crc32_add(&sum, name, 4);
    brio_crc32_add(&sum, bytes, size);
    put_word(word, (uint32_t)size);
    BRIO_FORWARD(brio_output_bytes(out, word, 4));
    BRIO_FORWARD(brio_output_bytes(out, name, 4));
    BRIO_FORWARD(brio_output_bytes(out, bytes, size));
    put_word(word, brio_crc32_end(&sum));
    return brio_output_bytes(out, word, 4);
}

brio_status brio_png_write(brio_context *ctx, const char *path, const brio_raster *r, uint64_t *bytes) {
    static const size_t CHUNK = (size_t)1 << 30; /* a chunk's size has 31 bits */
    brio_status status = BRIO_OK;
    brio_output out = {.ctx = ctx, .target.folder = -1, .file = -1};
    packer p = {.ctx = ctx};
    uint8_t header[13] = {[8] = 8, [9] = 2}, *best = NULL, *tried = NULL; /* 8 bits, three colours */
    BRIO_TRY(BRIO_ALLOC(ctx, p.token, BLOCK));
    BRIO_TRY(BRIO_ALLOC(ctx, best, 3 * (size_t)r->width + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, tried, 3 * (size_t)r->width + 1));
    BRIO_TRY(pack_rows(&p, r, best, tried));
    put_word(header, (uint32_t)r->width);
    put_word(header + 4, (uint32_t)r->height);
    BRIO_TRY(brio_output_open(&out, ctx, path, p.used));
    BRIO_TRY(brio_output_bytes(&out, "\x89PNG\r\n\x1a\n", 8));
    BRIO_TRY(put_chunk(&out, "IHDR", header, sizeof header));
    for (size_t at = 0; at < p.used; at += CHUNK)
        BRIO_TRY(put_chunk(&out, "IDAT", p.bytes + at, p.used - at < CHUNK ? p.used - at : CHUNK));
    BRIO_TRY(put_chunk(&out, "IEND", header, 0));
    *bytes = brio_output_offset(&out);
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    brio_release(ctx, p.bytes);
    brio_release(ctx, p.token);
    brio_release(ctx, best);
    brio_release(ctx, tried);
    return status;
}
