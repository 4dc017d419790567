/* Nearest points of a query point, by a k-d tree in place.
 *
 * Each range of the array holds its median along the longest side of its box in the middle, smaller points before it
 * and larger ones behind. So the order of the points is the tree. The other coordinates break ties, and short ranges
 * are sorted. So the tree does not depend on the order of the input.
 *
 * A query lists the points it meets that are not farther than its bound (near_list.h). It enters the far half of a
 * range only when the half is within the bound, by its distances along all axes: by that to the cut alone, a query far
 * from a cluster would meet all of the cluster. Of a range of duplicates it lists as many as are wanted, and it ends
 * when it has as many where it is: else a query among n duplicates would meet them all.
 *
 * Based on: Friedman, Bentley, Finkel. An algorithm for finding best matches in logarithmic expected time. ACM TOMS
 * 1977.
 *           Arya, Mount. Algorithms for fast vector quantization. DCC 1993 (distances of ranges).
 * Differs from the papers: ties, and duplicates. */
#include "query/nearest_points.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/halving.h"
#include "base/scale.h"
#include "query/near_list.h"
#include <assert.h>
#include <string.h>

enum {
    LEAF = BRIO_TREE_LEAF,
    POINTS_A_PIECE = 4096,
    DUPLICATES = 3 /* in place of an axis: the range has one position */
};

/* --- building --- */

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
    assert(0 <= first && first <= last && axis < 3);
    ptrdiff_t middle = first + (last - first + 1) / 2;
    while (first < last) {
        double pivot[3];
        memcpy(pivot, t->point[first + (last - first) / 2], sizeof pivot);
        ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (brio_is_before(t->point[i], pivot, axis)) i++;
            while (brio_is_before(pivot, t->point[j], axis)) j--;
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
        for (size_t j = i; j > begin && brio_is_before(t->point[j], t->point[j - 1], 0); j--)
            swap(t, (ptrdiff_t)j, (ptrdiff_t)j - 1);
}

/* Returns the axis along which a range is longest, or DUPLICATES. */
static int longest_axis(const brio_point_tree *t, size_t begin, size_t end) {
    int axis = DUPLICATES;
    double longest = 0;
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
    assert(begin <= middle && middle < end && end <= t->count);
    t->axis[middle] = (uint8_t)longest_axis(t, begin, end);
    if (t->axis[middle] != DUPLICATES) select_middle(t, (ptrdiff_t)begin, (ptrdiff_t)end - 1, t->axis[middle]);
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

brio_status brio_point_tree_scaled(brio_context *ctx, const double *points, size_t count, int exponent,
                                   brio_point_tree *out) {
    brio_status status = BRIO_OK;
    *out = (brio_point_tree){.count = count};
    BRIO_TRY(brio_refuse_many(ctx, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->point, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->index, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->axis, count));
    if (count) memcpy(out->point, points, count * sizeof *out->point);
    if (exponent) BRIO_TRY(brio_scale(ctx, *out->point, 3 * count, exponent, *out->point));
    BRIO_TRY(
        brio_refuse_not_finite(ctx, *out->point, NULL, count, NULL)); /* the copy: the points may change meanwhile */
    for (size_t i = 0; i < count; i++) out->index[i] = (uint32_t)i;
    status = brio_halve(
        ctx,
        &(brio_halving){.count = count, .gap = 1, .least = POINTS_A_PIECE, .cut = cut, .finish = build, .user = out});
done:
    return status;
}

brio_status brio_point_tree_new(brio_context *ctx, const double *points, size_t count, brio_point_tree *out) {
    return brio_point_tree_scaled(ctx, points, count, 0, out);
}

void brio_point_tree_free(brio_context *ctx, brio_point_tree *tree) {
    brio_release(ctx, tree->point);
    brio_release(ctx, tree->index);
    brio_release(ctx, tree->axis);
    *tree = (brio_point_tree){0};
}

/* --- queries --- */

/* Lists the first duplicates of a range: those behind them come after them. */
static void look_at_duplicates(brio_near_list *l, size_t begin, size_t end) {
    if (end - begin > l->wanted) end = begin + l->wanted;
    for (; begin + LEAF < end; begin += LEAF) brio_offer_points(l, begin, begin + LEAF);
    brio_offer_points(l, begin, end);
}

/* Lists points of a range.   off  along each axis, how far the range is from the position at least. Squares of these
 * sum to no more than the computed square of any point, because each step rounds in the same direction. */
static void look(brio_near_list *l, const brio_point_tree *t, size_t begin, size_t end, double off[3]) {
    if (brio_is_settled(l)) return;
    if (end - begin <= LEAF) {
        brio_offer_points(l, begin, end);
        return;
    }
    size_t middle = begin + (end - begin) / 2;
    if (t->axis[middle] == DUPLICATES) {
        look_at_duplicates(l, begin, end);
        return;
    }
    int axis = t->axis[middle];
    assert(axis < 3);
    double across = l->p[axis] - t->point[middle][axis], before = off[axis];
    if (across < 0)
        look(l, t, begin, middle, off);
    else
        look(l, t, middle + 1, end, off);
    if (isinf(l->bound) && l->size >= l->wanted) brio_keep_nearest(l); /* the points that remain are usually farther */
    off[axis] = across;
    if (brio_dot(off, off) <= l->bound) {
        brio_offer_points(l, middle, middle + 1);
        if (across < 0)
            look(l, t, middle + 1, end, off);
        else
            look(l, t, begin, middle, off);
    }
    off[axis] = before;
}

void brio_offer_tree(brio_near_list *l, const brio_point_tree *tree) {
    look(l, tree, 0, tree->count, (double[3]){0, 0, 0});
}

size_t brio_nearest_points(const brio_point_tree *tree, const double *p, size_t wanted, double bound,
                           brio_near_point *near) {
    brio_near_list l = brio_near_list_for((const double(*)[3])tree->point, p, wanted, near);
    assert(0 < wanted && wanted <= BRIO_MOST_NEAR && !(bound < 0));
    l.bound = bound;
    brio_offer_tree(&l, tree);
    if (l.size > wanted) brio_keep_nearest(&l);
    assert(l.size <= wanted);
    return l.size;
}

static double nearest_in(const brio_point_tree *t, const double *p, size_t begin, size_t end, double best,
                         double off[3]) {
    if (end - begin <= LEAF) {
        for (size_t i = begin; i < end; i++) {
            double square = brio_square_distance(p, t->point[i]);
            best = square < best ? square : best;
        }
        return best;
    }
    size_t middle = begin + (end - begin) / 2;
    int axis = t->axis[middle];
    if (axis == DUPLICATES) return fmin(best, brio_square_distance(p, t->point[middle]));
    assert(axis < 3);
    double across = p[axis] - t->point[middle][axis], before = off[axis];
    bool below = across < 0;
    double square = brio_square_distance(p, t->point[middle]);
    best = square < best ? square : best;
    best = below ? nearest_in(t, p, begin, middle, best, off) : nearest_in(t, p, middle + 1, end, best, off);
    off[axis] = across;
    if (brio_dot(off, off) < best)
        best = below ? nearest_in(t, p, middle + 1, end, best, off) : nearest_in(t, p, begin, middle, best, off);
    off[axis] = before;
    return best;
}

double brio_nearest_square(const brio_point_tree *tree, const double *p, double best) {
    return nearest_in(tree, p, 0, tree->count, best, (double[3]){0, 0, 0});
}

void brio_sort_near_points(const brio_point_tree *tree, brio_near_point *near, size_t count) {
    brio_sort_near_list((const double(*)[3])tree->point, near, count);
}
