/* The local feature size, from the poles.
 *
 * Poles converge to the medial axis as the sampling gets denser, so the distance to the nearest pole estimates the
 * distance to the medial axis. The poles lie in a balanced k-d tree without pointers: the middle of a range is its
 * node, split along the axis in which the range is longest.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999.
 *           Bentley. Multidimensional binary search trees used for associative searching. CACM 1975. */
#include "dual/feature_size.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/vector.h"
#include <string.h>

enum { LEAF = 8 };

typedef struct {
    double (*pole)[3];
    uint8_t *axis; /* of each node */
    size_t count;
} pole_tree;

static void swap_poles(double *p, double *q) {
    double kept[3];
    memcpy(kept, p, sizeof kept);
    memcpy(p, q, sizeof kept);
    memcpy(q, kept, sizeof kept);
}

/* Moves the poles first .. last so that the one in the middle is where sorting along the axis would put it. */
static void select_middle(double (*pole)[3], ptrdiff_t first, ptrdiff_t last, int axis) {
    ptrdiff_t middle = first + (last - first + 1) / 2;
    while (first < last) {
        double pivot = pole[first + (last - first) / 2][axis];
        ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (pole[i][axis] < pivot) i++;
            while (pole[j][axis] > pivot) j--;
            if (i <= j) swap_poles(pole[i++], pole[j--]);
        }
        if (middle <= j)
            last = j;
        else if (middle >= i)
            first = i;
        else
            return;
    }
}

static int longest_axis(const pole_tree *t, size_t begin, size_t end) {
    double low[3], high[3];
    for (int k = 0; k < 3; k++) low[k] = high[k] = t->pole[begin][k];
    for (size_t i = begin + 1; i < end; i++)
        for (int k = 0; k < 3; k++) {
            double x = t->pole[i][k];
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    return axis;
}

/* Recursion as deep as the logarithm of the number of poles; large halves are left to other threads. */
static void build(pole_tree *t, size_t begin, size_t end) {
    enum { LARGE = 4096 };
    if (end - begin <= LEAF) return;
    size_t middle = begin + (end - begin) / 2;
    t->axis[middle] = (uint8_t)longest_axis(t, begin, end);
    select_middle(t->pole, (ptrdiff_t)begin, (ptrdiff_t)end - 1, t->axis[middle]);
    BRIO_OMP(task if (end - begin > LARGE))
    build(t, begin, middle);
    build(t, middle + 1, end);
}

static inline double least(double a, double b) {
    return b < a ? b : a;
}

/* The least of `best` and the squared distances from p to the poles of a range. */
static double nearest(const pole_tree *t, const double *p, size_t begin, size_t end, double best) {
    if (end - begin <= LEAF) {
        for (size_t i = begin; i < end; i++) best = least(best, brio_square_distance(p, t->pole[i]));
        return best;
    }
    size_t middle = begin + (end - begin) / 2;
    double across = p[t->axis[middle]] - t->pole[middle][t->axis[middle]];
    best = least(best, brio_square_distance(p, t->pole[middle]));
    bool below = across < 0;
    best = below ? nearest(t, p, begin, middle, best) : nearest(t, p, middle + 1, end, best);
    if (across * across >= best) return best;
    return below ? nearest(t, p, middle + 1, end, best) : nearest(t, p, begin, middle, best);
}

/* Square of the distance from a sample to the nearest pole; its own ones are near to begin with. */
static double nearest_of(const pole_tree *t, const brio_pole_vectors *v, size_t p) {
    double best = INFINITY;
    for (int side = 0; side < 2; side++) {
        size_t own = v->pole[2 * p + (size_t)side];
        if (own < v->num_finite) best = least(best, brio_square_distance(v->points + 3 * p, v->centre + 4 * own));
    }
    return nearest(t, v->points + 3 * p, 0, t->count, best);
}

/* The finite poles, each once. */
static brio_status collect_poles(brio_context *ctx, const brio_pole_vectors *v, pole_tree *tree) {
    brio_status status = BRIO_OK;
    uint8_t *is_pole = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, is_pole, v->num_finite));
    for (size_t i = 0; i < 2 * v->num_points; i++)
        if (v->pole[i] < v->num_finite) tree->count += !is_pole[v->pole[i]], is_pole[v->pole[i]] = 1;
    BRIO_TRY(BRIO_ALLOC(ctx, tree->pole, tree->count));
    BRIO_TRY(BRIO_ALLOC(ctx, tree->axis, tree->count));
    for (size_t tet = 0, n = 0; tet < v->num_finite; tet++)
        if (is_pole[tet]) memcpy(tree->pole[n++], v->centre + 4 * tet, sizeof *tree->pole);
done:
    brio_release(ctx, is_pole);
    return status;
}

brio_status brio_feature_sizes(brio_context *ctx, const brio_pole_vectors *v, double **size) {
    brio_status status = BRIO_OK;
    pole_tree tree = {0};
    double *result = NULL;
    *size = NULL;
    BRIO_TRY(collect_poles(ctx, v, &tree));
    BRIO_TRY(BRIO_ALLOC(ctx, result, v->num_points));
    BRIO_OMP(parallel num_threads(brio_context_threads(ctx)))
    BRIO_OMP(single)
    build(&tree, 0, tree.count);
    BRIO_OMP(parallel for schedule(dynamic, 1024) num_threads(brio_context_threads(ctx)))
    for (size_t p = 0; p < v->num_points; p++) {
        bool vertex = v->pole[2 * p] != BRIO_INFINITE;
        result[p] = vertex ? sqrt(nearest_of(&tree, v, p)) : 0;
    }
    *size = result;
done:
    brio_release(ctx, tree.pole);
    brio_release(ctx, tree.axis);
    return status;
}
