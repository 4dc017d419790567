/* Writes TetGen's set of files: .node, .ele, and where they are asked for .neigh, .face and .edge.
 *
 * Rows count from 0 in all of them. Neighbours are found from the tetrahedra, so that tetrahedra from anywhere have
 * them.
 *
 * Based on: Si. TetGen user's manual, section 5.2. WIAS 2015. */
#include "io/node_files.h"
#include "base/memory.h"
#include "mesh/tetrahedra_adjacency.h"
#include <string.h>
#include <unistd.h>

typedef struct {
    const brio_write_job *job;
    uint32_t *neighbours; /* NULL if no file needs them */
} node_job;

typedef brio_status (*node_writer)(brio_output *out, const node_job *job);

/* --- the files --- */

static brio_status write_points(brio_output *out, const node_job *job) {
    return brio_node_write(out, job->job);
}

static brio_status write_tetrahedra(brio_output *out, const node_job *job) {
    return brio_ele_write(out, job->job);
}

static brio_status write_neighbours(brio_output *out, const node_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->job->mesh;
    BRIO_TRY(brio_output_comment(out, "# ", job->job->options->comment));
    BRIO_TRY(brio_output_format(out, "%zu 4\n", m->num_tetrahedra));
    for (size_t t = 0; t < m->num_tetrahedra; t++) {
        BRIO_TRY(brio_output_integer(out, 0, (int64_t)t));
        for (size_t i = 4 * t; i < 4 * t + 4; i++) {
            bool hull = job->neighbours[i] == BRIO_INFINITE;
            BRIO_TRY(brio_output_integer(out, ' ', hull ? -1 : (int64_t)job->neighbours[i]));
        }
        BRIO_TRY(brio_output_string(out, "\n"));
    }
done:
    return status;
}

/* A row of indices between the row's number and its marker. */
static brio_status write_row(brio_output *out, size_t row, const uint32_t *vertices, int count, bool hull) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_integer(out, 0, (int64_t)row));
    for (int i = 0; i < count; i++) BRIO_TRY(brio_output_integer(out, ' ', vertices[i]));
    BRIO_TRY(brio_output_string(out, hull ? " 1\n" : " 0\n"));
done:
    return status;
}

/* A facet is written for the first of its two tetrahedra. BRIO_INFINITE is greater than all. */
static bool is_written(const node_job *job, size_t facet) {
    return job->neighbours[facet] > facet / 4;
}

static brio_status write_faces(brio_output *out, const node_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->job->mesh;
    size_t count = 0, row = 0;
    for (size_t f = 0; f < 4 * m->num_tetrahedra; f++) count += is_written(job, f);
    BRIO_TRY(brio_output_comment(out, "# ", job->job->options->comment));
    BRIO_TRY(brio_output_format(out, "%zu 1\n", count));
    for (size_t f = 0; f < 4 * m->num_tetrahedra; f++) {
        uint32_t v[3];
        if (!is_written(job, f)) continue;
        for (int k = 0; k < 3; k++) v[k] = m->tetrahedra[f / 4 * 4 + brio_facet_corners[f % 4][k]];
        BRIO_TRY(write_row(out, row++, v, 3, job->neighbours[f] == BRIO_INFINITE));
    }
done:
    return status;
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
    brio_status status = BRIO_OK;
    for (int i = 0; i < FILES; i++) BRIO_TRY(brio_sibling(ctx, path, kinds[i].extension, &files[i].path));
    if (!brio_is_ele(path)) { /* the name as it was given, which may have another extension */
        brio_release(ctx, files[POINTS].path);
        BRIO_TRY(BRIO_ALLOC(ctx, files[POINTS].path, strlen(path) + 1));
        strcpy(files[POINTS].path, path);
    }
    files[POINTS].wanted = true;
    /* an old .ele belongs to the points that are replaced */
    files[TETRAHEDRA].wanted = job->mesh->num_tetrahedra || access(files[TETRAHEDRA].path, F_OK) == 0;
    files[NEIGHBOURS].wanted = job->options->neighbours;
    files[FACES].wanted = job->options->faces;
    files[EDGES].wanted = job->options->edges;
done:
    return status;
}

static brio_status write_files(brio_context *ctx, node_file *files, const node_job *job, uint64_t expected) {
    brio_status status = BRIO_OK;
    brio_output *outs[FILES];
    uint64_t written = 0;
    int count = 0;
    for (int i = 0; i < FILES; i++) {
        if (!files[i].wanted) continue;
        outs[count++] = &files[i].output;
        BRIO_TRY(brio_output_open(&files[i].output, ctx, files[i].path, expected));
        files[i].output.written = written;
        BRIO_TRY(kinds[i].write(&files[i].output, job));
        BRIO_TRY(brio_output_finish(&files[i].output));
        written = files[i].output.written;
    }
    BRIO_TRY(brio_output_publish_all(outs, count));
done:
    return status;
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
