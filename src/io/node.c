/* TetGen's pair of text files: .node with points, attributes and boundary markers, and .ele with tetrahedra.
 *
 * Rows are numbered from 0 or 1: the number of the first point decides for both files. Attributes become the properties
 * attribute1, attribute2, ..., and the marker becomes the property boundary_marker. Of quadratic tetrahedra the four
 * corners are read.
 *
 * Based on: Si. TetGen user's manual, section 5.2. WIAS 2015. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/builder.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include "mesh/tetrahedra_adjacency.h"
#include "platform/file.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char marker_name[] = "boundary_marker";

/* Reads the numbers in the first line of a file. Numbers that are missing become 0. */
static brio_status read_header(brio_text *t, uint64_t *counts, size_t num_counts) {
    memset(counts, 0, num_counts * sizeof *counts);
    brio_stream_element(t->stream, "count", num_counts);
    BRIO_FORWARD(brio_text_next_line(t));
    if (!t->at) return brio_text_expected(t, "the number of rows");
    for (size_t i = 0; i < num_counts && brio_text_more(t); i++)
        BRIO_FORWARD(brio_text_count(t, "a number of the first line", UINT64_MAX >> 1, &counts[i]));
    return brio_text_row_end(t);
}

/* Reads the number in front of a row. Row i must have the number base + i. */
static brio_status read_row_number(brio_text *t, unsigned base) {
    brio_stream *s = t->stream;
    uint64_t number;
    BRIO_FORWARD(brio_text_count(t, "the row's number", UINT64_MAX >> 1, &number));
    BRIO_EXPECT(s->ctx, number == s->row + base, BRIO_ERR_FORMAT,
                "%s: line %zu: expected row %" PRIu64 ", found %" PRIu64, s->name, s->line, s->row + base, number);
    return BRIO_OK;
}

/* Reads the first row's number without using it up. */
static brio_status find_base(brio_text *t, unsigned *base) {
    BRIO_FORWARD(brio_text_next_line(t));
    *base = t->at && t->at[0] == '1' && brio_is_blank(t->at[1]);
    return BRIO_OK;
}

static brio_status plan_node(brio_builder *b, const uint64_t *counts) {
    BRIO_EXPECT(b->ctx, counts[1] == 3, BRIO_ERR_FORMAT, "%s: %" PRIu64 " dimensions, expected 3", b->name, counts[1]);
    BRIO_EXPECT(b->ctx, counts[2] <= BRIO_MOST_NUMBERS && counts[3] <= 1, BRIO_ERR_FORMAT,
                "%s: %" PRIu64 " attributes and %" PRIu64 " markers, expected up to %d and 1", b->name, counts[2],
                counts[3], BRIO_MOST_NUMBERS);
    for (uint64_t i = 0; i < counts[2]; i++) {
        char name[64];
        snprintf(name, sizeof name, "attribute%" PRIu64, i + 1);
        BRIO_FORWARD(brio_builder_property(b, name, BRIO_SCALAR_FLOAT64));
    }
    if (counts[3]) BRIO_FORWARD(brio_builder_property(b, marker_name, BRIO_SCALAR_INT32));
    return BRIO_OK;
}

static brio_status read_node_row(brio_text *t, brio_builder *b) {
    double point[3], value;
    BRIO_FORWARD(read_row_number(t, b->index_base));
    for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_text_number(t, &point[k]));
    BRIO_FORWARD(brio_builder_vertex(b, point));
    size_t v = b->mesh->num_vertices - 1;
    for (size_t i = 0; i < b->mesh->num_properties; i++) {
        brio_property *p = &b->mesh->properties[i];
        BRIO_FORWARD(brio_text_number(t, &value));
        BRIO_EXPECT(b->ctx, brio_scalar_store((char *)p->data + v * brio_scalar_size(p->type), p->type, value),
                    BRIO_ERR_FORMAT, "%s: line %zu: boundary marker %.17g, expected a whole number", b->name,
                    t->stream->line, value);
    }
    return brio_text_row_end(t);
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_text t = {s, '#', NULL};
    uint64_t counts[4];
    BRIO_TRY(read_header(&t, counts, 4));
    BRIO_TRY(plan_node(b, counts));
    /* each number has a blank or the line's end behind it, except the last one */
    if (!b->salvage)
        BRIO_TRY(brio_stream_expect(s, counts[0], 2 * (4 + counts[2] + counts[3]) - 1, "the number of points"));
    brio_stream_element(s, "point", counts[0]);
    BRIO_TRY(find_base(&t, &b->index_base));
    for (; s->row < counts[0]; s->row++) {
        uint64_t before = brio_builder_count(b);
        status = read_node_row(&t, b);
        if (brio_salvage(b, s, before, true, &status)) break;
        BRIO_TRY(status);
    }
    if (!s->salvaged) BRIO_TRY(brio_text_end(&t));
done:
    return status;
}

