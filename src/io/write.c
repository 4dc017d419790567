/* Writes a mesh: refuses what the format cannot hold, and calls the format's writer. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "io/row_format.h"
#include "mesh/edge_rings.h"
#include <string.h>
#include <unistd.h>

static const brio_write_options STANDARD = {.size = sizeof STANDARD, .format = BRIO_FORMAT_AUTO};

BRIO_OPTIONS_INIT(brio_write_options)

/* --- what a format can hold --- */

static brio_status check_holds(brio_context *ctx, const char *path, const brio_mesh *m, brio_format format,
                               const brio_write_options *options) {
    static const char *const without_tetrahedra[BRIO_FORMAT_END] = {
        [BRIO_FORMAT_XYZ] = "a text of points", [BRIO_FORMAT_OBJ] = "an OBJ file", [BRIO_FORMAT_OFF] = "an OFF file",
        [BRIO_FORMAT_VTP] = "a VTP file",       [BRIO_FORMAT_LAS] = "a LAS file",  [BRIO_FORMAT_STL] = "an STL file",
        [BRIO_FORMAT_NPY] = "an NPY file"};
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, format > BRIO_FORMAT_AUTO && format < BRIO_FORMAT_END, BRIO_ERR_ARGUMENT,
                 "%s: unknown format, expected .ply .xyz .pts .txt .csv .obj .off .vtu .vtp .node .las .stl or .npy",
                 path);
    BRIO_REQUIRE(ctx, !m->num_tetrahedra || !without_tetrahedra[format], BRIO_ERR_ARGUMENT,
                 "%s: %s cannot hold tetrahedra; .ply, .vtu and .node can", path, without_tetrahedra[format]);
    BRIO_REQUIRE(ctx, !m->num_tetrahedra || format != BRIO_FORMAT_NODE || strcmp(path, "-") != 0, BRIO_ERR_ARGUMENT,
                 "standard output cannot hold the two files .node and .ele");
    if (options->float32 || format == BRIO_FORMAT_STL) BRIO_TRY(brio_check_single(ctx, path, m));
done:
    return status;
}

/* --- writing --- */

static uint64_t expected_bytes(const brio_mesh *m, brio_format format, bool ascii) {
    bool text = ascii || format == BRIO_FORMAT_XYZ || format == BRIO_FORMAT_OBJ || format == BRIO_FORMAT_OFF ||
                format == BRIO_FORMAT_NODE;
    uint64_t corners = m->num_faces ? m->face_offsets[m->num_faces] : 0, scalars = 3 + m->num_properties;
    uint64_t number = text ? 18 : 8, index = text ? 7 : 4;
    return m->num_vertices * scalars * number +
           (corners + m->num_faces + 5 * m->num_tetrahedra + 2 * m->num_edges) * index;
}

static brio_status write_output(brio_output *out, const brio_write_job *job, brio_format format) {
    switch (format) {
    case BRIO_FORMAT_OBJ:
        return brio_obj_write(out, job);
    case BRIO_FORMAT_OFF:
        return brio_off_write(out, job);
    case BRIO_FORMAT_VTU:
        return brio_vtu_write(out, job);
    case BRIO_FORMAT_NODE:
        return brio_node_write(out, job);
    case BRIO_FORMAT_VTP:
        return brio_vtp_write(out, job);
    case BRIO_FORMAT_STL:
        return brio_stl_write(out, job);
    case BRIO_FORMAT_PLY:
    case BRIO_FORMAT_XYZ:
    case BRIO_FORMAT_LAS:
    case BRIO_FORMAT_NPY: /* by row_writer.c */
        break;
    case BRIO_FORMAT_LAZ:
    case BRIO_FORMAT_PCD:
    case BRIO_FORMAT_PTX:
        return brio_fail(out->ctx, BRIO_ERR_ARGUMENT, "%s: LAZ, PCD and PTX files are read, not written", out->name);
    case BRIO_FORMAT_AUTO:
    case BRIO_FORMAT_END:
        break;
    }
    return brio_fail(out->ctx, BRIO_ERR_ARGUMENT, "%s: no such format: %d", out->name, (int)format);
}

