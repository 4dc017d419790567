/* Whether a surface through samples of an offset is within the error, and samples where it is not.
 *
 * A first test looks at seven places of each triangle. The proof bounds the distance from the solid over each whole
 * triangle. It is nowhere less than the least distance between the triangle and the solid's surface. It is nowhere more
 * than the largest distance of the triangle's corners from any one triangle of that surface, because the distance from
 * a convex set is a convex function. Where this bound is too large, the triangle is cut into four, and so on.
 *
 * The distance falls short where a chord cuts through a round part; a sample is put there on the offset. It is too
 * large where a chord spans a crease; a sample is put on the crease.
 *
 * Based on: Tang, Lee, Kim. Interactive Hausdorff distance computation for general polygonal models. ACM TOG 2009
 * (bounds by single triangles, and subdivision). */
#include "base/team.h"
#include "base/vector.h"
#include "mesh/triangle_distance.h"
#include "offset/work.h"
#include <math.h>
#include <string.h>

enum { BATCH = 1 << 13, TRIANGLES_A_CHUNK = 32, DEEPEST = 14 /* cuts into four for a proof; chosen */ };

/* Side of the smallest part of a triangle in a proof, in means of distance and error: the distance of two points of a
 * plane at this distance from each other differs by a hundredth of the error. Chosen. */
static const double SMALLEST = 0.14;
static const double PROOF_SHARE = 0x1p-30; /* of the error, for rounding */

typedef struct {
    brio_offset_work *w;
    size_t first;  /* of the batch */
    double *bound; /* of the batch: distance from the offset at the worst place, or a bound on it */
    double (*place)[3];
} judge;

typedef void (*judge_fn)(const judge *j, const double *const corner[3], double *bound, double *place);

const double brio_offset_places[BRIO_OFFSET_PLACES][3] = {
    {1. / 3, 1. / 3, 1. / 3}, {0.5, 0.5, 0},   {0, 0.5, 0.5},  {0.5, 0, 0.5},
    {0.6, 0.2, 0.2},          {0.2, 0.6, 0.2}, {0.2, 0.2, 0.6}};

static double distance_of(const judge *j, const double *p) {
    double nearest[3];
    size_t triangle;
    return sqrt(brio_closest_point(&j->w->field.solid->tree, p, nearest, &triangle));
}

/* --- the test --- */

static void test_triangle(const judge *j, const double *const corner[3], double *bound, double *place) {
    *bound = 0;
    for (int i = 0; i < BRIO_OFFSET_PLACES; i++) {
        const double *share = brio_offset_places[i];
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = share[0] * corner[0][k] + share[1] * corner[1][k] + share[2] * corner[2][k];
        double off = fabs(distance_of(j, p) - j->w->field.distance);
        if (off <= *bound) continue;
        *bound = off;
        memcpy(place, p, sizeof p);
    }
}

/* --- the proof --- */

static double longest_side(const double *const corner[3]) {
    double square = 0;
    for (int c = 0; c < 3; c++) square = fmax(square, brio_square_distance(corner[c], corner[(c + 1) % 3]));
    return sqrt(square);
}

/* Raises *bound to a bound on the distance from the solid over a triangle, less the offset's. */
static void bound_above(const judge *j, const double *const corner[3], int depth, double *bound, double *place) {
    const brio_triangle_tree *tree = &j->w->field.solid->tree;
    double centroid[3], nearest[3], square = 0, cut[3][3];
    size_t triangle;
    for (int k = 0; k < 3; k++) centroid[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
    brio_closest_point(tree, centroid, nearest, &triangle);
    for (int c = 0; c < 3; c++) {
        brio_closest_on_triangle(tree, triangle, corner[c], nearest);
        square = fmax(square, brio_square_distance(corner[c], nearest));
    }
    double over = sqrt(square) - j->w->field.distance, side = longest_side(corner);
    if (over <= *bound) return;
    if (over <= j->w->error || depth == DEEPEST || side < SMALLEST * sqrt(j->w->field.distance * j->w->error)) {
        *bound = over;
        memcpy(place, centroid, sizeof centroid);
        return;
    }
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) cut[c][k] = 0.5 * (corner[(c + 1) % 3][k] + corner[(c + 2) % 3][k]);
    bound_above(j, (const double *const[3]){cut[0], cut[1], cut[2]}, depth + 1, bound, place);
    for (int c = 0; c < 3; c++)
        bound_above(j, (const double *const[3]){corner[c], cut[(c + 2) % 3], cut[(c + 1) % 3]}, depth + 1, bound,
                    place);
}

