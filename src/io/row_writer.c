/* Writes a file of points block by block, see row_format.h. */
#include "io/row_format.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/utf8.h"
#include "io/textrow.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- rows of properties --- */

/* CHUNK: rows encoded at a time. Both chosen. */
enum { CHUNK = 1 << 16, ROWS_A_THREAD = 1 << 12 };

static size_t row_size(const brio_write_job *job) {
    size_t size = 3 * (job->options->float32 ? sizeof(float) : sizeof(double));
    for (size_t i = 0; i < job->mesh->num_properties; i++) size += brio_scalar_size(job->mesh->properties[i].type);
    return size;
}

static void encode_row(const brio_write_job *job, size_t v, char *bytes) {
    const double *p = job->mesh->vertices + 3 * v;
    float rounded[3] = {(float)p[0], (float)p[1], (float)p[2]};
    size_t size = job->options->float32 ? sizeof rounded : 3 * sizeof *p;
    memcpy(bytes, job->options->float32 ? (const void *)rounded : p, size);
    for (size_t i = 0; i < job->mesh->num_properties; i++) {
        const brio_property *property = &job->mesh->properties[i];
        bytes += size;
        size = brio_scalar_size(property->type);
        memcpy(bytes, (const char *)property->data + v * size, size);
    }
}

/* Rows of the vertices from `first` on. */
typedef struct {
    const brio_write_job *job;
    size_t first;
    char *bytes;
    size_t size; /* bytes of a row */
} chunk;

static void encode(void *user, size_t begin, size_t end, int thread) {
    const chunk *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) encode_row(c->job, c->first + i, c->bytes + i * c->size);
}

brio_status brio_rows_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t size = row_size(job), most = m->num_vertices < CHUNK ? m->num_vertices : CHUNK;
    char *bytes = NULL;
    if (!m->num_properties && !job->options->float32)
        return brio_output_bytes(out, m->vertices, 3 * m->num_vertices * sizeof *m->vertices);
    BRIO_TRY(BRIO_ALLOC(out->ctx, bytes, most * size));
    for (size_t begin = 0; begin < m->num_vertices; begin += CHUNK) {
        size_t count = m->num_vertices - begin < CHUNK ? m->num_vertices - begin : CHUNK;
        BRIO_TRY(brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode,
                          &(chunk){job, begin, bytes, size}));
        BRIO_TRY(brio_output_bytes(out, bytes, count * size));
    }
done:
    brio_release(out->ctx, bytes);
    return status;
}

/* --- the writer --- */

const brio_row_format *brio_row_format_of(brio_format format) {
    const brio_format_row *row = brio_format_row_of(format);
    return row ? row->codec->rows : NULL;
}

/* --- what a format can hold --- */

/* Makes a name one word: PLY and the header of XYZ cannot quote a blank or a comma, nor the latter a comment's mark. */
static void make_word(char name[64], const char *source, bool comments) {
    size_t n = 0;
    for (; n < 63 && source[n]; n++) {
        bool plain = (unsigned char)source[n] > ' ' && source[n] != 127 && !strchr(",;\"'", source[n]);
        bool mark = comments && brio_starts_comment(source + n);
        name[n] = plain && !mark ? source[n] : '_';
    }
    name[n] = 0;
}

static bool is_axis(const char *name) {
    return strlen(name) == 1 && strchr("xyzXYZ", name[0]);
}

static bool is_list_of_corners(const char *name) {
    return !strcmp(name, "vertex_indices") || !strcmp(name, "vertex_index");
}

/* Returns whether one of the first `count` names is this. */
static bool is_taken(char (*names)[64], size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(names[i], name)) return true;
    return false;
}

/* Makes the names of the properties. A name that is taken gets _2, _3 and so on behind it, and is cut so that the whole
 * fits: no result of long work is refused for a name. */
