/* Compressed files and archives made byte by byte, from blocks that are stored as they are: no library is needed. */
#ifndef BRIO_TESTS_PACKED_SAMPLES_H
#define BRIO_TESTS_PACKED_SAMPLES_H

#include "io/crc32.h"
#include "io/little_endian.h"
#include "io_files.h"

typedef struct {
    char bytes[1 << 16];
    size_t size;
} sample;

static inline void sample_add(sample *s, const void *bytes, size_t size) {
    if (s->size + size > sizeof s->bytes) abort();
    if (size) memcpy(s->bytes + s->size, bytes, size);
    s->size += size;
}

static inline void sample_number(sample *s, uint64_t value, size_t size) {
    char bytes[8];
    brio_put_le64(bytes, value);
    sample_add(s, bytes, size);
}

static inline uint32_t sample_crc(const void *bytes, size_t size) {
    brio_crc32 crc;
    brio_crc32_begin(&crc);
    brio_crc32_add(&crc, bytes, size);
    return brio_crc32_end(&crc);
}

/* Deflate: one stored block, the last. */
static inline void sample_deflate(sample *s, const void *bytes, size_t size) {
    sample_number(s, 1, 1);
    sample_number(s, size, 2);
    sample_number(s, ~size, 2);
    sample_add(s, bytes, size);
}

