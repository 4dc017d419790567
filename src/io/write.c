/* Writes a mesh: refuses what the format cannot hold, and calls the format's writer. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "io/formats.h"
#include "io/row_format.h"
#include "mesh/edge_rings.h"
#include <string.h>

/* --- what a format can hold --- */

brio_status brio_check_compress(brio_context *ctx, const char *path, brio_format format,
                                const brio_write_options *options) {
    char others[BRIO_FORMAT_LIST];
    if (!options->compress) return BRIO_OK;
    brio_format_list(1, BRIO_HOLDS_COMPRESSED, others, sizeof others);
    BRIO_EXPECT(ctx, brio_format_holds(format, BRIO_HOLDS_COMPRESSED), BRIO_ERR_ARGUMENT,
                "%s: a file of this format cannot be compressed; %s can", path, others);
    BRIO_EXPECT(ctx, !options->ascii, BRIO_ERR_ARGUMENT, "%s: text is not compressed", path);
    BRIO_EXPECT(ctx, format == BRIO_FORMAT_PCD || brio_vtk_has_zlib(), BRIO_ERR_ARGUMENT,
                "%s: this brio was built without zlib, which compresses", path);
    return BRIO_OK;
}

/* Checks that properties are at most as many as the readers take, which must not believe every header. */
brio_status brio_check_properties(brio_context *ctx, const char *path, brio_format format, size_t count) {
    const brio_format_info *info = brio_format_facts(format);
    BRIO_EXPECT(ctx, !info->most_properties || count <= info->most_properties, BRIO_ERR_ARGUMENT,
                "%s: %zu properties; readers of this format take at most %u", path, count, info->most_properties);
    return BRIO_OK;
}

brio_status brio_check_written(brio_context *ctx, const char *path, brio_format format) {
    const brio_format_info *info = brio_format_facts(format);
    if (!info) {
        char known[BRIO_FORMAT_LIST];
        brio_format_list(1, 0, known, sizeof known);
        return brio_fail(ctx, BRIO_BECAUSE(ctx, UNKNOWN_FORMAT, BRIO_ERR_ARGUMENT),
                         "%s: unknown format, expected one of %s", path, known);
    }
    BRIO_EXPECT(ctx, info->written[0], BRIO_ERR_ARGUMENT, "%s: %s is read, not written", path, info->name);
    BRIO_EXPECT(ctx, format != BRIO_FORMAT_GLB || !brio_is_gltf(path), BRIO_ERR_ARGUMENT,
                "%s: .gltf files are read, not written; .glb files are", path);
    return BRIO_OK;
}

static brio_status check_holds(brio_context *ctx, const char *path, const brio_mesh *m, brio_format format,
                               const brio_write_options *options) {
    char others[BRIO_FORMAT_LIST];
    BRIO_FORWARD(brio_check_written(ctx, path, format));
    brio_format_list(1, BRIO_HOLDS_TETRAHEDRA, others, sizeof others);
    BRIO_EXPECT(ctx, !m->num_tetrahedra || brio_format_holds(format, BRIO_HOLDS_TETRAHEDRA), BRIO_ERR_ARGUMENT,
                "%s: %s cannot hold tetrahedra; %s can", path, brio_format_facts(format)->name, others);
    bool beside = options->neighbours || options->faces || options->edges;
    BRIO_EXPECT(ctx, !beside || format == BRIO_FORMAT_NODE, BRIO_ERR_ARGUMENT,
                "%s: neighbours, faces and edges are written beside .node only", path);
    BRIO_EXPECT(ctx, (!m->num_tetrahedra && !beside) || format != BRIO_FORMAT_NODE || !brio_output_is_single(path),
                BRIO_ERR_ARGUMENT, "%s cannot hold the two files .node and .ele",
                strcmp(path, "-") ? path : "standard output");
    BRIO_FORWARD(brio_check_compress(ctx, path, format, options));
    BRIO_FORWARD(brio_check_properties(ctx, path, format, m->num_properties));
    if (m->num_faces && brio_format_holds(format, BRIO_HOLDS_FACE_PROPERTIES))
        BRIO_FORWARD(brio_check_properties(ctx, path, format, m->num_face_properties));
    if (brio_is_single(format, options)) BRIO_FORWARD(brio_check_single(ctx, path, m));
    return BRIO_OK;
}

/* --- writing --- */

static uint64_t expected_bytes(const brio_mesh *m, brio_format format, bool ascii) {
    bool text = ascii || !brio_format_holds(format, BRIO_HOLDS_BINARY);
    uint64_t corners = m->num_faces ? m->face_offsets[m->num_faces] : 0, scalars = 3 + m->num_properties;
    uint64_t number = text ? 18 : 8, index = text ? 7 : 4;
    return m->num_vertices * scalars * number + m->num_faces * m->num_face_properties * number +
           (corners + m->num_faces + 5 * m->num_tetrahedra + 2 * m->num_edges) * index;
}

