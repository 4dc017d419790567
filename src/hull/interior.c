/* Skips points inside the hull before any work: the extreme points along 26 directions span a polytope, and a point
 * that is strictly inside all planes of the polytope is strictly inside the hull.
 *
 * The planes are evaluated in doubles, against a bound of all rounding errors; points nearer to a plane are kept. Both
 * passes hold a block of points as three arrays, so that the compiler computes several points at a time.
 *
 * Let E be the greatest difference of two coordinates on one axis, M the greatest magnitude of a coordinate, u = 2^-53.
 * A component of a rounded normal is at most 2.01 E^2 and wrong by at most 8 u E^2, so the products with coordinates
 * are wrong by at most 3 * 8 u E^2 M; the offset, a sum of three such products, by as much again, and the roundings of
 * both sums add less than 2 * 4 u * 3 * 2.01 E^2 M. Together less than 128 u E^2 M. ERROR is eight times that.
 *
 * The caller's points may change meanwhile. What is computed from them here only chooses which points are candidates.
 *
 * Based on: Akl, Toussaint. A fast convex hull algorithm. IPL 1978. */
#include "hull/interior.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "hull/polytope.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { DIRECTIONS = 13, EXTREMES = 2 * DIRECTIONS, BLOCK = 128, LEAST_POINTS = 256, MOST_PLANES = 2 * EXTREMES };
enum { POINTS_A_THREAD = 1 << 16, MOST_PARTS = 64 };

static const double ERROR = 1024 * 0x1p-53;

/* Chosen: within these bounds nothing overflows, and underflow costs less than 2^-1000. */
static const double MOST_MAGNITUDE = 1e90, UNDERFLOW_FLOOR = 0x1p-1000;

/* The axes, the diagonals of faces and the diagonals of a cube. */
static const double DIRECTION[DIRECTIONS][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0},
                                                {1, 0, 1},  {1, 0, -1}, {0, 1, 1}, {0, 1, -1}, {1, 1, 1},
                                                {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};

/* A block of points, coordinate by coordinate. The last point fills what is left of the block. */
typedef struct {
    double x[BLOCK], y[BLOCK], z[BLOCK];
} block;

static void take_block(const double *points, size_t begin, size_t end, block *b) {
    for (size_t i = 0; i < BLOCK; i++) {
        const double *p = points + 3 * (begin + i < end ? begin + i : end - 1);
        b->x[i] = p[0], b->y[i] = p[1], b->z[i] = p[2];
    }
}

/* --- extreme points --- */

/* The points of a part that are farthest along the directions (even places) and against them (odd places). */
typedef struct {
    double most[EXTREMES];
    uint32_t point[EXTREMES];
} extremes;

static double block_values(const block *b, const double d[3], double sign, double *value) {
    double most = -INFINITY;
    double x = sign * d[0], y = sign * d[1], z = sign * d[2];
    for (size_t i = 0; i < BLOCK; i++) value[i] = x * b->x[i] + y * b->y[i] + z * b->z[i];
    for (size_t i = 0; i < BLOCK; i++) most = value[i] > most ? value[i] : most;
    return most;
}

static void find_part(const double *points, size_t begin, size_t end, extremes *e) {
    block b;
    double value[BLOCK];
    for (int d = 0; d < EXTREMES; d++) e->most[d] = -INFINITY, e->point[d] = (uint32_t)begin;
    for (; begin < end; begin += BLOCK) {
        take_block(points, begin, end, &b);
        for (int d = 0; d < EXTREMES; d++) {
            double most = block_values(&b, DIRECTION[d / 2], d % 2 ? -1 : 1, value);
            if (!(most > e->most[d])) continue;
            size_t i = 0;
            while (value[i] < most) i++;
            e->most[d] = most;
            e->point[d] = (uint32_t)(begin + i < end ? begin + i : end - 1);
        }
    }
}

/* --- planes --- */

/* The planes of the polytope: a point p is beyond plane i when normal[i] p + offset[i] is positive. */
typedef struct {
    double normal[MOST_PLANES][3], offset[MOST_PLANES];
    int count;
    double error; /* of a rounded value of a plane */
} planes;

static double magnitude(const double (*record)[4], size_t n, double *extent) {
    double most = 0;
    *extent = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < n; i++) low = fmin(low, record[i][k]), high = fmax(high, record[i][k]);
        most = fmax(most, fmax(fabs(low), fabs(high)));
        *extent = fmax(*extent, high - low);
    }
    return most;
}

static void set_planes(const brio_polytope *p, const double (*record)[4], planes *out) {
    assert(p->count <= MOST_PLANES);
    out->count = (int)p->count;
    for (int f = 0; f < out->count; f++) {
        const uint32_t *v = p->triangle[f].vertex;
        const double *o = record[v[0]], *a = record[v[1]], *b = record[v[2]];
        double u[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]}, w[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]};
        brio_cross(u, w, out->normal[f]);
        out->offset[f] = -brio_dot(out->normal[f], o);
    }
}

/* Finds the planes of the hull of the extreme points. The extremes along the axes bound all coordinates, so E and M are
 * those of all points. Leaves no planes where the hull is flat or the coordinates are too large or have changed to no
 * numbers. */
