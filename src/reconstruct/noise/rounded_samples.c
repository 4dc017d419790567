/* Undoing the rounding of depths.
 *
 * A depth that is rounded is known to half a step. Of all surfaces that keep to this the smoothest is taken: the sum of
 * squares of differences between each depth and the mean of its neighbours', and then of the differences of these
 * differences, is made small. So a flat piece between two steps becomes the slope from one step to the other.
 *
 * Neighbours are the nearest samples where a step counts as much as the spacing on one level: otherwise the nearest
 * samples of one on a wide level would all be on the same, and see no step. They are found among images of the samples.
 * If the scanner's place is known, that is exp(angle * number of the level) times the unit vector towards the sample,
 * which keeps angles; else the sample with its depth replaced by spacing * number of the level.
 *
 * Based on: Beck, Teboulle. A fast iterative shrinkage-thresholding algorithm for linear inverse problems. SIAM J.
 *           Imaging Sciences 2009 (steps with momentum, each followed by a projection onto what is allowed).
 *           Carrara, Bitelli, Carla. Comparison of techniques for generating digital terrain models from contour lines.
 *           IJGIS 1997 (steps of contours become slopes). */
#include "reconstruct/noise/sample_noise.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "query/nearest_points.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* NEAR: neighbours. MEANS: passes that make the first differences small; BENDS: the second ones, after them. Chosen on
 * simulated frames with steps of 2 to 8 pixels: more passes gain little. FEWEST: samples that are looked at at all. */
enum { NEAR = 8, MEANS = 50, BENDS = 100, FEWEST = 500, SAMPLES_A_THREAD = 1 << 12 };

/* A ray whose cosine with the direction of depth is less is none of a camera. Chosen. */
static const double LEAST_COSINE = 0.1;

/* The samples in the order of the tree of their images. Heights are counted in steps. */
typedef struct {
    const brio_step_levels *levels;
    const double *points; /* the caller's, in their order */
    const double *place;  /* of the scanner, or NULL */
    brio_point_tree tree;
    uint32_t *level;                     /* #P: levels->count if on none */
    uint32_t (*near)[NEAR];              /* #P */
    uint8_t *count;                      /* #P: neighbours, on the same level or the next */
    double *height, *spare, *mean, *old; /* #P */
    double push;                         /* of the momentum */
} rounded;

/* --- neighbours --- */

/* Writes the image of a point: where a step is as long as a spacing is wide. */
static void image_of(const rounded *r, const double *p, double *out) {
    const brio_step_levels *l = r->levels;
    size_t level = brio_level_of(l, p);
    double number = level < l->count ? l->number[level] : l->number[l->count - 1] + 1.0;
    if (r->place || l->is_distance) {
        const double to[3] = {p[0] - l->place[0], p[1] - l->place[1], p[2] - l->place[2]};
        double grow = exp(l->angle * (number - l->number[l->count - 1])) / fmax(brio_length(to), 0x1p-500);
        for (int k = 0; k < 3; k++) out[k] = grow * to[k];
    } else {
        double more = l->spacing * number - brio_dot(p, l->direction);
        for (int k = 0; k < 3; k++) out[k] = p[k] + more * l->direction[k];
    }
}

static bool are_beside(const rounded *r, uint32_t p, uint32_t q) {
    const brio_step_levels *l = r->levels;
    if (r->level[p] == l->count || r->level[q] == l->count) return false;
    return abs(l->number[r->level[p]] - l->number[r->level[q]]) <= 1;
}

static void find_near(void *user, size_t begin, size_t end, int thread) {
    const rounded *r = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        brio_near_point near[BRIO_NEAR_ROOM];
        size_t count = brio_nearest_points(&r->tree, r->tree.point[p], NEAR + 1, INFINITY, near);
        r->count[p] = 0;
        for (size_t k = 0; k < count && r->count[p] < NEAR; k++)
            if (near[k].place != p && are_beside(r, (uint32_t)p, near[k].place))
                r->near[p][r->count[p]++] = near[k].place;
    }
}

static brio_status find_neighbours(brio_context *ctx, rounded *r, size_t count, int threads) {
    brio_status status = BRIO_OK;
    double *image = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, image, 3 * count));
    for (size_t p = 0; p < count; p++) image_of(r, r->points + 3 * p, image + 3 * p);
    BRIO_TRY(brio_point_tree_new(ctx, image, count, &r->tree));
    brio_release(ctx, image);
    image = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, r->level, count));
    BRIO_TRY(BRIO_ALLOC(ctx, r->near, count));
    BRIO_TRY(BRIO_ALLOC(ctx, r->count, count));
    for (size_t p = 0; p < count; p++)
        r->level[p] = (uint32_t)brio_level_of(r->levels, r->points + 3 * (size_t)r->tree.index[p]);
    BRIO_TRY(brio_for(ctx, threads, count, find_near, r));
done:
    brio_release(ctx, image);
    return status;
}

/* --- heights --- */

/* Returns a height as far as its level allows. */
static double allowed(const rounded *r, size_t p, double height) {
    double middle = r->levels->number[r->level[p]];
    return fmin(fmax(height, middle - 0.5), middle + 0.5);
}

