/* What the fuzzers share: numbers out of an input's bytes, what must hold, and a context that holds nothing between
 * inputs. An input that is used up gives zeros, so that every input has a meaning. */
#ifndef BRIO_TESTS_FUZZ_H
#define BRIO_TESTS_FUZZ_H

#include "brio/brio.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/** Stops with a message: the fuzzer then keeps the input. */
#define FUZZ_EXPECT(condition, ...)                                                                                    \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition);                                            \
            fprintf(stderr, " " __VA_ARGS__);                                                                          \
            fputc('\n', stderr);                                                                                       \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

typedef struct {
    const uint8_t *at;
    size_t left;
} fuzz_input;

static inline uint8_t fuzz_byte(fuzz_input *in) {
    if (!in->left) return 0;
    in->left--;
    return *in->at++;
}

/** A number below n, from one byte or two. */
static inline size_t fuzz_below(fuzz_input *in, size_t n) {
    size_t x = fuzz_byte(in);
    if (n > 256) x = x << 8 | fuzz_byte(in);
    return n ? x % n : 0;
}

static inline bool fuzz_flag(fuzz_input *in) {
    return fuzz_byte(in) & 1;
}

static inline uint64_t fuzz_word(fuzz_input *in) {
    uint64_t x = 0;
    for (int i = 0; i < 8; i++) x = x << 8 | fuzz_byte(in);
    return x;
}

/** Any finite double: often a small integer, or one of those that predicates and boxes stumble over. */
static inline double fuzz_double(fuzz_input *in) {
    static const double hostile[] = {0.0,    -0.0,   1e-150, -1e150, 1e150, 5e-324,      2.2250738585072014e-308,
                                     1e-300, 1e-162, 1e77,   1e100,  0.1,   1 + 0x1p-52, 1e17,
                                     -1e-9,  1.0 / 3};
    uint8_t kind = fuzz_byte(in);
    if (kind < 160) return (double)(kind % 16) - 4;
    if (kind < 192) return hostile[kind % 16];
    if (kind < 224) return (double)(kind % 8) + ldexp((double)fuzz_byte(in) - 128, -50);
    uint64_t bits = fuzz_word(in);
    double x;
    memcpy(&x, &bits, sizeof x);
    return isfinite(x) ? x : 1;
}

/** The context of all inputs: one thread, and a limit of memory that no small input may need. */
static inline brio_context *fuzz_context(void) {
    static brio_context *ctx;
    if (!ctx) {
        FUZZ_EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK);
        brio_context_set_memory_limit(ctx, (size_t)256 << 20);
    }
    brio_context_set_threads(ctx, 1);
    return ctx;
}

/** Whether every input's objects are gone. */
static inline void fuzz_end(void) {
    FUZZ_EXPECT(brio_context_memory(fuzz_context()) == 0, "%zu bytes left", brio_context_memory(fuzz_context()));
}

/** A failure explains itself, and is none of a fault of the library. */
static inline void fuzz_expect_failure(brio_status status) {
    FUZZ_EXPECT(status != BRIO_ERR_INTERNAL, "%s", brio_message(fuzz_context()));
    FUZZ_EXPECT(status == BRIO_OK || brio_message(fuzz_context())[0], "status %d", (int)status);
}

/** Indices are in range and coordinates are finite. */
static inline void fuzz_expect_sound(const brio_mesh *m) {
    uint64_t corners = m->num_faces ? m->face_offsets[m->num_faces] : 0;
    for (size_t i = 0; i < 3 * m->num_vertices; i++) FUZZ_EXPECT(isfinite(m->vertices[i]), "coordinate %zu", i);
    for (size_t f = 0; f < m->num_faces; f++) FUZZ_EXPECT(m->face_offsets[f] <= m->face_offsets[f + 1], "face %zu", f);
    for (uint64_t i = 0; i < corners; i++) FUZZ_EXPECT(m->face_vertices[i] < m->num_vertices);
    for (size_t i = 0; i < 4 * m->num_tetrahedra; i++) FUZZ_EXPECT(m->tetrahedra[i] < m->num_vertices);
    for (size_t i = 0; i < 2 * m->num_edges; i++) FUZZ_EXPECT(m->edges[i] < m->num_vertices);
    for (size_t p = 0; p < m->num_properties; p++) {
        FUZZ_EXPECT(memchr(m->properties[p].name, 0, sizeof m->properties[p].name), "property %zu", p);
        for (size_t i = 0; i < m->num_vertices; i++) (void)brio_property_value(&m->properties[p], i);
    }
}

#endif
