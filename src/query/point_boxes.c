/* Boxes about runs of points, for some queries of nearest points.
 *
 * A query looks at the runs about its point first: the last of the nearest points there bounds the search. It then
 * enters the boxes that are within the bound. */
#include "query/point_boxes.h"
#include "base/memory.h"
#include "base/team.h"
#include "query/near_list.h"
#include <assert.h>

/* RUN: points of a box of level 0. FAN: boxes of a box of the next level. AROUND: runs on either side of a point that a
 * query looks at first. All chosen. */
enum { RUN = BRIO_TREE_LEAF, FAN = 8, AROUND = 2, RUNS_A_THREAD = 1 << 9 };

static const brio_box EMPTY = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void widen(brio_box *b, const double *low, const double *high) {
    for (int k = 0; k < 3; k++) {
        b->low[k] = low[k] < b->low[k] ? low[k] : b->low[k];
        b->high[k] = high[k] > b->high[k] ? high[k] : b->high[k];
    }
}

static size_t end_of_run(const brio_point_boxes *b, size_t run) {
    return (run + 1) * RUN < b->count ? (run + 1) * RUN : b->count;
}

static void box_runs(void *user, size_t begin, size_t end, int thread) {
    const brio_point_boxes *b = user;
    (void)thread;
    for (size_t run = begin; run < end; run++) {
        brio_box box = EMPTY;
        for (size_t i = run * RUN; i < end_of_run(b, run); i++) widen(&box, b->point[i], b->point[i]);
        b->box[run] = box;
    }
}

/* Fills the boxes of a level from those of the level below. */
static void box_boxes(const brio_point_boxes *b, int level) {
    assert(0 < level && level < b->levels);
    const brio_box *below = b->box + b->first[level - 1];
    size_t count = b->first[level] - b->first[level - 1];
    for (size_t i = b->first[level]; i < b->first[level + 1]; i++) b->box[i] = EMPTY;
    for (size_t i = 0; i < count; i++) widen(&b->box[b->first[level] + i / FAN], below[i].low, below[i].high);
}

brio_status brio_point_boxes_new(brio_context *ctx, const double *points, size_t count, brio_point_boxes *out) {
    size_t boxes = (count + RUN - 1) / RUN;
    *out = (brio_point_boxes){.count = count, .point = (const double(*)[3])points};
    for (size_t size = boxes; size > 0; size = size > 1 ? (size + FAN - 1) / FAN : 0) {
        out->first[out->levels + 1] = out->first[out->levels] + size;
        out->levels++;
        assert(out->levels <= BRIO_BOX_LEVELS);
    }
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->box, out->first[out->levels]));
    BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, boxes, RUNS_A_THREAD), boxes, box_runs, out));
    for (int level = 1; level < out->levels; level++) box_boxes(out, level);
    return BRIO_OK;
}

void brio_point_boxes_free(brio_context *ctx, brio_point_boxes *boxes) {
    brio_release(ctx, boxes->box);
    *boxes = (brio_point_boxes){0};
}

/* Returns the square of the distance of a box; not more than the computed square of any of its points, because each
 * step rounds in the same direction. */
static double square_of_box(const brio_box *b, const double *p) {
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = p[k] < b->low[k] ? b->low[k] - p[k] : p[k] > b->high[k] ? p[k] - b->high[k] : 0;
    return brio_dot(d, d);
}

/* Lists the points of a box and of the boxes below it. */
static void enter(const brio_point_boxes *b, int level, size_t i, brio_near_list *l) {
    assert(0 <= level && level < b->levels && b->first[level] + i < b->first[level + 1]);
    if (brio_is_settled(l) || square_of_box(&b->box[b->first[level] + i], l->p) > l->bound) return;
    if (level == 0) {
        brio_offer_points(l, i * RUN, end_of_run(b, i));
        return;
    }
    size_t below = b->first[level] - b->first[level - 1];
    for (size_t j = i * FAN; j < (i + 1) * FAN && j < below; j++) enter(b, level - 1, j, l);
}

/* Returns the square of a distance within which there are `wanted` points. */
static double first_bound(const brio_point_boxes *b, size_t point, size_t wanted, brio_near_point *near) {
    brio_near_list l = brio_near_list_for(b->point, b->point[point], wanted, near);
    size_t run = point / RUN, end = run + AROUND + 1 < b->first[1] ? run + AROUND + 1 : b->first[1];
    for (run = run < AROUND ? 0 : run - AROUND; run < end; run++) brio_offer_points(&l, run * RUN, end_of_run(b, run));
    if (l.size >= wanted) brio_keep_nearest(&l);
    return l.bound;
}

size_t brio_nearest_in_boxes(const brio_point_boxes *boxes, size_t point, size_t wanted, brio_near_point *near) {
    brio_near_list l = brio_near_list_for(boxes->point, boxes->point[point], wanted, near);
    assert(point < boxes->count && 0 < wanted && wanted <= BRIO_MOST_NEAR);
    l.bound = first_bound(boxes, point, wanted, near);
    enter(boxes, boxes->levels - 1, 0, &l);
    if (l.size > wanted) brio_keep_nearest(&l);
    brio_sort_near_list(boxes->point, near, l.size);
    return l.size;
}
