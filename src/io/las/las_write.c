/* Writes LAS and LAZ files: version 1.2 with formats 0 to 3, version 1.4 with formats 6 to 8.
 *
 * All points are seen before the first one is written: for the grid of their coordinates, and for what is in which
 * field (las_layout.c). Polygons are left out.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "base/memory.h"
#include "base/team.h"
#include "io/crs.h"
#include "io/formats.h"
#include "io/las/las_layout.h"
#include "io/las/laz_write.h"
#include "io/little_endian.h"
#include "io/row_format.h"
#include <stdlib.h>
#include <string.h>

/* --- the header and its records --- */

/* Writes the header of a LAS file and its records of variable length.
 *
 * Version 1.2 has formats 0 to 3, version 1.4 formats 6 to 8. A file with a coordinate system as text, or with a record
 * of more than 65535 bytes, has version 1.4 in any case. Formats 6 to 8 are to have coordinate systems as text; one
 * that is known by its keys alone is written so, and the header says it. */

enum { BRIO_LAS_RETURNS = 15 };

typedef struct brio_las_facts {
    const brio_mesh *mesh; /* whose metadata are written */
    const brio_las_layout *layout;
    const brio_las_grid *grid;
    const char *comment; /* NULL, or in place of the program's name */
    uint64_t points;
    uint64_t returns[BRIO_LAS_RETURNS + 1]; /* points by the number of their return */
    bool compressed;
    uint32_t chunk; /* compressed: points of a chunk */
    uint64_t late;  /* the first byte behind the points, if it is known */
} brio_las_facts;

/** The place in the header of the first byte of the records behind the points. */
enum { BRIO_LAS_LATE_PLACE = 235 };

enum { HEADER = 227, HEADER_1_4 = 375, MOST_EARLY = 65535, EXTRA_BYTES = 4, WKT_ID = 2112, LASZIP = 22204 };
enum { STANDARD_TIME = 1, SYNTHETIC_RETURNS = 8, WKT = 16, COMPRESSED = 128 };

/* Metadata that are lists of records, in the order in which they are written. */
static const char *const lists[] = {"crs.geokeys", "las.records"};
enum { LISTS = sizeof lists / sizeof *lists };

static const char *text_of(const brio_mesh *mesh, const char *name) {
    const brio_metadata *m = brio_mesh_metadata(mesh, name);
    return m ? m->bytes : "";
}

static size_t wkt_size(const brio_mesh *mesh) {
    const brio_metadata *m = brio_mesh_metadata(mesh, "crs.wkt");
    return m && m->size ? m->size + 1 : 0; /* a byte 0 ends it */
}

/* --- the header --- */

static void put_text(char *to, const char *text) {
    size_t length = strlen(text);
    memcpy(to, text, length < 32 ? length : 31);
}

/* Puts what the file said that the points come from, or what is true of any. */
static void put_origin(const brio_las_facts *f, char *header) {
    const char *system = text_of(f->mesh, "las.system"), *software = text_of(f->mesh, "las.software");
    const char *project = text_of(f->mesh, "las.project"), *comment = f->comment ? f->comment : "brio " BRIO_VERSION;
    char *day = NULL;
    unsigned long year = strtoul(text_of(f->mesh, "las.date"), &day, 10);
    put_text(header + 26, *system ? system : "OTHER");
    put_text(header + 58, *software ? software : comment);
    brio_put_le16(header + 4, (uint16_t)strtoul(text_of(f->mesh, "las.source"), NULL, 10));
    if (*day == '-') {
        brio_put_le16(header + 90, (uint16_t)strtoul(day + 1, NULL, 10));
        brio_put_le16(header + 92, (uint16_t)year);
    }
    for (int i = 0; i < 16 && strlen(project) == 32; i++) {
        char digits[3] = {project[2 * i], project[2 * i + 1], 0};
        header[8 + i] = (char)strtoul(digits, NULL, 16);
    }
}

