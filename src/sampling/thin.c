/* Thins points to a spacing: a maximal subset whose points are at least the spacing apart.
 *
 * Space is cut into cubic cells a little wider than the spacing, and the cells into slabs, one cell wide, across the
 * longest side of the box. Points of two slabs that are not neighbours are farther apart than the spacing, so first all
 * even slabs are done, by threads, and then all odd ones. Within a slab cells follow one another by their place. In a
 * cell, the points too near to a chosen point of the 27 cells around are dropped; of the others the one nearest to the
 * middle of the cell is chosen, those too near to it are dropped, and so on. None of this depends on the order of the
 * points.
 *
 * Points are sorted by the number of their cell. A slab keeps its chosen points in front of its part of the sorted
 * arrays, so they are sorted too: while the slab goes from cell to cell, nine cursors run along the rows of cells
 * around.
 *
 * Based on: Cook. Stochastic sampling in computer graphics. ACM Transactions on Graphics 5, 1986 (Poisson disks: points
 * with a least distance). Differs from the paper: chosen from given points, in an order that only their positions
 * decide. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/team.h"
#include <math.h>
#include <string.h>

/* KEY_BITS: of the number of a cell. POINTS_A_THREAD and GROUP (points between two reports of progress): chosen. */
enum { KEY_BITS = 63, POINTS_A_THREAD = 1 << 14, GROUP = 1 << 21 };

/* Cells are wider than the spacing by this factor. Derived: with at most 2^42 cells along an axis the place of a point
 * in units of cells is rounded by less than 2^-10, so points in cells that are not neighbours are at least the spacing
 * apart. */
static const double WIDER = 1 + 0x1p-8;
/* Chosen: the most that rounding of coordinates counts for, a share of the spacing. */
static const double MOST_ROUNDED = 0x1p-14;
enum { MOST_AXIS_BITS = 42 };

typedef struct {
    uint64_t place;    /* along the longest axis */
    size_t begin, end; /* of its points in the sorted arrays */
    size_t num_chosen; /* of these; they are at the front */
} slab;

typedef struct {
    brio_context *ctx;
    const double *points;
    size_t num_points;
    double low[3], width, scale; /* scale: a power of 2 that brings the spacing near 1 */
    double square;               /* of the scaled spacing */
    int axes[3];                 /* the longest first */
    int bits[3], shift[3];       /* of the cell's places along these axes in its number */
    uint64_t *keys;              /* numbers of cells */
    uint32_t *order;             /* points */
    slab *slabs;
    size_t num_slabs, slab_capacity;
    unsigned parity;
    size_t first_slab; /* of the slabs that are being done */
    uint8_t *chosen;
} thinning;

/* --- cells --- */

static void find_axes(thinning *t, const double high[3]) {
    double side[3];
    for (int k = 0; k < 3; k++) {
        t->axes[k] = k;
        side[k] = high[k] / 2 - t->low[k] / 2;
    }
    for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++)
            if (side[t->axes[l]] < side[t->axes[l + 1]]) {
                int axis = t->axes[l];
                t->axes[l] = t->axes[l + 1];
                t->axes[l + 1] = axis;
            }
}

/* Returns a coordinate in units of cells. Halves, because the difference of two doubles may overflow. */
static double place_of(const thinning *t, const double *p, int axis) {
    return (p[axis] / 2 - t->low[axis] / 2) / (t->width / 2);
}

/* Finds how many bits the places of cells need along each axis, an empty cell at either end included. */
static bool count_bits(thinning *t, const double high[3]) {
    int sum = 0;
    for (int k = 0; k < 3; k++) {
        double cells = place_of(t, high, t->axes[k]) + 3;
        if (!(cells < 0x1p42)) return false;
        t->bits[k] = ilogb(cells) + 1;
        sum += t->bits[k];
    }
    t->shift[2] = 0;
    t->shift[1] = t->bits[2];
    t->shift[0] = t->bits[2] + t->bits[1];
    return sum <= KEY_BITS;
}

/* Makes the cells as wide as the spacing asks, or wider if their numbers would have too many bits. The points were
 * finite when the call began, but another thread of the caller may have written to them since. */
static brio_status find_cells(thinning *t, double spacing) {
    double high[3];
    for (int k = 0; k < 3; k++) t->low[k] = high[k] = t->points[k];
    for (size_t i = 1; i < t->num_points; i++)
        for (int k = 0; k < 3; k++) {
            double x = t->points[3 * i + (size_t)k];
            if (x < t->low[k]) t->low[k] = x;
            if (x > high[k]) high[k] = x;
        }
    if (!brio_all_finite(t->low, 3) || !brio_all_finite(high, 3))
        return brio_fail(t->ctx, BRIO_ERR_NOT_FINITE,
                         "the points changed during the call, to numbers that are not finite");
    find_axes(t, high);
    t->scale = ldexp(1, -ilogb(spacing) > 1000 ? 1000 : -ilogb(spacing));
    double greatest = 0;
    for (int k = 0; k < 3; k++) greatest = fmax(greatest, fmax(fabs(t->low[k]), fabs(high[k])));
    double apart = (spacing - fmin(brio_distance_rounding(greatest), MOST_ROUNDED * spacing)) * t->scale;
    t->square = apart * apart;
    t->width = fmax(spacing * WIDER, 0x1p-1000);
    while (!count_bits(t, high)) t->width *= 2;
    return BRIO_OK;
}

