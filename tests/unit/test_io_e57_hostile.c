/* E57 files that are damaged or lie: every truncation, every changed byte, counts, lengths, offsets and packets that are
 * not true, XML that is none, memory that runs out. Each is a status with a sentence, and leaves nothing behind. */
#include "e57_image.h"
#include "failing_allocator.h"

enum { RECORDS = 40, FIELDS = 6 };

static uint64_t numbers[FIELDS][RECORDS];
static const e57_test_field fields[FIELDS] = {
    {"cartesianX", "type=\"Float\" precision=\"single\"", 32, numbers[0]},
    {"cartesianY", "type=\"Float\" precision=\"double\"", 64, numbers[1]},
    {"cartesianZ", "type=\"ScaledInteger\" minimum=\"0\" maximum=\"2047\" scale=\"0.01\"", 11, numbers[2]},
    {"cartesianInvalidState", "type=\"Integer\" minimum=\"0\" maximum=\"2\"", 2, numbers[3]},
    {"intensity", "type=\"Integer\" minimum=\"-3\" maximum=\"4\"", 3, numbers[4]},
    {"colorRed", "type=\"Integer\" minimum=\"9\" maximum=\"9\"", 0, numbers[5]}};

static void make_numbers(void) {
    for (size_t r = 0; r < RECORDS; r++) {
        numbers[0][r] = e57_float((float)r / 3);
        numbers[1][r] = e57_double((double)r / 7);
        numbers[2][r] = r * 17 % 2048;
        numbers[3][r] = r % 9 == 0;
        numbers[4][r] = r % 8;
        numbers[5][r] = 0;
    }
}

typedef struct {
    const char *records, *before, *after; /* before, after: text of the XML before and behind the scans */
    const e57_test_field *fields;
    size_t count, scans;
    uint64_t offset; /* not 0: of the points, instead of the true one */
} variant;

static const variant right = {"40", "", "", fields, FIELDS, 1, 0};

/* The content of a file, to be freed: small packets, so that there are several. */
static e57_image make(const variant *v) {
    e57_image f = e57_begin();
    uint64_t section = e57_put_section(&f, fields, FIELDS, RECORDS, 50);
    e57_begin_xml(&f);
    e57_text(&f, v->before);
    for (size_t i = 0; i < v->scans; i++)
        e57_put_scan(&f, v->fields, v->count, v->records, v->offset ? v->offset : section, "");
    e57_text(&f, v->after);
    e57_end_xml(&f);
    e57_set_header(&f);
    return f;
}

static void expect_variant(const variant *v, brio_status expected, const char *part) {
    e57_image f = make(v);
    e57_store(&f, "v.e57");
    free(f.bytes);
    if (expected != BRIO_OK)
        e57_refused("v.e57", expected, part);
    else
        brio_mesh_free(e57_read_right("v.e57"));
}

static void expect_sane(const char *name, const char *how, size_t at) {
    brio_mesh *m = NULL;
    brio_status status = brio_read(io_ctx, io_path(name), &(brio_read_options){.format = BRIO_FORMAT_E57}, &m);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT || status == BRIO_ERR_NOT_FINITE ||
               status == BRIO_ERR_TOO_LARGE,
           "%s %zu: status %d: %s", how, at, (int)status, brio_message(io_ctx));
    EXPECT((status == BRIO_OK) == (m != NULL) && (m || strstr(brio_message(io_ctx), name)), "%s %zu: %s", how, at,
           brio_message(io_ctx));
    brio_mesh_free(m);
    EXPECT(brio_context_memory(io_ctx) == 0, "%s %zu", how, at);
}

/* --- the file --- */

static void every_truncation_is_refused(void) {
    size_t size;
    e57_image f = make(&right);
    uint8_t *bytes = e57_pages(&f, &size);
    for (size_t n = 0; n < size; n++) {
        brio_mesh *m = NULL;
        io_put("t.e57", bytes, n);
        brio_status status = brio_read(io_ctx, io_path("t.e57"), NULL, &m);
        EXPECT(!m && (status == BRIO_ERR_FORMAT), "%zu bytes: status %d", n, (int)status);
        brio_mesh_free(m);
    }
    /* whole pages are missing, and the header agrees */
    for (size_t n = E57_PAGE; n < size; n += E57_PAGE) {
        e57_set(f.bytes + 16, n, 8);
        uint8_t *shorter = e57_pages(&f, &size);
        io_put("t.e57", shorter, n);
        e57_refused("t.e57", BRIO_ERR_FORMAT, "");
        free(shorter);
    }
    free(bytes);
    free(f.bytes);
}