static uint16_t encoding_of(const brio_las_facts *f) {
    bool text = wkt_size(f->mesh) > 0, keys = brio_mesh_metadata(f->mesh, "crs.geokeys") != NULL;
    unsigned bits = text || (f->layout->format >= 6 && !keys) ? WKT : 0;
    if (!strcmp(text_of(f->mesh, "las.gps_time"), "standard")) bits |= STANDARD_TIME;
    if (!strcmp(text_of(f->mesh, "las.returns"), "synthetic")) bits |= SYNTHETIC_RETURNS;
    return (uint16_t)bits;
}

static void put_limits(const brio_las_grid *g, char *header) {
    for (int k = 0; k < 3; k++) {
        int32_t low = g->points ? brio_las_grid_number(g, k, g->low[k]) : 0;
        int32_t high = g->points ? brio_las_grid_number(g, k, g->high[k]) : 0;
        brio_put_le_double(header + 131 + 8 * k, g->step[k]);
        brio_put_le_double(header + 155 + 8 * k, g->origin[k]);
        brio_put_le_double(header + 179 + 16 * k, high * g->step[k] + g->origin[k]);
        brio_put_le_double(header + 187 + 16 * k, low * g->step[k] + g->origin[k]);
    }
}

static void put_counts(const brio_las_facts *f, char *header, bool is_1_4) {
    if (f->layout->format < 6) {
        brio_put_le32(header + 107, (uint32_t)f->points);
        for (int i = 0; i < 5; i++) brio_put_le32(header + 111 + 4 * i, (uint32_t)f->returns[i + 1]);
    }
    if (!is_1_4) return;
    brio_put_le64(header + 247, f->points);
    for (int i = 0; i < BRIO_LAS_RETURNS; i++) brio_put_le64(header + 255 + 8 * i, f->returns[i + 1]);
}

/* --- records of variable length --- */

static bool is_early(size_t size) {
    return size <= MOST_EARLY;
}

/* Returns how many records stand behind the points: those that are too long to stand before them. */
static uint32_t las_late_records(const brio_mesh *mesh) {
    uint32_t count = !is_early(wkt_size(mesh));
    for (int i = 0; i < LISTS; i++) {
        const brio_metadata *list = brio_mesh_metadata(mesh, lists[i]);
        const char *header = NULL;
        for (size_t at = 0, size = 0; list && brio_record_next(list, &at, &header, &size);) count += !is_early(size);
    }
    return count;
}

/* Makes the header of a record that brio itself makes. */
static void make_header(char header[BRIO_RECORD_HEADER], const char *user, unsigned id, const char *text, size_t size) {
    memset(header, 0, BRIO_RECORD_HEADER);
    memcpy(header + BRIO_RECORD_USER, user, strlen(user));
    brio_put_le16(header + BRIO_RECORD_ID, (uint16_t)id);
    brio_put_le64(header + BRIO_RECORD_SIZE, size);
    memcpy(header + BRIO_RECORD_TEXT, text, strlen(text));
}

/* Writes a record if it belongs to this side of the points. */
static brio_status put_record(brio_output *out, bool late, const char header[BRIO_RECORD_HEADER], const char *bytes) {
    size_t size = (size_t)brio_le64(header + BRIO_RECORD_SIZE);
    if (late == is_early(size)) return BRIO_OK;
    BRIO_FORWARD(brio_output_bytes(out, header, BRIO_RECORD_SIZE + (late ? 8 : 2)));
    BRIO_FORWARD(brio_output_bytes(out, header + BRIO_RECORD_TEXT, BRIO_RECORD_HEADER - BRIO_RECORD_TEXT));
    return brio_output_bytes(out, bytes, size);
}

/* Writes the records of the metadata on one side of the points. */
static brio_status put_kept(brio_output *out, bool late, const brio_mesh *mesh) {
    char wkt[BRIO_RECORD_HEADER];
    make_header(wkt, "LASF_Projection", WKT_ID, "WKT", wkt_size(mesh));
    if (wkt_size(mesh)) BRIO_FORWARD(put_record(out, late, wkt, text_of(mesh, "crs.wkt")));
    for (int i = 0; i < LISTS; i++) {
        const brio_metadata *list = brio_mesh_metadata(mesh, lists[i]);
        const char *header = NULL;
        for (size_t at = 0, size = 0; list && brio_record_next(list, &at, &header, &size);)
            BRIO_FORWARD(put_record(out, late, header, header + BRIO_RECORD_HEADER));
    }
    return BRIO_OK;
}

