/* Reads LAS files of versions 1.0 to 1.4 and, with laz_read.c, their compressed form LAZ.
 *
 * Records have fixed size. What the buffer has of them is divided among the threads; each thread goes through its part
 * in blocks that stay in the cache while one column after the other is taken.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "io/las/las_read.h"
#include "base/team.h"
#include "io/formats.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Both chosen: a block fits in the second-level cache, and a thread's part is worth waking it. */
enum { BLOCK_BYTES = 1 << 16, LEAST_ROWS = 1 << 12 };

bool brio_las_starts(const char *bytes, size_t size) {
    return size >= 4 && !memcmp(bytes, "LASF", 4);
}

typedef struct {
    const brio_las_plan *plan;
    const brio_mesh *mesh;
    const char *records;
    size_t first;
} block_job;

static void store_part(void *user, size_t begin, size_t end, int thread) {
    const block_job *job = user;
    size_t record = job->plan->record, most = BLOCK_BYTES / record + 1;
    (void)thread;
    for (size_t i = begin; i < end; i += most)
        brio_las_store(job->plan, job->mesh, job->records + i * record, job->first + i,
                       end - i < most ? end - i : most);
}

static brio_status read_records(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan) {
    brio_status status = BRIO_OK;
    if (s->size != BRIO_SIZE_UNKNOWN) BRIO_TRY(brio_builder_expect_vertices(b, h->num_points));
    while (s->row < h->num_points) {
        BRIO_TRY(brio_stream_fill(s, h->record));
        size_t rows = brio_stream_left(s) / h->record;
        if (rows > BRIO_BLOCK_ROWS) rows = BRIO_BLOCK_ROWS;
        if (rows > h->num_points - s->row) rows = (size_t)(h->num_points - s->row);
        if (!rows) return brio_stream_truncated(s);
        BRIO_TRY(brio_builder_add_vertices(b, rows));
        block_job job = {plan, b->mesh, s->buffer + s->begin, b->mesh->num_vertices - rows};
        brio_for(s->ctx, brio_threads(s->ctx, rows, LEAST_ROWS), rows, store_part, &job);
        s->begin += rows * h->record;
        s->row += rows;
    }
done:
    return status;
}

brio_status brio_las_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_las_header h;
    brio_las_plan plan = {.columns = NULL};
    BRIO_TRY(brio_las_header_read(s, &h));
    if (!h.compressed) BRIO_TRY(brio_stream_expect(s, h.num_points, h.record, "the header"));
    brio_builder_stream(b, h.num_points);
    snprintf(b->version, sizeof b->version, "1.%d, point format %u", h.minor, h.format);
    BRIO_REQUIRE(b->ctx, b->streams || h.num_points <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                 "%s: %" PRIu64 " points, the most are %" PRIu64, b->name, h.num_points, BRIO_MAX_VERTICES);
    BRIO_TRY(brio_las_plan_make(&plan, b, &h));
    memcpy(b->mesh->coordinate_step, h.scale, sizeof h.scale);
    memcpy(b->mesh->coordinate_origin, h.offset, sizeof h.offset);
    brio_stream_element(s, "point", h.num_points);
    BRIO_TRY(h.compressed ? brio_laz_read(s, b, &h, &plan) : read_records(s, b, &h, &plan));
done:
    brio_las_plan_free(b->ctx, &plan);
    brio_las_header_free(b->ctx, &h);
    return status;
}
