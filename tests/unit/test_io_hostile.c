/* Damaged files and failing memory: every prefix of a file, every byte changed, every allocation refused, is a status
 * and leaves nothing behind. */
#include "failing_allocator.h"
#include "io_files.h"

typedef struct {
    const char *name;
    int parts;
    int ascii, compress;
} file_case;

static const file_case files[] = {{"b.ply", IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES, 0, 0},
                                  {"a.ply", IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES, 1, 0},
                                  {"a.xyz", IO_PROPERTIES, 0, 0},
                                  {"a.csv", IO_PROPERTIES, 0, 0},
                                  {"a.obj", IO_FACES, 0, 0},
                                  {"a.off", IO_FACES, 0, 0},
                                  {"a.vtu", IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES, 0, 0},
                                  {"t.vtu", IO_FACES | IO_TETRAHEDRA, 1, 0},
                                  {"z.vtu", IO_FACES | IO_TETRAHEDRA, 0, 1},
                                  {"a.vtp", IO_FACES, 0, 0},
                                  {"a.glb", IO_FACES | IO_PROPERTIES | IO_SINGLE, 0, 0},
                                  {"a.node", IO_TETRAHEDRA | IO_PROPERTIES, 0, 0},
                                  {"a.las", IO_PROPERTIES, 0, 0},
                                  {"b.stl", IO_FACES | IO_SINGLE, 0, 0},
                                  {"a.stl", IO_FACES | IO_SINGLE, 1, 0},
                                  {"a.npy", IO_PROPERTIES, 0, 0}};
enum { NUM_FILES = sizeof files / sizeof *files };

static bool lacking[NUM_FILES]; /* what this build cannot read or write, because it lacks a library */

static brio_write_options options_of(const file_case *file) {
    brio_write_options options = {0};
    options.ascii = file->ascii;
    options.compress = file->compress;
    options.comment = "c";
    return options;
}

/* The bytes of a small file of each kind, to be freed. */
static char *make_file(const file_case *file, size_t *size) {
    brio_mesh *mesh = io_make(7, file->parts);
    brio_write_options options = options_of(file);
    EXPECT(brio_write(io_ctx, io_path(file->name), mesh, &options) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
    return io_get(file->name, size);
}

static void expect_sane(const char *name, const char *bytes, size_t size, const char *how, size_t at) {
    brio_mesh_free(io_expect_sane(name, bytes, size, how, at));
    EXPECT(brio_context_memory(io_ctx) == 0, "%s %s %zu: %zu bytes left", name, how, at, brio_context_memory(io_ctx));
}

static void every_prefix(void) {
    for (size_t k = 0; k < NUM_FILES; k++) {
        size_t size;
        if (lacking[k]) continue;
        char *bytes = make_file(&files[k], &size);
        for (size_t n = 0; n < size; n++) expect_sane(files[k].name, bytes, n, "prefix", n);
        free(bytes);
    }
}

static void random_bytes_changed(void) {
    uint64_t state = 5;
    for (size_t k = 0; k < NUM_FILES; k++) {
        size_t size;
        if (lacking[k]) continue;
        char *bytes = make_file(&files[k], &size), *changed = malloc(size + 1);
        for (size_t i = 0; bytes && changed && i < 500; i++) {
            memcpy(changed, bytes, size);
            for (uint64_t n = 1 + io_random(&state) % 3; n > 0; n--)
                changed[io_random(&state) % size] ^= (char)(1 << io_random(&state) % 8);
            expect_sane(files[k].name, changed, size, "change", i);
        }
        free(bytes);
        free(changed);
    }
}

/* Words that a format knows, in the wrong places. */
static void random_words_inserted(void) {
    static const char *const words[] = {"-1",   "nan",  "1e999",    "4294967296", "99999999999999999999",
                                        "\n",   "\r",   " ",        ",",          "#",
                                        "\\\n", "list", "property", "element",    "vertex",
                                        "<",    ">",    "\"",       "0x",         "f ",
                                        "v "};
    uint64_t state = 6;
    for (size_t k = 0; k < NUM_FILES; k++) {
        size_t size;
        if (lacking[k]) continue;
        char *bytes = make_file(&files[k], &size), *changed = malloc(size + 32);
        for (size_t i = 0; bytes && changed && i < 250; i++) {
            const char *word = words[io_random(&state) % (sizeof words / sizeof *words)];
            size_t at = io_random(&state) % size, length = strlen(word);
            memcpy(changed, bytes, at);
            memcpy(changed + at, word, length);
            memcpy(changed + at + length, bytes + at, size - at);
            expect_sane(files[k].name, changed, size + length, word, at);
        }
        free(bytes);
        free(changed);
    }
}

/* --- memory --- */

static const file_case *current;
static const brio_mesh *to_write;

static brio_status read_current(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path(current->name), NULL, &mesh);
    EXPECT((status == BRIO_OK) == (mesh != NULL), "%s", current->name);
    brio_mesh_free(mesh);
    return status;
}

static brio_status write_current(brio_context *ctx) {
    brio_write_options options = options_of(current);
    brio_status status = brio_write(ctx, io_path(current->name), to_write, &options);
    EXPECT(status == BRIO_OK || io_count_files("") == 0, "%s: a file is left", current->name);
    return status;
}

static void each_allocation_of_a_read_fails(void) {
    for (current = files; current < files + NUM_FILES; current++) {
        size_t size;
        if (lacking[current - files]) continue;
        free(make_file(current, &size));
        expect_clean_failures(read_current);
    }
}

static void each_allocation_of_a_write_fails(void) {
    for (current = files; current < files + NUM_FILES; current++) {
        if (lacking[current - files]) continue;
        brio_mesh *mesh = io_make(7, current->parts);
        io_empty_folder();
        to_write = mesh;
        expect_clean_failures(write_current);
        brio_mesh_free(mesh);
    }
}

static void find_lacking(void) {
    for (size_t k = 0; k < NUM_FILES; k++) {
        brio_mesh *mesh = io_make(7, files[k].parts), *back = NULL;
        brio_write_options options = options_of(&files[k]);
        brio_status status = brio_write(io_ctx, io_path(files[k].name), mesh, &options);
        if (status == BRIO_OK) status = brio_read(io_ctx, io_path(files[k].name), NULL, &back);
        lacking[k] = status != BRIO_OK && strstr(brio_message(io_ctx), "was built without");
        if (lacking[k]) printf("skipped: %s\n", brio_message(io_ctx));
        brio_mesh_free(mesh);
        brio_mesh_free(back);
    }
}

SUITE(test_io_hostile) {
    io_begin();
    find_lacking();
    RUN(every_prefix);
    RUN(random_bytes_changed);
    RUN(random_words_inserted);
    RUN(each_allocation_of_a_read_fails);
    RUN(each_allocation_of_a_write_fails);
    return io_end();
}