static brio_status put_extras(brio_output *out, const brio_las_facts *f) {
    brio_status status = BRIO_OK;
    char header[BRIO_RECORD_HEADER], *extras = NULL;
    const brio_las_layout *l = f->layout;
    if (!l->num_extras) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(out->ctx, extras, BRIO_LAS_EXTRA * l->num_extras));
    make_header(header, "LASF_Spec", EXTRA_BYTES, "", BRIO_LAS_EXTRA * l->num_extras);
    for (size_t i = 0, count = 0; i < f->mesh->num_properties; i++)
        if (l->places[i].extra) brio_las_describe(l, f->mesh, i, extras + BRIO_LAS_EXTRA * count++);
    BRIO_TRY(put_record(out, false, header, extras));
done:
    brio_release(out->ctx, extras);
    return status;
}

static brio_status put_form(brio_output *out, const brio_las_facts *f) {
    char header[BRIO_RECORD_HEADER], record[BRIO_LAZ_FORM];
    const brio_laz_form form = brio_laz_form_of(f->layout->format, f->layout->record);
    if (!f->compressed) return BRIO_OK;
    make_header(header, "laszip encoded", LASZIP, "", brio_laz_form_write(&form, f->chunk, record));
    return put_record(out, false, header, record);
}

/* Counts the records before the points and their bytes. */
static uint32_t early_records(const brio_las_facts *f, uint64_t *bytes) {
    char record[BRIO_LAZ_FORM];
    const brio_laz_form form = brio_laz_form_of(f->layout->format, f->layout->record);
    size_t extras = BRIO_LAS_EXTRA * f->layout->num_extras, text = wkt_size(f->mesh);
    uint32_t count = (extras > 0) + (text && is_early(text)) + f->compressed;
    *bytes = extras + (is_early(text) ? text : 0) + (f->compressed ? brio_laz_form_write(&form, f->chunk, record) : 0);
    for (int i = 0; i < LISTS; i++) {
        const brio_metadata *list = brio_mesh_metadata(f->mesh, lists[i]);
        const char *header = NULL;
        for (size_t at = 0, size = 0; list && brio_record_next(list, &at, &header, &size);) {
            count += is_early(size);
            *bytes += is_early(size) ? size : 0;
        }
    }
    *bytes += (uint64_t)BRIO_LAS_RECORD_HEADER * count;
    return count;
}

/* Writes the header and the records before the points.   Returns BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY. */
static brio_status las_facts_write(brio_output *out, brio_las_facts *f) {
    char header[HEADER_1_4] = "LASF";
    const brio_las_layout *l = f->layout;
    uint32_t late = las_late_records(f->mesh);
    bool is_1_4 = l->format >= 6 || wkt_size(f->mesh) || late;
    size_t size = is_1_4 ? HEADER_1_4 : HEADER;
    uint64_t records = 0;
    brio_put_le32(header + 100, early_records(f, &records));
    BRIO_EXPECT(out->ctx, size + records <= UINT32_MAX, BRIO_ERR_ARGUMENT,
                "%s: records of 4 GiB before the points, more than LAS holds", out->name);
    put_origin(f, header);
    put_limits(f->grid, header);
    put_counts(f, header, is_1_4);
    brio_put_le16(header + 6, encoding_of(f));
    header[24] = 1;
    header[25] = is_1_4 ? 4 : 2;
    brio_put_le16(header + 94, (uint16_t)size);
    brio_put_le32(header + 96, (uint32_t)(size + records));
    header[104] = (char)(l->format | (f->compressed ? COMPRESSED : 0));
    brio_put_le16(header + 105, (uint16_t)l->record);
    f->late = size + records + f->points * l->record;
    if (late) {
        brio_put_le64(header + BRIO_LAS_LATE_PLACE, f->late); /* of compressed points: put in its place at the end */
        brio_put_le32(header + BRIO_LAS_LATE_PLACE + 8, late);
    }
    BRIO_FORWARD(brio_output_bytes(out, header, size));
    BRIO_FORWARD(put_form(out, f));
    BRIO_FORWARD(put_kept(out, false, f->mesh));
    return put_extras(out, f);
}

