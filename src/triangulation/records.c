/* The points as records, copied in the order of insertion by all threads of the context. */
#include "triangulation/records.h"
#include "base/memory.h"
#include "base/team.h"
#include <math.h>
#include <string.h>

enum { RECORDS_A_THREAD = 1 << 14 };

static brio_status refuse_not_finite(brio_context *ctx, const brio_input *input, size_t first) {
    const double *points = input->points, *weights = input->weights;
    size_t bad = 0, n = input->count;
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

brio_status brio_records_new(brio_context *ctx, const brio_input *input, const uint32_t *order, size_t room,
                             brio_record **out) {
    brio_record *record = NULL;
    size_t n = input->count;
    brio_status status = BRIO_ALLOC(ctx, record, n + room);
    if (status != BRIO_OK) return status;
    brio_expect_sequence(record);
    record_job job = {input->points, input->weights, order, record, n};
    brio_for(ctx, brio_threads(ctx, n, RECORDS_A_THREAD), n, write_records, &job);
    if (job.bad < n) {
        brio_release(ctx, record);
        return refuse_not_finite(ctx, input, job.bad);
    }
    memset(record + n, 0, room * sizeof *record);
    *out = record;
    return BRIO_OK;
}
