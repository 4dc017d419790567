/* Memory estimates of commands: see estimate.h. */
#include "cli/steps/estimate.h"
#include <math.h>

static const double COORDINATES = 24, WEIGHT = 8, INDEX = 4, FACE_OFFSET = 8;
static const double INFO_BYTES_A_POINT = 6; /* the hash table of duplicates */
static const double SAMPLE_BYTES = 8e6;     /* of the triangulations of the estimates, at most */
static const double USUAL_TETRAHEDRA = 6.8; /* a point, where points are spread evenly or scanned */

double cli_mesh_bytes(const brio_mesh *mesh) {
    double bytes = COORDINATES * (double)mesh->num_vertices + 4 * INDEX * (double)mesh->num_tetrahedra;
    if (mesh->num_faces)
        bytes += FACE_OFFSET * (double)mesh->num_faces + INDEX * (double)mesh->face_offsets[mesh->num_faces];
    for (size_t i = 0; i < mesh->num_properties; i++)
        bytes += (double)brio_scalar_size(mesh->properties[i].type) * (double)mesh->num_vertices;
    for (size_t i = 0; i < mesh->num_face_properties; i++)
        bytes += (double)brio_scalar_size(mesh->face_properties[i].type) * (double)mesh->num_faces;
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

brio_status cli_usual_points(run *r, const brio_mesh *mesh, const double *weights, bool asked, size_t *points) {
    uint64_t tetrahedra = 0;
    *points = mesh->num_vertices;
    if (!asked && !cli_limits_memory(r)) return BRIO_OK;
    FORWARD(brio_estimate_tetrahedra(r->ctx, mesh->vertices, weights, mesh->num_vertices, &tetrahedra));
    *points = (size_t)fmax((double)mesh->num_vertices, (double)tetrahedra / USUAL_TETRAHEDRA);
    return BRIO_OK;
}

double cli_hull_bytes(const brio_mesh *mesh) {
    static const double A_POINT = 264; /* measured on points on a sphere: all are vertices of the hull */
    return CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + A_POINT * (double)mesh->num_vertices;
}

double cli_alpha_bytes(const brio_mesh *mesh, size_t usual) {
    static const double A_POINT = 1400; /* of the complex and its work */
    return CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + A_POINT * (double)usual;
}

double cli_voronoi_bytes(double delaunay, size_t usual, bool vertices) {
    /* Measured on 40,000 uniform points: 2,591 bytes a point in all, 3,688 with vertices; less those that brio_delaunay
     * takes. */
    static const double CELL = 2300 + 32 /* the copy of a point */, VERTICES = 1100;
    return delaunay + (CELL + (vertices ? VERTICES : 0)) * (double)usual;
}

double cli_locate_bytes(const brio_mesh *mesh, double delaunay, const brio_mesh *places) {
    /* Of a locator for evenly spread points (brio.h, brio_locator_new), of which the triangulation's estimate covers
     * the part that is sorted; and of a query with its answers. */
    static const double LOCATOR = 290, PLACE = 48;
    double bytes = delaunay + LOCATOR * (double)mesh->num_vertices;
    return places ? bytes + cli_mesh_bytes(places) + PLACE * (double)places->num_vertices : bytes;
}

double cli_info_bytes(const brio_mesh *mesh) {
    return CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) +
           fmax(INFO_BYTES_A_POINT * (double)mesh->num_vertices, SAMPLE_BYTES);
}

brio_status cli_require_work(run *r, brio_status status, const brio_mesh *input, uint64_t work) {
    if (status != BRIO_OK) return status;
    return cli_require_memory(r, CLI_PROGRAM_BYTES + (input ? cli_mesh_bytes(input) : 0) + (double)work);
}
