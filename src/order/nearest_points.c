/* The nearest points of a point, by a k-d tree in place.
 *
 * Of every range the middle point, across the longest side of the range's box, stands in the middle, smaller ones before
 * it, larger ones behind: the tree is the order of the points. A query keeps the nearest points so far in a heap with
 * the farthest on top, and goes into the far half only when the cut is nearer than that.
 *
 * Based on: Friedman, Bentley, Finkel. An algorithm for finding best matches in logarithmic expected time. ACM TOMS
 *           1977. */
#include "order/nearest_points.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/vector.h"
#include <string.h>

enum { LEAF = 8, LARGE = 4096 };

/* --- building --- */

static void swap(double (*point)[3], ptrdiff_t i, ptrdiff_t j) {
    double spare[3];
    memcpy(spare, point[i], sizeof spare);
    memcpy(point[i], point[j], sizeof spare);
    memcpy(point[j], spare, sizeof spare);
}

/* Hoare's selection: nothing before the middle is greater, nothing behind it smaller. */
static void select_middle(double (*point)[3], ptrdiff_t first, ptrdiff_t last, int axis) {
    ptrdiff_t middle = first + (last - first + 1) / 2;
    while (first < last) {
        double pivot = point[first + (last - first) / 2][axis];
        ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (point[i][axis] < pivot) i++;
            while (point[j][axis] > pivot) j--;
            if (i <= j) swap(point, i++, j--);
        }
        if (middle <= j)
            last = j;
        else if (middle >= i)
            first = i;
        else
            return;
    }
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

/* Recursion as deep as the logarithm of the number of points; large halves are left to other threads. */
static void build(const brio_point_tree *t, size_t begin, size_t end) {
    if (end - begin <= LEAF) return;
    size_t middle = begin + (end - begin) / 2;
    t->axis[middle] = (uint8_t)longest_axis(t, begin, end);
    select_middle(t->point, (ptrdiff_t)begin, (ptrdiff_t)end - 1, t->axis[middle]);
    BRIO_OMP(task if (end - begin > LARGE))
    build(t, begin, middle);
    build(t, middle + 1, end);
}

brio_status brio_point_tree_new(brio_context *ctx, const double *points, size_t count, brio_point_tree *out) {
    brio_status status = BRIO_OK;
    *out = (brio_point_tree){.count = count};
    BRIO_TRY(BRIO_ALLOC(ctx, out->point, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->axis, count));
    memcpy(out->point, points, count * sizeof *out->point);
    BRIO_OMP(parallel num_threads(brio_context_threads(ctx)))
    BRIO_OMP(single)
    build(out, 0, count);
done:
    return status;
}

void brio_point_tree_free(brio_context *ctx, brio_point_tree *tree) {
    brio_release(ctx, tree->point);
    brio_release(ctx, tree->axis);
    *tree = (brio_point_tree){0};
}

/* --- queries --- */

typedef struct {
    const brio_point_tree *tree;
    const double *p;
    brio_near_point *heap; /* the farthest first */
    size_t size, wanted;
} query;

static bool is_after(const brio_near_point *a, const brio_near_point *b) {
    if (a->square != b->square) return a->square > b->square;
    for (int k = 0; k < 3; k++)
        if (a->point[k] != b->point[k]) return a->point[k] > b->point[k];
    return false;
}

/* Puts x into the heap of the given size whose top is free. */
static void sift_down(brio_near_point *heap, size_t size, brio_near_point x) {
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < size; i = child) {
        if (child + 1 < size && is_after(&heap[child + 1], &heap[child])) child++;
        if (!is_after(&heap[child], &x)) break;
        heap[i] = heap[child];
    }
    heap[i] = x;
}

static void offer(query *q, const double *point) {
    brio_near_point x = {brio_square_distance(q->p, point), point};
    if (q->size == q->wanted) {
        if (is_after(&q->heap[0], &x)) sift_down(q->heap, q->size, x);
        return;
    }
    size_t i = q->size++;
    for (; i > 0 && is_after(&x, &q->heap[(i - 1) / 2]); i = (i - 1) / 2) q->heap[i] = q->heap[(i - 1) / 2];
    q->heap[i] = x;
}

static void look(query *q, size_t begin, size_t end) {
    const brio_point_tree *t = q->tree;
    if (end - begin <= LEAF) {
        for (size_t i = begin; i < end; i++) offer(q, t->point[i]);
        return;
    }
    size_t middle = begin + (end - begin) / 2;
    double across = q->p[t->axis[middle]] - t->point[middle][t->axis[middle]];
    offer(q, t->point[middle]);
    across < 0 ? look(q, begin, middle) : look(q, middle + 1, end);
    if (q->size == q->wanted && across * across >= q->heap[0].square) return;
    across < 0 ? look(q, middle + 1, end) : look(q, begin, middle);
}

size_t brio_nearest_points(const brio_point_tree *tree, const double *p, size_t wanted, brio_near_point *near) {
    query q = {.tree = tree, .p = p, .heap = near, .wanted = wanted};
    look(&q, 0, tree->count);
    for (size_t size = q.size; size > 1;) { /* sorted from the end */
        brio_near_point farthest = near[0];
        size--;
        sift_down(near, size, near[size]);
        near[size] = farthest;
    }
    return q.size;
}
