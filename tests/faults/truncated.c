/* fault_truncated FOLDER: every file of the folder, a corpus of fuzz_read.c, cut at every length.
 *
 * The first byte of a file chooses its format. Each beginning is read or refused with a message; no memory stays, and no reader
 * asks for much more than the file has. Prints the numbers. */
#define _GNU_SOURCE
#include "fault.h"
#include "harness.h"
#include <dirent.h>
#include <string.h>

static const char *const names[] = {"a.ply", "a.xyz",  "a.csv", "a.obj", "a.off", "a.vtu",   "a.vtp",   "a.node",
                                    "a.las", "a.laz",  "a.pcd", "a.ptx", "a.stl", "a.npy",   "a.npz",   "a.glb",
                                    "a.txt", "a.gltf", "a.e57", "a.pts", NULL,    "a.bnpts", "a.extxyz"};

enum { NAMES = sizeof names / sizeof *names, LONGEST = 1 << 16, MUCH = 64 << 20 };

static size_t files, lengths, refused;

static void read_beginning(const char *name, const char *bytes, size_t size, const char *file) {
    int64_t live = fault->live;
    brio_context *ctx = NULL;
    brio_mesh *m = NULL;
    EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK);
    brio_status status = brio_read_memory(ctx, bytes, size, name, NULL, &m);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT || status == BRIO_ERR_NOT_FINITE, "%s, %zu bytes: %s", file,
           size, brio_message(ctx));
    EXPECT((status == BRIO_OK) == (m != NULL) && (m || strstr(brio_message(ctx), name)), "%s, %zu bytes: %s", file,
           size, brio_message(ctx));
    EXPECT(brio_context_memory_peak(ctx) < MUCH, "%s, %zu bytes: %zu", file, size, brio_context_memory_peak(ctx));
    brio_mesh_free(m);
    brio_context_free(ctx);
    EXPECT(fault->live == live, "%s, %zu bytes: memory stays", file, size);
    lengths++, refused += status != BRIO_OK;
}

static void read_all_beginnings(const char *folder, const char *file) {
    static char bytes[LONGEST];
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    FILE *f = fopen(path, "rb");
    size_t size = f ? fread(bytes, 1, sizeof bytes, f) : 0;
    if (f) fclose(f);
    size_t choice = size ? (unsigned char)bytes[0] % 32 : NAMES;
    if (choice >= NAMES || !names[choice]) return;
    files++;
    for (size_t n = 0; n < size; n++) {
        char *exact = malloc(n ? n : 1); /* so that a tool sees what reads beyond */
        memcpy(exact, bytes + 1, n);
        read_beginning(names[choice], exact, n, file);
        free(exact);
    }
}

int main(int argc, char **argv) {
    DIR *dir = argc == 2 ? opendir(argv[1]) : NULL;
    if (!dir) return 2;
    for (struct dirent *e = readdir(dir); e; e = readdir(dir))
        if (e->d_name[0] != '.') read_all_beginnings(argv[1], e->d_name);
    closedir(dir);
    printf("%zu files, %zu lengths, %zu refused\n", files, lengths, refused);
    return harness_end();
}
