/* Delaunay and regular triangulation: order the points, insert them one by one, sort the result.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "base/team.h"
#include "order/order.h"
#include "triangulation/kernel.h"
#include "triangulation/recorder.h"
#include "triangulation/triangulation.h"
#include <math.h>
#include <string.h>

enum { PROGRESS_EVERY = 8192, RECORDS_A_THREAD = 1 << 14, POINTS_A_THREAD = 512 };

static const brio_delaunay_options STANDARD = {
    .size = sizeof STANDARD, .order = BRIO_ORDER_BRIO, .seed = 1, .max_tetrahedra = UINT32_C(1) << 30};

BRIO_OPTIONS_INIT(brio_delaunay_options)

static brio_status check_options(brio_context *ctx, size_t n, const brio_delaunay_options *o) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, n < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^32 - 17", n);
    BRIO_REQUIRE(ctx, (unsigned)o->order < BRIO_ORDER_END, BRIO_ERR_ARGUMENT, "no insertion order %d", (int)o->order);
    BRIO_REQUIRE(ctx, o->round_ratio >= 0 && o->round_ratio < 1, BRIO_ERR_ARGUMENT,
                 "round ratio %g is not between 0 and 1", o->round_ratio);
    BRIO_REQUIRE(ctx, (unsigned)o->locate < BRIO_LOCATION_END, BRIO_ERR_ARGUMENT, "no location strategy %d",
                 (int)o->locate);
    BRIO_REQUIRE(ctx, o->edges || !o->num_edges, BRIO_ERR_ARGUMENT, "%zu edges, but no array of them", o->num_edges);
    for (size_t i = 0; i < 2 * o->num_edges; i++)
        BRIO_REQUIRE(ctx, o->edges[i] < n, BRIO_ERR_ARGUMENT, "edge %zu ends at point %u of %zu", i / 2, o->edges[i],
                     n);
    BRIO_REQUIRE(ctx, o->max_tetrahedra <= UINT32_C(1) << 30, BRIO_ERR_ARGUMENT, "at most 2^30 tetrahedra, not %u",
                 o->max_tetrahedra);
done:
    return status;
}

/* --- points --- */

static brio_status refuse_not_finite(brio_context *ctx, const double *points, const double *weights, size_t n,
                                     size_t first) {
    size_t bad = 0;
    for (size_t i = first; i < n; i++)
        bad += !(isfinite(points[3 * i]) && isfinite(points[3 * i + 1]) && isfinite(points[3 * i + 2]) &&
                 (!weights || isfinite(weights[i])));
    int c = 0;
    while (c < 3 && isfinite(points[3 * first + (size_t)c])) c++;
    double x = c < 3 ? points[3 * first + (size_t)c] : weights[first];
    static const char *const name[] = {"x", "y", "z", "weight"};
    return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "point %zu: %s is %s (%zu such points in all)", first, name[c],
                     isnan(x) ? "NaN" : "infinite", bad);
}

/* Writes a record; whether all its numbers are finite. */
static inline bool write_record(const double *points, const double *weights, size_t from, double *record) {
    double w = weights ? weights[from] + 0.0 : 0.0, finite = 0 * w;
    for (size_t c = 0; c < 3; c++) {
        record[c] = points[3 * from + c] + 0.0;
        finite += 0 * record[c];
    }
    record[3] = w;
    return finite == 0; /* else NaN */
}

typedef struct {
    const double *points, *weights;
    const uint32_t *order; /* NULL: as they are */
    brio_record *record;
    size_t bad; /* the least index of a point that is not finite */
} record_job;

