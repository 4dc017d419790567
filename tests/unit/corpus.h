/* Files of all formats, for tests that damage them: those of tests/fuzz/corpus/read, the corpus of fuzz_read.c and, of each
 * format that has none there, one that the library writes.
 *
 * The first byte of a file of the corpus chooses the name under which the rest is read. */
#ifndef BRIO_TESTS_CORPUS_H
#define BRIO_TESTS_CORPUS_H

#include "harness.h"
#include <dirent.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

enum { CORPUS_CHOICES = 32, CORPUS_FORMATS = 128, CORPUS_LONGEST = 1 << 16 };

/* The places of names are what files of the corpus begin with: tests/faults/cases.py reads this list, too. Places without a
 * name are wrappings (read_input.h). */
static const char *const corpus_names[CORPUS_CHOICES] = {
    "a.ply", "a.xyz", "a.csv", "a.obj", "a.off", "a.vtu",  "a.vtp", "a.node", "a.las", "a.laz",   "a.pcd",   "a.ptx",
    "a.stl", "a.npy", "a.npz", "a.glb", "a.txt", "a.gltf", "a.e57", "a.pts",  NULL,    "a.bnpts", "a.extxyz"};

/* Returns the name for a first byte, valid until the next call: of the list, or, from CORPUS_FORMATS on, of the format of
 * that number; NULL for a wrapping. */
static inline const char *corpus_name(unsigned char first) {
    static char name[32];
    const brio_format_info *info =
        first > CORPUS_FORMATS ? brio_format_facts((brio_format)(first - CORPUS_FORMATS)) : NULL;
    if (!info) return corpus_names[first % CORPUS_CHOICES];
    snprintf(name, sizeof name, "a.%.*s", (int)strcspn(info->extensions, " "), info->extensions);
    return name;
}

/* A test of a file: where it is from, its name, its bytes. */
typedef void (*corpus_test)(const char *file, const char *name, const char *bytes, size_t size);

/* Writes a small file of a format and reads its bytes. Returns their number, 0 when that fails. */
static inline size_t corpus_write(const brio_format_info *info, const char *name, char *bytes) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.5, 2};
    static const uint64_t ends[] = {0, 3};
    static const uint32_t corners[] = {0, 1, 2};
    const char *base = getenv("TMPDIR");
    char path[512];
    brio_context *ctx = NULL;
    brio_mesh *m = NULL;
    void *data = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/brio-corpus-%d-%s", base ? base : "/tmp", (int)getpid(), name);
    bool made = brio_context_new(NULL, &ctx) == BRIO_OK && brio_mesh_new(ctx, &m) == BRIO_OK &&
                brio_mesh_set_vertices(m, points, 4) == BRIO_OK &&
                brio_mesh_set_faces(m, ends, corners, 1) == BRIO_OK &&
                brio_mesh_add_property(m, "heat", BRIO_SCALAR_FLOAT32, &data) == BRIO_OK;
    if (made) memcpy(data, (const float[]){1, 2, 3, 0.5f}, 4 * sizeof(float));
    made = made && brio_write(ctx, path, m, &(brio_write_options){.format = info->format}) == BRIO_OK;
    EXPECT(made, "%s: %s", name, brio_message(ctx));
    FILE *f = made ? fopen(path, "rb") : NULL;
    if (f) size = fread(bytes, 1, CORPUS_LONGEST, f);
    if (f) fclose(f);
    unlink(path);
    brio_mesh_free(m);
    brio_context_free(ctx);
    return size;
}

/* Calls a test for each file of the folder of the corpus, then for files of the formats that have none there. Returns the
 * number of files. */
static inline size_t corpus_each(const char *corpus, corpus_test test) {
    static char bytes[CORPUS_LONGEST];
    bool seen[BRIO_FORMAT_MOST + 1] = {false};
    DIR *folder = opendir(corpus);
    size_t taken = 0;
    EXPECT(folder != NULL, "%s", corpus);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", corpus, entry->d_name);
        FILE *f = entry->d_name[0] == '.' ? NULL : fopen(path, "rb");
        size_t size = f ? fread(bytes, 1, sizeof bytes, f) : 0;
        const char *name = size ? corpus_name((unsigned char)bytes[0]) : NULL;
        if (f) fclose(f);
        if (!name) continue;
        seen[brio_format_of(name)] = true;
        test(entry->d_name, name, bytes + 1, size - 1), taken++;
    }
    if (folder) closedir(folder);
    for (int number = 1; number <= BRIO_FORMAT_MOST; number++) {
        const brio_format_info *info = seen[number] ? NULL : brio_format_facts((brio_format)number);
        const char *name = info ? corpus_name((unsigned char)(CORPUS_FORMATS + number % 128)) : NULL;
        if (!info) continue;
        EXPECT(info->written[0], "%s is read only: put one into tests/fuzz/corpus/read, behind the byte %d", info->name,
               CORPUS_FORMATS + number);
        size_t size = info->written[0] ? corpus_write(info, name, bytes) : 0;
        if (size) test("(written)", name, bytes, size), taken++;
    }
    return taken;
}

#endif
