/* Levels on which samples lie because their depths are rounded.
 *
 * A depth camera rounds depths to whole steps, which are often several pixels high. Then nearest points lie exactly in
 * one plane, or on one sphere round the scanner, and show no noise at all. What tells:
 *   1. At one look in ten, the nearest points fill a piece of a plane, more exactly than a scanner measures. Planes of
 *      models do, too.
 *   2. All these planes have one direction, or look at one place. Then depth is measured along this direction, or from
 *      that place.
 *   3. The depths of nearly all samples are few, and stand in steps that change slowly.
 *   4. Planes are on many of these levels. A model has flat sides in few; the rows of a grid, and scan lines, are
 *      levels, too, but no planes lie in them.
 *   5. Steps are higher than the spacing. Lower ones do not hide the noise.
 *
 * Based on: Khoshelham, Oude Elberink. Accuracy and resolution of Kinect depth data for indoor mapping applications.
 *           Sensors 2012 (steps that grow with the square of the depth). */
#include "reconstruct/noise/sample_noise.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "query/point_boxes.h"
#include "reconstruct/noise/local_surface.h"
#include <math.h>
#include <string.h>

/* NEAR: points that a plane is fitted to. LOOKS, LEAST_LOOKS: about how many samples are looked at, and the fewest that
 * are flat. LEAST_LEVELS: in all, and the fewest with planes in them. LEAST_ON: samples of a level. All chosen. */
enum { NEAR = 9, LOOKS = 1000, LEAST_LOOKS = 30, LEAST_LEVELS = 8, LEAST_PLANES = 5, LEAST_ON = 3, PAIRS = 64 };
enum { LOOKS_A_THREAD = 16, MOST_STEPS = 1000 };

/* In spacings. Points are FLAT if they scatter less about a plane, and fill a piece of it if they reach WIDE in both of
 * its directions. Levels are over APART from each other, and under THIN thick. Steps are COARSE and not over
 * COARSEST. Chosen. */
static const double FLAT = 0.02, WIDE = 0.3, APART = 0.1, THIN = 0.05, COARSE = 1.2, COARSEST = 20;

/* SHARE: of the looks that are flat. ONE_WAY: cosine between planes of one direction; MOST: share of the flat looks
 * that have it, of the samples that lie on levels, and of those whose steps are like the next ones, by a factor of
 * ALIKE. Chosen. */
static const double SHARE = 0.1, ONE_WAY = 0.9999, LOOKS_AT = 0.99, MOST = 0.8, ALIKE = 1.6;

/* What is seen at a sample. */
typedef struct {
    double spacing; /* 0: its nearest points fill no piece of a plane */
    double normal[3];
    const double *point;
} flat_look;

typedef struct {
    const brio_point_boxes *boxes;
    size_t stride;
    flat_look *look;
} looking;

static void look(const looking *l, size_t i) {
    brio_near_point near[BRIO_NEAR_ROOM];
    brio_neighbourhood n = {.count = 0};
    brio_local_surface s;
    double reach[2] = {0, 0}, sum = 0;
    bool fitted;
    flat_look *out = &l->look[i];
    const double *p = out->point = l->boxes->point[i * l->stride];
    size_t count = brio_nearest_in_boxes(l->boxes, i * l->stride, NEAR, near);
    for (size_t k = 0; k < count; k++) {
        brio_add_neighbour(&n, p, l->boxes->point[near[k].place]);
        sum += sqrt(near[k].square);
    }
    out->spacing = 0;
    if (count < NEAR) return;
    double spacing = sum / NEAR, spread = brio_plane_spread(&n);
    brio_fit_local_surfaces(&n, 1, &s, &fitted);
    if (!fitted || !(spread < FLAT * spacing)) return;
    for (size_t k = 0; k < n.count; k++)
        for (int a = 0; a < 2; a++) {
            const double d[3] = {n.offset[0][k], n.offset[1][k], n.offset[2][k]};
            reach[a] = fmax(reach[a], fabs(brio_dot(d, s.frame[a])));
        }
    if (fmin(reach[0], reach[1]) < WIDE * spacing) return;
    memcpy(out->normal, s.frame[2], sizeof out->normal);
    out->spacing = spacing;
}

static void look_at_some(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    for (size_t i = begin; i < end; i++) look(user, i);
}

