/* Samples divided into pieces by an octree.
 *
 * The samples are sorted along a Hilbert curve, so every cell of the octree is a range of them. A cell with too many
 * samples is divided into its eight parts. Parts that follow each other along the curve lie side by side; they stay
 * together while they have few enough samples.
 *
 * The surface of a piece is found from its own samples, all samples within a margin of many spacings, and a thin
 * selection of all others. So its Voronoi cells end where they end in the whole set, and its poles lie near those of
 * the whole set. Outside and inside are decided as in the whole set.
 *
 * Based on: Dey, Giesen, Hudson. Delaunay based shape reconstruction from large data. PVG 2001.
 * Differs from the paper: the selection from everywhere. */
#include "reconstruct/cocone/octree_pieces.h"
#include "base/memory.h"
#include "base/sort.h"
#include "order/canonical_points.h"
#include "order/hilbert.h"
#include <math.h>
#include <string.h>

/* THIN: the selection has one sample in THIN * pieces. Chosen. */
enum { BITS = BRIO_HILBERT_MAX_BITS, THIN = 4 };

/* Width of the margin, in spacings of the piece's samples, if these lay in a square lattice as wide as their box.
 * Chosen. */
static const double MARGIN = 12;

/* --- the cells --- */

typedef struct {
    brio_context *ctx;
    const uint64_t *keys; /* one for each entry of out->order */
    brio_pieces *out;
    size_t most; /* most samples in a piece */
} divider;

static brio_status add_piece(divider *d, size_t begin, size_t end) {
    brio_status status = BRIO_OK;
    brio_pieces *out = d->out;
    if (begin == end) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(d->ctx, out->pieces, out->capacity, out->num_pieces + 1));
    out->pieces[out->num_pieces++] = (brio_piece){.begin = begin, .end = end};
done:
    return status;
}

/* Returns the first index in [begin, end) whose key is at least `key`, or end. */
static size_t find_key(const divider *d, size_t begin, size_t end, uint64_t key) {
    while (begin < end) {
        size_t middle = begin + (end - begin) / 2;
        if (d->keys[middle] < key)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/* Divides the cell that begins at `key` and has 2^levels smallest cells on a side. Its samples are [begin, end). The
 * recursion is at most BITS deep. */
static brio_status divide(divider *d, size_t begin, size_t end, uint64_t key, int levels) {
    brio_status status = BRIO_OK;
    size_t first = begin; /* the first sample of the parts put together so far */
    if (end - begin <= d->most || levels == 0) return add_piece(d, begin, end);
    for (uint64_t part = 0, at = begin; part < 8; part++) {
        uint64_t next_key = key + ((part + 1) << 3 * (levels - 1));
        size_t next = find_key(d, at, end, next_key);
        if (next - first > d->most) {
            BRIO_TRY(add_piece(d, first, at));
            first = at;
        }
        if (next - at > d->most) {
            BRIO_TRY(divide(d, at, next, key + (part << 3 * (levels - 1)), levels - 1));
            first = next;
        }
        at = next;
    }
    BRIO_TRY(add_piece(d, first, end));
done:
    return status;
}

/* --- boxes --- */

/* Returns the diagonal of a box. It is infinite only if doubles cannot hold it. */
static double diagonal_of(const double *low, const double *high) {
    double half[3], most = 0, square = 0;
    for (int k = 0; k < 3; k++) half[k] = 0.5 * high[k] - 0.5 * low[k], most = fmax(most, half[k]);
    for (int k = 0; k < 3 && most > 0; k++) square += (half[k] / most) * (half[k] / most);
    return 2 * (most * sqrt(square));
}

static void find_box(const brio_pieces *p, brio_piece *piece) {
    for (int k = 0; k < 3; k++) piece->low[k] = INFINITY, piece->high[k] = -INFINITY;
    for (size_t n = piece->begin; n < piece->end; n++)
        for (int k = 0; k < 3; k++) {
            double x = p->points[3 * (size_t)p->order[n] + (size_t)k];
            piece->low[k] = x < piece->low[k] ? x : piece->low[k];
            piece->high[k] = x > piece->high[k] ? x : piece->high[k];
        }
    piece->margin = MARGIN / sqrt((double)(piece->end - piece->begin)) * diagonal_of(piece->low, piece->high);
}

/* Returns the largest gap between two boxes along an axis, 0 if they overlap. */
static double gap(const double *low, const double *high, const double *other_low, const double *other_high) {
    double most = 0;
    for (int k = 0; k < 3; k++) most = fmax(most, fmax(other_low[k] - high[k], low[k] - other_high[k]));
    return most;
}

/* Sorts the samples of each smallest cell by position, so that the places do not depend on the caller's order. */
static void sort_ties(const double *points, size_t n, const uint64_t *keys, uint32_t *order) {
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin + 1; end < n && keys[end] == keys[begin];) end++;
        brio_sort_indices(order + begin, end - begin, brio_compare_points, points);
    }
}

