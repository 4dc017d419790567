/* Computes Hilbert curve keys with a state table. From the root cell downwards, each state maps an octant to its rank
 * along the curve and to the state inside the octant.
 *
 * Based on: Hamilton. Compact Hilbert indices. Technical report CS-2006-07, Dalhousie University 2006 (the table is his
 * construction from Gray codes, written out for three dimensions; twelve of the 24 orientations occur). */
#include "order/hilbert.h"
#include "base/team.h"
#include "order/cube.h"
#include <assert.h>

enum { POINTS_A_THREAD = 1 << 12 };

/* STATE[s][octant] = 8 * next state + rank; octant = 4 x + 2 y + z of the next bits. */
static const uint8_t STATE[12][8] = {
    {0x08, 0x17, 0x19, 0x26, 0x2b, 0x2c, 0x1a, 0x25}, {0x18, 0x33, 0x3f, 0x34, 0x01, 0x02, 0x46, 0x45},
    {0x4c, 0x27, 0x4b, 0x50, 0x05, 0x06, 0x42, 0x41}, {0x00, 0x09, 0x53, 0x0a, 0x5f, 0x4e, 0x54, 0x4d},
    {0x16, 0x07, 0x15, 0x3c, 0x31, 0x58, 0x32, 0x3b}, {0x3a, 0x55, 0x03, 0x04, 0x39, 0x56, 0x48, 0x37},
    {0x5a, 0x59, 0x2d, 0x2e, 0x0b, 0x20, 0x0c, 0x57}, {0x24, 0x0d, 0x47, 0x0e, 0x23, 0x4a, 0x28, 0x49},
    {0x3e, 0x51, 0x0f, 0x10, 0x3d, 0x52, 0x5c, 0x5b}, {0x5e, 0x5d, 0x29, 0x2a, 0x1f, 0x14, 0x38, 0x13},
    {0x12, 0x1b, 0x11, 0x40, 0x35, 0x1c, 0x36, 0x2f}, {0x44, 0x43, 0x1d, 0x22, 0x4f, 0x30, 0x1e, 0x21},
};

/* STATE composed with itself: step[s][pair of octants] = 64 * next state + rank of the pair. */
typedef struct {
    uint16_t step[12][64];
} two_levels;

static void compose(two_levels *two) {
    for (int s = 0; s < 12; s++)
        for (unsigned i = 0; i < 64; i++) { /* i = x x y y z z, the higher level first */
            unsigned high = (i >> 5 & 1) << 2 | (i >> 3 & 1) << 1 | (i >> 1 & 1);
            unsigned low = (i >> 4 & 1) << 2 | (i >> 2 & 1) << 1 | (i & 1);
            unsigned first = STATE[s][high], second = STATE[first >> 3][low];
            two->step[s][i] = (uint16_t)((second >> 3) << 6 | (first & 7) << 3 | (second & 7));
        }
}

static inline uint64_t key_of(const two_levels *two, uint32_t x, uint32_t y, uint32_t z, int bits) {
    uint64_t key = 0;
    unsigned state = 0;
    int b = bits;
    if (b % 2) {
        b--;
        unsigned first = STATE[0][(x >> b & 1) << 2 | (y >> b & 1) << 1 | (z >> b & 1)];
        key = first & 7;
        state = first >> 3;
    }
    while ((b -= 2) >= 0) {
        unsigned next = two->step[state][(x >> b & 3) << 4 | (y >> b & 3) << 2 | (z >> b & 3)];
        key = key << 6 | (next & 63);
        state = next >> 6;
        assert(state < 12); /* bits 0 to 5: the rank; bits 6 on: the state inside */
    }
    assert(key >> 3 * bits == 0);
    return key;
}

uint64_t brio_hilbert_key(uint32_t x, uint32_t y, uint32_t z, int bits) {
    two_levels two;
    assert(0 <= bits && bits <= BRIO_HILBERT_MAX_BITS && (x | y | z) >> bits == 0);
    compose(&two);
    return key_of(&two, x, y, z, bits);
}

static inline uint64_t cube_key(const brio_cube *c, const two_levels *two, const double *p, int bits) {
    return key_of(two, brio_cube_cell(c, p, 0), brio_cube_cell(c, p, 1), brio_cube_cell(c, p, 2), bits);
}

/* The data of one call that computes keys. */
typedef struct {
    const double *points;
    uint64_t *keys; /* one key for each point, or the items */
    int bits;
    brio_cube cube;
    two_levels two;
} numbering;

static void number_points(void *user, size_t begin, size_t end, int thread) {
    const numbering *n = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) n->keys[i] = cube_key(&n->cube, &n->two, n->points + 3 * i, n->bits);
}

static void number_items(void *user, size_t begin, size_t end, int thread) {
    const numbering *n = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint64_t index = (uint32_t)n->keys[i];
        n->keys[i] = cube_key(&n->cube, &n->two, n->points + 3 * index, n->bits) << 32 | index;
    }
}

brio_status brio_hilbert_keys(brio_context *ctx, const double *points, size_t n, int bits, uint64_t *keys) {
    brio_status status = BRIO_OK;
    assert(0 < bits && bits <= BRIO_HILBERT_MAX_BITS);
    numbering all = {.points = points, .keys = keys, .bits = bits};
    int threads = brio_threads(ctx, n, POINTS_A_THREAD);
    if (!n) return BRIO_OK;
    compose(&all.two);
    BRIO_TRY(brio_cube_of(ctx, points, NULL, n, threads, &all.cube));
    brio_cube_divide(&all.cube, bits);
    status = brio_for(ctx, threads, n, number_points, &all);
done:
    return status;
}

brio_status brio_hilbert_items(brio_context *ctx, const double *points, uint64_t *items, size_t n, int *bits,
                               int threads) {
    assert(0 < *bits && *bits <= 10); /* keys have 32 bits */
    numbering all = {.points = points, .keys = items, .bits = *bits};
    *bits = 0;
    if (!n) return BRIO_OK;
    compose(&all.two);
    BRIO_FORWARD(brio_cube_of(ctx, points, items, n, threads, &all.cube));
    if (!brio_cube_divide(&all.cube, all.bits)) return BRIO_OK;
    BRIO_FORWARD(brio_for(ctx, threads, n, number_items, &all));
    *bits = all.bits;
    return BRIO_OK;
}