static inline void sample_gzip(sample *s, const void *bytes, size_t size) {
    sample_add(s, "\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
    sample_deflate(s, bytes, size);
    sample_number(s, sample_crc(bytes, size), 4);
    sample_number(s, size, 4);
}

/* A zstd frame: the length of what is in it in four bytes, one raw block, no checksum. */
static inline void sample_zstd(sample *s, const void *bytes, size_t size) {
    sample_number(s, 0xfd2fb528, 4);
    sample_number(s, 0xa0, 1);
    sample_number(s, size, 4);
    sample_number(s, size << 3 | 1, 3);
    sample_add(s, bytes, size);
}

/* --- zip --- */

typedef struct {
    sample file, table;
    size_t count;
    bool wide; /* numbers of 64 bits wherever there can be any */
} zip_sample;

static inline void zip_begin(zip_sample *z, bool wide) {
    z->file.size = z->table.size = z->count = 0;
    z->wide = wide;
}

static inline void zip_add(zip_sample *z, const char *name, const void *bytes, size_t size, bool deflate) {
    sample packed = {.size = 0};
    size_t header = z->file.size, length = strlen(name);
    if (deflate)
        sample_deflate(&packed, bytes, size);
    else
        sample_add(&packed, bytes, size);
    uint32_t crc = sample_crc(bytes, size);
    sample_add(&z->file, "PK\3\4\x14\0\0\0", 8);
    sample_number(&z->file, deflate ? 8 : 0, 2);
    sample_number(&z->file, 0, 4);
    sample_number(&z->file, crc, 4);
    sample_number(&z->file, packed.size, 4);
    sample_number(&z->file, size, 4);
    sample_number(&z->file, length, 4);
    sample_add(&z->file, name, length);
    sample_add(&z->file, packed.bytes, packed.size);
    sample_add(&z->table, "PK\1\2\x14\0\x14\0\0\0", 10);
    sample_number(&z->table, deflate ? 8 : 0, 2);
    sample_number(&z->table, 0, 4);
    sample_number(&z->table, crc, 4);
    sample_number(&z->table, z->wide ? UINT32_MAX : packed.size, 4);
    sample_number(&z->table, z->wide ? UINT32_MAX : size, 4);
    sample_number(&z->table, length, 2);
    sample_number(&z->table, z->wide ? 28 + 5 : 0, 2); /* extra */
    sample_number(&z->table, 0, 8);                    /* comment, disk, attributes */
    sample_number(&z->table, 0, 2);
    sample_number(&z->table, z->wide ? UINT32_MAX : header, 4);
    sample_add(&z->table, name, length);
    if (z->wide) {
        sample_add(&z->table, "\x99\x99\1\0?", 5); /* a field of something else before it */
        sample_add(&z->table, "\1\0\x18\0", 4);
        sample_number(&z->table, size, 8);
        sample_number(&z->table, packed.size, 8);
        sample_number(&z->table, header, 8);
    }
    z->count++;
}

static inline void zip_end(zip_sample *z) {
    sample *f = &z->file;
    uint64_t table = f->size, size = z->table.size;
    sample_add(f, z->table.bytes, z->table.size);
    if (z->wide) {
        uint64_t large = f->size;
        sample_add(f, "PK\6\6\x2c\0\0\0\0\0\0\0\x2d\0\x2d\0\0\0\0\0\0\0\0\0", 24);
        sample_number(f, z->count, 8);
        sample_number(f, z->count, 8);
        sample_number(f, size, 8);
        sample_number(f, table, 8);
        sample_add(f, "PK\6\7\0\0\0\0", 8);
        sample_number(f, large, 8);
        sample_number(f, 1, 4);
    }
    sample_add(f, "PK\5\6\0\0\0\0", 8);
    sample_number(f, z->wide ? 0xffff : z->count, 2);
    sample_number(f, z->wide ? 0xffff : z->count, 2);
    sample_number(f, z->wide ? UINT32_MAX : size, 4);
    sample_number(f, z->wide ? UINT32_MAX : table, 4);
    sample_add(f, "\3\0end", 5); /* a comment */
}

/* Adds an array to an archive.   shape  as Python writes it, e.g. "(4, 3)" */
static inline void zip_array(zip_sample *z, const char *name, const char *type, const char *shape, const void *data,
                             size_t size) {
    char header[256], file[64];
    sample s = {.size = 0};
    snprintf(header, sizeof header, "{'descr': '%s', 'fortran_order': False, 'shape': %s, }\n", type, shape);
    snprintf(file, sizeof file, "%s.npy", name);
    sample_add(&s, "\x93NUMPY\1\0", 8);
    sample_number(&s, strlen(header), 2);
    sample_add(&s, header, strlen(header));
    sample_add(&s, data, size);
    zip_add(z, file, s.bytes, s.size, z->count % 2);
}

/* --- the samples of tests with damage --- */

static const char packed_text[] = "x y z v\n1 2 3 4\n5 6 7 8\n-1 -2 -3 9\n";

/* Four points with a property, two triangles and a tetrahedron: stored and deflated arrays by turns. */
static inline void packed_npz(zip_sample *z, bool wide) {
    static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint16_t label[4] = {7, 8, 9, 10};
    static const int32_t faces[6] = {0, 1, 2, 1, 2, 3}, tetrahedra[4] = {0, 1, 2, 3};
    zip_begin(z, wide);
    zip_array(z, "label", "<u2", "(4,)", label, sizeof label);
    zip_array(z, "points", "<f8", "(4, 3)", points, sizeof points);
    zip_array(z, "faces", "<i4", "(2, 3)", faces, sizeof faces);
    zip_array(z, "simplices", "<i4", "(1, 4)", tetrahedra, sizeof tetrahedra);
    zip_array(z, "words", "<U4", "(4,)", points, 64);
    zip_end(z);
}

/* Whether this build decompresses. */
static inline bool reads_packed(bool zstd) {
    sample s = {.size = 0};
    brio_status status;
    if (zstd)
        sample_zstd(&s, packed_text, strlen(packed_text));
    else
        sample_gzip(&s, packed_text, strlen(packed_text));
    brio_mesh *m = io_read_bytes(zstd ? "try.xyz.zst" : "try.xyz.gz", s.bytes, s.size, &status);
    bool lacks = status == BRIO_ERR_FORMAT && strstr(brio_message(io_ctx), "this build of brio cannot read");
    if (lacks) printf("skipped: %s: %s\n", zstd ? "zstd" : "gzip", brio_message(io_ctx));
    EXPECT(m || lacks, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
    return !lacks;
}

#endif
