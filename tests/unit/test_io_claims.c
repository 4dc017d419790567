/* Files that claim more than they hold, of every format: refused, or read, without memory for what is not there.
 *
 * The samples are those of corpus.h. Each number of a text, and each four and eight bytes of a file, become numbers that are large, or wrap when they are multiplied. */
#include "corpus.h"
#include <ctype.h>

/* MOST: bytes that a reader may have at once, besides 64 times the file: its buffers; a window of E57 has 4 MiB. */
/* SPARSE: a number goes into one of SPARSE places. */
enum { LARGEST = 1 << 13, DIGITS = 20, MOST = 24 << 20, SPARSE = BRIEF_TESTS ? 3 : 1 };

static const uint64_t NUMBERS[] = {0xffffffff,          0xfffffffe,         0x7fffffff,         0x10000001, 0x02000000,
                                   0xffffffffffffffffU, 0x8000000000000001, 0x2000000000000001, 0x100000001};

static size_t read_files, refused_files;
static brio_context *ctx;
static bool all; /* as test_io_claims all */

static void expect_little_memory(const char *sample, const char *name, const char *bytes, size_t size, size_t at) {
    brio_mesh *mesh = NULL;
    brio_context_set_memory_limit(ctx, MOST + 64 * size);
    brio_status status = brio_read_memory(ctx, bytes, size, name, NULL, &mesh);
    EXPECT(status != BRIO_ERR_NO_MEMORY, "%s with a large number at byte %zu of %zu: %s", sample, at, size,
           brio_message(ctx));
    read_files += status == BRIO_OK;
    refused_files += status != BRIO_OK;
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
}

/* Whether to try a number at a place: one of them each, or at some places, unless all are wanted. */
static bool is_tried(size_t at, size_t n) {
    return all || (at + n) % (sizeof NUMBERS / sizeof *NUMBERS * SPARSE) == 0;
}

/* Bytes of four or eight, little and big endian. */
static void claim_in_bytes(const char *sample, const char *name, const char *bytes, size_t size) {
    static char lie[LARGEST];
    for (size_t at = 0; at + 4 <= size; at++) {
        for (size_t n = 0; n < sizeof NUMBERS / sizeof *NUMBERS; n++) {
            size_t width = NUMBERS[n] >> 32 ? 8 : 4;
            bool big = at % 2 && NUMBERS[n] == 0x7fffffff;
            if (at + width > size || !is_tried(at, n)) continue;
            memcpy(lie, bytes, size);
            for (size_t i = 0; i < width; i++) lie[at + i] = (char)(NUMBERS[n] >> 8 * (big ? width - 1 - i : i));
            expect_little_memory(sample, name, lie, size, at);
        }
    }
}

/* A number of a text. */
static void claim_in_text(const char *sample, const char *name, const char *bytes, size_t size) {
    static char lie[LARGEST + DIGITS + 1];
    for (size_t at = 0; at < size; at++) {
        size_t end = at;
        while (end < size && isdigit((unsigned char)bytes[end])) end++;
        if (end == at || (at && isdigit((unsigned char)bytes[at - 1]))) continue;
        for (size_t n = 0; n < sizeof NUMBERS / sizeof *NUMBERS; n++) {
            memcpy(lie, bytes, at);
            int digits = snprintf(lie + at, DIGITS + 1, "%llu", (unsigned long long)NUMBERS[n]);
            memcpy(lie + at + digits, bytes + end, size - end);
            expect_little_memory(sample, name, lie, at + (size_t)digits + size - end, at);
        }
    }
}

static void claim_in(const char *file, const char *name, const char *bytes, size_t size) {
    if (size > LARGEST) size = LARGEST;
    claim_in_bytes(file, name, bytes, size);
    claim_in_text(file, name, bytes, size);
}

static void claims_beyond_the_file_take_no_memory(void) {
    size_t samples = corpus_each(BRIO_CORPUS, claim_in);
    fprintf(stderr, "%zu samples: %zu files read, %zu refused\n", samples, read_files, refused_files);
    EXPECT(samples > 20 && read_files && refused_files);
}

SUITE(test_io_claims) {
    all = argc > 1 && !strcmp(argv[1], "all");
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 2;
    brio_context_set_threads(ctx, 1);
    RUN(claims_beyond_the_file_take_no_memory);
    brio_context_free(ctx);
    return harness_end();
}
