/* Finds outliers: points that are much farther from their neighbours than these are from theirs.
 *
 * The spacing of a point is its mean distance to its k nearest points. A point is an outlier if its spacing is more
 * than `factor` times the lower quartile of the spacings of its k nearest points. The comparison is with the
 * surroundings and not with all points, so where a scan becomes sparse by and by nothing is dropped. In space far from
 * the scan the neighbours of an outlier are outliers, too. So a point is also an outlier if the logarithm of its
 * spacing is DEVIATIONS robust standard deviations above the median of these logarithms (the median absolute deviation
 * times 1.4826). A spacing up to factor^2 times the median is always allowed by this rule. Nothing here depends on the
 * unit, so points far from 1 are taken times a power of two: the squares of their distances would be infinite or 0.
 *
 * Spacings are rounded, and so are the coordinates that a file gives. Spacings that differ by rounding alone must not
 * stand out from each other. So each spacing is taken as an interval (`slack_of`): a point is an outlier only if the
 * low end of its spacing is above a threshold that was made of high ends. Logarithms are those of spacings divided by
 * their median: they are the same at every scale by a power of two.
 *
 * Based on: Breunig Kriegel Ng Sander. LOF: identifying density-based local outliers. SIGMOD 2000.
 * Differs from the paper: mean distances instead of reachability distances, a quartile instead of a mean, and the
 * second rule. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/versioned.h"
#include "query/nearest_points.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* POINTS_A_THREAD, GROUP (points between two reports of progress): chosen. */
enum { POINTS_A_THREAD = 1 << 8, CHUNK = 1 << 10, GROUP = 1 << 16 };

/* Derived: where usual coordinates are between 2^-ORDINARY and 2^ORDINARY, squares of their distances are finite, and
 * those of distances 2^-250 times as large are normal numbers. */
enum { ORDINARY = 256 };

/* Chosen on the sets of docs/algorithms.md, with the factor. */
static const double DEVIATIONS = 8;
/* That a factor of 0 stands for; chosen on them, too. */
static const double FACTOR = 3;

/* Half a unit in the last place of 1. */
static const double ROUNDING = 0x1p-53;

typedef struct {
    brio_point_tree tree;
    size_t neighbours;
    double factor;
    double *spacing; /* of the points, in the order of the tree */
    double most;     /* the greatest spacing that the second rule allows */
    uint8_t *outlier;
    size_t first; /* of the points that are being done */
} search;

/* Returns the exponent of the power of two that the points are taken times; 0 for points that are not far from 1. */
static int scale_of(const double *points, size_t num_points) {
    int exponent = brio_usual_exponent(points, num_points);
    return abs(exponent) <= ORDINARY ? 0 : -exponent;
}

/* Finds the nearest points of a point of the tree, without the point itself. */
static size_t find_near(const search *s, size_t place, brio_near_point *near) {
    size_t found = brio_nearest_points(&s->tree, s->tree.point[place], s->neighbours + 1, INFINITY, near), kept = 0;
    brio_sort_near_points(&s->tree, near, found);
    for (size_t i = 0; i < found; i++)
        if (near[i].place != place) near[kept++] = near[i];
    return kept < s->neighbours ? kept : s->neighbours;
}

/* Returns how far the spacing of a point may be from that of the points before they were rounded to doubles. Derived: a
 * squared distance is rounded by 5 units of ROUNDING at most, a root by 4, a sum of k roots by k + 4, their mean by k +
 * 5. Both ends of a distance may be rounded by ROUNDING times their coordinates, along three axes: by 4 times that in
 * all. The neighbours' coordinates exceed those of the point by k spacings at most. */
static double slack_of(const search *s, size_t place) {
    const double *p = s->tree.point[place];
    double greatest = fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2])));
    return ROUNDING * ((double)(5 * s->neighbours + 8) * s->spacing[place] + 4 * greatest);
}

static double low_spacing(const search *s, size_t place) {
    return s->spacing[place] < INFINITY ? s->spacing[place] - slack_of(s, place) : INFINITY;
}

static double high_spacing(const search *s, size_t place) {
    return s->spacing[place] + slack_of(s, place);
}

static void find_spacings(void *user, size_t begin, size_t end, int thread) {
    const search *s = user;
    brio_near_point near[BRIO_NEAR_ROOM];
    (void)thread;
    for (size_t i = s->first + begin; i < s->first + end; i++) {
        size_t found = find_near(s, i, near);
        double sum = 0;
        for (size_t j = 0; j < found; j++) sum += sqrt(near[j].square);
        s->spacing[i] = found ? sum / (double)found : 0;
    }
}

/* Returns the lower quartile of a few numbers, which it sorts. */
static double lower_quartile(double *numbers, size_t count) {
    for (size_t i = 1; i < count; i++) {
        double number = numbers[i];
        size_t j = i;
        for (; j > 0 && numbers[j - 1] > number; j--) numbers[j] = numbers[j - 1];
        numbers[j] = number;
    }
    return numbers[count / 4];
}

