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
    uint64_t work = 0;
    brio_status status = brio_estimate_delaunay(r->ctx, mesh->vertices, weights, mesh->num_vertices, o, &work);
    *bytes =
        CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + (weights ? WEIGHT * (double)mesh->num_vertices : 0) + (double)work;
    return status;
}

double cli_hull_bytes(const brio_mesh *mesh) {
    static const double A_POINT = 264; /* measured on points on a sphere: all are vertices of the hull */
    return CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + A_POINT * (double)mesh->num_vertices;
}

double cli_alpha_bytes(const brio_mesh *mesh) {
    static const double A_POINT = 1400; /* of the complex and its work, with 6.8 tetrahedra a point */
    return CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + A_POINT * (double)mesh->num_vertices;
}

brio_status cli_voronoi_bytes(run *r, const brio_mesh *mesh, const double *weights, bool vertices, double *bytes) {
    /* Measured on 40,000 uniform points: 2,591 bytes a point in all, 3,688 with vertices; less those that brio_delaunay
     * takes. */
    static const double CELL = 2300 + 32 /* the copy of a point */, VERTICES = 1100;
    brio_delaunay_options o = brio_delaunay_options_default();
    brio_status status = cli_delaunay_bytes(r, mesh, weights, &o, bytes);
    *bytes += (CELL + (vertices ? VERTICES : 0)) * (double)mesh->num_vertices;
    return status;
}

brio_status cli_locate_bytes(run *r, const brio_mesh *mesh, const double *weights, const brio_mesh *places,
                             double *bytes) {
    /* Of a locator for evenly spread points (brio.h, brio_locator_new), of which the triangulation's estimate covers the
     * part that is sorted; and of a query with its answers. */
    static const double LOCATOR = 290, PLACE = 48;
    brio_delaunay_options o = brio_delaunay_options_default();
    brio_status status = cli_delaunay_bytes(r, mesh, weights, &o, bytes);
    *bytes += LOCATOR * (double)mesh->num_vertices;
    if (places) *bytes += cli_mesh_bytes(places) + PLACE * (double)places->num_vertices;
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