/* Returns the number of a point's cell along the k-th axis. A point that left the box during the call has a cell at an
 * end of it, so that the number never has more bits than are sorted. */
static inline uint64_t cell_of(const thinning *t, const double *p, int k) {
    double place = place_of(t, p, t->axes[k]), last = (double)((INT64_C(1) << t->bits[k]) - 2);
    return (uint64_t)(int64_t)(place > 0 ? fmin(place, last) : 0) + 1;
}

static void find_keys(void *user, size_t begin, size_t end, int thread) {
    const thinning *t = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint64_t key = 0;
        for (int k = 0; k < 3; k++) key |= cell_of(t, t->points + 3 * i, k) << t->shift[k];
        t->keys[i] = key;
        t->order[i] = (uint32_t)i;
    }
}

static brio_status find_slabs(thinning *t) {
    for (size_t i = 0; i < t->num_points; i++) {
        uint64_t place = t->keys[i] >> t->shift[0];
        if (i == 0 || place != t->slabs[t->num_slabs - 1].place) {
            BRIO_FORWARD(BRIO_RESERVE(t->ctx, t->slabs, t->slab_capacity, t->num_slabs + 1));
            t->slabs[t->num_slabs++] = (slab){place, i, i, 0};
        }
        t->slabs[t->num_slabs - 1].end = i + 1;
    }
    return BRIO_OK;
}

/* --- one slab --- */

static inline bool too_near(const thinning *t, const double *p, const double *q) {
    double x = (p[0] - q[0]) * t->scale, y = (p[1] - q[1]) * t->scale, z = (p[2] - q[2]) * t->scale;
    return x * x + y * y + z * z < t->square;
}

/* A row of three cells beside the present one: chosen points [begin, end) of a slab. */
typedef struct {
    const slab *slab;
    uint64_t first; /* number of the first cell, less the number of the present cell (modulo 2^64) */
    size_t begin, end;
} cursor;

typedef struct {
    const thinning *t;
    slab *own;
    cursor cursors[9];
    int num_cursors;
} sweep;

static void start_cursors(sweep *w, size_t index) {
    const thinning *t = w->t;
    for (int i = -1; i <= 1; i++) {
        size_t other = index + (size_t)i;
        if (other >= t->num_slabs || t->slabs[other].place != w->own->place + (uint64_t)i) continue;
        for (int j = -1; j <= 1; j++) {
            uint64_t first = ((uint64_t)i << t->shift[0]) + ((uint64_t)j << t->shift[1]) - 1;
            size_t begin = t->slabs[other].begin;
            w->cursors[w->num_cursors++] = (cursor){&t->slabs[other], first, begin, begin};
        }
    }
}

static void move_cursors(sweep *w, uint64_t key) {
    const uint64_t *keys = w->t->keys;
    for (int i = 0; i < w->num_cursors; i++) {
        cursor *c = &w->cursors[i];
        size_t end = c->slab->begin + c->slab->num_chosen;
        uint64_t first = key + c->first;
        while (c->begin < end && keys[c->begin] < first) c->begin++;
        if (c->end < c->begin) c->end = c->begin;
        while (c->end < end && keys[c->end] <= first + 2) c->end++;
    }
}

static bool is_covered(const sweep *w, const double *p) {
    const thinning *t = w->t;
    for (int i = 0; i < w->num_cursors; i++)
        for (size_t j = w->cursors[i].begin; j < w->cursors[i].end; j++)
            if (too_near(t, p, t->points + 3 * (size_t)t->order[j])) return true;
    return false;
}

/* Returns the square of the distance from the middle of the cell, in units of cells. */
static double distance_from_middle(const thinning *t, const double *p) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double place = place_of(t, p, k), off = place - floor(place) - 0.5;
        sum += off * off;
    }
    return sum;
}

static bool comes_before(const double *points, uint32_t a, uint32_t b) {
    const double *p = points + 3 * (size_t)a, *q = points + 3 * (size_t)b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k];
    return a < b;
}

/* Moves the point of [begin, end) that is nearest to the middle of the cell to the front. */
static void put_nearest_first(const thinning *t, size_t begin, size_t end) {
    size_t best = begin;
    double least = INFINITY;
    for (size_t i = begin; i < end; i++) {
        double square = distance_from_middle(t, t->points + 3 * (size_t)t->order[i]);
        if (square > least || (square == least && comes_before(t->points, t->order[best], t->order[i]))) continue;
        least = square;
        best = i;
    }
    uint32_t point = t->order[best];
    t->order[best] = t->order[begin];
    t->order[begin] = point;
}

