/* Nearest points of a query point, by a k-d tree in place.
 *
 * Each range of the array holds its median along the longest side of its box in the middle, smaller points before it
 * and larger ones behind. So the order of the points is the tree. The other coordinates break ties, and short ranges
 * are sorted. So the tree does not depend on the order of the input.
 *
 * A query lists each point it meets that is not farther than its bound. When the list is full, the query keeps the
 * `wanted` nearest points and lowers the bound to the distance of the last of them. It enters the far half of a range
 * only when the cut is within the bound.
 *
 * Based on: Friedman, Bentley, Finkel. An algorithm for finding best matches in logarithmic expected time. ACM TOMS
 * 1977. */
#include "query/nearest_points.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/vector.h"
#include "base/halving.h"
#include <math.h>
#include <string.h>

enum { LEAF = BRIO_TREE_LEAF, POINTS_A_PIECE = 4096 };
_Static_assert(BRIO_NEAR_ROOM >= 2 * BRIO_MOST_NEAR + LEAF, "a full list has room for one range more");

/* --- building --- */

static bool is_before_in_others(const double *a, const double *b, int axis) {
    int k = (axis + 1) % 3, l = (axis + 2) % 3;
    return a[k] != b[k] ? a[k] < b[k] : a[l] < b[l];
}

/* Returns whether a comes before b along an axis; the other two coordinates break ties. */
static inline bool is_before(const double *a, const double *b, int axis) {
    return a[axis] != b[axis] ? a[axis] < b[axis] : is_before_in_others(a, b, axis);
}

static inline void swap(const brio_point_tree *t, ptrdiff_t i, ptrdiff_t j) {
    double spare[3];
    uint32_t index = t->index[i];
    memcpy(spare, t->point[i], sizeof spare);
    memcpy(t->point[i], t->point[j], sizeof spare);
    memcpy(t->point[j], spare, sizeof spare);
    t->index[i] = t->index[j];
    t->index[j] = index;
}

/* Selects by Hoare's method: afterwards no point before the middle is greater than the middle, and none behind it
 * smaller. */
static void select_middle(const brio_point_tree *t, ptrdiff_t first, ptrdiff_t last, int axis) {
    ptrdiff_t middle = first + (last - first + 1) / 2;
    while (first < last) {
        double pivot[3];
        memcpy(pivot, t->point[first + (last - first) / 2], sizeof pivot);
        ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (is_before(t->point[i], pivot, axis)) i++;
            while (is_before(pivot, t->point[j], axis)) j--;
            if (i <= j) swap(t, i++, j--);
        }
        if (middle <= j)
            last = j;
        else if (middle >= i)
            first = i;
        else
            return;
    }
}

static void sort_leaf(const brio_point_tree *t, size_t begin, size_t end) {
    for (size_t i = begin + 1; i < end; i++)
        for (size_t j = i; j > begin && is_before(t->point[j], t->point[j - 1], 0); j--)
            swap(t, (ptrdiff_t)j, (ptrdiff_t)j - 1);
}

