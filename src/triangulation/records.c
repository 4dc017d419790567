/* The points as records, copied in the order of insertion by all threads of the context. Each number is read once, and
 * it is the copy that must be finite: another thread of the caller may write to the caller's arrays meanwhile. */
#include "triangulation/records.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/points_hash.h"
#include "base/team.h"
#include <math.h>
#include <string.h>

enum { RECORDS_A_THREAD = 1 << 14 };

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
    bool bad;      /* a record is not finite; atomic */
    uint64_t hash; /* the sum of the records' hashes; atomic */
} record_job;

static void write_records(void *user, size_t begin, size_t end, int thread) {
    record_job *job = user;
    bool finite = true;
    uint64_t hash = 0;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        size_t from = job->order ? job->order[i] : i;
        finite &= write_record(job->points, job->weights, from, job->record[i]);
        hash += brio_point_hash(from, job->record[i]);
    }
    __atomic_fetch_add(&job->hash, hash, __ATOMIC_RELAXED);
    if (!finite) __atomic_store_n(&job->bad, true, __ATOMIC_RELAXED);
}

brio_status brio_records_new(brio_context *ctx, const brio_input *input, const uint32_t *order, size_t room,
                             uint64_t *hash, brio_record **out) {
    brio_record *record = NULL;
    size_t n = input->count;
    brio_status status = BRIO_ALLOC(ctx, record, n + room);
    if (status != BRIO_OK) return status;
    brio_expect_sequence(record);
    record_job job = {input->points, input->weights, order, record, false, 0};
    status = brio_for(ctx, brio_threads(ctx, n, RECORDS_A_THREAD), n, write_records, &job);
    if (status != BRIO_OK || job.bad) {
        if (status == BRIO_OK) status = brio_refuse_records(ctx, (const brio_record *)record, order, n);
        brio_release(ctx, record);
        return status;
    }
    memset(record + n, 0, room * sizeof *record);
    if (hash) *hash = job.hash;
    *out = record;
    return BRIO_OK;
}
