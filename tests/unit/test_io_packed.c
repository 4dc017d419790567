/* Files compressed by gzip and zstd, whole and damaged: made here byte by byte. tests/foreign compares with the programs
 * that compress. */
#include "failing_allocator.h"
#include "packed_samples.h"

static bool has_gzip, has_zstd;

static brio_mesh *read_sample(const char *name, const sample *s) {
    brio_status status;
    brio_mesh *m = io_read_bytes(name, s->bytes, s->size, &status);
    EXPECT(status == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    return m;
}

static void expect_failure(const char *name, const sample *s, brio_status expected, const char *part) {
    brio_status status;
    brio_mesh *m = io_read_bytes(name, s->bytes, s->size, &status);
    EXPECT(status == expected && strstr(brio_message(io_ctx), part), "%s: %d \"%s\" without \"%s\"", name, (int)status,
           brio_message(io_ctx), part);
    brio_mesh_free(m);
}

static void pack(sample *s, bool zstd, const char *text) {
    if (zstd)
        sample_zstd(s, text, strlen(text));
    else
        sample_gzip(s, text, strlen(text));
}

static const char *name_of(bool zstd, const char *gz, const char *zst) {
    return zstd ? zst : gz;
}

static void crc_of_known_words(void) {
    EXPECT(sample_crc("123456789", 9) == 0xcbf43926, "the check value of the polynomial");
    EXPECT(sample_crc("", 0) == 0);
}

static void one_and_several_members(void) {
    for (int zstd = 0; zstd < 2; zstd++) {
        if (!(zstd ? has_zstd : has_gzip)) continue;
        sample s = {.size = 0};
        pack(&s, zstd, packed_text);
        brio_mesh *m = read_sample(name_of(zstd, "a.xyz.gz", "a.xyz.zst"), &s);
        EXPECT(m && m->num_vertices == 3 && m->vertices[8] == -3 && m->num_properties == 1);
        brio_mesh_free(m);
        pack(&s, zstd, "0 0 1 5\n");
        pack(&s, zstd, "");
        pack(&s, zstd, "0 0 2 ");
        pack(&s, zstd, "6\n");
        m = read_sample("several.xyz.gz", &s); /* zstd, too: the content decides */
        EXPECT(m && m->num_vertices == 5 && m->vertices[14] == 2);
        brio_mesh_free(m);
    }
}

static void extension_under_the_packing_decides(void) {
    if (!has_gzip) return;
    sample s = {.size = 0};
    const char *obj = "v 1 2 3\nv 4 5 6\nv 7 8 9\nf 1 2 3\n", *ele = "1 4 0\n1 1 2 3 4\n";
    pack(&s, false, obj);
    brio_mesh *m = read_sample("a.OBJ.Gz", &s);
    EXPECT(m && m->num_faces == 1);
    brio_mesh_free(m);
    s.size = 0;
    pack(&s, false, "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    sample e = {.size = 0};
    pack(&e, false, ele);
    io_put("n.ele.gz", e.bytes, e.size);
    m = read_sample("n.node.gz", &s);
    EXPECT(m && m->num_tetrahedra == 1, "the .ele.gz beside");
    brio_mesh_free(m);
    EXPECT(brio_read(io_ctx, io_path("n.ele.gz"), NULL, &m) == BRIO_OK && m->num_vertices == 4);
    brio_mesh_free(m);
    s.size = 0;
    pack(&s, false, "1 2 3\n");
    expect_failure("a.what.gz", &s, BRIO_ERR_FORMAT, "unknown format");
}

static void places_are_those_of_decompressed_data(void) {
    if (!has_gzip) return;
    sample s = {.size = 0};
    pack(&s, false, "1 2 3\n4 x 6\n");
    expect_failure("a.xyz.gz", &s, BRIO_ERR_FORMAT, "a.xyz.gz, decompressed: line 2: expected a number");
    s.size = 0;
    pack(&s, false, "OFF\n3\n");
    expect_failure("a.off.gz", &s, BRIO_ERR_FORMAT, "a.off.gz, decompressed: ends at byte 6");
}

static void damage_has_its_own_words(void) {
    for (int zstd = 0; zstd < 2; zstd++) {
        if (!(zstd ? has_zstd : has_gzip)) continue;
        const char *name = name_of(zstd, "a.xyz.gz", "a.xyz.zst");
        sample s = {.size = 0}, outer = {.size = 0};
        pack(&s, zstd, packed_text);
        sample_add(&s, "hello", 5);
        expect_failure(name, &s, BRIO_ERR_FORMAT, "what follows the compressed data is none near byte");
        s.size = 0;
        pack(&s, zstd, packed_text);
        s.size--;
        expect_failure(name, &s, BRIO_ERR_FORMAT, "the compressed data breaks off");
        s.size = 0;
        pack(&s, zstd, packed_text);
        sample_add(&s, s.bytes, 7);
        expect_failure(name, &s, BRIO_ERR_FORMAT, "the compressed data breaks off");
        s.size = 0;
        pack(&s, zstd, packed_text);
        if (zstd)
            sample_zstd(&outer, s.bytes, s.size);
        else
            sample_gzip(&outer, s.bytes, s.size);
        expect_failure(name, &outer, BRIO_ERR_FORMAT, "compressed again; only one level");
    }
    if (!has_gzip) return;
    sample s = {.size = 0}, tar = {.size = 0};
    pack(&s, false, packed_text);
    s.bytes[s.size - 6] ^= 1;
    expect_failure("a.xyz.gz", &s, BRIO_ERR_FORMAT, "incorrect data check");
    s.size = 0;
    pack(&s, false, packed_text);
    sample_number(&s, 0, 8);
    sample_number(&s, 0, 8);
    brio_mesh_free(read_sample("padded.xyz.gz", &s));
    memset(tar.bytes, 'a', 512);
    memcpy(tar.bytes + 257, "ustar", 5);
    s.size = 0;
    sample_gzip(&s, tar.bytes, 512);
    expect_failure("a.xyz.gz", &s, BRIO_ERR_FORMAT, "a tar archive");
}

/* A repeated block, which stands for 128 KiB in 4 bytes. */
static void bomb_meets_the_memory_limit(void) {
    enum { BLOCKS = 4000, BLOCK = 1 << 17 };
    if (!has_zstd) return;
    sample s = {.size = 0};
    sample_number(&s, 0xfd2fb528, 4);
    sample_add(&s, "\0\x38", 2); /* a window of 128 KiB */
    for (int i = 0; i < BLOCKS; i++) {
        sample_number(&s, (uint64_t)BLOCK << 3 | 2 | (i == BLOCKS - 1), 3);
        sample_number(&s, '7', 1);
    }
    brio_context_set_memory_limit(io_ctx, 64 << 20);
    expect_failure("bomb.xyz.zst", &s, BRIO_ERR_NO_MEMORY, "limit 67108864");
    expect_failure("bomb.bnpts.zst", &s, BRIO_ERR_NO_MEMORY, "limit 67108864");
    brio_context_set_memory_limit(io_ctx, 0);
}

/* A frame that asks for a window of 2 GiB. */
static void window_counts_against_the_limit(void) {
    if (!has_zstd) return;
    sample s = {.size = 0};
    sample_number(&s, 0xfd2fb528, 4);
    sample_add(&s,
               "\0\xa8\x09\0\0"
               "1",
               6);
    brio_context_set_memory_limit(io_ctx, 64 << 20);
    expect_failure("window.xyz.zst", &s, BRIO_ERR_NO_MEMORY, "limit 67108864");
    brio_context_set_memory_limit(io_ctx, 0);
}

static void every_prefix_and_changed_byte(void) {
    for (int zstd = 0; zstd < 2; zstd++) {
        if (!(zstd ? has_zstd : has_gzip)) continue;
        const char *name = name_of(zstd, "a.xyz.gz", "a.xyz.zst");
        sample s = {.size = 0};
        pack(&s, zstd, packed_text);
        for (size_t n = 0; n < s.size; n++) {
            brio_mesh *m = io_expect_sane(name, s.bytes, n, "prefix", n);
            EXPECT(!m || n < 4, "%zu bytes of %zu were read", n, s.size);
            brio_mesh_free(m);
        }
        for (size_t i = 0; i < 8 * s.size; i++) {
            s.bytes[i / 8] ^= (char)(1 << i % 8);
            brio_mesh_free(io_expect_sane(name, s.bytes, s.size, "bit", i));
            s.bytes[i / 8] ^= (char)(1 << i % 8);
        }
    }
}

static const char *current;

static brio_status read_current(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path(current), NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void each_allocation_fails(void) {
    for (int zstd = 0; zstd < 2; zstd++) {
        if (!(zstd ? has_zstd : has_gzip)) continue;
        sample s = {.size = 0};
        pack(&s, zstd, packed_text);
        current = name_of(zstd, "a.xyz.gz", "a.xyz.zst");
        io_put(current, s.bytes, s.size);
        expect_clean_failures(read_current);
    }
}

SUITE(test_io_packed) {
    io_begin();
    has_gzip = reads_packed(false);
    has_zstd = reads_packed(true);
    RUN(crc_of_known_words);
    RUN(one_and_several_members);
    RUN(extension_under_the_packing_decides);
    RUN(places_are_those_of_decompressed_data);
    RUN(damage_has_its_own_words);
    RUN(bomb_meets_the_memory_limit);
    RUN(window_counts_against_the_limit);
    RUN(every_prefix_and_changed_byte);
    RUN(each_allocation_fails);
    return io_end();
}
