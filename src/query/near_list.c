/* The nearest points that a search has met so far.
 *
 * The k-th least distance is found by counting: how many distances are within a limit, between two limits that hold too
 * few and too many. The next limit is where the k-th would be if the distances were spread evenly between these two, as
 * the squares of the distances of points of a surface are. Counting reads all numbers side by side and has no branch.
 * After TRIES limits, and where the distance is that of several points, a selection goes on. */
#include "query/near_list.h"
#include <assert.h>
#include <float.h>
#include <string.h>

enum { TRIES = 8, WIDE = 4, ROOM = (BRIO_NEAR_ROOM + WIDE - 1) / WIDE };
_Static_assert(BRIO_NEAR_ROOM >= 2 * BRIO_MOST_NEAR + BRIO_TREE_LEAF, "a full list has room for one range more");

/* Returns the k-th least of `count` numbers, k counted from 0. Overwrites x. Has no branches that depend on single
 * numbers. */
static double select_least(double *x, size_t count, size_t k) {
    double more[BRIO_NEAR_ROOM];
    for (;;) {
        assert(k < count && count <= BRIO_NEAR_ROOM);
        double pivot = x[count / 2];
        size_t less = 0, greater = 0;
        for (size_t i = 0; i < count; i++) {
            double now = x[i];
            x[less] = now;
            less += now < pivot;
            more[greater] = now;
            greater += now > pivot;
        }
        if (k < less) {
            count = less;
        } else if (k >= count - greater) {
            k -= count - greater;
            count = greater;
            memcpy(x, more, count * sizeof *x);
        } else {
            return pivot;
        }
    }
}

/* Numbers side by side. */
typedef double lanes __attribute__((vector_size(8 * WIDE)));
typedef int64_t lane_bits __attribute__((vector_size(8 * WIDE)));

typedef struct {
    lanes x[ROOM];
    size_t count; /* of lanes; the last ones are filled up with INFINITY */
} numbers;

static size_t count_within(const numbers *n, double limit) {
    lane_bits within = {0};
    for (size_t i = 0; i < n->count; i++) within -= (lane_bits)(n->x[i] <= limit);
    return (size_t)(within[0] + within[1] + within[2] + within[3]);
}

static double greatest_within(const numbers *n, double limit) {
    lanes most = {0};
    for (size_t i = 0; i < n->count; i++) {
        lane_bits more = (lane_bits)(n->x[i] <= limit) & (lane_bits)(n->x[i] > most);
        most = (lanes)(((lane_bits)n->x[i] & more) | ((lane_bits)most & ~more));
    }
    double low = most[0] > most[1] ? most[0] : most[1], high = most[2] > most[3] ? most[2] : most[3];
    return low > high ? low : high;
}

static void take_squares(const brio_near_list *l, numbers *n) {
    double *x = (double *)n->x;
    size_t i = 0;
    for (; i < l->size; i++) x[i] = l->near[i].square;
    for (; i % WIDE; i++) x[i] = INFINITY;
    n->count = i / WIDE;
    assert(n->count <= ROOM);
}

/* Finds the least bound that holds `wanted` points of the list. Returns false if it did not find one: there is none
 * where several points are at one distance. */
static bool find_bound(const brio_near_list *l, double *bound) {
    numbers n;
    take_squares(l, &n);
    double low = 0, high = l->bound < INFINITY ? l->bound : greatest_within(&n, DBL_MAX);
    size_t below = 0, above = l->size; /* points within `low` and within `high` */
    for (int i = 0; i < TRIES; i++) {
        assert(below < l->wanted && l->wanted <= above);
        double limit = low + (high - low) * ((double)(l->wanted - below) / (double)(above - below));
        size_t within = count_within(&n, limit);
        if (within == l->wanted) {
            *bound = greatest_within(&n, limit);
            return true;
        }
        if (within < l->wanted)
            low = limit, below = within;
        else
            high = limit, above = within;
    }
    return false;
}

/* Returns whether the point at place a comes before that at place b. Among duplicates the lower place comes first. */
static bool comes_before(brio_near_list *l, uint32_t a, uint32_t b) {
    const double *p = l->point[a], *q = l->point[b];
    l->compared++;
    return brio_is_before(p, q, 0) || (!brio_is_before(q, p, 0) && a < b);
}

/* Returns the one of `count` places that k of them come before, by Hoare's method. Reorders the places. */
static uint32_t select_place(brio_near_list *l, uint32_t *place, ptrdiff_t count, ptrdiff_t k) {
    ptrdiff_t first = 0, last = count - 1;
    assert(0 <= k && k < count);
    while (first < last) {
        uint32_t pivot = place[first + (last - first) / 2];
        ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (comes_before(l, place[i], pivot)) i++;
            while (comes_before(l, pivot, place[j])) j--;
            if (i > j) break;
            uint32_t spare = place[i];
            place[i++] = place[j], place[j--] = spare;
        }
        if (k <= j)
            last = j;
        else if (k >= i)
            first = i;
        else
            break;
    }
    return place[k];
}

/* Finds the bound by selection, and keeps the points within it that have a place: of those at the bound the first. */
static void keep_by_place(brio_near_list *l) {
    assert(l->wanted <= l->size && l->size <= BRIO_NEAR_ROOM);
    double square[BRIO_NEAR_ROOM];
    uint32_t at_bound[BRIO_NEAR_ROOM];
    size_t kept = 0, less = 0, ties = 0;
    for (size_t i = 0; i < l->size; i++) square[i] = l->near[i].square;
    l->bound = select_least(square, l->size, l->wanted - 1);
    for (size_t i = 0; i < l->size; i++) {
        at_bound[ties] = l->near[i].place;
        less += l->near[i].square < l->bound, ties += l->near[i].square == l->bound;
    }
    uint32_t last = select_place(l, at_bound, (ptrdiff_t)ties, (ptrdiff_t)(l->wanted - less) - 1);
    for (size_t i = 0; i < l->size; i++) {
        const brio_near_point now = l->near[i];
        l->near[kept] = now;
        kept += now.square < l->bound || (now.square == l->bound && !comes_before(l, last, now.place));
    }
    l->size = kept;
    assert(kept == l->wanted);
}

void brio_keep_nearest(brio_near_list *l) {
    double bound;
    size_t kept = 0;
    if (!find_bound(l, &bound)) {
        keep_by_place(l);
        return;
    }
    for (size_t i = 0; i < l->size; i++) {
        l->near[kept] = l->near[i];
        kept += l->near[i].square <= bound;
    }
    assert(kept == l->wanted);
    l->bound = bound;
    l->size = kept;
}

/* Returns whether a is nearer than b; ties are lexicographic. */
static inline bool is_nearer(const double (*point)[3], const brio_near_point *a, const brio_near_point *b) {
    if (a->square != b->square) return a->square < b->square;
    return brio_is_before(point[a->place], point[b->place], 0);
}

void brio_sort_near_list(const double (*point)[3], brio_near_point *near, size_t count) {
    for (size_t i = 1; i < count; i++) {
        brio_near_point x = near[i];
        size_t j = i;
        for (; j > 0 && is_nearer(point, &x, &near[j - 1]); j--) near[j] = near[j - 1];
        near[j] = x;
    }
}