brio_status brio_pieces_new(brio_context *ctx, const double *points, size_t num_points, size_t wanted,
                            brio_pieces *out) {
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    divider d = {.ctx = ctx, .out = out};
    *out = (brio_pieces){.points = points, .num_points = num_points};
    if (wanted > num_points) wanted = num_points;
    d.most = wanted ? (num_points + wanted - 1) / wanted : 0;
    out->stride = THIN * (wanted ? wanted : 1);
    BRIO_TRY(BRIO_ALLOC(ctx, out->order, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, out->piece_of, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, keys, num_points));
    for (size_t n = 0; n < num_points; n++) out->order[n] = (uint32_t)n;
    BRIO_TRY(brio_hilbert_keys(ctx, points, num_points, BITS, keys));
    BRIO_TRY(brio_radix_sort(ctx, keys, out->order, num_points, 3 * BITS));
    sort_ties(points, num_points, keys, out->order);
    brio_name_coincident(points, num_points, out->order);
    d.keys = keys;
    BRIO_TRY(divide(&d, 0, num_points, 0, BITS));
    for (size_t i = 0; i < out->num_pieces; i++) {
        brio_piece *piece = &out->pieces[i];
        find_box(out, piece);
        for (size_t n = piece->begin; n < piece->end; n++) out->piece_of[out->order[n]] = (uint32_t)i;
    }
done:
    brio_release(ctx, keys);
    return status;
}

void brio_pieces_free(brio_context *ctx, brio_pieces *pieces) {
    brio_release(ctx, pieces->order);
    brio_release(ctx, pieces->piece_of);
    brio_release(ctx, pieces->pieces);
    *pieces = (brio_pieces){0};
}

/* --- the samples of a piece --- */

typedef struct {
    brio_context *ctx;
    uint64_t *place; /* index in the order of the samples << 32 */
    size_t count, capacity;
} selection;

static brio_status add_sample(selection *s, size_t place) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(s->ctx, s->place, s->capacity, s->count + 1));
    s->place[s->count++] = (uint64_t)place << 32;
done:
    return status;
}

/* Adds the samples of another piece that lie within the margin of `piece` or of `other`, the larger one. */
static brio_status add_margin(selection *s, const brio_pieces *p, const brio_piece *piece, const brio_piece *other) {
    brio_status status = BRIO_OK;
    double margin = fmax(piece->margin, other->margin);
    if (gap(piece->low, piece->high, other->low, other->high) > margin) return BRIO_OK;
    for (size_t n = other->begin; n < other->end; n++) {
        const double *x = p->points + 3 * (size_t)p->order[n];
        if (gap(piece->low, piece->high, x, x) <= margin) BRIO_TRY(add_sample(s, n));
    }
done:
    return status;
}

brio_status brio_piece_samples(brio_context *ctx, const brio_pieces *p, size_t piece, uint32_t **samples,
                               size_t *count) {
    brio_status status = BRIO_OK;
    selection s = {.ctx = ctx};
    uint64_t *spare = NULL;
    *samples = NULL;
    *count = 0;
    for (size_t i = 0; i < p->num_pieces; i++) BRIO_TRY(add_margin(&s, p, &p->pieces[piece], &p->pieces[i]));
    for (size_t n = 0; n < p->num_points; n += p->stride) BRIO_TRY(add_sample(&s, n));
    BRIO_TRY(BRIO_ALLOC(ctx, spare, s.count));
    BRIO_TRY(brio_sort_items(ctx, s.place, spare, s.count, 32, 1));
    BRIO_TRY(BRIO_ALLOC(ctx, *samples, s.count));
    for (size_t n = 0; n < s.count; n++)
        if (n == 0 || s.place[n] != s.place[n - 1]) (*samples)[(*count)++] = p->order[s.place[n] >> 32];
done:
    brio_release(ctx, s.place);
    brio_release(ctx, spare);
    return status;
}