static void prove_triangle(const judge *j, const double *const corner[3], double *bound, double *place) {
    double d = j->w->field.distance, at[3];
    *bound = 0;
    bound_above(j, corner, 0, bound, place);
    double least = sqrt(brio_triangle_distance(&j->w->field.solid->tree, corner, d * d, at));
    if (d - least <= *bound) return; /* -INFINITY where it is not below d */
    *bound = d - least;
    memcpy(place, at, sizeof at);
}

/* --- all triangles --- */

typedef struct {
    judge j;
    judge_fn judge;
    uint8_t kind; /* what a triangle has passed then: 1 the test, 2 the proof */
} pass;

/* Writes the set by which a triangle is remembered. */
static void set_of(const brio_offset_work *w, size_t triangle, uint32_t set[4]) {
    memcpy(set, w->triangles[triangle], 3 * sizeof *set);
    set[3] = BRIO_SEEN_NONE - 1;
}

static bool has_passed(const pass *p, size_t triangle) {
    uint32_t set[4];
    set_of(p->j.w, triangle, set);
    const uint8_t *known = brio_seen_find(&p->j.w->passed, set);
    return known && *known >= p->kind;
}

/* Keeps what passed for the next round, with what passed before and is still there. */
static brio_status remember(const pass *p) {
    brio_status status = BRIO_OK;
    brio_offset_work *w = p->j.w;
    brio_seen next = {0};
    size_t fault = 0;
    BRIO_TRY(brio_seen_new(w->ctx, w->num_triangles, &next));
    for (size_t i = 0; i < w->num_triangles; i++) {
        uint32_t set[4];
        if (fault < w->num_faults && w->faults[fault].triangle == i) {
            fault++;
            continue;
        }
        set_of(w, i, set);
        const uint8_t *known = brio_seen_find(&w->passed, set);
        if (!brio_seen_find(&next, set)) brio_seen_add(&next, set, known && *known > p->kind ? *known : p->kind);
    }
    brio_seen_free(w->ctx, &w->passed);
    w->passed = next;
    return BRIO_OK;
done:
    brio_seen_free(w->ctx, &next);
    return status;
}

static void judge_part(void *user, size_t begin, size_t end, int thread) {
    const pass *p = user;
    const brio_offset_work *w = p->j.w;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const double *corner[3];
        if (has_passed(p, p->j.first + i)) {
            p->j.bound[i] = 0;
            continue;
        }
        for (int c = 0; c < 3; c++) corner[c] = w->points + 3 * (size_t)w->triangles[p->j.first + i][c];
        p->judge(&p->j, corner, &p->j.bound[i], p->j.place[i]);
    }
}

static brio_status judge_all(brio_offset_work *w, judge_fn fn, uint8_t kind) {
    brio_status status = BRIO_OK;
    pass p = {{.w = w}, fn, kind};
    size_t n = w->num_triangles;
    w->num_faults = 0;
    BRIO_TRY(BRIO_ALLOC(w->ctx, p.j.bound, BATCH));
    BRIO_TRY(BRIO_ALLOC(w->ctx, p.j.place, BATCH));
    for (; p.j.first < n; p.j.first += BATCH) {
        size_t count = n - p.j.first < BATCH ? n - p.j.first : BATCH;
        BRIO_TRY(brio_offset_progress(w));
        BRIO_TRY(brio_for_chunks(w->ctx, brio_threads(w->ctx, count, TRIANGLES_A_CHUNK), count, TRIANGLES_A_CHUNK,
                                 judge_part, &p));
        for (size_t i = 0; i < count; i++) {
            if (p.j.bound[i] <= w->error * (1 + PROOF_SHARE)) continue;
            brio_offset_fault fault = {.triangle = (uint32_t)(p.j.first + i), .bound = p.j.bound[i]};
            memcpy(fault.place, p.j.place[i], sizeof fault.place);
            BRIO_TRY(BRIO_RESERVE(w->ctx, w->faults, w->fault_capacity, w->num_faults + 1));
            w->faults[w->num_faults++] = fault;
        }
    }
    BRIO_TRY(remember(&p));
done:
    brio_release(w->ctx, p.j.bound);
    brio_release(w->ctx, p.j.place);
    return status;
}

brio_status brio_offset_test(brio_offset_work *w) {
    return judge_all(w, test_triangle, 1);
}

brio_status brio_offset_prove(brio_offset_work *w) {
    return judge_all(w, prove_triangle, 2);
}
