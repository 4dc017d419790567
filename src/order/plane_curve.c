/* Sorts points of the plane along a Hilbert curve: a radix sort by keys of at most 16 levels. Cells with more than
 * CELL_MOST points are sorted again, along the curve through the square of their own points, as in curve.c. One thread
 * does it all. As in curve.c, the points may change meanwhile.
 *
 * Based on: Hamilton. Compact Hilbert indices. Technical report CS-2006-07, Dalhousie University 2006 (states and their
 * table, here for two dimensions, where four orientations occur). */
#include "order/plane_curve.h"
#include "base/sort.h"
#include "order/ruler.h"

enum { CURVE_BITS = 16, CELL_MOST = 8, GROUP = 4 };

/* STATE[s][quadrant] = 4 * next state + rank; quadrant = 2 x + y of the next bits. */
static const uint8_t STATE[4][4] = {
    {0x4, 0x1, 0xb, 0x2}, {0x0, 0xf, 0x5, 0x6}, {0xa, 0x9, 0x3, 0xc}, {0xe, 0x7, 0xd, 0x8}};

/* STATE composed GROUP times: step[s][x bits, y bits] = 256 * next state + rank. */
typedef struct {
    uint16_t step[4][256];
} levels;

static void compose(levels *out) {
    for (unsigned s = 0; s < 4; s++)
        for (unsigned i = 0; i < 256; i++) {
            unsigned state = s, rank = 0, x = i >> GROUP, y = i & 15;
            for (int b = GROUP - 1; b >= 0; b--) {
                unsigned next = STATE[state][(x >> b & 1) << 1 | (y >> b & 1)];
                rank = rank << 2 | (next & 3);
                state = next >> 2;
            }
            out->step[s][i] = (uint16_t)(state << 8 | rank);
        }
}

/* Returns the position of cell (x, y) along the curve through a grid of 2^bits cells a side. */
static inline uint32_t key_of(const levels *l, uint32_t x, uint32_t y, int bits) {
    uint32_t key = 0;
    unsigned state = 0;
    int b = bits;
    while (b % GROUP) {
        b--;
        unsigned next = STATE[state][(x >> b & 1) << 1 | (y >> b & 1)];
        key = key << 2 | (next & 3);
        state = next >> 2;
    }
    while ((b -= GROUP) >= 0) {
        unsigned next = l->step[state][(x >> b & 15) << GROUP | (y >> b & 15)];
        key = key << 2 * GROUP | (next & 255);
        state = next >> 8;
    }
    return key;
}

/* The smallest square around points, cut into cells. */
typedef struct {
    double low[2], high[2];
    brio_ruler ruler;
} square;

typedef struct {
    brio_context *ctx;
    const brio_plane_points *points;
    uint64_t *items, *spare;
    levels levels;
} curve;

static inline double coordinate_of(const curve *c, uint64_t item, int k) {
    return c->points->rows[c->points->stride * (uint32_t)item + (size_t)c->points->axis[k]];
}

/* Returns false when all points of the items have one place. */
static bool find_square(const curve *c, const uint64_t *items, size_t n, int bits, square *s) {
    for (int k = 0; k < 2; k++) s->low[k] = s->high[k] = coordinate_of(c, items[0], k);
    for (size_t i = 1; i < n; i++)
        for (int k = 0; k < 2; k++) {
            double x = coordinate_of(c, items[i], k);
            s->low[k] = x < s->low[k] ? x : s->low[k];
            s->high[k] = x > s->high[k] ? x : s->high[k];
        }
    return brio_ruler_lay(&s->ruler, s->low, s->high, 2, bits);
}

static inline uint32_t cell_of(const curve *c, const square *s, uint64_t item, int k) {
    return brio_ruler_cell(&s->ruler, coordinate_of(c, item, k), s->low[k]);
}

/* Writes the keys of the items. Returns false when all their points have one place. */
static bool number_items(const curve *c, uint64_t *items, size_t n, int bits) {
    square s;
    if (!find_square(c, items, n, bits, &s)) return false;
    for (size_t i = 0; i < n; i++) {
        uint32_t x = cell_of(c, &s, items[i], 0), y = cell_of(c, &s, items[i], 1);
        items[i] = (uint64_t)key_of(&c->levels, x, y, bits) << 32 | (uint32_t)items[i];
    }
    return true;
}

/* Returns the number of levels for n points: about one point in each cell, if the points are spread evenly. */
static int curve_bits(size_t n) {
    int bits = 2;
    while (bits < CURVE_BITS && (size_t)1 << 2 * bits < n) bits++;
    return bits;
}

static brio_status sort_range(const curve *c, size_t begin, size_t end);

/* Sorts the cells of the items [begin, end) with more than CELL_MOST points, except the largest one, whose bounds it
 * writes; without any, *from == *to. The cells that it sorts have at most half of the points. */
static brio_status refine_cells(const curve *c, size_t begin, size_t end, size_t *from, size_t *to) {
    const uint64_t *items = c->items;
    brio_status status = BRIO_OK;
    *from = *to = begin;
    for (size_t next; begin < end && status == BRIO_OK; begin = next) {
        for (next = begin + 1; next < end && items[next] >> 32 == items[begin] >> 32;) next++;
        size_t first = begin, last = next;
        if (last - first <= CELL_MOST) continue;
        if (last - first > *to - *from) {
            first = *from, last = *to;
            *from = begin, *to = next;
        }
        if (first < last) status = sort_range(c, first, last);
    }
    return status;
}

/* Sorts the items [begin, end), and goes on with the largest cell. Stops at a cell with all points of its range: its
 * square is too small to be divided. */
static brio_status sort_range(const curve *c, size_t begin, size_t end) {
    for (size_t n = end - begin; n >= 2; n = end - begin) {
        uint64_t *items = c->items + begin;
        int bits = curve_bits(n);
        if (!number_items(c, items, n, bits)) break;
        BRIO_FORWARD(brio_sort_items(c->ctx, items, c->spare + begin, n, 2 * bits, 1));
        BRIO_FORWARD(refine_cells(c, begin, end, &begin, &end));
        if (end - begin == n) break;
    }
    return BRIO_OK;
}

brio_status brio_sort_along_plane_curve(brio_context *ctx, const brio_plane_points *points, uint64_t *items,
                                        uint64_t *spare, size_t n) {
    curve c = {.ctx = ctx, .points = points, .items = items, .spare = spare};
    if (n == 0) return BRIO_OK;
    compose(&c.levels);
    return sort_range(&c, 0, n);
}