static double of_key(uint64_t key) {
    uint64_t bits = key >> 63 ? key ^ UINT64_C(1) << 63 : ~key;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Returns the median of the numbers with these keys, 0 of none. */
static double median(uint64_t *key, size_t count) {
    brio_sort_keys(key, count);
    return count ? of_key(key[count / 2]) : 0;
}

/* --- along what --- */

/* Returns how many flat looks have the direction of `normal`, and adds these up. */
static size_t count_one_way(const flat_look *l, size_t count, const double *normal, double sum[3]) {
    size_t one_way = 0;
    sum[0] = sum[1] = sum[2] = 0;
    for (size_t i = 0; i < count; i++) {
        double along = brio_dot(l[i].normal, normal);
        if (fabs(along) < ONE_WAY) continue;
        for (int k = 0; k < 3; k++) sum[k] += along < 0 ? -l[i].normal[k] : l[i].normal[k];
        one_way++;
    }
    return one_way;
}

/* Finds the direction that most planes have.   Returns whether most do. */
static bool find_direction(const flat_look *l, size_t count, double direction[3]) {
    size_t best = 0;
    double sum[3];
    for (size_t i = 0; i < count; i += 1 + count / PAIRS) {
        size_t one_way = count_one_way(l, count, l[i].normal, sum);
        if (one_way <= best) continue;
        best = one_way;
        double length = brio_length(sum);
        for (int k = 0; k < 3; k++) direction[k] = sum[k] / length;
    }
    for (int k = 0; k < 3; k++)
        if (fabs(direction[k]) > 1 - 1e-9) /* exact depths have exact levels */
            for (int j = 0; j < 3; j++) direction[j] = j == k;
    return (double)best > MOST * (double)count;
}

/* Returns whether most planes look at a place. */
static bool look_at(const flat_look *l, size_t count, const double *place) {
    size_t at = 0;
    for (size_t i = 0; i < count; i++) {
        double to[3] = {place[0] - l[i].point[0], place[1] - l[i].point[1], place[2] - l[i].point[2]};
        at += fabs(brio_dot(to, l[i].normal)) > LOOKS_AT * brio_length(to);
    }
    return (double)at > MOST * (double)count;
}

double brio_depth_of(const brio_step_levels *l, const double *p) {
    double d[3] = {p[0] - l->place[0], p[1] - l->place[1], p[2] - l->place[2]};
    return l->is_distance ? hypot(hypot(d[0], d[1]), d[2]) : brio_dot(p, l->direction);
}

size_t brio_level_of(const brio_step_levels *l, const double *p) {
    double depth = brio_depth_of(l, p);
    size_t low = 0, high = l->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (l->depth[middle] < depth)
            low = middle + 1;
        else
            high = middle;
    }
    if (low > 0 && (low == l->count || depth - l->depth[low - 1] < l->depth[low] - depth)) low--;
    return low < l->count && fabs(depth - l->depth[low]) < APART * fmin(l->step[low], l->spacing) ? low : l->count;
}

/* --- levels --- */

/* Cuts sorted depths into levels. Levels of under LEAST_ON samples, and thick ones, are left out.   on  #L: the samples
 * of each.   Returns how many samples are on levels. */
static size_t cut_levels(const double *depth, size_t count, double spacing, brio_step_levels *out, size_t *on) {
    size_t samples = 0;
    out->count = 0;
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && depth[end] - depth[end - 1] < APART * spacing;) end++;
        if (end - begin < LEAST_ON || depth[end - 1] - depth[begin] > THIN * spacing) continue;
        on[out->count] = end - begin;
        out->depth[out->count++] = depth[begin + (end - begin) / 2];
        samples += end - begin;
    }
    return samples;
}

/* Measures and counts the steps. Returns whether they change slowly. */
static bool measure_steps(brio_step_levels *l, const size_t *on) {
    size_t alike = 0, all = 0;
    for (size_t i = 0; i < l->count; i++) {
        double below = i ? l->depth[i] - l->depth[i - 1] : INFINITY,
               above = i + 1 < l->count ? l->depth[i + 1] - l->depth[i] : INFINITY;
        l->step[i] = fmin(below, above);
        if (i == 0 || i + 1 == l->count) continue;
        alike += fmax(below, above) < ALIKE * l->step[i] ? on[i] : 0;
        all += on[i];
    }
    l->number[0] = 0;
    for (size_t i = 1; i < l->count; i++) {
        double steps = rint((l->depth[i] - l->depth[i - 1]) / fmin(l->step[i], l->step[i - 1]));
        l->number[i] = l->number[i - 1] + (int32_t)fmin(steps, MOST_STEPS);
    }
    return (double)alike > MOST * (double)all;
}

