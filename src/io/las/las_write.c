/* Writes LAS and LAZ files: version 1.2 with formats 0 to 3, version 1.4 with formats 6 to 8.
 *
 * All points are seen before the first one is written: for the grid of their coordinates, and for what is in which field
 * (las_layout.c). Header and records of variable length are those of las_facts.c. Polygons are left out.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "base/memory.h"
#include "base/team.h"
#include "io/las/las_facts.h"
#include "io/las/laz_write.h"
#include "io/little_endian.h"
#include "io/row_format.h"
#include <string.h>

/* CHUNK: rows encoded at a time. Both chosen. */
enum { CHUNK = 1 << 15, ROWS_A_THREAD = 1 << 12 };

typedef struct {
    const brio_mesh *block; /* that is being written; of the first one the properties count */
    brio_las_grid grid;
    brio_las_layout layout;
    brio_las_facts facts;
    brio_laz_writer laz; /* compressed points */
    brio_mesh *late;     /* NULL, or has the metadata that stand behind the points */
    char *rows;
    size_t first; /* the vertex of the first row */
} las_writer;

/* --- records --- */

static void encode(void *user, size_t begin, size_t end, int thread) {
    const las_writer *w = user;
    const brio_mesh *m = w->block;
    size_t record = w->layout.record;
    (void)thread;
    memset(w->rows + begin * record, 0, (end - begin) * record);
    for (size_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++)
            brio_put_le32(w->rows + i * record + 4 * k,
                          (uint32_t)brio_las_grid_number(&w->grid, k, m->vertices[3 * (w->first + i) + (size_t)k]));
    for (size_t j = 0; j < m->num_properties; j++)
        for (size_t i = begin; i < end; i++)
            brio_las_put(&w->layout.places[j], &m->properties[j], w->first + i, w->rows + i * record);
}

static brio_status write_records(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    size_t n = job->mesh->num_vertices, record = w->layout.record;
    w->block = job->mesh;
    if (!w->rows) BRIO_TRY(BRIO_ALLOC(out->ctx, w->rows, CHUNK * record));
    for (w->first = 0; w->first < n; w->first += CHUNK) {
        size_t count = n - w->first < CHUNK ? n - w->first : CHUNK;
        BRIO_TRY(brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode, w));
        if (w->facts.compressed)
            BRIO_TRY(brio_laz_write_rows(&w->laz, out, (uint8_t *)w->rows, count));
        else
            BRIO_TRY(brio_output_bytes(out, w->rows, count * record));
    }
done:
    return status;
}

/* --- what must be known before --- */

static void count_returns(las_writer *w, const brio_mesh *block) {
    const brio_property *p = brio_mesh_property(block, "return_number");
    for (size_t v = 0; p && v < block->num_vertices; v++) {
        double x = brio_property_value(p, v);
        if (x >= 0 && x <= BRIO_LAS_RETURNS) w->facts.returns[(int)x]++;
    }
}

static brio_status survey(brio_context *ctx, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    if (w->grid.pass == 0) {
        BRIO_TRY(brio_las_layout_see(ctx, &w->layout, job->mesh));
        count_returns(w, job->mesh);
    }
    BRIO_TRY(brio_las_grid_survey(ctx, &w->grid, job->mesh));
done:
    return status;
}

static bool surveyed(void *state) {
    las_writer *w = state;
    return brio_las_grid_end_pass(&w->grid);
}

static uint64_t surveyed_points(const void *state) {
    const las_writer *w = state;
    return w->grid.points;
}

static bool renames(const void *state, size_t i) {
    const las_writer *w = state;
    return w->layout.places[i].renamed;
}

static bool rounds(const void *state) {
    const las_writer *w = state;
    return w->grid.rounds[0] || w->grid.rounds[1] || w->grid.rounds[2];
}

static double moved(const void *state, const brio_mesh *block) {
    const las_writer *w = state;
    return brio_las_grid_moved(&w->grid, block);
}

/* --- beginning and end --- */

/* Keeps the metadata that stand behind the points: the blocks are gone by then. */
static brio_status keep_late(brio_context *ctx, las_writer *w, const brio_mesh *block) {
    brio_status status = BRIO_OK;
    if (!brio_las_late_records(block)) return BRIO_OK;
    BRIO_TRY(brio_mesh_new(ctx, &w->late));
    for (size_t i = 0; i < block->num_metadata; i++) {
        const brio_metadata *m = &block->metadata[i];
        BRIO_TRY(brio_mesh_set_metadata(w->late, m->name, m->bytes, m->size));
    }
done:
    return status;
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    const brio_property *numbers = brio_mesh_property(job->mesh, "return_number");
    brio_las_facts *f = &w->facts;
    w->block = job->mesh;
    /* the formats before version 1.4 count points in 32 bits */
    BRIO_TRY(brio_las_layout_make(out->ctx, &w->layout, out->name, job->mesh, w->grid.points > UINT32_MAX));
    BRIO_TRY(keep_late(out->ctx, w, job->mesh));
    if (numbers && w->layout.places[numbers - job->mesh->properties].extra) memset(f->returns, 0, sizeof f->returns);
    f->mesh = job->mesh;
    f->layout = &w->layout;
    f->grid = &w->grid;
    f->comment = job->options->comment;
    f->points = job->points;
    if (f->compressed) {
        const brio_laz_form form = brio_laz_form_of(w->layout.format, w->layout.record);
        f->chunk = brio_laz_chunk_points(&form);
    }
    BRIO_TRY(brio_las_facts_write(out, f));
done:
    return status;
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    las_writer *w = state;
    (void)job;
    return w->late ? brio_las_late_write(out, w->late) : BRIO_OK;
}

static brio_status begin_compressed(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    w->facts.compressed = true;
    BRIO_REQUIRE(out->ctx, !brio_las_late_records(job->mesh) || brio_output_can_patch(out), BRIO_ERR_ARGUMENT,
                 "%s: a record of more than 65535 bytes stands behind compressed points: that needs a file, no pipe",
                 out->name);
    BRIO_TRY(begin(out, job, state));
    const brio_laz_form form = brio_laz_form_of(w->layout.format, w->layout.record);
    BRIO_TRY(brio_laz_write_begin(&w->laz, out, &form));
done:
    return status;
}

static brio_status end_compressed(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    char place[8];
    BRIO_TRY(brio_laz_write_end(&w->laz, out));
    brio_put_le64(place, brio_output_offset(out));
    if (w->late) BRIO_TRY(brio_output_patch(out, BRIO_LAS_LATE_PLACE, place, sizeof place));
    BRIO_TRY(end(out, job, state));
done:
    return status;
}

static void free_state(brio_context *ctx, void *state) {
    las_writer *w = state;
    brio_las_layout_free(ctx, &w->layout);
    brio_laz_write_free(&w->laz, ctx);
    brio_mesh_free(w->late);
    brio_release(ctx, w->rows);
    brio_las_grid_free(ctx, &w->grid);
}

#define LAS_ROWS                                                                                                       \
    .state = sizeof(las_writer), .survey = survey, .surveyed = surveyed, .surveyed_points = surveyed_points,           \
    .rows = write_records, .free = free_state, .renames = renames, .rounds = rounds, .moved = moved

const brio_row_format brio_las_rows = {LAS_ROWS, .begin = begin, .end = end};
const brio_row_format brio_laz_rows = {LAS_ROWS, .begin = begin_compressed, .end = end_compressed};