static brio_status write_one(brio_context *ctx, const char *path, const brio_write_job *job, brio_format format) {
    brio_status status = BRIO_OK;
    brio_output out;
    BRIO_TRY(brio_output_open(&out, ctx, path, job->expected));
    BRIO_TRY(write_output(&out, job, format));
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    return status;
}

/* Writes .node and .ele. Both files are complete before either gets its name. */
static brio_status write_pair(brio_context *ctx, const char *node_path, const char *ele_path,
                              const brio_write_job *job) {
    brio_status status = BRIO_OK;
    brio_output node = {.ctx = ctx, .target.folder = -1, .file = -1}, ele = node;
    BRIO_TRY(brio_output_open(&node, ctx, node_path, job->expected));
    BRIO_TRY(brio_node_write(&node, job));
    BRIO_TRY(brio_output_finish(&node));
    BRIO_TRY(brio_output_open(&ele, ctx, ele_path, job->expected));
    ele.written = node.written;
    BRIO_TRY(brio_ele_write(&ele, job));
    BRIO_TRY(brio_output_finish(&ele));
    BRIO_TRY(brio_output_publish(&node));
    BRIO_TRY(brio_output_publish(&ele));
done:
    brio_output_close(&node);
    brio_output_close(&ele);
    return status;
}

/* Writes a .node file and the .ele file beside it. An old .ele file is replaced even by an empty one, because it
 * belongs to the points that are replaced. */
static brio_status write_node(brio_context *ctx, const char *path, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    char *node = NULL, *ele = NULL;
    if (!strcmp(path, "-")) return write_one(ctx, path, job, BRIO_FORMAT_NODE);
    if (brio_is_ele(path)) BRIO_TRY(brio_sibling(ctx, path, ".node", &node));
    BRIO_TRY(brio_sibling(ctx, path, ".ele", &ele));
    const char *points = node ? node : path;
    bool pair = job->mesh->num_tetrahedra || access(ele, F_OK) == 0;
    BRIO_TRY(pair ? write_pair(ctx, points, ele, job) : write_one(ctx, points, job, BRIO_FORMAT_NODE));
done:
    brio_release(ctx, node);
    brio_release(ctx, ele);
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

/* Refuses indices of vertices that there are not. */
static brio_status check_indices(brio_context *ctx, const brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    for (size_t i = 0; i < 4 * mesh->num_tetrahedra; i++)
        BRIO_REQUIRE(ctx, mesh->tetrahedra[i] < mesh->num_vertices, BRIO_ERR_ARGUMENT,
                     "tetrahedron %zu has vertex %u of %zu", i / 4, mesh->tetrahedra[i], mesh->num_vertices);
    for (size_t i = 0; i < 2 * mesh->num_edges; i++)
        BRIO_REQUIRE(ctx, mesh->edges[i] < mesh->num_vertices, BRIO_ERR_ARGUMENT, "edge %zu has vertex %u of %zu",
                     i / 2, mesh->edges[i], mesh->num_vertices);
done:
    return status;
}

brio_status brio_write(brio_context *ctx, const char *path, const brio_mesh *mesh, const brio_write_options *options) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_write_options o = STANDARD;
    brio_write_job job = {.mesh = mesh, .options = &o};
    BRIO_TRY(BRIO_TAKE(ctx, brio_write_options, options, &o));
    brio_format format = o.format;
    if (format == BRIO_FORMAT_AUTO && strcmp(path, "-") != 0) format = brio_format_of(path);
    BRIO_TRY(check_indices(ctx, mesh));
    BRIO_TRY(check_holds(ctx, path, mesh, format, job.options));
    job.expected = expected_bytes(mesh, format, o.ascii);
    job.points = mesh->num_vertices;
    if (brio_row_format_of(format))
        BRIO_TRY(write_rows(ctx, path, &job, format));
    else
        BRIO_TRY(format == BRIO_FORMAT_NODE ? write_node(ctx, path, &job) : write_one(ctx, path, &job, format));
done:
    return status;
}