/* Every byte lies in a page with a checksum, or is one. */
static void every_changed_byte_is_refused(void) {
    size_t size;
    e57_image f = make(&right);
    uint8_t *bytes = e57_pages(&f, &size);
    for (size_t i = 0; i < size; i++) {
        brio_mesh *m = NULL;
        bytes[i] ^= (uint8_t)(1 << i % 8);
        io_put("c.e57", bytes, size);
        brio_status status = brio_read(io_ctx, io_path("c.e57"), &(brio_read_options){.format = BRIO_FORMAT_E57}, &m);
        EXPECT(status == BRIO_ERR_FORMAT && !m, "byte %zu: status %d", i, (int)status);
        EXPECT(i < E57_HEADER || strstr(brio_message(io_ctx), "is damaged: its checksum is"), "byte %zu: %s", i,
               brio_message(io_ctx));
        brio_mesh_free(m);
        bytes[i] ^= (uint8_t)(1 << i % 8);
    }
    free(bytes);
    free(f.bytes);
}

/* With true checksums. */
static void random_changes_are_a_status(void) {
    uint64_t state = 3;
    e57_image f = make(&right);
    uint8_t *copy = malloc(f.size);
    memcpy(copy, f.bytes, f.size);
    for (size_t n = 0; n < 6000; n++) {
        /* half of the changes are in the sections of the file and of the points, where every byte counts */
        size_t room = n % 2 ? f.size : 120;
        for (uint64_t i = 1 + io_random(&state) % 3; i > 0; i--)
            f.bytes[io_random(&state) % room] ^= (uint8_t)(1 << io_random(&state) % 8);
        e57_store(&f, "r.e57");
        expect_sane("r.e57", "change", n);
        memcpy(f.bytes, copy, f.size);
    }
    free(copy);
    free(f.bytes);
}

