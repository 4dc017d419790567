/* Reading from memory: every format gives what the file gives, also those that are read from their end first and those that
 * are compressed; names choose formats; no other file is opened. */
#include "e57_image.h"
#include "laz_samples.h"
#include "io/stream.h"
#include "packed_samples.h"

static brio_mesh *read_bytes(const void *bytes, size_t size, const char *name, brio_status *status) {
    brio_mesh *m = NULL;
    *status = brio_read_memory(io_ctx, bytes, size, name, NULL, &m);
    EXPECT((*status == BRIO_OK) == (m != NULL), "%s: status %d", name, (int)*status);
    return m;
}

static bool same_properties(const brio_mesh *a, const brio_mesh *b) {
    if (a->num_properties != b->num_properties) return false;
    for (size_t i = 0; i < a->num_properties; i++) {
        const brio_property *p = &a->properties[i], *q = &b->properties[i];
        if (strcmp(p->name, q->name) != 0 || p->type != q->type) return false;
        if (!io_same_bytes(p->data, q->data, a->num_vertices * brio_scalar_size(p->type))) return false;
    }
    return true;
}

/* Reads a file of the folder both ways. */
static void expect_same_as_file(const char *name) {
    size_t size;
    char *bytes = io_get(name, &size);
    brio_mesh *file = NULL;
    brio_status status = brio_read(io_ctx, io_path(name), NULL, &file), from_memory;
    char *copy = malloc(size + 1); /* of its size alone, so that a read behind the end is seen */
    memcpy(copy, bytes, size);
    brio_mesh *memory = read_bytes(copy, size, name, &from_memory);
    EXPECT(status == from_memory, "%s: %d, %d: %s", name, (int)status, (int)from_memory, brio_message(io_ctx));
    EXPECT(!memcmp(copy, bytes, size), "%s: the bytes changed", name);
    if (file && memory)
        EXPECT(io_same_points(file, memory) && io_same_faces(file, memory) && io_same_tetrahedra(file, memory) &&
                   same_properties(file, memory),
               "%s", name);
    brio_mesh_free(file);
    brio_mesh_free(memory);
    free(copy);
    free(bytes);
}

static void written_formats_read_the_same(void) {
    static const struct {
        const char *name;
        int parts;
    } files[] = {{"a.ply", IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES},
                 {"a.xyz", IO_PROPERTIES},
                 {"a.csv", IO_PROPERTIES},
                 {"a.obj", IO_FACES},
                 {"a.off", IO_FACES},
                 {"a.vtu", IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES},
                 {"a.vtp", IO_FACES | IO_PROPERTIES},
                 {"a.node", 0},
                 {"a.las", IO_SINGLE},
                 {"a.stl", IO_FACES | IO_SINGLE},
                 {"a.npy", IO_PROPERTIES},
                 {"a.glb", IO_FACES | IO_SINGLE}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        brio_mesh *m = io_make(400, files[i].parts);
        brio_status status = brio_write(io_ctx, io_path(files[i].name), m, NULL);
        EXPECT(status == BRIO_OK || !strcmp(files[i].name, "a.las"), "%s", brio_message(io_ctx));
        if (status == BRIO_OK) expect_same_as_file(files[i].name);
        brio_mesh_free(m);
    }
}

static void put_sample(const char *name, const void *bytes, size_t size) {
    io_put(name, bytes, size);
    expect_same_as_file(name);
}

/* Directories of archives are at their end; E57 has its XML there, LAZ its table of chunks. */
static void formats_that_seek_read_the_same(void) {
    static zip_sample z;
    const uint64_t number = 0x3ff0000000000000;
    const e57_test_field fields[] = {{"cartesianX", "type=\"Float\"", 64, &number},
                                     {"cartesianY", "type=\"Float\"", 64, &number},
                                     {"cartesianZ", "type=\"Float\"", 64, &number}};
    e57_write_scan("a.e57", fields, 3, 1, "");
    expect_same_as_file("a.e57");
    for (int wide = 0; wide < 2; wide++) {
        packed_npz(&z, wide);
        put_sample("a.npz", z.file.bytes, z.file.size);
    }
    put_sample("a.laz", laz_format_3, sizeof laz_format_3);
    put_sample("b.laz", laz_format_8, sizeof laz_format_8);
    put_sample("a.las", las_format_8, sizeof las_format_8);
}

