/* Memory estimates of commands: see estimate.h. */
#include "estimate.h"
#include <math.h>

static const double COORDINATES = 24, WEIGHT = 8, INDEX = 4, FACE_OFFSET = 8;
static const double INFO_BYTES_A_POINT = 6; /* the hash table of duplicates */
static const double SAMPLE_BYTES = 3e6;     /* of the triangulations of the estimates */

double cli_mesh_bytes(const brio_mesh *mesh) {
    double bytes = COORDINATES * (double)mesh->num_vertices + 4 * INDEX * (double)mesh->num_tetrahedra;
    if (mesh->num_faces)
        bytes += FACE_OFFSET * (double)mesh->num_faces + INDEX * (double)mesh->face_offsets[mesh->num_faces];
    for (size_t i = 0; i < mesh->num_properties; i++)
        bytes += (double)brio_scalar_size(mesh->properties[i].type) * (double)mesh->num_vertices;
    return bytes;
}

brio_status cli_delaunay_bytes(run *r, const brio_mesh *mesh, const double *weights, const brio_delaunay_options *o,
                               double *bytes) {
    uint64_t work;
    brio_status status = brio_estimate_delaunay(r->ctx, mesh->vertices, weights, mesh->num_vertices, o, &work);
    *bytes =
        CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + (weights ? WEIGHT * (double)mesh->num_vertices : 0) + (double)work;
    return status;
}

double cli_info_bytes(const brio_mesh *mesh) {
    return CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) +
           fmax(INFO_BYTES_A_POINT * (double)mesh->num_vertices, SAMPLE_BYTES);
}

brio_status cli_require_work(run *r, brio_status status, const brio_mesh *input, uint64_t work) {
    if (status != BRIO_OK) return status;
    return cli_require_memory(r, CLI_PROGRAM_BYTES + (input ? cli_mesh_bytes(input) : 0) + (double)work);
}
