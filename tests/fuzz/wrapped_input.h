/* Bytes inside a file with checksums that are right: pages of E57, an archive of NumPy with one array, gzip and zstd. */
#ifndef BRIO_TESTS_WRAPPED_INPUT_H
#define BRIO_TESTS_WRAPPED_INPUT_H

#include "e57_image.h"
#include "packed_samples.h"

typedef enum { WRAP_E57, WRAP_NPZ, WRAP_GZIP, WRAP_ZSTD, WRAPPINGS } wrapping;

enum { MOST_WRAPPED = 1 << 14 };

typedef struct {
    char bytes[1 << 16];
    size_t size;
    const char *name;
} wrapped;

static inline void wrap(wrapped *w, wrapping how, const void *bytes, size_t size) {
    static const char *const names[] = {"a.e57", "a.npz", "a.xyz.gz", "a.xyz.zst"};
    static zip_sample z;
    static sample s;
    if (size > MOST_WRAPPED) size = MOST_WRAPPED;
    w->name = names[how];
    s.size = 0;
    if (how == WRAP_E57) {
        e57_image f = {(uint8_t *)(uintptr_t)bytes, size, 0};
        uint8_t *pages = e57_pages(&f, &w->size);
        memcpy(w->bytes, pages, w->size);
        free(pages);
        return;
    }
    if (how == WRAP_NPZ) {
        zip_begin(&z, false);
        zip_add(&z, "points.npy", bytes, size, size % 2);
        zip_end(&z);
        s = z.file;
    } else if (how == WRAP_GZIP) {
        sample_gzip(&s, bytes, size);
    } else {
        sample_zstd(&s, bytes, size);
    }
    memcpy(w->bytes, s.bytes, s.size);
    w->size = s.size;
}

#endif