static brio_status read_ele_row(brio_text *t, brio_builder *b, uint64_t corners) {
    brio_stream *s = t->stream;
    double indices[4];
    uint64_t index;
    size_t points = b->mesh->num_vertices;
    BRIO_FORWARD(read_row_number(t, b->index_base));
    for (uint64_t i = 0; i < corners; i++) {
        BRIO_FORWARD(brio_text_count(t, "a corner", UINT32_MAX, &index));
        BRIO_EXPECT(s->ctx, index >= b->index_base && index - b->index_base < points, BRIO_ERR_FORMAT,
                    "%s: line %zu: corner %" PRIu64 ", expected one of the %zu points, numbered from %u", s->name,
                    s->line, index, points, b->index_base);
        if (i < 4) indices[i] = (double)(index - b->index_base);
    }
    BRIO_FORWARD(brio_builder_tetrahedron(b, indices));
    t->at = NULL; /* the rest of the line is the attribute of the region */
    return BRIO_OK;
}

brio_status brio_ele_read(brio_stream *s, brio_builder *b) {
    brio_text t = {s, '#', NULL};
    uint64_t counts[3];
    BRIO_FORWARD(read_header(&t, counts, 3));
    BRIO_EXPECT(s->ctx, counts[1] == 4 || counts[1] == 10 || !counts[0], BRIO_ERR_FORMAT,
                "%s: %" PRIu64 " corners, expected 4 or 10", s->name, counts[1]);
    BRIO_FORWARD(brio_stream_expect(s, counts[0], 2 * (1 + counts[1]) - 1, "the number of tetrahedra"));
    brio_stream_element(s, "tetrahedron", counts[0]);
    for (; s->row < counts[0]; s->row++) BRIO_FORWARD(read_ele_row(&t, b, counts[1]));
    return brio_text_end(&t);
}

/* --- writing --- */

static bool is_marker(const brio_property *p) {
    return p->type == BRIO_SCALAR_INT32 && !strcmp(p->name, marker_name);
}

static brio_status write_node(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh;
    const brio_property *marker = brio_mesh_property(m, marker_name);
    if (marker && !is_marker(marker)) marker = NULL;
    BRIO_FORWARD(brio_output_comment(out, "# ", job->options->comment));
    BRIO_FORWARD(brio_output_format(out, "%zu 3 %zu %d\n", m->num_vertices, m->num_properties - (marker != NULL),
                                    marker != NULL));
    for (size_t v = 0; v < m->num_vertices; v++) {
        BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)v));
        BRIO_FORWARD(brio_output_string(out, " "));
        BRIO_FORWARD(brio_output_point(out, m->vertices + 3 * v));
        for (size_t i = 0; i < m->num_properties; i++)
            if (&m->properties[i] != marker) BRIO_FORWARD(brio_output_scalar(out, ' ', &m->properties[i], v));
        if (marker) BRIO_FORWARD(brio_output_scalar(out, ' ', marker, v));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static brio_status ele_write(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh;
    BRIO_FORWARD(brio_output_comment(out, "# ", job->options->comment));
    BRIO_FORWARD(brio_output_format(out, "%zu 4 0\n", m->num_tetrahedra));
    for (size_t t = 0; t < m->num_tetrahedra; t++) {
        BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)t));
        for (int i = 0; i < 4; i++) BRIO_FORWARD(brio_output_integer(out, ' ', m->tetrahedra[4 * t + (size_t)i]));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

/* --- neighbours, faces and edges --- */

/* Writes TetGen's set of files: .node, .ele, and where they are asked for .neigh, .face and .edge.
 *
 * Rows count from 0 in all of them. Neighbours are found from the tetrahedra, so that tetrahedra from anywhere have
 * them. */

typedef struct {
    const brio_write_job *job;
    uint32_t *neighbours; /* NULL if no file needs them */
} node_job;

typedef brio_status (*node_writer)(brio_output *out, const node_job *job);

/* --- the files --- */

static brio_status write_points(brio_output *out, const node_job *job) {
    return write_node(out, job->job);
}

static brio_status write_tetrahedra(brio_output *out, const node_job *job) {
    return ele_write(out, job->job);
}

static brio_status write_neighbours(brio_output *out, const node_job *job) {
    const brio_mesh *m = job->job->mesh;
    BRIO_FORWARD(brio_output_comment(out, "# ", job->job->options->comment));
    BRIO_FORWARD(brio_output_format(out, "%zu 4\n", m->num_tetrahedra));
    for (size_t t = 0; t < m->num_tetrahedra; t++) {
        BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)t));
        for (size_t i = 4 * t; i < 4 * t + 4; i++) {
            bool hull = job->neighbours[i] == BRIO_INFINITE;
            BRIO_FORWARD(brio_output_integer(out, ' ', hull ? -1 : (int64_t)job->neighbours[i]));
        }
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

/* Writes a row of indices between the row's number and its marker. */
static brio_status write_row(brio_output *out, size_t row, const uint32_t *vertices, int count, bool hull) {
    BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)row));
    for (int i = 0; i < count; i++) BRIO_FORWARD(brio_output_integer(out, ' ', vertices[i]));
    return brio_output_string(out, hull ? " 1\n" : " 0\n");
}

