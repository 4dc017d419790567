/* What the tests of files share: a folder of their own, files made of bytes, meshes to write, exact comparison. */
#ifndef BRIO_TESTS_IO_FILES_H
#define BRIO_TESTS_IO_FILES_H

#include "harness.h"
#include <dirent.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char io_folder[256];
static brio_context *io_ctx;

static inline void io_begin(void) {
    const char *base = getenv("TMPDIR");
    snprintf(io_folder, sizeof io_folder, "%s/brio-test-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(io_folder) || brio_context_new(NULL, &io_ctx) != BRIO_OK) {
        fprintf(stderr, "no temporary folder\n");
        exit(HARNESS_SKIP);
    }
}

/* Path of a file in the folder; valid until the fourth next call. */
static inline const char *io_path(const char *name) {
    static char paths[4][512];
    static int next;
    char *path = paths[next++ & 3];
    snprintf(path, 512, "%s/%s", io_folder, name);
    return path;
}

/* Number of files in the folder whose names contain a text. */
static inline int io_count_files(const char *part) {
    DIR *dir = opendir(io_folder);
    int count = 0;
    for (struct dirent *e = dir ? readdir(dir) : NULL; e; e = readdir(dir))
        count += e->d_name[0] != '.' && strstr(e->d_name, part) != NULL;
    if (dir) closedir(dir);
    return count;
}

static inline void io_empty_folder(void) {
    DIR *dir = opendir(io_folder);
    for (struct dirent *e = dir ? readdir(dir) : NULL; e; e = readdir(dir))
        if (e->d_name[0] != '.') unlink(io_path(e->d_name));
    if (dir) closedir(dir);
}

static inline int io_end(void) {
    EXPECT(brio_context_memory(io_ctx) == 0, "%zu bytes left", brio_context_memory(io_ctx));
    brio_context_free(io_ctx);
    io_empty_folder();
    rmdir(io_folder);
    return harness_end();
}

/* A new file each time: file systems flush one that is truncated and written again. */
static inline void io_put(const char *name, const void *bytes, size_t size) {
    unlink(io_path(name));
    FILE *f = fopen(io_path(name), "wb");
    if (!f || fwrite(bytes, 1, size, f) != size) EXPECT(0, "cannot write %s", name);
    if (f) fclose(f);
}

/* The bytes of a file, to be freed by the caller. */
static inline char *io_get(const char *name, size_t *size) {
    FILE *f = fopen(io_path(name), "rb");
    char *bytes = malloc(1 << 20);
    *size = f && bytes ? fread(bytes, 1, (1 << 20) - 1, f) : 0;
    if (bytes) bytes[*size] = 0;
    if (f) fclose(f);
    return bytes;
}

/* Reads a file made of bytes; NULL on failure. */
static inline brio_mesh *io_read_bytes(const char *name, const void *bytes, size_t size, brio_status *status) {
    brio_mesh *mesh = NULL;
    io_put(name, bytes, size);
    *status = brio_read(io_ctx, io_path(name), NULL, &mesh);
    EXPECT((*status == BRIO_OK) == (mesh != NULL), "%s: status %d", name, (int)*status);
    return mesh;
}

/* Reads a text that is right. */
static inline brio_mesh *io_read_text(const char *name, const char *text) {
    brio_status status;
    brio_mesh *mesh = io_read_bytes(name, text, strlen(text), &status);
    EXPECT(status == BRIO_OK, "%s: %s: %.60s", name, brio_message(io_ctx), text);
    return mesh;
}

/* Reads a text that is wrong, with a message that holds `part`. */
static inline void io_expect_error(const char *name, const char *text, brio_status expected, const char *part) {
    brio_status status;
    brio_mesh *mesh = io_read_bytes(name, text, strlen(text), &status);
    EXPECT(status == expected, "%s: status %d: %.60s", name, (int)status, text);
    EXPECT(strstr(brio_message(io_ctx), part), "%s: \"%s\" without \"%s\"", name, brio_message(io_ctx), part);
    brio_mesh_free(mesh);
}

/* Reads bytes that may be damaged: the status is one of bad input, or all indices are in range. NULL on failure. */
static inline brio_mesh *io_expect_sane(const char *name, const char *bytes, size_t size, const char *how, size_t at) {
    brio_mesh *mesh = NULL;
    io_put(name, bytes, size);
    brio_status status = brio_read(io_ctx, io_path(name), NULL, &mesh);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT || status == BRIO_ERR_NOT_FINITE ||
               status == BRIO_ERR_TOO_LARGE,
           "%s %s %zu: status %d: %s", name, how, at, (int)status, brio_message(io_ctx));
    EXPECT((status == BRIO_OK) == (mesh != NULL) && (mesh || brio_message(io_ctx)[0]), "%s %s %zu", name, how, at);
    if (mesh && mesh->num_faces) {
        uint64_t corners = mesh->face_offsets[mesh->num_faces];
        for (uint64_t i = 0; i < corners; i++) EXPECT(mesh->face_vertices[i] < mesh->num_vertices, "%s %zu", how, at);
    }
    for (size_t i = 0; mesh && i < 2 * mesh->num_edges; i++)
        EXPECT(mesh->edges[i] < mesh->num_vertices, "%s %zu", how, at);
    for (size_t i = 0; mesh && i < 4 * mesh->num_tetrahedra; i++)
        EXPECT(mesh->tetrahedra[i] < mesh->num_vertices, "%s %zu", how, at);
    if (!mesh)
        EXPECT(brio_context_memory(io_ctx) == 0, "%s %s %zu: %zu bytes left", name, how, at,
               brio_context_memory(io_ctx));
    return mesh;
}

