/* Hilbert curve keys by a state table: from the root cell downwards, each state maps an octant to its rank along the
 * curve and to the state of that octant.
 *
 * Based on: Hamilton. Compact Hilbert indices. Technical report CS-2006-07, Dalhousie University 2006 (the table is his
 * construction from Gray codes, written out for three dimensions; twelve of the 24 orientations occur). */
#include "order/hilbert.h"
#include <math.h>

/* STATE[s][octant] = 8 * next state + rank; octant = 4 x + 2 y + z of the next bits. */
static const uint8_t STATE[12][8] = {
    {0x08, 0x17, 0x19, 0x26, 0x2b, 0x2c, 0x1a, 0x25}, {0x18, 0x33, 0x3f, 0x34, 0x01, 0x02, 0x46, 0x45},
    {0x4c, 0x27, 0x4b, 0x50, 0x05, 0x06, 0x42, 0x41}, {0x00, 0x09, 0x53, 0x0a, 0x5f, 0x4e, 0x54, 0x4d},
    {0x16, 0x07, 0x15, 0x3c, 0x31, 0x58, 0x32, 0x3b}, {0x3a, 0x55, 0x03, 0x04, 0x39, 0x56, 0x48, 0x37},
    {0x5a, 0x59, 0x2d, 0x2e, 0x0b, 0x20, 0x0c, 0x57}, {0x24, 0x0d, 0x47, 0x0e, 0x23, 0x4a, 0x28, 0x49},
    {0x3e, 0x51, 0x0f, 0x10, 0x3d, 0x52, 0x5c, 0x5b}, {0x5e, 0x5d, 0x29, 0x2a, 0x1f, 0x14, 0x38, 0x13},
    {0x12, 0x1b, 0x11, 0x40, 0x35, 0x1c, 0x36, 0x2f}, {0x44, 0x43, 0x1d, 0x22, 0x4f, 0x30, 0x1e, 0x21},
};

uint64_t brio_hilbert_key(uint32_t x, uint32_t y, uint32_t z, int bits) {
    uint64_t key = 0;
    unsigned state = 0;
    for (int b = bits - 1; b >= 0; b--) {
        unsigned octant = (x >> b & 1) << 2 | (y >> b & 1) << 1 | (z >> b & 1);
        unsigned next = STATE[state][octant];
        key = key << 3 | (next & 7);
        state = next >> 3;
    }
    return key;
}

/* Coordinates are halved first, so that the side of the box cannot overflow. */
static void half_box(const double *points, size_t n, double low[3], double *side) {
    double high[3];
    for (int k = 0; k < 3; k++) low[k] = high[k] = points[k] * 0.5;
    for (size_t i = 1; i < n; i++)
        for (int k = 0; k < 3; k++) {
            double c = points[3 * i + (size_t)k] * 0.5;
            low[k] = c < low[k] ? c : low[k];
            high[k] = c > high[k] ? c : high[k];
        }
    *side = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
}

void brio_hilbert_keys(const double *points, size_t n, int bits, uint64_t *keys) {
    if (!n) return;
    double low[3], side;
    half_box(points, n, low, &side);
    double cells = ldexp(1, bits), last = cells - 1;
    double scale = side > 0 ? fmin(cells / side, 0x1p1000) : 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t cell[3];
        for (int k = 0; k < 3; k++) {
            double c = (points[3 * i + (size_t)k] * 0.5 - low[k]) * scale;
            cell[k] = (uint32_t)(c < last ? c : last);
        }
        keys[i] = brio_hilbert_key(cell[0], cell[1], cell[2], bits);
    }
}