/* Writes the records behind the points. */
static brio_status las_late_write(brio_output *out, const brio_mesh *mesh) {
    return put_kept(out, true, mesh);
}

/* --- points --- */

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
    las_writer *w = state;
    size_t n = job->mesh->num_vertices, record = w->layout.record;
    w->block = job->mesh;
    if (!w->rows) BRIO_FORWARD(BRIO_ALLOC(out->ctx, w->rows, CHUNK * record));
    for (w->first = 0; w->first < n; w->first += CHUNK) {
        size_t count = n - w->first < CHUNK ? n - w->first : CHUNK;
        BRIO_FORWARD(brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode, w));
        if (w->facts.compressed)
            BRIO_FORWARD(brio_laz_write_rows(&w->laz, out, (uint8_t *)w->rows, count));
        else
            BRIO_FORWARD(brio_output_bytes(out, w->rows, count * record));
    }
    return BRIO_OK;
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
    las_writer *w = state;
    if (w->grid.pass == 0) {
        BRIO_FORWARD(brio_las_layout_see(ctx, &w->layout, job->mesh));
        count_returns(w, job->mesh);
    }
    return brio_las_grid_survey(ctx, &w->grid, job->mesh);
}

static bool surveyed(void *state) {
    las_writer *w = state;
    return brio_las_grid_end_pass(&w->grid);
}

static uint64_t surveyed_points(const void *state) {
    const las_writer *w = state;
    return w->grid.points;
}

static brio_status share(brio_context *ctx, void *state, const void *from, size_t columns) {
    las_writer *w = state;
    const las_writer *all = from;
    brio_las_grid_share(&w->grid, &all->grid);
    return brio_las_layout_share(ctx, &w->layout, &all->layout, columns);
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
    if (!las_late_records(block)) return BRIO_OK;
    BRIO_FORWARD(brio_mesh_new(ctx, &w->late));
    for (size_t i = 0; i < block->num_metadata; i++) {
        const brio_metadata *m = &block->metadata[i];
        BRIO_FORWARD(brio_mesh_set_metadata(w->late, m->name, m->bytes, m->size));
    }
    return BRIO_OK;
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    las_writer *w = state;
    const brio_property *numbers = brio_mesh_property(job->mesh, "return_number");
    brio_las_facts *f = &w->facts;
    w->block = job->mesh;
    /* the formats before version 1.4 count points in 32 bits */
    BRIO_FORWARD(brio_las_layout_make(out->ctx, &w->layout, out->name, job->mesh, w->grid.points > UINT32_MAX));
    BRIO_FORWARD(keep_late(out->ctx, w, job->mesh));
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
    return las_facts_write(out, f);
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    las_writer *w = state;
    (void)job;
    return w->late ? las_late_write(out, w->late) : BRIO_OK;
}

static brio_status begin_compressed(brio_output *out, const brio_write_job *job, void *state) {
    las_writer *w = state;
    w->facts.compressed = true;
    BRIO_EXPECT(out->ctx, !las_late_records(job->mesh) || brio_output_can_patch(out), BRIO_ERR_ARGUMENT,
                "%s: a record of more than 65535 bytes stands behind compressed points: that needs a file, no pipe",
                out->name);
    BRIO_FORWARD(begin(out, job, state));
    const brio_laz_form form = brio_laz_form_of(w->layout.format, w->layout.record);
    return brio_laz_write_begin(&w->laz, out, &form);
}

static brio_status end_compressed(brio_output *out, const brio_write_job *job, void *state) {
    las_writer *w = state;
    char place[8];
    BRIO_FORWARD(brio_laz_write_end(&w->laz, out));
    brio_put_le64(place, brio_output_offset(out));
    if (w->late) BRIO_FORWARD(brio_output_patch(out, BRIO_LAS_LATE_PLACE, place, sizeof place));
    return end(out, job, state);
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
    .share = share, .rows = write_records, .free = free_state, .renames = renames, .rounds = rounds, .moved = moved

const brio_row_format brio_las_rows = {LAS_ROWS, .begin = begin, .end = end};
const brio_row_format brio_laz_rows = {LAS_ROWS, .begin = begin_compressed, .end = end_compressed};