/* --- meshes --- */

enum { IO_FACES = 1, IO_TETRAHEDRA = 2, IO_PROPERTIES = 4, IO_BIG_FACE = 8, IO_SINGLE = 16 };

static inline uint64_t io_random(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state >> 11;
}

/* Any finite double, with all exponents. */
static inline double io_random_double(uint64_t *state) {
    for (;;) {
        uint64_t bits = io_random(state) << 32 ^ io_random(state);
        double x;
        memcpy(&x, &bits, sizeof x);
        if (isfinite(x)) return x;
    }
}

static inline void io_fill_property(brio_mesh *m, const char *name, brio_scalar type, uint64_t *state) {
    void *data = NULL;
    EXPECT(brio_mesh_add_property(m, name, type, &data) == BRIO_OK);
    for (size_t i = 0; data && i < m->num_vertices * brio_scalar_size(type); i++)
        ((uint8_t *)data)[i] = (uint8_t)(io_random(state) >> 7);
    for (size_t i = 0; data && i < m->num_vertices; i++) {
        /* signalling NaNs are the one thing that a conversion may change */
        if (type == BRIO_SCALAR_FLOAT32 && !isfinite(((float *)data)[i])) ((float *)data)[i] = -0.1f;
        if (type == BRIO_SCALAR_FLOAT64 && !isfinite(((double *)data)[i])) ((double *)data)[i] = -0.0;
    }
}

static inline void io_add_faces(brio_mesh *m, bool big) {
    size_t count = 5, n = m->num_vertices, corners = 0;
    uint64_t offsets[6] = {0};
    uint32_t *indices = malloc(2000 * sizeof *indices);
    for (size_t f = 0; f < count; f++) {
        size_t sides = big && f == 3 ? 300 : 3 + f;
        for (size_t i = 0; i < sides; i++) indices[corners++] = (uint32_t)((7 * f + 3 * i) % n);
        offsets[f + 1] = corners;
    }
    EXPECT(brio_mesh_set_faces(m, offsets, indices, count) == BRIO_OK);
    free(indices);
}

static inline brio_mesh *io_make(size_t n, int parts) {
    brio_mesh *m = NULL;
    uint64_t state = n + (uint64_t)parts;
    EXPECT(brio_mesh_new(io_ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, NULL, n) == BRIO_OK);
    for (size_t i = 0; i < 3 * n; i++) {
        double x = i % 4 == 0 ? (double)(int64_t)(io_random(&state) % 20001) / 1000 - 10 : io_random_double(&state);
        m->vertices[i] = parts & IO_SINGLE ? (double)(float)fmod(x, 1e30) : x;
    }
    if (parts & IO_PROPERTIES)
        for (brio_scalar type = BRIO_SCALAR_INT8; type < BRIO_SCALAR_END; type++) {
            char name[16];
            snprintf(name, sizeof name, "p%d", (int)type);
            io_fill_property(m, name, type, &state);
        }
    if (parts & (IO_FACES | IO_BIG_FACE)) io_add_faces(m, parts & IO_BIG_FACE);
    if (parts & IO_TETRAHEDRA) {
        const uint32_t tetrahedra[] = {0, 1, 2, 3, 3, 2, 1, 4, 4, 0, 1, 2};
        EXPECT(brio_mesh_set_tetrahedra(m, tetrahedra, 4, 3) == BRIO_OK);
    }
    return m;
}

static inline bool io_same_bytes(const void *a, const void *b, size_t size) {
    return size == 0 || !memcmp(a, b, size);
}

static inline bool io_same_faces(const brio_mesh *a, const brio_mesh *b) {
    if (a->num_faces != b->num_faces) return false;
    if (!a->num_faces) return !b->face_offsets;
    return io_same_bytes(a->face_offsets, b->face_offsets, (a->num_faces + 1) * sizeof *a->face_offsets) &&
           io_same_bytes(a->face_vertices, b->face_vertices, a->face_offsets[a->num_faces] * sizeof *a->face_vertices);
}

static inline bool io_same_points(const brio_mesh *a, const brio_mesh *b) {
    return a->num_vertices == b->num_vertices &&
           io_same_bytes(a->vertices, b->vertices, 3 * a->num_vertices * sizeof *a->vertices);
}

static inline bool io_same_tetrahedra(const brio_mesh *a, const brio_mesh *b) {
    return a->num_tetrahedra == b->num_tetrahedra &&
           io_same_bytes(a->tetrahedra, b->tetrahedra, 4 * a->num_tetrahedra * sizeof *a->tetrahedra);
}

#endif