static brio_status make_names(const brio_row_writer *w, const char *path, const brio_property *of, size_t count,
                              bool (*reserved)(const char *name), char (**out)[64]) {
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, *out, count));
    for (size_t i = 0; i < count; i++) {
        char word[64], *name = (*out)[i];
        BRIO_EXPECT(w->ctx, of[i].name[0], BRIO_ERR_ARGUMENT, "%s: a property without a name", path);
        make_word(word, of[i].name, w->format->comments);
        memcpy(name, word, sizeof word);
        for (size_t n = 2; is_taken(*out, i, name) || reserved(name); n++) brio_numbered_name(name, 64, word, n);
    }
    return BRIO_OK;
}

bool brio_is_single(brio_format format, const brio_write_options *o) {
    const brio_format_row *row = brio_format_row_of(format);
    unsigned holds = row ? row->info.holds : 0;
    if (!(holds & BRIO_HOLDS_SINGLES) || holds & BRIO_HOLDS_ORIGIN) return false;
    return o->float32 || !(holds & BRIO_HOLDS_DOUBLES);
}

double brio_moved_by_singles(const brio_mesh *m) {
    double most = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double by[3];
        for (size_t k = 0; k < 3; k++) by[k] = m->vertices[3 * v + k] - (double)(float)m->vertices[3 * v + k];
        if (by[0] != 0 || by[1] != 0 || by[2] != 0) most = fmax(most, hypot(by[0], hypot(by[1], by[2])));
    }
    return most;
}

brio_status brio_check_single(brio_context *ctx, const char *path, const brio_mesh *m) {
    for (size_t i = 0; i < 3 * m->num_vertices; i++)
        BRIO_EXPECT(ctx, !(fabs(m->vertices[i]) >= 0x1.ffffffp127), BRIO_ERR_ARGUMENT,
                    "%s: point %zu (counted from 0): %g does not fit single precision", path, i / 3, m->vertices[i]);
    return BRIO_OK;
}

/* --- the file --- */

brio_status brio_row_writer_new(brio_row_writer *w, brio_context *ctx, brio_format format, const brio_write_job *job) {
    *w = (brio_row_writer){.ctx = ctx, .kind = format, .format = brio_row_format_of(format), .job = *job};
    w->out = (brio_output){.ctx = ctx, .target.folder = -1, .file = -1};
    w->surveys = w->format->survey != NULL;
    w->colours = brio_format_colours(format);
    return brio_zeroed(ctx, &w->state, 1, w->format->state + 1);
}

/* Takes a block. Another pass over a file that somebody replaced can have other properties: what was planned is then of
 * no use. */
static brio_status take_block(brio_row_writer *w, const brio_mesh *block) {
    if (!w->shown) w->columns = block->num_properties;
    w->shown = true;
    w->job.mesh = block;
    if (block->num_properties == w->columns) return BRIO_OK;
    return brio_fail(w->ctx, BRIO_ERR_FORMAT, "blocks of one file have %zu and %zu properties", w->columns,
                     block->num_properties);
}

bool brio_row_writer_is_open(const brio_row_writer *w, const brio_mesh *block) {
    return brio_colour_is_open(&w->colours, block);
}

void brio_row_writer_look(brio_row_writer *w, const brio_mesh *block) {
    brio_colour_look(&w->colours, block);
}

void brio_row_writer_end_look(brio_row_writer *w) {
    w->colours.points.looked = true;
}

brio_status brio_row_writer_share(brio_row_writer *w, const brio_row_writer *all) {
    return w->format->share ? w->format->share(w->ctx, w->state, all->state, all->columns) : BRIO_OK;
}

brio_status brio_row_writer_survey(brio_row_writer *w, const brio_mesh *block) {
    brio_status status = BRIO_OK;
    brio_mesh shown;
    BRIO_TRY(brio_colour_show(w->ctx, &w->colours, block, &shown));
    BRIO_TRY(take_block(w, &shown));
    BRIO_TRY(w->format->survey(w->ctx, &w->job, w->state));
done:
    brio_colour_free(w->ctx, block, &shown);
    return status;
}

void brio_row_writer_end_survey(brio_row_writer *w) {
    w->surveys = w->format->surveyed && !w->format->surveyed(w->state);
}

uint64_t brio_row_writer_surveyed_points(const brio_row_writer *w) {
    return w->format->surveyed_points(w->state);
}