/* A place in the header or the section, and a number that is not true there. */
static void lying_numbers(void) {
    static const struct {
        size_t at;
        int bytes;
        uint64_t value;
        const char *part;
    } cases[] = {{7, 1, '8', "byte 0: expected ASTM-E57"},
                 {8, 4, 2, "byte 8: version 2"},
                 {16, 8, UINT64_C(1) << 63, "its header announces 9223372036854775808 bytes"},
                 {16, 8, 1000, "expected whole pages"},
                 {16, 8, 0, "expected whole pages"},
                 {24, 8, UINT64_MAX, "the XML section at byte 18446744073709551615"},
                 {24, 8, 1022, "where a checksum is"},
                 {24, 8, 0, "XML section, line 1"},
                 {32, 8, UINT64_C(1) << 63, "an XML section of 9223372036854775808 bytes"},
                 {32, 8, 0, "an XML section of 0 bytes"},
                 {32, 8, 50, "XML section, line"},
                 {40, 8, 4096, "pages of 4096 bytes"},
                 {48, 1, 2, "a section of the kind 2"},
                 {56, 8, UINT64_MAX, "a section of 18446744073709551615 bytes"},
                 {56, 8, 31, "a section of 31 bytes"},
                 {56, 8, 64, "need more than the 32 bytes"},
                 {64, 8, UINT64_C(1) << 62, "the packets of a scan at byte 4611686018427387904"},
                 {64, 8, 48, "outside of their section"},
                 {64, 8, 0, "outside of their section"},
                 {80, 1, 3, "a packet of the kind 3"},
                 {80, 1, 2, "values of cartesian"},
                 {82, 2, 65535, "bytes at most"},
                 {82, 2, 4, "expected 8"},
                 {82, 2, 3, "byte streams, expected 6"},
                 {82, 2, 7, "bytes at least, expected 18"},
                 {84, 2, 7, "7 byte streams, expected 6"},
                 {84, 2, 65535, "65535 byte streams"},
                 {86, 2, 65535, "bytes, expected 65553"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        e57_image f = make(&right);
        e57_set(f.bytes + cases[k].at, cases[k].value, cases[k].bytes);
        e57_store(&f, "l.e57");
        free(f.bytes);
        brio_mesh *m = NULL;
        brio_status status = brio_read(io_ctx, io_path("l.e57"), &(brio_read_options){.format = BRIO_FORMAT_E57}, &m);
        EXPECT(status == BRIO_ERR_FORMAT && !m, "%s: status %d", cases[k].part, (int)status);
        EXPECT(strstr(brio_message(io_ctx), cases[k].part), "\"%s\" without \"%s\"", brio_message(io_ctx),
               cases[k].part);
        brio_mesh_free(m);
    }
}

static void lying_xml(void) {
    static const struct {
        const char *records;
        uint64_t offset;
        size_t scans;
        const char *part;
    } cases[] = {{"9223372036854775808", 0, 1, "its 9223372036854775808 points of 112 bits need more than"},
                 {"18446744073709551615", 0, 1, "need more than"},
                 {"18446744073709551616", 0, 1, "the recordCount \"18446744073709551616\""},
                 {"-1", 0, 1, "the recordCount \"-1\""},
                 {"4 0", 0, 1, "the recordCount \"4 0\""},
                 {"41", 0, 1, "values of"},
                 {"40", 1 << 20, 1, "the points of a scan at byte 1048576"},
                 {"40", 1022, 1, "where a checksum is"},
                 {"40", 4, 1, "a section of the kind"},
                 {"40", 0, 40, "have more bytes than the file"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        variant v = right;
        v.records = cases[k].records;
        v.offset = cases[k].offset;
        v.scans = cases[k].scans;
        expect_variant(&v, BRIO_ERR_FORMAT, cases[k].part);
    }
    expect_variant(&right, BRIO_OK, "");
}

/* Points that are all one point need no bytes: what they promise is limited all the same. */
static void points_of_no_bits(void) {
    static const e57_test_field constant[] = {{"cartesianX", "type=\"Integer\" minimum=\"1\" maximum=\"1\"", 0, NULL},
                                              {"cartesianY", "type=\"Integer\" minimum=\"2\" maximum=\"2\"", 0, NULL},
                                              {"cartesianZ", "type=\"Integer\" minimum=\"3\" maximum=\"3\"", 0, NULL}};
    variant v = right;
    v.fields = constant;
    v.count = 3;
    expect_variant(&v, BRIO_OK, "");
    v.records = "4000000000";
    expect_variant(&v, BRIO_ERR_FORMAT, "need more than");
}

static void wrong_prototypes(void) {
    static const struct {
        const char *name, *attributes, *part;
    } cases[] = {{"cartesianX", "type=\"Float\"", "points without coordinates"},
                 {"a", "type=\"Structure\"", "the type Structure"},
                 {"a", "", "the type (none)"},
                 {"a", "type=\"Float\" precision=\"half\"", "precision \"half\""},
                 {"a", "type=\"Integer\" minimum=\"1\" maximum=\"0\"", "its minimum is above its maximum"},
                 {"a", "type=\"Integer\" minimum=\"9223372036854775808\"", "expected a whole number of 64 bits"},
                 {"a", "type=\"Integer\" maximum=\"x\"", "maximum \"x\""},
                 {"a", "type=\"ScaledInteger\" scale=\"inf\"", "scale \"inf\", expected a finite number"},
                 {"a", "type=\"ScaledInteger\" offset=\"1,5\"", "offset \"1,5\""},
                 {"a", "type=\"Float\" type=\"Float\"", "duplicate attribute"},
                 {"no:a", "type=\"Float\"", "unbound prefix"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        e57_test_field field = {cases[k].name, cases[k].attributes, 0, NULL};
        variant v = right;
        v.fields = &field;
        v.count = 1;
        expect_variant(&v, BRIO_ERR_FORMAT, cases[k].part);
    }
    e57_test_field twice[FIELDS + 1];
    memcpy(twice, fields, sizeof fields);
    twice[FIELDS] = fields[FIELDS - 1];
    variant v = right;
    v.fields = twice;
    v.count = FIELDS + 1;
    expect_variant(&v, BRIO_ERR_FORMAT, "two fields named colorRed");
}

/* --- XML --- */

static void store_xml(const char *text) {
    e57_image f = e57_begin();
    e57_put_section(&f, fields, FIELDS, RECORDS, 50);
    f.xml = f.size;
    e57_text(&f, text);
    e57_set_header(&f);
    e57_store(&f, "x.e57");
    free(f.bytes);
}

static void wrong_xml(void) {
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"<?xml version=\"1.0\"?>\n<!DOCTYPE lolz [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]><e57Root>&b;"
         "</e57Root>",
         "line 2: a document type (lolz)"},
        {"<!DOCTYPE e57Root SYSTEM \"http://example.org/x.dtd\"><e57Root/>", "a document type (e57Root)"},
        {"<e57Root>\n<data3D>\n</e57Root>", "line 3, column 2: mismatched tag"},
        {"<e57Root>&amp;&unknown;</e57Root>", "undefined entity"},
        {"<html/>", "the element html, expected e57Root"},
        {"<e57Root/><e57Root/>", "junk after document element"},
        {"<e57Root>\xff</e57Root>", "not well-formed"},
        {"   ", "no element found"},
        {"<e57Root><data3D><s><points type=\"Vector\"/></s></data3D></e57Root>", "points of the type Vector"},
        {"<e57Root><data3D><s><points type=\"CompressedVector\"/></s></data3D></e57Root>", "the fileOffset \"\""},
        {"<e57Root><data3D><s><points type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"1\"/></s></data3D>"
         "</e57Root>",
         "points without coordinates"},
        {"<e57Root><data3D><s><points type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"1\"><codecs><a>"
         "<zip/></a></codecs></points></s></data3D></e57Root>",
         "the codec zip is not known"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        store_xml(cases[k].text);
        e57_refused("x.e57", BRIO_ERR_FORMAT, cases[k].part);
    }
    store_xml("<e57Root/>");
    brio_mesh *m = e57_read_right("x.e57");
    EXPECT(m && m->num_vertices == 0);
    brio_mesh_free(m);
}

static void deep_and_long_xml(void) {
    enum { DEEP = 100000 };
    char *text = malloc(8 * DEEP + 100), *at = text + sprintf(text, "<e57Root><data3D><s><points><a>");
    for (int i = 0; i < DEEP; i++) at += sprintf(at, "<a>");
    store_xml(text);
    e57_refused("x.e57", BRIO_ERR_FORMAT, "points of the type (none)");
    at = text + sprintf(text, "<e57Root><other>");
    for (int i = 0; i < DEEP; i++) at += sprintf(at, "<a>");
    store_xml(text);
    e57_refused("x.e57", BRIO_ERR_FORMAT, "elements nested more than 1000 deep");
    at = text + sprintf(text, "<e57Root><data3D><s><pose><rotation><w>");
    memset(at, '1', 300000);
    strcpy(at + 300000, "</w></rotation></pose></s></data3D></e57Root>");
    store_xml(text);
    e57_refused("x.e57", BRIO_ERR_FORMAT, "expected a finite number");
    free(text);
}

/* Expat would go through the tag again with each part of it. */
static void a_tag_without_an_end(void) {
    static const char start[] = "<e57Root a=\"";
    e57_image f = e57_begin();
    f.xml = f.size;
    f.bytes = realloc(f.bytes, 3 * (size_t)E57_ROOM);
    memcpy(f.bytes + f.size, start, sizeof start);
    memset(f.bytes + f.size + sizeof start - 1, 'x', 2 * (size_t)E57_ROOM);
    f.size += 2 * (size_t)E57_ROOM;
    e57_set_header(&f);
    e57_store(&f, "x.e57");
    e57_refused("x.e57", BRIO_ERR_FORMAT, "line 1: a tag or comment of more than 1048576 bytes");
    free(f.bytes);
}

/* --- the machine --- */

static brio_status read_right_file(brio_context *ctx) {
    brio_mesh *m = NULL;
    brio_status status = brio_read(ctx, io_path("m.e57"), NULL, &m);
    brio_mesh_free(m);
    return status;
}

static void each_allocation_fails(void) {
    e57_image f = make(&right);
    e57_store(&f, "m.e57");
    free(f.bytes);
    expect_clean_failures(read_right_file);
}

static int cancel_at_once(const char *stage, double fraction, void *user) {
    (void)stage, (void)user;
    return fraction < 1;
}

static void limits_and_cancellation(void) {
    brio_context_set_memory_limit(io_ctx, 1 << 18);
    EXPECT(read_right_file(io_ctx) == BRIO_ERR_NO_MEMORY);
    brio_context_set_memory_limit(io_ctx, 0);
    brio_context_set_progress(io_ctx, cancel_at_once, NULL);
    EXPECT(read_right_file(io_ctx) == BRIO_ERR_CANCELLED);
    brio_context_set_progress(io_ctx, NULL, NULL);
    EXPECT(read_right_file(io_ctx) == BRIO_OK, "%s", brio_message(io_ctx));
}

SUITE(test_io_e57_hostile) {
    io_begin();
    make_numbers();
    if (!e57_is_read()) {
        printf("skipped: unit.test_io_e57_hostile: brio was built without the library expat\n");
        io_end();
        return HARNESS_SKIP;
    }
    RUN(every_truncation_is_refused);
    RUN(every_changed_byte_is_refused);
    RUN(random_changes_are_a_status);
    RUN(lying_numbers);
    RUN(lying_xml);
    RUN(points_of_no_bits);
    RUN(wrong_prototypes);
    RUN(wrong_xml);
    RUN(deep_and_long_xml);
    RUN(a_tag_without_an_end);
    RUN(each_allocation_fails);
    RUN(limits_and_cancellation);
    return io_end();
}