static brio_status find_planes(brio_context *ctx, const double *points, const extremes *e, planes *out) {
    double record[EXTREMES + 1][4], extent;
    uint32_t corner[4];
    const brio_hull_records records = {record, e->point, EXTREMES};
    brio_filter filter;
    brio_polytope p = {0};
    brio_status status = BRIO_OK;
    out->count = 0;
    for (int d = 0; d < EXTREMES; d++) {
        for (int k = 0; k < 3; k++) record[d][k] = points[3 * (size_t)e->point[d] + (size_t)k] + 0.0;
        record[d][3] = 0;
    }
    if (!brio_all_finite(record[0], 4 * EXTREMES)) return BRIO_OK;
    double most = magnitude((const double(*)[4])record, EXTREMES, &extent);
    if (!(most < MOST_MAGNITUDE)) return BRIO_OK;
    out->error = ERROR * extent * extent * most + UNDERFLOW_FLOOR;
    brio_filter_for(&filter, (const double(*)[4])record, EXTREMES, false);
    if (brio_general_position(&filter, (const double(*)[4])record, EXTREMES, corner) < 3) return BRIO_OK;
    status = brio_polytope_build(ctx, &records, corner, 1, &p);
    if (status == BRIO_OK) set_planes(&p, (const double(*)[4])record, out);
    brio_polytope_free(ctx, &p);
    return status;
}

/* --- both passes --- */

typedef struct {
    const double *points;
    size_t n;
    int parts;
    extremes extreme[MOST_PARTS];
    planes planes;
    uint32_t *candidate;      /* part i writes its list where its points begin */
    size_t count[MOST_PARTS]; /* of each part */
} skipping;

static void find_extremes(void *user, size_t begin, size_t end, int thread) {
    skipping *s = user;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        find_part(s->points, brio_part(s->n, (int)i, s->parts), brio_part(s->n, (int)i + 1, s->parts), &s->extreme[i]);
}

/* Sets worst[i] to the greatest value of a plane at point i. */
static void plane_values(const planes *a, const block *b, double *worst) {
    for (size_t i = 0; i < BLOCK; i++) worst[i] = -INFINITY;
    for (int f = 0; f < a->count; f++) {
        double x = a->normal[f][0], y = a->normal[f][1], z = a->normal[f][2], offset = a->offset[f];
        for (size_t i = 0; i < BLOCK; i++) {
            double value = x * b->x[i] + y * b->y[i] + z * b->z[i] + offset;
            worst[i] = value > worst[i] ? value : worst[i];
        }
    }
}

static size_t list_part(skipping *s, size_t begin, size_t end) {
    block b;
    double worst[BLOCK];
    assert(begin <= end && end <= s->n);
    uint32_t *out = s->candidate + begin;
    size_t count = 0;
    for (; begin < end; begin += BLOCK) {
        take_block(s->points, begin, end, &b);
        plane_values(&s->planes, &b, worst);
        for (size_t i = 0; i < BLOCK && begin + i < end; i++) {
            out[count] = (uint32_t)(begin + i);
            count += !(worst[i] < -s->planes.error);
        }
    }
    return count;
}

static void list_candidates(void *user, size_t begin, size_t end, int thread) {
    skipping *s = user;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        s->count[i] = list_part(s, brio_part(s->n, (int)i, s->parts), brio_part(s->n, (int)i + 1, s->parts));
}

/* Joins the extremes of the parts in part 0. */
static void join_extremes(skipping *s) {
    extremes *all = &s->extreme[0];
    for (int i = 1; i < s->parts; i++)
        for (int d = 0; d < EXTREMES; d++)
            if (s->extreme[i].most[d] > all->most[d])
                all->most[d] = s->extreme[i].most[d], all->point[d] = s->extreme[i].point[d];
}

static void list_all(skipping *s) {
    for (size_t i = 0; i < s->n; i++) s->candidate[i] = (uint32_t)i;
    s->count[0] = s->n;
    s->parts = 1;
}

brio_status brio_hull_candidates(brio_context *ctx, const double *points, size_t n, uint32_t **candidate,
                                 size_t *num_candidates) {
    brio_status status = BRIO_OK;
    const brio_bar bar = brio_progress_bar(ctx);
    skipping *s = NULL;
    *candidate = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s, 1));
    BRIO_TRY(BRIO_ALLOC(ctx, s->candidate, n));
    s->points = points, s->n = n;
    s->parts = brio_threads(ctx, n, POINTS_A_THREAD);
    s->parts = s->parts < MOST_PARTS ? s->parts : MOST_PARTS;
    if (n >= LEAST_POINTS) {
        BRIO_TRY(brio_for_chunks(ctx, s->parts, (size_t)s->parts, 1, find_extremes, s));
        join_extremes(s);
        BRIO_TRY(brio_progress(ctx, "skip", 0.5));
        brio_progress_part(ctx, bar, 0.5, 1);
        BRIO_TRY(find_planes(ctx, points, &s->extreme[0], &s->planes));
    }
    if (s->planes.count > 0)
        BRIO_TRY(brio_for_chunks(ctx, s->parts, (size_t)s->parts, 1, list_candidates, s));
    else
        list_all(s);
    *num_candidates = 0;
    for (int i = 0; i < s->parts; i++) {
        memmove(s->candidate + *num_candidates, s->candidate + brio_part(n, i, s->parts),
                s->count[i] * sizeof *s->candidate);
        assert(*num_candidates <= brio_part(n, i, s->parts)); /* lists move to the front */
        *num_candidates += s->count[i];
    }
    *candidate = s->candidate;
done:
    brio_progress_part(ctx, bar, 0, 1);
    if (s && status != BRIO_OK) brio_release(ctx, s->candidate);
    brio_release(ctx, s);
    return status;
}