static brio_status open_output(brio_row_writer *w, const char *path) {
    const brio_mesh *m = w->job.mesh;
    if (!w->format->renames)
        BRIO_FORWARD(make_names(w, path, m->properties, m->num_properties, is_axis, &w->job.names));
    if (brio_format_holds(w->kind, BRIO_HOLDS_FACE_PROPERTIES))
        BRIO_FORWARD(
            make_names(w, path, m->face_properties, m->num_face_properties, is_list_of_corners, &w->job.face_names));
    BRIO_FORWARD(brio_check_properties(w->ctx, path, w->kind, w->columns));
    w->begun = true;
    BRIO_FORWARD(brio_output_open(&w->out, w->ctx, path, w->job.expected));
    BRIO_EXPECT(w->ctx, !w->format->counts || w->job.points != BRIO_COUNT_UNKNOWN || brio_output_can_patch(&w->out),
                BRIO_ERR_INTERNAL, "%s: the number of points is not known", path);
    return w->format->begin(&w->out, &w->job, w->state);
}

/* Writes a block whose colours are those of the format. */
static brio_status write_shown(brio_row_writer *w, const char *path, const brio_mesh *block) {
    BRIO_FORWARD(take_block(w, block));
    if (!w->begun) BRIO_FORWARD(open_output(w, path));
    bool single = brio_is_single(w->kind, w->job.options);
    if (single) BRIO_FORWARD(brio_check_single(w->ctx, path, block));
    BRIO_FORWARD(w->format->rows(&w->out, &w->job, w->state));
    if (w->job.options->moved && w->format->moved)
        *w->job.options->moved = fmax(*w->job.options->moved, w->format->moved(w->state, block));
    else if (w->job.options->moved && single)
        *w->job.options->moved = fmax(*w->job.options->moved, brio_moved_by_singles(block));
    w->points += block->num_vertices;
    return BRIO_OK;
}

brio_status brio_row_writer_write(brio_row_writer *w, const char *path, const brio_mesh *block) {
    brio_status status = BRIO_OK;
    brio_mesh shown;
    BRIO_TRY(brio_colour_show(w->ctx, &w->colours, block, &shown));
    BRIO_TRY(write_shown(w, path, &shown));
    if (w->job.options->colours_rounded) *w->job.options->colours_rounded = brio_colour_lost(&w->colours);
done:
    brio_colour_free(w->ctx, block, &shown);
    return status;
}

bool brio_row_writer_renames(const brio_row_writer *w, const brio_mesh *block, size_t i) {
    if (w->format->renames) return w->format->renames(w->state, i);
    return w->job.names && strcmp(w->job.names[i], block->properties[i].name) != 0;
}

brio_status brio_row_writer_cells(brio_row_writer *w, const brio_mesh *cells) {
    w->job.mesh = cells;
    w->job.points = w->points;
    return w->format->end(&w->out, &w->job, w->state);
}

brio_status brio_row_writer_end(brio_row_writer *w, const brio_mesh *last) {
    brio_status status = BRIO_OK;
    brio_mesh cells = *last, shown;
    cells.num_properties = 0; /* its points are written */
    BRIO_TRY(brio_colour_show(w->ctx, &w->colours, &cells, &shown));
    w->job.mesh = &shown;
    w->job.points = w->points;
    if (w->format->end) BRIO_TRY(w->format->end(&w->out, &w->job, w->state));
    BRIO_TRY(brio_output_finish(&w->out));
    BRIO_TRY(brio_output_publish(&w->out));
done:
    brio_colour_free(w->ctx, &cells, &shown);
    return status;
}

void brio_row_writer_free(brio_row_writer *w) {
    if (w->format && w->format->free && w->state) w->format->free(w->ctx, w->state);
    brio_release(w->ctx, w->state);
    brio_release(w->ctx, w->job.names);
    brio_release(w->ctx, w->job.face_names);
    if (w->begun) brio_output_close(&w->out);
    w->begun = false;
    w->state = NULL;
    w->job.names = w->job.face_names = NULL;
}