static brio_status write_one(brio_context *ctx, const char *path, const brio_write_job *job, brio_format format) {
    brio_status status = BRIO_OK;
    const brio_format_row *row = brio_format_row_of(format);
    brio_write_job of_shown = *job;
    brio_output out = {.ctx = ctx, .target.folder = -1, .file = -1};
    brio_mesh shown;
    BRIO_TRY(brio_colour_show(ctx, job->colours, job->mesh, &shown));
    of_shown.mesh = &shown;
    BRIO_TRY(brio_output_open(&out, ctx, path, job->expected));
    BRIO_TRY(row->codec->write(&out, &of_shown));
    if (job->options->colours_rounded) *job->options->colours_rounded = brio_colour_lost(job->colours);
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    brio_colour_free(ctx, job->mesh, &shown);
    return status;
}

/* Writes a mesh as one block. */
static brio_status write_rows(brio_context *ctx, const char *path, const brio_write_job *job, brio_format format) {
    brio_status status = BRIO_OK;
    brio_row_writer w;
    BRIO_TRY(brio_row_writer_new(&w, ctx, format, job));
    while (w.surveys) {
        BRIO_TRY(brio_row_writer_survey(&w, job->mesh));
        brio_row_writer_end_survey(&w);
    }
    BRIO_TRY(brio_row_writer_write(&w, path, job->mesh));
    BRIO_TRY(brio_row_writer_end(&w, job->mesh));
done:
    brio_row_writer_free(&w);
    return status;
}

/* Refuses indices of vertices that there are not, and coordinates that are no numbers: no format that
 * is written reads back with these. */
static brio_status check_mesh(brio_context *ctx, const char *path, const brio_mesh *mesh) {
    BRIO_FORWARD(brio_refuse_not_finite(ctx, mesh->vertices, NULL, mesh->num_vertices, path));
    BRIO_FORWARD(brio_mesh_check_faces(ctx, mesh));
    for (size_t i = 0; i < 4 * mesh->num_tetrahedra; i++)
        BRIO_EXPECT(ctx, mesh->tetrahedra[i] < mesh->num_vertices, BRIO_ERR_ARGUMENT,
                    "tetrahedron %zu has vertex %u of %zu", i / 4, mesh->tetrahedra[i], mesh->num_vertices);
    for (size_t i = 0; i < 2 * mesh->num_edges; i++)
        BRIO_EXPECT(ctx, mesh->edges[i] < mesh->num_vertices, BRIO_ERR_ARGUMENT, "edge %zu has vertex %u of %zu", i / 2,
                    mesh->edges[i], mesh->num_vertices);
    return BRIO_OK;
}

brio_status brio_write_with_colours(brio_context *ctx, const char *path, const brio_mesh *mesh,
                                    const brio_write_options *options, brio_colour_plan *colours) {
    brio_write_options o = *options;
    brio_write_job job = {.mesh = mesh, .options = &o, .colours = colours};
    const brio_format format = o.format;
    if (o.moved) *o.moved = 0;
    if (o.colours_rounded) *o.colours_rounded = 0;
    BRIO_FORWARD(check_mesh(ctx, path, mesh));
    BRIO_FORWARD(check_holds(ctx, path, mesh, format, job.options));
    job.expected = expected_bytes(mesh, format, o.ascii);
    job.points = mesh->num_vertices;
    if (o.moved && brio_is_single(format, &o)) *o.moved = brio_moved_by_singles(mesh);
    if (brio_row_format_of(format))
        BRIO_FORWARD(write_rows(ctx, path, &job, format));
    else if (format == BRIO_FORMAT_NODE && !brio_output_is_single(path))
        BRIO_FORWARD(brio_node_write_files(ctx, path, &job, job.expected));
    else
        BRIO_FORWARD(write_one(ctx, path, &job, format));
    return BRIO_OK;
}

brio_status brio_write(brio_context *ctx, const char *path, const brio_mesh *mesh, const brio_write_options *options) {
    BRIO_DOOR;
    brio_write_options o = {0};
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_write_options, options, &o));
    if (o.format == BRIO_FORMAT_AUTO && strcmp(path, "-") != 0) o.format = brio_format_of(path);
    BRIO_FORWARD(brio_check_written(ctx, path, o.format));
    brio_colour_plan colours = brio_format_colours(o.format);
    return brio_write_with_colours(ctx, path, mesh, &o, &colours);
}
