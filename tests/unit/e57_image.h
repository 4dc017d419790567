/* E57 files for tests, made from scratch: fields of any width, packets that break where they like, true checksums around
 * whatever content a test wants. */
#ifndef BRIO_TESTS_E57_IMAGE_H
#define BRIO_TESTS_E57_IMAGE_H

#include "io_files.h"

enum { E57_PAGE = 1024, E57_CONTENT = 1020, E57_HEADER = 48, E57_ROOM = 1 << 20 };

/* The content of a file, without checksums. */
typedef struct {
    uint8_t *bytes;
    size_t size, xml;
} e57_image;

/* A field of a prototype: its attributes, and a number for each record. Numbers NULL: text, which has no numbers here. */
typedef struct {
    const char *name, *attributes;
    unsigned bits;
    const uint64_t *numbers;
} e57_test_field;

static inline void e57_put(e57_image *f, const void *bytes, size_t size) {
    if (!f->bytes || f->size + size > E57_ROOM) {
        EXPECT(0, "the image is full");
        return;
    }
    memcpy(f->bytes + f->size, bytes, size);
    f->size += size;
}

static inline void e57_set(uint8_t *at, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) at[i] = (uint8_t)(value >> 8 * i);
}

static inline void e57_put_number(e57_image *f, uint64_t value, int bytes) {
    uint8_t number[8];
    e57_set(number, value, bytes);
    e57_put(f, number, (size_t)bytes);
}

static inline e57_image e57_begin(void) {
    e57_image f = {calloc(E57_ROOM, 1), E57_HEADER, 0};
    return f;
}

static inline uint64_t e57_physical(uint64_t logical) {
    return logical / E57_CONTENT * E57_PAGE + logical % E57_CONTENT;
}

/* The byte stream of a field: its numbers, lowest bit first. */
static inline uint8_t *e57_stream(const e57_test_field *field, size_t records, size_t *size) {
    size_t bits = field->numbers ? field->bits * records : 0;
    uint8_t *stream = calloc(bits / 8 + 1, 1);
    for (size_t i = 0, bit = 0; stream && bit < bits; i++)
        for (unsigned b = 0; b < field->bits; b++, bit++)
            stream[bit / 8] |= (uint8_t)((field->numbers[i] >> b & 1) << bit % 8);
    *size = (bits + 7) / 8;
    return stream;
}

/* A packet with up to `part` bytes of each stream, from byte `from` on; every other field gets one byte less at first, so
 * that fields run apart. */
static inline bool e57_put_packet(e57_image *f, uint8_t **streams, size_t *sizes, size_t *used, size_t count,
                                  size_t part) {
    size_t start = f->size, total = 6 + 2 * count;
    bool more = false;
    uint8_t header[6] = {1, 0, 0, 0, (uint8_t)count, (uint8_t)(count >> 8)};
    e57_put(f, header, 6);
    size_t lengths[300];
    for (size_t i = 0; i < count; i++) {
        size_t want = i % 2 && !used[i] && part > 1 ? part - 1 : part, left = sizes[i] - used[i];
        lengths[i] = want < left ? want : left;
        e57_put_number(f, lengths[i], 2);
        total += lengths[i];
    }
    for (size_t i = 0; i < count; i++) {
        e57_put(f, streams[i] + used[i], lengths[i]);
        used[i] += lengths[i];
        more |= used[i] < sizes[i];
    }
    for (; total % 4; total++) e57_put_number(f, 0, 1);
    e57_set(f->bytes + start + 2, total - 1, 2);
    return more;
}

/* Adds a section of points and returns its physical offset. Between the packets with data stand an index packet and an
 * empty one. */
static inline uint64_t e57_put_section(e57_image *f, const e57_test_field *fields, size_t count, size_t records,
                                       size_t part) {
    static const uint8_t others[] = {0, 0, 15, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 7, 0, 0, 0, 0, 0};
    uint8_t *streams[300];
    size_t sizes[300], used[300] = {0}, begin = f->size;
    for (size_t i = 0; i < count; i++) streams[i] = e57_stream(&fields[i], records, &sizes[i]);
    e57_put_number(f, 1, 8);
    e57_put_number(f, 0, 8); /* the length, below */
    e57_put_number(f, e57_physical(begin + 32), 8);
    e57_put_number(f, 0, 8);
    while (e57_put_packet(f, streams, sizes, used, count, part)) e57_put(f, others, sizeof others);
    e57_set(f->bytes + begin + 8, f->size - begin, 8);
    for (size_t i = 0; i < count; i++) free(streams[i]);
    return e57_physical(begin);
}

static inline void e57_text(e57_image *f, const char *text) {
    e57_put(f, text, strlen(text));
}

static inline void e57_begin_xml(e57_image *f) {
    while (f->size % 4) e57_put_number(f, 0, 1);
    f->xml = f->size;
    e57_text(f, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
                "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
                "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\" xmlns:demo=\"http://demo\">\n"
                "<guid type=\"String\"><![CDATA[{1}]]></guid>\n"
                "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n");
}