static void write_records(void *user, size_t begin, size_t end, int thread) {
    record_job *job = user;
    size_t bad = SIZE_MAX, least = __atomic_load_n(&job->bad, __ATOMIC_RELAXED);
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        size_t from = job->order ? job->order[i] : i;
        if (!write_record(job->points, job->weights, from, job->record[i]) && from < bad) bad = from;
    }
    while (bad < least &&
           !__atomic_compare_exchange_n(&job->bad, &least, bad, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

brio_status brio_records_new(brio_context *ctx, const double *points, const double *weights, size_t n,
                             const uint32_t *order, size_t room, brio_record **out) {
    brio_record *record = NULL;
    brio_status status = BRIO_ALLOC(ctx, record, n + room);
    if (status != BRIO_OK) return status;
    brio_expect_sequence(record);
    record_job job = {points, weights, order, record, n};
    brio_for(ctx, brio_threads(ctx, n, RECORDS_A_THREAD), n, write_records, &job);
    if (job.bad < n) {
        brio_release(ctx, record);
        return refuse_not_finite(ctx, points, weights, n, job.bad);
    }
    memset(record + n, 0, room * sizeof *record);
    *out = record;
    return BRIO_OK;
}

/* --- construction --- */

static brio_status kernel_new(brio_kernel *k, brio_context *ctx, const double *points, const double *weights, size_t n,
                              const brio_delaunay_options *options, brio_round_ends *rounds) {
    brio_status status = BRIO_OK;
    memset(k, 0, sizeof *k);
    k->ctx = ctx;
    k->num_points = n;
    k->reports = true;
    k->weighted = weights != NULL;
    k->engine = brio_engine_choose(k->weighted);
    brio_read_ahead_start(&k->read_ahead, ctx);
    k->goes_on = k->read_ahead.active && options->order != BRIO_ORDER_RANDOM;
    k->locator = brio_locator_choose(options->locate);
    k->max_tetrahedra = options->max_tetrahedra;
    k->stats.points = n;
    k->t.infinite = (uint32_t)n + 2;
    double start = brio_seconds();
    BRIO_TRY(BRIO_ALLOC(ctx, k->caller, n + 3));
    BRIO_TRY(brio_progress(ctx, "order", 0));
    bool parallel = brio_threads(ctx, n, POINTS_A_THREAD) > 1 && options->locate == BRIO_LOCATION_WALK;
    if (parallel && brio_order_has_ranks(options->order)) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, k->rank, n + 3));
    BRIO_TRY(brio_order_points(ctx, points, n, options, k->caller, k->rank, rounds));
    BRIO_TRY(brio_records_new(ctx, points, weights, n, k->caller, 3, &k->record));
    k->record[n + 2][3] = INFINITY; /* the infinite vertex, as conflict_lanes.h knows it */
    k->t.record = k->record;
    k->stats.order_seconds = brio_seconds() - start;
    status = brio_kernel_workspace(k);
done:
    return status;
}

brio_status brio_kernel_workspace(brio_kernel *k) {
    brio_status status = BRIO_OK;
    size_t n = k->num_points;
    BRIO_TRY(BRIO_ALLOC(k->ctx, k->representative, n + 3));
    brio_expect_sequence(k->representative);
    for (uint32_t i = 0; i < n + 3; i++) k->representative[i] = i;
    brio_expect_random(k->representative);
    BRIO_TRY(BRIO_ALLOC(k->ctx, k->cavity.local, n + 3));
    BRIO_TRY(BRIO_ALLOC(k->ctx, k->cavity.table, BRIO_TABLE));
    status = brio_cavity_reserve(k->ctx, &k->cavity, 64);
done:
    return status;
}

void brio_kernel_free(brio_kernel *k) {
    if (k->locator->release) k->locator->release(k);
    brio_cavity_free(k->ctx, &k->cavity);
    brio_release(k->ctx, k->t.tet);
    brio_release(k->ctx, k->state);
    brio_release(k->ctx, k->unused);
    brio_release(k->ctx, k->star.tet);
    brio_release(k->ctx, k->record);
    brio_release(k->ctx, k->caller);
    brio_release(k->ctx, k->rank);
    brio_release(k->ctx, k->representative);
}

static inline size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Where the records from `begin` on stop to follow the curve, at most `end`. */
static size_t end_of_run(const brio_kernel *k, size_t begin, size_t end) {
    size_t i = begin + 1;
    while (i < end && k->rank[i] > k->rank[i - 1]) i++;
    return i;
}

static brio_status insert_some(brio_kernel *k, size_t begin, size_t end) {
    brio_status status = BRIO_OK;
    for (size_t p = begin; p < end; p++) {
        BRIO_TRY(brio_kernel_insert(k, (uint32_t)p));
        if (brio_kernel_work(k) >= k->report_at) BRIO_TRY(brio_kernel_report(k, (double)p / (double)k->num_points));
    }
done:
    return status;
}