static double mean_near(const rounded *r, const double *height, size_t p) {
    double sum = 0;
    for (size_t k = 0; k < r->count[p]; k++) sum += height[r->near[p][k]];
    return sum / r->count[p];
}

/* Makes the first differences smaller, in one pass: reads `height`, writes `spare`. */
static void take_means(void *user, size_t begin, size_t end, int thread) {
    const rounded *r = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        r->spare[p] = r->count[p] ? allowed(r, p, mean_near(r, r->height, p)) : r->height[p];
}

/* Goes on with the momentum, in `spare`: the first half of a pass that makes the second differences small. */
static void go_on(void *user, size_t begin, size_t end, int thread) {
    const rounded *r = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) r->spare[p] = r->height[p] + r->push * (r->height[p] - r->old[p]);
}

static void find_half_means(void *user, size_t begin, size_t end, int thread) {
    const rounded *r = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        r->mean[p] = r->count[p] ? 0.5 * (r->spare[p] + mean_near(r, r->spare, p)) : r->spare[p];
}

/* Writes heights whose difference from their means is the mean of their neighbours' differences. */
static void bend_less(void *user, size_t begin, size_t end, int thread) {
    const rounded *r = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        r->old[p] = r->height[p];
        if (r->count[p] == 0) continue;
        double mean = r->mean[p], of_means = 0.5 * (mean + mean_near(r, r->mean, p));
        r->height[p] = allowed(r, p, mean + (mean - of_means));
    }
}

static brio_status smooth_heights(brio_context *ctx, rounded *r, size_t count, int threads) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, r->height, count));
    BRIO_TRY(BRIO_ALLOC(ctx, r->spare, count));
    BRIO_TRY(BRIO_ALLOC(ctx, r->mean, count));
    BRIO_TRY(BRIO_ALLOC(ctx, r->old, count));
    for (size_t p = 0; p < count; p++)
        r->height[p] = r->level[p] < r->levels->count ? r->levels->number[r->level[p]] : 0;
    for (int pass = 0; pass < MEANS; pass++) {
        BRIO_TRY(brio_for(ctx, threads, count, take_means, r));
        double *written = r->spare;
        r->spare = r->height, r->height = written;
    }
    memcpy(r->old, r->height, count * sizeof *r->old);
    for (int pass = 0; pass < BENDS; pass++) {
        r->push = pass / (pass + 3.0);
        BRIO_TRY(brio_for(ctx, threads, count, go_on, r));
        BRIO_TRY(brio_for(ctx, threads, count, find_half_means, r));
        BRIO_TRY(brio_for(ctx, threads, count, bend_less, r));
    }
done:
    return status;
}

/* --- samples --- */

/* Moves a sample along its ray, or along the direction of depth where no scanner is known, by a share of a step. */
static void move(const rounded *r, double more, double *p) {
    const brio_step_levels *l = r->levels;
    double d[3] = {l->direction[0], l->direction[1], l->direction[2]}, along = 1;
    if (r->place || l->is_distance) {
        double to[3] = {p[0] - l->place[0], p[1] - l->place[1], p[2] - l->place[2]}, length = brio_length(to);
        for (int k = 0; k < 3 && length > 0; k++) to[k] /= length;
        along = l->is_distance ? 1 : brio_dot(to, l->direction);
        if (fabs(along) > LEAST_COSINE)
            memcpy(d, to, sizeof d);
        else
            along = 1;
    }
    for (int k = 0; k < 3; k++) p[k] += more / along * d[k];
}

static size_t move_all(const rounded *r, double *points, size_t count) {
    size_t moved = 0;
    for (size_t p = 0; p < count; p++) {
        if (r->count[p] == 0) continue;
        double more = r->height[p] - r->levels->number[r->level[p]];
        move(r, more * r->levels->step[r->level[p]], points + 3 * (size_t)r->tree.index[p]);
        moved += more != 0;
    }
    return moved;
}

static void release(brio_context *ctx, rounded *r) {
    brio_point_tree_free(ctx, &r->tree);
    brio_release(ctx, r->level);
    brio_release(ctx, r->near);
    brio_release(ctx, r->count);
    brio_release(ctx, r->height);
    brio_release(ctx, r->spare);
    brio_release(ctx, r->mean);
    brio_release(ctx, r->old);
}

brio_status brio_unround_samples(brio_context *ctx, double *points, size_t count, const double *place,
                                 brio_rounding *out) {
    brio_status status = BRIO_OK;
    brio_step_levels levels = {0};
    rounded r = {.levels = &levels, .points = points, .place = place};
    int threads = brio_threads(ctx, count, SAMPLES_A_THREAD);
    *out = (brio_rounding){0};
    if (count < FEWEST) goto done;
    BRIO_TRY(brio_find_step_levels(ctx, points, count, place, &levels));
    if (levels.count == 0) goto done;
    BRIO_TRY(find_neighbours(ctx, &r, count, threads));
    BRIO_TRY(smooth_heights(ctx, &r, count, threads));
    out->moved = move_all(&r, points, count);
    out->step = levels.coarse;
done:
    release(ctx, &r);
    brio_step_levels_free(ctx, &levels);
    return status;
}
