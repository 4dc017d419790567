/* The nearest points that a search has met so far.
 *
 * The k-th least distance is found by counting: how many distances are within a limit, between two limits that hold too
 * few and too many. The next limit is where the k-th would be if the distances were spread evenly between these two, as
 * the squares of the distances of points of a surface are. Counting reads all numbers side by side and has no branch.
 * After TRIES limits, and where the distance is that of several points, a selection goes on. */
#include "query/near_list.h"
#include <string.h>

enum { TRIES = 8 };
_Static_assert(BRIO_NEAR_ROOM >= 2 * BRIO_MOST_NEAR + BRIO_TREE_LEAF, "a full list has room for one range more");

/* Returns the k-th least of `count` numbers, k counted from 0. Overwrites x. Has no branches that depend on single
 * numbers. */
static double select_least(double *x, size_t count, size_t k) {
    double more[BRIO_NEAR_ROOM];
    for (;;) {
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

static size_t count_within(const double *x, size_t count, double limit) {
    int64_t within = 0;
    for (size_t i = 0; i < count; i++) within += x[i] <= limit;
    return (size_t)within;
}

static double greatest_within(const double *x, size_t count, double limit) {
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        double now = x[i] <= limit ? x[i] : 0;
        most = now > most ? now : most;
    }
    return most;
}

/* Returns the `wanted`-th least of `count` numbers that are not negative. Overwrites x. */
static double find_bound(double *x, size_t count, size_t wanted) {
    double low = 0, high = greatest_within(x, count, INFINITY);
    size_t below = 0, above = count; /* numbers within `low` and within `high` */
    for (int n = 0; n < TRIES && high < INFINITY; n++) {
        double limit = low + (high - low) * ((double)(wanted - below) / (double)(above - below));
        size_t within = count_within(x, count, limit);
        if (within == wanted) return greatest_within(x, count, limit);
        if (within < wanted)
            low = limit, below = within;
        else
            high = limit, above = within;
    }
    return select_least(x, count, wanted - 1);
}

/* Returns whether fewer than `room` listed points at the bound come before the point at `place`. Among duplicates the
 * lower place comes first. */
static bool has_place(const brio_near_list *l, uint32_t place, size_t room) {
    const double *point = l->point[place];
    size_t before = 0;
    for (size_t i = 0; i < l->size; i++) {
        if (l->near[i].square != l->bound) continue;
        const double *other = l->point[l->near[i].place];
        before += brio_is_before(other, point, 0) || (!brio_is_before(point, other, 0) && l->near[i].place < place);
    }
    return before < room;
}

/* Sets the bits of the entries at the bound that have no place, where `less` points are nearer than the bound. */
static void mark_out(const brio_near_list *l, size_t less, uint64_t *out) {
    for (size_t i = 0; i < l->size; i++)
        if (l->near[i].square == l->bound && !has_place(l, l->near[i].place, l->wanted - less))
            out[i / 64] |= UINT64_C(1) << i % 64;
}

void brio_keep_nearest(brio_near_list *l) {
    double square[BRIO_NEAR_ROOM];
    size_t kept = 0, less = 0, within = 0;
    for (size_t i = 0; i < l->size; i++) square[i] = l->near[i].square;
    l->bound = find_bound(square, l->size, l->wanted);
    for (size_t i = 0; i < l->size; i++) within += l->near[i].square <= l->bound, less += l->near[i].square < l->bound;
    uint64_t out[(BRIO_NEAR_ROOM + 63) / 64] = {0}; /* bits of list entries to drop */
    if (within > l->wanted) mark_out(l, less, out);
    for (size_t i = 0; i < l->size; i++) {
        l->near[kept] = l->near[i];
        kept += l->near[i].square <= l->bound && !(out[i / 64] >> i % 64 & 1);
    }
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