static int longest_axis(const brio_point_tree *t, size_t begin, size_t end) {
    int axis = 0;
    double longest = -1;
    for (int k = 0; k < 3; k++) {
        double low = t->point[begin][k], high = low;
        for (size_t i = begin + 1; i < end; i++) {
            double x = t->point[i][k];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        if (high - low > longest) longest = high - low, axis = k;
    }
    return axis;
}

/* Moves the median of a range to its middle. */
static void cut(const void *user, size_t begin, size_t middle, size_t end) {
    const brio_point_tree *t = user;
    t->axis[middle] = (uint8_t)longest_axis(t, begin, end);
    select_middle(t, (ptrdiff_t)begin, (ptrdiff_t)end - 1, t->axis[middle]);
}

/* Builds the tree of a range. The recursion is as deep as the logarithm of the number of points. */
static void build(const void *user, size_t begin, size_t end, int depth) {
    const brio_point_tree *t = user;
    if (end - begin <= LEAF) {
        sort_leaf(t, begin, end);
        return;
    }
    size_t middle = begin + (end - begin) / 2;
    cut(t, begin, middle, end);
    build(t, begin, middle, depth + 1);
    build(t, middle + 1, end, depth + 1);
}

brio_status brio_point_tree_new(brio_context *ctx, const double *points, size_t count, brio_point_tree *out) {
    brio_status status = BRIO_OK;
    *out = (brio_point_tree){.count = count};
    BRIO_REQUIRE(ctx, count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu points, the limit is 2^32 - 2", count);
    BRIO_TRY(BRIO_ALLOC(ctx, out->point, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->index, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->axis, count));
    if (count) memcpy(out->point, points, count * sizeof *out->point);
    BRIO_TRY(
        brio_refuse_not_finite(ctx, *out->point, NULL, count, NULL)); /* the copy: the points may change meanwhile */
    for (size_t i = 0; i < count; i++) out->index[i] = (uint32_t)i;
    brio_halve(ctx, &(brio_halving){
                        .count = count, .gap = 1, .least = POINTS_A_PIECE, .cut = cut, .finish = build, .user = out});
done:
    return status;
}

void brio_point_tree_free(brio_context *ctx, brio_point_tree *tree) {
    brio_release(ctx, tree->point);
    brio_release(ctx, tree->index);
    brio_release(ctx, tree->axis);
    *tree = (brio_point_tree){0};
}

/* --- queries --- */

typedef struct {
    const brio_point_tree *tree;
    double p[3];
    brio_near_point *near; /* in the order in which the query met them */
    size_t size, wanted;
    double bound; /* square of a distance; no farther point is among the nearest */
} query;

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

/* Returns whether fewer than `room` listed points at the bound come before the point at `place`. Among duplicates the
 * lower place comes first. */
static bool has_place(const query *q, uint32_t place, size_t room) {
    const double *point = q->tree->point[place];
    size_t before = 0;
    for (size_t i = 0; i < q->size; i++) {
        if (q->near[i].square != q->bound) continue;
        const double *other = q->tree->point[q->near[i].place];
        before += is_before(other, point, 0) || (!is_before(point, other, 0) && q->near[i].place < place);
    }
    return before < room;
}

/* Keeps the nearest `wanted` points of the list, in the list's order. Sets the bound to the distance of the last of
 * them. */
static void keep_nearest(query *q) {
    double square[BRIO_NEAR_ROOM];
    size_t kept = 0, less = 0, equal = 0;
    for (size_t i = 0; i < q->size; i++) square[i] = q->near[i].square;
    q->bound = select_least(square, q->size, q->wanted - 1);
    for (size_t i = 0; i < q->size; i++) less += q->near[i].square < q->bound, equal += q->near[i].square == q->bound;
    uint64_t out[(BRIO_NEAR_ROOM + 63) / 64] = {0}; /* bits of list entries to drop */
    for (size_t i = 0; i < q->size && less + equal > q->wanted; i++)
        if (q->near[i].square == q->bound && !has_place(q, q->near[i].place, q->wanted - less))
            out[i / 64] |= UINT64_C(1) << i % 64;
    for (size_t i = 0; i < q->size; i++) {
        q->near[kept] = q->near[i];
        kept += q->near[i].square <= q->bound && !(out[i / 64] >> i % 64 & 1);
    }
    q->size = kept;
}

/* Lists the points of a range that are within the bound. A point beyond the bound is written too, and overwritten
 * next. */
static inline void offer(query *q, size_t begin, size_t end) {
    if (q->size >= 2 * q->wanted) keep_nearest(q);
    for (size_t i = begin; i < end; i++) {
        double square = brio_square_distance(q->p, q->tree->point[i]);
        q->near[q->size] = (brio_near_point){square, (uint32_t)i};
        q->size += square <= q->bound;
    }
}

static void look(query *q, size_t begin, size_t end) {
    if (end - begin <= LEAF) {
        offer(q, begin, end);
        return;
    }
    const brio_point_tree *t = q->tree;
    size_t middle = begin + (end - begin) / 2;
    double across = q->p[t->axis[middle]] - t->point[middle][t->axis[middle]];
    if (across < 0)
        look(q, begin, middle);
    else
        look(q, middle + 1, end);
    if (isinf(q->bound) && q->size >= q->wanted) keep_nearest(q); /* the points that remain are usually farther */
    if (across * across > q->bound) return;
    offer(q, middle, middle + 1);
    if (across < 0)
        look(q, middle + 1, end);
    else
        look(q, begin, middle);
}

size_t brio_nearest_points(const brio_point_tree *tree, const double *p, size_t wanted, double bound,
                           brio_near_point *near) {
    query q = {.tree = tree, .p = {p[0], p[1], p[2]}, .near = near, .wanted = wanted, .bound = bound};
    look(&q, 0, tree->count);
    if (q.size > wanted) keep_nearest(&q);
    return q.size;
}

static double nearest_in(const brio_point_tree *t, const double *p, size_t begin, size_t end, double best) {
    if (end - begin <= LEAF) {
        for (size_t i = begin; i < end; i++) {
            double square = brio_square_distance(p, t->point[i]);
            best = square < best ? square : best;
        }
        return best;
    }
    size_t middle = begin + (end - begin) / 2;
    double across = p[t->axis[middle]] - t->point[middle][t->axis[middle]];
    bool below = across < 0;
    double square = brio_square_distance(p, t->point[middle]);
    best = square < best ? square : best;
    best = below ? nearest_in(t, p, begin, middle, best) : nearest_in(t, p, middle + 1, end, best);
    if (across * across >= best) return best;
    return below ? nearest_in(t, p, middle + 1, end, best) : nearest_in(t, p, begin, middle, best);
}

double brio_nearest_square(const brio_point_tree *tree, const double *p, double best) {
    return nearest_in(tree, p, 0, tree->count, best);
}

/* Returns whether a is nearer than b; ties are lexicographic. */
static inline bool is_nearer(const brio_point_tree *t, const brio_near_point *a, const brio_near_point *b) {
    if (a->square != b->square) return a->square < b->square;
    return is_before(t->point[a->place], t->point[b->place], 0);
}

void brio_sort_near_points(const brio_point_tree *tree, brio_near_point *near, size_t count) {
    for (size_t i = 1; i < count; i++) {
        brio_near_point x = near[i];
        size_t j = i;
        for (; j > 0 && is_nearer(tree, &x, &near[j - 1]); j--) near[j] = near[j - 1];
        near[j] = x;
    }
}