/* A scan of the XML section.   pose  elements, or "".   records  as text, so that it can lie. */
static inline void e57_put_scan(e57_image *f, const e57_test_field *fields, size_t count, const char *records,
                                uint64_t offset, const char *pose) {
    char text[512];
    e57_text(f, "<vectorChild type=\"Structure\"><name type=\"String\">s</name>");
    e57_text(f, pose);
    snprintf(text, sizeof text,
             "<points type=\"CompressedVector\" fileOffset=\"%llu\" recordCount=\"%s\">\n<prototype "
             "type=\"Structure\">\n",
             (unsigned long long)offset, records);
    e57_text(f, text);
    for (size_t i = 0; i < count; i++) {
        snprintf(text, sizeof text, "<%s %s/>\n", fields[i].name, fields[i].attributes);
        e57_text(f, text);
    }
    e57_text(f, "</prototype><codecs type=\"Vector\"/></points></vectorChild>\n");
}

static inline void e57_end_xml(e57_image *f) {
    e57_text(f, "</data3D><images2D type=\"Vector\"/></e57Root>\n");
}

/* The checksum of a page, bit by bit. */
static inline uint32_t e57_checksum(const uint8_t *bytes) {
    uint32_t rest = UINT32_MAX;
    for (size_t i = 0; i < E57_CONTENT; i++) {
        rest ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) rest = rest & 1 ? rest >> 1 ^ 0x82f63b78u : rest >> 1;
    }
    return ~rest;
}

/* The file's bytes, to be freed: pages with checksums around the content. */
static inline uint8_t *e57_pages(const e57_image *f, size_t *size) {
    size_t pages = (f->size + E57_CONTENT - 1) / E57_CONTENT;
    uint8_t *bytes = calloc(pages + 1, E57_PAGE);
    *size = pages * E57_PAGE;
    for (size_t i = 0; bytes && i < pages; i++) {
        size_t left = f->size - i * E57_CONTENT;
        uint8_t *page = bytes + i * E57_PAGE;
        memcpy(page, f->bytes + i * E57_CONTENT, left < E57_CONTENT ? left : E57_CONTENT);
        uint32_t sum = e57_checksum(page);
        for (int k = 0; k < 4; k++) page[E57_CONTENT + k] = (uint8_t)(sum >> (24 - 8 * k));
    }
    return bytes;
}

static inline void e57_set_header(e57_image *f) {
    size_t pages = (f->size + E57_CONTENT - 1) / E57_CONTENT;
    memcpy(f->bytes, "ASTM-E57", 8);
    e57_set(f->bytes + 8, 1, 4);
    e57_set(f->bytes + 12, 0, 4);
    e57_set(f->bytes + 16, pages * E57_PAGE, 8);
    e57_set(f->bytes + 24, e57_physical(f->xml), 8);
    e57_set(f->bytes + 32, f->size - f->xml, 8);
    e57_set(f->bytes + 40, E57_PAGE, 8);
}

/* Writes the content as a file, with its header as it stands. */
static inline void e57_store(const e57_image *f, const char *name) {
    size_t size;
    uint8_t *bytes = e57_pages(f, &size);
    io_put(name, bytes, size);
    free(bytes);
}

/* Writes a finished file, and frees the content. */
static inline void e57_finish(e57_image *f, const char *name) {
    e57_set_header(f);
    e57_store(f, name);
    free(f->bytes);
}

/* A file of one scan. */
static inline void e57_write_scan(const char *name, const e57_test_field *fields, size_t count, size_t records,
                                  const char *pose) {
    e57_image f = e57_begin();
    char number[32];
    uint64_t section = e57_put_section(&f, fields, count, records, 64);
    snprintf(number, sizeof number, "%zu", records);
    e57_begin_xml(&f);
    e57_put_scan(&f, fields, count, number, section, pose);
    e57_end_xml(&f);
    e57_finish(&f, name);
}

/* Reads a file that is right; NULL on failure. */
static inline brio_mesh *e57_read_right(const char *name) {
    brio_mesh *m = NULL;
    brio_status status = brio_read(io_ctx, io_path(name), NULL, &m);
    EXPECT(status == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    return m;
}

static inline void e57_refused(const char *name, brio_status expected, const char *part) {
    brio_mesh *m = NULL;
    brio_status status = brio_read(io_ctx, io_path(name), NULL, &m);
    EXPECT(status == expected && !m, "%s: status %d, expected %d", part, (int)status, (int)expected);
    EXPECT(strstr(brio_message(io_ctx), part), "\"%s\" without \"%s\"", brio_message(io_ctx), part);
    EXPECT(strstr(brio_message(io_ctx), name), "\"%s\" without the file's name", brio_message(io_ctx));
    brio_mesh_free(m);
    EXPECT(brio_context_memory(io_ctx) == 0, "%s: memory left", part);
}

/* Whether this build reads E57 files. */
static inline bool e57_is_read(void) {
    static const uint64_t zero = 0;
    const e57_test_field fields[] = {{"cartesianX", "type=\"Float\"", 64, &zero},
                                     {"cartesianY", "type=\"Float\"", 64, &zero},
                                     {"cartesianZ", "type=\"Float\"", 64, &zero}};
    brio_mesh *m = NULL;
    e57_write_scan("probe.e57", fields, 3, 1, "");
    brio_status status = brio_read(io_ctx, io_path("probe.e57"), NULL, &m);
    brio_mesh_free(m);
    return status == BRIO_OK || !strstr(brio_message(io_ctx), "without the library expat");
}

static inline uint64_t e57_double(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline uint64_t e57_float(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

#endif