/* Before, in and behind what the stream's buffer holds. */
static void any_place_can_be_looked_at(void) {
    enum { SIZE = 3 << 20, WORDS = SIZE / 4 };
    uint32_t *words = malloc(SIZE), found[2];
    brio_stream s;
    for (uint32_t i = 0; i < WORDS; i++) words[i] = i;
    EXPECT(brio_stream_open_memory(&s, io_ctx, "m", words, SIZE) == BRIO_OK);
    for (uint64_t skipped = 0; skipped <= SIZE; skipped += SIZE / 4) {
        for (uint32_t i = 0; i < WORDS - 1; i += 9973)
            EXPECT(brio_stream_peek(&s, 4 * (uint64_t)i, found, 8) == BRIO_OK && found[0] == i && found[1] == i + 1);
        EXPECT(brio_stream_peek(&s, SIZE - 4, found, 8) == BRIO_ERR_FORMAT);
        EXPECT(brio_stream_peek(&s, SIZE + UINT64_C(4), found, 1) == BRIO_ERR_FORMAT);
        EXPECT(brio_stream_peek(&s, UINT64_MAX, found, 8) == BRIO_ERR_FORMAT);
        EXPECT(!strcmp(brio_message(io_ctx), "m: ends at byte 3145728"), "%s", brio_message(io_ctx));
        if (skipped < SIZE) EXPECT(brio_stream_skip(&s, SIZE / 4) == BRIO_OK);
    }
    brio_stream_close(&s);
    free(words);
}

static void compressed_bytes_are_decompressed(void) {
    sample s = {.size = 0};
    sample_gzip(&s, packed_text, strlen(packed_text));
    put_sample("a.xyz.gz", s.bytes, s.size);
    s.size = 0;
    sample_zstd(&s, packed_text, strlen(packed_text));
    put_sample("a.xyz.zst", s.bytes, s.size);
}

/* Over the block of a stream, with lines across its ends. */
static void long_texts_read_the_same(void) {
    enum { ROWS = 150000 };
    size_t size = 0;
    char *text = malloc(ROWS * 24);
    for (int i = 0; i < ROWS; i++) size += (size_t)sprintf(text + size, "%d %d %d\n", i, i % 7, -i);
    brio_status status;
    brio_mesh *m = read_bytes(text, size, "long.xyz", &status);
    EXPECT(m && m->num_vertices == ROWS && m->vertices[3 * ROWS - 1] == 1 - ROWS, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
    free(text);
}

static void the_name_chooses_the_format(void) {
    static const char obj[] = "v 1 2 3\nv 4 5 6\nv 7 8 9\nf 1 2 3\n", rows[] = "1 2 3\n4 5 6\n";
    brio_read_options o = {0};
    brio_status status;
    brio_mesh *m = read_bytes(obj, strlen(obj), "A.Obj", &status);
    EXPECT(m && m->num_faces == 1);
    brio_mesh_free(m);
    o.format = BRIO_FORMAT_OBJ;
    EXPECT(brio_read_memory(io_ctx, obj, strlen(obj), NULL, &o, &m) == BRIO_OK && m->num_faces == 1);
    brio_mesh_free(m);
    m = read_bytes(rows, strlen(rows), NULL, &status);
    EXPECT(m && m->num_vertices == 2, "rows of numbers have no need of a name");
    brio_mesh_free(m);
    EXPECT(!read_bytes(rows, strlen(rows), "a.what", &status) && status == BRIO_ERR_FORMAT);
    EXPECT(strstr(brio_message(io_ctx), "a.what: unknown format"), "%s", brio_message(io_ctx));
    EXPECT(!read_bytes("1 2\n", 4, NULL, &status) && strstr(brio_message(io_ctx), "memory: "), "%s",
           brio_message(io_ctx));
    EXPECT(!read_bytes(NULL, 0, "a.ply", &status) && status == BRIO_ERR_FORMAT, "%s", brio_message(io_ctx));
}

static void no_file_beside_is_opened(void) {
    static const char node[] = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", ele[] = "1 4 0\n1 1 2 3 4\n";
    brio_status status;
    io_put("n.node", node, strlen(node));
    io_put("n.ele", ele, strlen(ele));
    brio_mesh *m = read_bytes(node, strlen(node), io_path("n.node"), &status);
    EXPECT(m && m->num_vertices == 4 && m->num_tetrahedra == 0, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
    EXPECT(!read_bytes(ele, strlen(ele), io_path("n.ele"), &status) && status == BRIO_ERR_ARGUMENT, "%s",
           brio_message(io_ctx));
}

SUITE(test_io_memory) {
    io_begin();
    RUN(written_formats_read_the_same);
    RUN(formats_that_seek_read_the_same);
    RUN(any_place_can_be_looked_at);
    RUN(compressed_bytes_are_decompressed);
    RUN(long_texts_read_the_same);
    RUN(the_name_chooses_the_format);
    RUN(no_file_beside_is_opened);
    return io_end();
}