/* Lists the levels of all samples. Returns nothing in out->count if there are none. */
static brio_status list_levels(brio_context *ctx, const double *points, size_t count, brio_step_levels *out) {
    brio_status status = BRIO_OK;
    size_t most = count / LEAST_LEVELS, *on = NULL;
    double *depth = NULL;
    uint64_t *key = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, key, count));
    BRIO_TRY(BRIO_ALLOC(ctx, depth, count));
    for (size_t i = 0; i < count; i++) key[i] = brio_double_key(brio_depth_of(out, points + 3 * i));
    BRIO_TRY(brio_sort_many_keys(ctx, key, count));
    for (size_t i = 0; i < count; i++) depth[i] = of_key(key[i]);
    brio_release(ctx, key);
    key = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, on, count / LEAST_ON + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->depth, count / LEAST_ON + 1));
    size_t samples = cut_levels(depth, count, out->spacing, out, on);
    if (out->count < LEAST_LEVELS || out->count > most || (double)samples < MOST * (double)count) out->count = 0;
    if (out->count == 0) goto done;
    BRIO_TRY(BRIO_ALLOC(ctx, out->step, out->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->number, out->count));
    if (!measure_steps(out, on)) out->count = 0;
done:
    brio_release(ctx, on);
    brio_release(ctx, depth);
    brio_release(ctx, key);
    return status;
}

/* Counts the levels that have planes. Measures the steps there.   key  workspace.   Returns whether the levels are
 * many, and more than a spacing apart. */
static bool are_planes_on_many(const flat_look *l, size_t count, uint64_t *key, brio_step_levels *levels) {
    size_t on = 0, many = 0;
    for (size_t i = 0; i < count; i++) {
        size_t level = brio_level_of(levels, l[i].point);
        if (level < levels->count) key[on++] = level;
    }
    brio_sort_keys(key, on);
    for (size_t i = 0; i < on; i++) many += i == 0 || key[i] != key[i - 1];
    for (size_t i = 0; i < on; i++) key[i] = brio_double_key(levels->step[key[i]]);
    levels->coarse = median(key, on);
    return many >= LEAST_PLANES && levels->coarse > COARSE * levels->spacing &&
           levels->coarse < COARSEST * levels->spacing;
}

/* Measures how far apart samples on one level are.   key  workspace. */
static void measure_spacing(const flat_look *l, size_t count, uint64_t *key, brio_step_levels *out) {
    for (size_t i = 0; i < count; i++) key[i] = brio_double_key(l[i].spacing);
    out->spacing = median(key, count);
    for (size_t i = 0; i < count; i++)
        key[i] = brio_double_key(l[i].spacing / sqrt(brio_square_distance(l[i].point, out->place)));
    out->angle = median(key, count);
}

/* Keeps the flat looks in front. Returns their number. */
static size_t keep_flat(flat_look *l, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (l[i].spacing > 0) l[kept++] = l[i];
    return kept;
}

/* Finds along what the planes of the flat looks say that depth is measured.   place  NULL, or of the scanner; without
 * one it may be the origin. */
static bool find_depth(const flat_look *l, size_t flat, const double *place, brio_step_levels *out) {
    static const double ORIGIN[3] = {0, 0, 0};
    memcpy(out->place, place ? place : ORIGIN, sizeof out->place);
    if (find_direction(l, flat, out->direction)) return true;
    return out->is_distance = look_at(l, flat, out->place);
}

static brio_status look_around(brio_context *ctx, const double *points, size_t count, looking *l) {
    brio_status status = BRIO_OK;
    brio_point_boxes boxes = {0};
    size_t looks = count / l->stride;
    BRIO_TRY(BRIO_ALLOC(ctx, l->look, looks));
    BRIO_TRY(brio_point_boxes_new(ctx, points, count, &boxes));
    l->boxes = &boxes;
    BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, looks, LOOKS_A_THREAD), looks, LOOKS_A_THREAD, look_at_some, l));
done:
    brio_point_boxes_free(ctx, &boxes);
    return status;
}

brio_status brio_find_step_levels(brio_context *ctx, const double *points, size_t count, const double *place,
                                  brio_step_levels *out) {
    brio_status status = BRIO_OK;
    looking l = {.stride = count / LOOKS > 1 ? count / LOOKS : 1};
    size_t looks = count / l.stride;
    uint64_t *key = NULL;
    *out = (brio_step_levels){0};
    BRIO_TRY(look_around(ctx, points, count, &l));
    size_t flat = keep_flat(l.look, looks);
    if (flat < LEAST_LOOKS || (double)flat < SHARE * (double)looks) goto done;
    if (!find_depth(l.look, flat, place, out)) goto done;
    BRIO_TRY(BRIO_ALLOC(ctx, key, flat));
    measure_spacing(l.look, flat, key, out);
    BRIO_TRY(list_levels(ctx, points, count, out));
    if (out->count > 0 && !are_planes_on_many(l.look, flat, key, out)) out->count = 0;
done:
    brio_release(ctx, l.look);
    brio_release(ctx, key);
    return status;
}

void brio_step_levels_free(brio_context *ctx, brio_step_levels *levels) {
    brio_release(ctx, levels->depth);
    brio_release(ctx, levels->step);
    brio_release(ctx, levels->number);
    *levels = (brio_step_levels){0};
}
