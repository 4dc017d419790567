/* A file out of an input's bytes. The first byte chooses a format by its extension, the rest is the file; or it chooses a
 * wrapping with right checksums (pages of E57, an archive of one array, gzip, zstd) for the rest, since a fuzzer guesses no
 * checksums; or names of the columns of a text. */
#ifndef BRIO_TESTS_READ_INPUT_H
#define BRIO_TESTS_READ_INPUT_H

#include "corpus.h"
#include "fuzz.h"
#include "wrapped_input.h"

typedef struct {
    const char *name; /* NULL: none */
    const char *columns;
    const void *bytes;
    size_t size;
} read_input;

/** Valid until the next call. */
static inline read_input fuzz_read_input(fuzz_input *in) {
    static const char *const columns[] = {"x,y,z", "-,x,y,z,nx", "z y x", "x,y,z,x", "x"};
    enum { NAMES = 23, COLUMNS = sizeof columns / sizeof *columns };
    static wrapped w;
    uint8_t first = fuzz_byte(in);
    size_t choice = first % CORPUS_CHOICES;
    const char *name = corpus_name(first);
    if (name || choice < NAMES) return (read_input){name, NULL, in->at, in->left};
    if (choice >= NAMES + WRAPPINGS) return (read_input){"a.csv", columns[choice % COLUMNS], in->at, in->left};
    wrap(&w, (wrapping)(choice - NAMES), in->at, in->left);
    return (read_input){w.name, NULL, w.bytes, w.size};
}

#endif