/* Does the cell of the sorted points [begin, end). The slab's chosen points end at `begin` or before, so there is room
 * for more in front of the points that are not decided yet. */
static void thin_cell(sweep *w, size_t begin, size_t end) {
    const thinning *t = w->t;
    uint64_t key = t->keys[begin];
    size_t rest = begin;
    move_cursors(w, key);
    for (size_t i = begin; i < end; i++)
        if (!is_covered(w, t->points + 3 * (size_t)t->order[i])) t->order[rest++] = t->order[i];
    while (begin < rest) {
        put_nearest_first(t, begin, rest);
        uint32_t taken = t->order[begin];
        size_t place = w->own->begin + w->own->num_chosen++, kept = ++begin;
        t->keys[place] = key;
        t->order[place] = taken;
        t->chosen[taken] = 1;
        for (size_t i = begin; i < rest; i++)
            if (!too_near(t, t->points + 3 * (size_t)taken, t->points + 3 * (size_t)t->order[i]))
                t->order[kept++] = t->order[i];
        rest = kept;
    }
}

static void thin_slabs(void *user, size_t begin, size_t end, int thread) {
    const thinning *t = user;
    (void)thread;
    for (size_t i = t->first_slab + begin; i < t->first_slab + end; i++) {
        slab *s = &t->slabs[i];
        if ((s->place & 1) != t->parity) continue;
        sweep w = {.t = t, .own = s};
        start_cursors(&w, i);
        for (size_t at = s->begin, next; at < s->end; at = next) {
            uint64_t key = t->keys[at];
            for (next = at + 1; next < s->end && t->keys[next] == key;) next++;
            thin_cell(&w, at, next);
        }
    }
}

/* --- all slabs --- */

static brio_status thin_all(thinning *t, brio_bar bar) {
    brio_progress_part(t->ctx, bar, 0.5, 1);
    for (t->parity = 0; t->parity < 2; t->parity++)
        for (size_t first = 0, last; first < t->num_slabs; first = last) {
            for (last = first + 1; last < t->num_slabs && t->slabs[last].end - t->slabs[first].begin < GROUP;) last++;
            t->first_slab = first;
            size_t points = t->slabs[last - 1].end - t->slabs[first].begin;
            BRIO_FORWARD(
                brio_for_chunks(t->ctx, brio_threads(t->ctx, points, POINTS_A_THREAD), last - first, 1, thin_slabs, t));
            BRIO_FORWARD(brio_progress(t->ctx, "thin", (t->parity + (double)last / (double)t->num_slabs) / 2));
        }
    return BRIO_OK;
}

static brio_status sort_points(thinning *t) {
    size_t n = t->num_points;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->keys, n));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->order, n));
    BRIO_FORWARD(brio_for(t->ctx, brio_threads(t->ctx, n, POINTS_A_THREAD), n, find_keys, t));
    BRIO_FORWARD(brio_progress(t->ctx, "sort", 0.1));
    BRIO_FORWARD(brio_radix_sort(t->ctx, t->keys, t->order, n, t->bits[0] + t->bits[1] + t->bits[2]));
    BRIO_FORWARD(brio_progress(t->ctx, "sort", 1));
    return find_slabs(t);
}

static size_t count_chosen(const uint8_t *chosen, size_t count) {
    size_t sum = 0;
    for (size_t i = 0; i < count; i++) sum += chosen[i];
    return sum;
}

brio_status brio_thin(brio_context *ctx, const double *points, size_t num_points, double spacing, uint8_t *chosen,
                      size_t *num_chosen) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(ctx);
    thinning t = {.ctx = ctx, .points = points, .num_points = num_points, .chosen = chosen};
    BRIO_REQUIRE(ctx, spacing > 0 && isfinite(spacing), BRIO_ERR_ARGUMENT,
                 "a spacing of %g, expected a finite number above 0", spacing);
    BRIO_TRY(brio_refuse_many(ctx, num_points));
    BRIO_TRY(brio_refuse_not_finite(ctx, points, NULL, num_points, NULL));
    if (num_points) {
        memset(chosen, 0, num_points);
        BRIO_TRY(find_cells(&t, spacing));
        brio_progress_part(ctx, bar, 0, 0.5);
        BRIO_TRY(sort_points(&t));
        BRIO_TRY(thin_all(&t, bar));
    }
    if (num_chosen) *num_chosen = count_chosen(chosen, num_points);
done:
    brio_progress_part(ctx, bar, 0, 1);
    brio_release(ctx, t.keys);
    brio_release(ctx, t.order);
    brio_release(ctx, t.slabs);
    return status;
}