/* Returns whether a facet is written here: a facet is written for the first of its two tetrahedra. BRIO_INFINITE is
 * greater than all. */
static bool is_written(const node_job *job, size_t facet) {
    return job->neighbours[facet] > facet / 4;
}

static brio_status write_faces(brio_output *out, const node_job *job) {
    const brio_mesh *m = job->job->mesh;
    size_t count = 0, row = 0;
    for (size_t f = 0; f < 4 * m->num_tetrahedra; f++) count += is_written(job, f);
    BRIO_FORWARD(brio_output_comment(out, "# ", job->job->options->comment));
    BRIO_FORWARD(brio_output_format(out, "%zu 1\n", count));
    for (size_t f = 0; f < 4 * m->num_tetrahedra; f++) {
        uint32_t v[3];
        if (!is_written(job, f)) continue;
        for (int k = 0; k < 3; k++) v[k] = m->tetrahedra[f / 4 * 4 + brio_facet_corners[f % 4][k]];
        BRIO_FORWARD(write_row(out, row++, v, 3, job->neighbours[f] == BRIO_INFINITE));
    }
    return BRIO_OK;
}

static brio_status write_edges(brio_output *out, const node_job *job) {
    brio_status status = BRIO_OK;
    brio_tetrahedra_edges edges;
    BRIO_TRY(brio_tetrahedra_edges_find(out->ctx, job->job->mesh, job->neighbours, &edges));
    BRIO_TRY(brio_output_comment(out, "# ", job->job->options->comment));
    BRIO_TRY(brio_output_format(out, "%zu 1\n", edges.count));
    for (size_t e = 0; e < edges.count; e++) BRIO_TRY(write_row(out, e, edges.ends + 2 * e, 2, edges.hull[e]));
done:
    brio_tetrahedra_edges_free(out->ctx, &edges);
    return status;
}

/* --- all of them --- */

enum { POINTS, TETRAHEDRA, NEIGHBOURS, FACES, EDGES, FILES };

static const struct {
    const char *extension;
    node_writer write;
} kinds[FILES] = {{".node", write_points},
                  {".ele", write_tetrahedra},
                  {".neigh", write_neighbours},
                  {".face", write_faces},
                  {".edge", write_edges}};

typedef struct {
    bool wanted;
    char *path;
    brio_output output;
} node_file;

static brio_status choose_files(brio_context *ctx, const char *path, const brio_write_job *job, node_file *files) {
    for (int i = 0; i < FILES; i++) BRIO_FORWARD(brio_sibling(ctx, path, kinds[i].extension, &files[i].path));
    if (!brio_is_ele(path)) { /* the name as it was given, which may have another extension */
        brio_release(ctx, files[POINTS].path);
        BRIO_FORWARD(BRIO_ALLOC(ctx, files[POINTS].path, strlen(path) + 1));
        strcpy(files[POINTS].path, path);
    }
    files[POINTS].wanted = true;
    /* an old .ele belongs to the points that are replaced */
    files[TETRAHEDRA].wanted = job->mesh->num_tetrahedra || brio_is_there(files[TETRAHEDRA].path);
    files[NEIGHBOURS].wanted = job->options->neighbours;
    files[FACES].wanted = job->options->faces;
    files[EDGES].wanted = job->options->edges;
    return BRIO_OK;
}

static brio_status write_files(brio_context *ctx, node_file *files, const node_job *job, uint64_t expected) {
    brio_output *outs[FILES];
    uint64_t written = 0;
    int count = 0;
    for (int i = 0; i < FILES; i++) {
        if (!files[i].wanted) continue;
        outs[count++] = &files[i].output;
        BRIO_FORWARD(brio_output_open(&files[i].output, ctx, files[i].path, expected));
        files[i].output.written = written;
        BRIO_FORWARD(kinds[i].write(&files[i].output, job));
        BRIO_FORWARD(brio_output_finish(&files[i].output));
        written = files[i].output.written;
    }
    return brio_output_publish_all(outs, count);
}

brio_status brio_node_write_files(brio_context *ctx, const char *path, const brio_write_job *job, uint64_t expected) {
    brio_status status = BRIO_OK;
    const brio_write_options *o = job->options;
    node_file files[FILES];
    node_job own = {job, NULL};
    for (int i = 0; i < FILES; i++) files[i] = (node_file){.output = {.ctx = ctx, .target.folder = -1, .file = -1}};
    BRIO_TRY(choose_files(ctx, path, job, files));
    if (o->neighbours || o->faces || o->edges) BRIO_TRY(brio_tetrahedra_neighbours(ctx, job->mesh, &own.neighbours));
    BRIO_TRY(write_files(ctx, files, &own, expected));
done:
    for (int i = 0; i < FILES; i++) {
        brio_output_close(&files[i].output);
        brio_release(ctx, files[i].path);
    }
    brio_release(ctx, own.neighbours);
    return status;
}

const brio_codec brio_node_codec = {.read = read_file, .write = write_node};