static void judge(void *user, size_t begin, size_t end, int thread) {
    const search *s = user;
    brio_near_point near[BRIO_NEAR_ROOM];
    double spacings[BRIO_MOST_NEAR];
    (void)thread;
    for (size_t i = s->first + begin; i < s->first + end; i++) {
        size_t found = find_near(s, i, near);
        for (size_t j = 0; j < found; j++) spacings[j] = high_spacing(s, near[j].place);
        bool stands_out = found && low_spacing(s, i) > s->factor * lower_quartile(spacings, found);
        s->outlier[s->tree.index[i]] = stands_out || low_spacing(s, i) > s->most;
    }
}

/* Finds the median of numbers that are not negative, given as sorting keys. */
static brio_status find_median(brio_context *ctx, const uint64_t *keys, size_t count, double *median) {
    uint64_t bits;
    BRIO_FORWARD(brio_key_of_rank(ctx, keys, count, count / 2, &bits));
    bits &= ~(UINT64_C(1) << 63);
    memcpy(median, &bits, sizeof *median);
    return BRIO_OK;
}

/* Finds the greatest spacing that the second rule allows. Points that coincide with all their nearest points do not
 * count. */
static brio_status find_most(brio_context *ctx, search *s) {
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    size_t count = 0;
    double middle, deviation;
    s->most = INFINITY;
    BRIO_TRY(BRIO_ALLOC(ctx, keys, s->tree.count + 1));
    for (size_t i = 0; i < s->tree.count; i++)
        if (s->spacing[i] > 0) keys[count++] = brio_double_key(high_spacing(s, i));
    if (!count) goto done;
    BRIO_TRY(find_median(ctx, keys, count, &middle));
    count = 0;
    for (size_t i = 0; i < s->tree.count; i++)
        if (s->spacing[i] > 0) keys[count++] = brio_double_key(fabs(log(high_spacing(s, i) / middle)));
    BRIO_TRY(find_median(ctx, keys, count, &deviation));
    s->most = middle * exp(fmax(DEVIATIONS * 1.4826 * deviation, 2 * log(s->factor)));
done:
    brio_release(ctx, keys);
    return status;
}

/* Does all points, a group at a time. */
static brio_status for_all(brio_context *ctx, search *s, brio_part_fn part) {
    size_t n = s->tree.count;
    for (s->first = 0; s->first < n; s->first += GROUP) {
        size_t count = n - s->first < GROUP ? n - s->first : GROUP;
        BRIO_FORWARD(brio_for_chunks(ctx, brio_threads(ctx, count, POINTS_A_THREAD), count, CHUNK, part, s));
        BRIO_FORWARD(brio_progress(ctx, "outliers", (double)(s->first + count) / (double)n));
    }
    return BRIO_OK;
}

static brio_status check(brio_context *ctx, int neighbours, double factor) {
    BRIO_EXPECT(ctx, neighbours >= 1 && neighbours < BRIO_MOST_NEAR, BRIO_ERR_ARGUMENT,
                "outliers by %d neighbours, expected 1 to %d", neighbours, BRIO_MOST_NEAR - 1);
    BRIO_EXPECT(ctx, factor >= 1 && isfinite(factor), BRIO_ERR_ARGUMENT,
                "a factor of %g, expected a finite number, 1 or more", factor);
    return BRIO_OK;
}

brio_status brio_outliers(brio_context *ctx, const double *points, size_t num_points, int neighbours,
                          const brio_outliers_options *options, uint8_t *outlier) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(ctx);
    brio_outliers_options o = {0};
    search s = {.outlier = outlier};
    BRIO_TRY(BRIO_TAKE(ctx, brio_outliers_options, options, &o));
    if (o.factor == 0) o.factor = FACTOR;
    BRIO_TRY(check(ctx, neighbours, o.factor));
    s.neighbours = (size_t)neighbours;
    s.factor = o.factor;
    brio_progress_part(ctx, bar, 0, 0.2);
    BRIO_TRY(brio_progress(ctx, "outliers", 0));
    BRIO_TRY(brio_refuse_many(ctx, num_points));
    BRIO_TRY(brio_point_tree_scaled(ctx, points, num_points, scale_of(points, num_points), &s.tree));
    BRIO_TRY(BRIO_ALLOC(ctx, s.spacing, num_points + 1));
    brio_progress_part(ctx, bar, 0.2, 0.6);
    BRIO_TRY(for_all(ctx, &s, find_spacings));
    BRIO_TRY(find_most(ctx, &s));
    brio_progress_part(ctx, bar, 0.6, 1);
    BRIO_TRY(for_all(ctx, &s, judge));
done:
    brio_progress_part(ctx, bar, 0, 1);
    brio_point_tree_free(ctx, &s.tree);
    brio_release(ctx, s.spacing);
    return status;
}
