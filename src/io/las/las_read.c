/* Reads LAS files of versions 1.0 to 1.5 and, with laz_read.c, their compressed form LAZ.
 *
 * Records have fixed size. What the buffer has of them is divided among the threads; each thread goes through its part
 * in blocks that stay in the cache while one column after the other is taken.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "io/las/las_read.h"
#include "base/team.h"
#include "io/formats.h"
#include "io/las/las_depth.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Both chosen: a block fits in the second-level cache, and a thread's part is worth waking it. */
enum { BLOCK_BYTES = 1 << 16, LEAST_ROWS = 1 << 12 };

bool brio_laz_starts(const char *bytes, size_t size) {
    enum { POINT_FORMAT = 104, COMPRESSED = 0xc0 };
    return brio_las_starts(bytes, size) && size > POINT_FORMAT && (bytes[POINT_FORMAT] & COMPRESSED);
}

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

/* Returns how many of the points that the header announces a file can have. */
static uint64_t points_that_are_there(const brio_stream *s, const brio_las_header *h) {
    uint64_t offset = brio_stream_offset(s), room = s->size > offset ? (s->size - offset) / h->record : 0;
    return room < h->num_points ? room : h->num_points;
}

static brio_status read_records(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan) {
    brio_status status = BRIO_OK;
    if (s->size != BRIO_SIZE_UNKNOWN) BRIO_TRY(brio_builder_expect_vertices(b, points_that_are_there(s, h)));
    while (s->row < h->num_points) {
        BRIO_TRY(brio_stream_fill(s, h->record));
        size_t rows = brio_stream_left(s) / h->record;
        if (rows > BRIO_BLOCK_ROWS) rows = BRIO_BLOCK_ROWS;
        if (rows > h->num_points - s->row) rows = (size_t)(h->num_points - s->row);
        if (!rows && b->salvage) break;
        if (!rows) return brio_stream_truncated(s);
        BRIO_TRY(brio_builder_add_vertices(b, rows));
        block_job job = {plan, b->mesh, s->buffer + s->begin, b->mesh->num_vertices - rows};
        BRIO_TRY(brio_for(s->ctx, brio_threads(s->ctx, rows, LEAST_ROWS), rows, store_part, &job));
        s->begin += rows * h->record;
        s->row += rows;
    }
    b->missing = h->num_points - s->row;
done:
    return status;
}

brio_status brio_las_read_points(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan) {
    brio_stream_element(s, "point", h->num_points);
    return h->compressed ? brio_laz_read(s, b, h, plan) : read_records(s, b, h, plan);
}

/* Whether a file can be read a second time while it is read. */
static bool can_look_ahead(const brio_stream *s) {
    return s->size != BRIO_SIZE_UNKNOWN && !s->unpacker;
}

/* What is known only when all points of a pipe have been read: the depth of colours, and records behind the points. */
static brio_status end_pipe(brio_stream *s, brio_builder *b, brio_las_header *h, bool has_depth) {
    brio_status status = BRIO_OK;
    brio_las_depth depth = {.deep = false};
    if (!has_depth) {
        brio_las_depth_see(&depth, b->mesh);
        BRIO_TRY(brio_las_depth_give(&depth, b->mesh));
    }
    if (h->late_pending && b->streams) BRIO_TRY(brio_builder_leave_out(b, "records behind the points of a pipe"));
    if (!h->late_pending || b->streams) return BRIO_OK;
    BRIO_TRY(brio_las_late_records_read(s, b, h));
    BRIO_TRY(brio_las_records_give(b, h));
done:
    return status;
}

/* A pipe with colours is not handed on in blocks: what the colours are is known at its end. */
brio_status brio_las_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_las_header h;
    atomic_bool rounded = false;
    brio_las_plan plan = {.ctx = b->ctx, .rounded = &rounded};
    brio_las_depth depth = {.deep = false};
    BRIO_TRY(brio_las_header_read(s, b, &h));
    if (!h.compressed && !b->salvage) BRIO_TRY(brio_stream_expect(s, h.num_points, h.record, "the header"));
    bool has_depth = can_look_ahead(s) || !brio_las_has_colours(h.format);
    if (has_depth) brio_builder_stream(b, b->salvage ? BRIO_COUNT_UNKNOWN : h.num_points);
    snprintf(b->version, sizeof b->version, "1.%d, point format %u", h.minor, h.format);
    BRIO_REQUIRE(b->ctx, b->streams || h.num_points <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                 "%s: %" PRIu64 " points, the most are %" PRIu64, b->name, h.num_points, BRIO_MAX_VERTICES);
    if (has_depth && brio_las_has_colours(h.format)) BRIO_TRY(brio_las_depth_find(s, b, &h, &depth));
    BRIO_TRY(brio_las_depth_give(&depth, b->mesh));
    BRIO_TRY(brio_las_plan_make(&plan, b, &h));
    memcpy(b->mesh->coordinate_step, h.scale, sizeof h.scale);
    memcpy(b->mesh->coordinate_origin, h.offset, sizeof h.offset);
    BRIO_TRY(brio_las_read_points(s, b, &h, &plan));
    BRIO_TRY(end_pipe(s, b, &h, has_depth));
    if (rounded) BRIO_TRY(brio_builder_leave_out(b, "last digits of integers of 64 bits"));
done:
    brio_las_plan_free(&plan);
    brio_las_header_free(b->ctx, &h);
    return status;
}
