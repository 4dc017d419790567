/* Memory estimates: bytes a point, for points that fill space or lie on a surface as scans do. Points on certain
 * surfaces have more tetrahedra (20 a point on a torus, and up to n^2 of them on a moment curve); there the limit
 * of the context, set together with the estimate, refuses while the work runs.
 *
 * The constants are those of the data structures or measured, as said beside them; measurement adjusts them here and
 * nowhere else. */
#include "estimate.h"

#define COORDINATES        24.0
#define WEIGHT             8.0
#define INDEX              4.0
#define FACE_OFFSET        8.0
#define TETRAHEDRA_A_POINT 6.8 /* of uniform points; raw scans have 6.2 to 6.4 */
#define BYTES_A_POINT      44.0
/* 33 of the triangulation with the slack of its growth, and 8 of the sort of its result: 1 million uniform points peak
 * at 353 bytes a point resident, input included. The output, 16 bytes a tetrahedron, comes after that peak and stays
 * below it. */
#define BYTES_A_TETRAHEDRON 45.0
/* Scans and models peak at 1,260 (dragon stand) to 1,720 (bunny) bytes a sample resident. */
#define SURFACE_BYTES_A_POINT 1600.0
/* Of the result: 4 million faces from 1 million peak at 77 bytes a face resident, the certificate included. */
#define GLOBAL_BYTES_A_POINT   600.0  /* more: the flow of anchor_scan takes 570, of the bunny 300 */
#define SIMPLIFY_BYTES_A_POINT 1700.0 /* more: bunny 1,570, fandisk 1,700 */
#define SUBDIVIDE_BYTES_A_FACE 78.0
#define LOCATION_BYTES_A_POINT 8.0 /* of the others, and of what goes along edges, beside the next */
#define EDGE_BYTES_A_CORNER    8.0 /* an edge has two corners, and takes 8 bytes as a pair and 8 in the graph */
#define INFO_BYTES_A_POINT     6.0 /* the hash table of duplicates */

double cli_mesh_bytes(const brio_mesh *mesh) {
    double bytes = COORDINATES * (double)mesh->num_vertices + 4 * INDEX * (double)mesh->num_tetrahedra;
    if (mesh->num_faces)
        bytes += FACE_OFFSET * (double)mesh->num_faces + INDEX * (double)mesh->face_offsets[mesh->num_faces];
    for (size_t i = 0; i < mesh->num_properties; i++)
        bytes += (double)brio_scalar_size(mesh->properties[i].type) * (double)mesh->num_vertices;
    return bytes;
}

double cli_delaunay_bytes(size_t points, bool weighted) {
    double point = BYTES_A_POINT + TETRAHEDRA_A_POINT * BYTES_A_TETRAHEDRON + (weighted ? WEIGHT : 0);
    return (double)points * point;
}

double cli_location_bytes(brio_location location, const brio_mesh *mesh) {
    double points = (double)mesh->num_vertices, corners = 0;
    if (mesh->num_faces) corners = (double)mesh->face_offsets[mesh->num_faces];
    bool keeps_history = location == BRIO_LOCATE_HISTORY || location == BRIO_LOCATE_TRACE;
    bool has_edges = location == BRIO_LOCATE_NEIGHBOUR || location == BRIO_LOCATE_TRACE;
    return points * (keeps_history ? HISTORY_BYTES_A_POINT : LOCATION_BYTES_A_POINT) +
           (has_edges ? corners * EDGE_BYTES_A_CORNER : 0);
}

double cli_surface_bytes(size_t points) {
    return (double)points * SURFACE_BYTES_A_POINT;
}

double cli_crust_extra_bytes(size_t points, bool global, bool simplify) {
    return (double)points * ((global ? GLOBAL_BYTES_A_POINT : 0) + (simplify ? SIMPLIFY_BYTES_A_POINT : 0));
}

double cli_info_bytes(size_t points) {
    return (double)points * INFO_BYTES_A_POINT;
}

double cli_subdivide_bytes(const brio_mesh *mesh, int levels) {
    double faces = (double)mesh->num_faces;
    for (int i = 0; i < levels; i++) faces *= 4;
    return faces * SUBDIVIDE_BYTES_A_FACE;
}

double cli_generate_bytes(size_t points) {
    return (double)points * COORDINATES;
}