static brio_status insert_all(brio_kernel *k, const brio_delaunay_options *options, brio_recorder *recorder) {
    brio_status status = BRIO_OK;
    size_t n = k->num_points, p, end;
    recorder->start = brio_seconds();
    BRIO_TRY(brio_kernel_start(k));
    if (k->dimension <= 0) {
        status = brio_recorder_note(recorder, k, n);
        goto done;
    }
    if (k->locator->start) BRIO_TRY(k->locator->start(k, options));
    bool parallel = k->rank && k->dimension == 3;
    p = (size_t)k->dimension + 1;
    BRIO_TRY(brio_recorder_note(recorder, k, p));
    for (; p < n; p = end) {
        BRIO_TRY(brio_kernel_report(k, (double)p / (double)n));
        end = least(brio_recorder_next(recorder, p), n);
        if (parallel) {
            end = end_of_run(k, p, end);
            BRIO_TRY(brio_kernel_insert_parallel(k, p, end));
        } else {
            end = least(end, p + PROGRESS_EVERY - p % PROGRESS_EVERY);
            BRIO_TRY(insert_some(k, p, end));
        }
        BRIO_TRY(brio_recorder_note(recorder, k, end));
    }
    if (k->locator->release) k->locator->release(k); /* the sort needs the room */
    status = brio_progress(k->ctx, "insert", 1);
done:
    return status;
}

/* --- result --- */

static brio_status triangulation_new(brio_kernel *k, brio_recorder *recorder, brio_triangulation **out) {
    brio_context *ctx = k->ctx;
    brio_triangulation *t = NULL;
    brio_status status = BRIO_OK;
    k->stats.dimension = k->dimension;
    k->stats.walk_steps = k->walk.steps;
    k->stats.exact_calls = k->filter.unsettled;
    BRIO_TRY(BRIO_RESIZE(ctx, k->t.tet, k->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t, 1));
    t->ctx = ctx;
    BRIO_TRY(BRIO_ALLOC(ctx, t->representative, k->num_points));
    for (size_t p = 0; p < k->num_points; p++) t->representative[k->caller[p]] = k->caller[k->representative[p]];
    t->tet = k->t.tet;
    t->stats = k->stats;
    t->stats.size = sizeof t->stats;
    k->t.tet = NULL;
    t->round = recorder->list;
    t->num_rounds = recorder->count;
    recorder->list = NULL;
    *out = t;
    t = NULL;
done:
    brio_triangulation_free(t);
    return status;
}

brio_status brio_delaunay(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                          const brio_delaunay_options *options, brio_triangulation **out) {
    BRIO_DOOR;
    brio_delaunay_options o = STANDARD;
    brio_kernel *k = NULL; /* on no stack: it takes 25 KiB */
    brio_recorder recorder = {0};
    brio_status status = BRIO_OK;
    *out = NULL;
    brio_keep_begin(ctx);
    BRIO_TRY(BRIO_TAKE(ctx, brio_delaunay_options, options, &o));
    BRIO_TRY(check_options(ctx, num_points, &o));
    recorder.every = o.record_every;
    BRIO_TRY(BRIO_ALLOC(ctx, k, 1));
    status = kernel_new(k, ctx, points, weights, num_points, &o, &recorder.rounds);
    double start = brio_seconds();
    if (status == BRIO_OK) status = insert_all(k, &o, &recorder);
    if (status == BRIO_OK) status = brio_kernel_represent(k);
    brio_release(ctx, k->record); /* only names matter from here on */
    k->record = NULL;
    if (k->dimension < 3) k->t.count = 0;
    if (status == BRIO_OK && k->t.count > 0) status = brio_kernel_sort(k);
    k->stats.insert_seconds = brio_seconds() - start;
    if (status == BRIO_OK) status = triangulation_new(k, &recorder, out);
    brio_kernel_free(k);
done:
    brio_release(ctx, k);
    brio_release(ctx, recorder.list);
    brio_keep_end(ctx);
    return status;
}

void brio_triangulation_free(brio_triangulation *t) {
    if (!t) return;
    brio_release(t->ctx, t->tet);
    brio_release(t->ctx, t->representative);
    brio_release(t->ctx, t->round);
    brio_release(t->ctx, t);
}

const brio_delaunay_stats *brio_triangulation_stats(const brio_triangulation *t) {
    return &t->stats;
}
const brio_tetrahedron *brio_triangulation_tetrahedra(const brio_triangulation *t) {
    return t->tet;
}
const uint32_t *brio_triangulation_representatives(const brio_triangulation *t) {
    return t->representative;
}
const brio_round *brio_triangulation_rounds(const brio_triangulation *t, size_t *count) {
    *count = t->num_rounds;
    return t->round;
}
