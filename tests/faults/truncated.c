/* fault_truncated FOLDER: every file of the folder, the corpus of fuzz_read.c, and of formats that have none there
 * (corpus.h), cut at every length.
 *
 * Each beginning is read or refused with a message; no memory stays, and no reader
 * asks for much more than the file has. Prints the numbers. */
#define _GNU_SOURCE
#include "corpus.h"
#include "fault.h"

enum { MUCH = 64 << 20 };

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

static void read_all_beginnings(const char *file, const char *name, const char *bytes, size_t size) {
    files++;
    for (size_t n = 0; n <= size; n++) {
        char *exact = malloc(n ? n : 1); /* so that a tool sees what reads beyond */
        memcpy(exact, bytes, n);
        read_beginning(name, exact, n, file);
        free(exact);
    }
}

int main(int argc, char **argv) {
    if (argc != 2) return 2;
    corpus_each(argv[1], read_all_beginnings);
    printf("%zu files, %zu lengths, %zu refused\n", files, lengths, refused);
    return harness_end();
}
