/* Memory estimates.
 *
 * The constants are those of the data structures or measured, as said beside them; measurement adjusts them here and
 * nowhere else. docs/performance.md holds the estimates against the peaks of many inputs. What no estimate foresees meets
 * the limit of the context, which is set together with it and refuses while the work runs. */
#include "estimate.h"

#define PROGRAM     4.5e6 /* the program itself, its libraries and small blocks */
#define COORDINATES 24.0
#define WEIGHT      8.0
#define INDEX       4.0
#define FACE_OFFSET 8.0

/* While points are inserted: record, index in the input, representative, number in the cavity. */
#define INSERT_BYTES_A_POINT       41.0
#define INSERT_BYTES_A_TETRAHEDRON 33.0
/* Then, where points are hidden, what finds the vertices that represent them (autzen and csite4: 32). */
#define BYTES_A_HIDDEN_POINT 32.0
/* While the result is sorted: index, representative and two buckets; two numbers a tetrahedron. */
#define SORT_BYTES_A_POINT       16.0
#define SORT_BYTES_A_TETRAHEDRON 41.0
/* With threads: the rank on the curve, and a thirty-second of the result moved at a time, with the lists for it. */
#define THREADS_BYTES_A_POINT       4.0
#define THREADS_BYTES_A_TETRAHEDRON 1.25

/* More: 300,000 points of a scan peak at 892 bytes a point resident, 322 by the walk. */
#define HISTORY_BYTES_A_POINT 570.0

/* Measured: models take 1,480 to 1,590 bytes a sample, a raw scan 1,610, offsets 1,260, the co-cone 560 to 660. */
#define CRUST_BYTES_A_POINT    1450.0
#define COCONE_BYTES_A_POINT   640.0
#define TRIANGLE_BYTES_A_POINT 300.0  /* more, with --triangulate: a scan of 20,000 points 210, bunny 350 */
#define SIMPLIFY_BYTES_A_POINT 2300.0 /* more: knot2 2,070, bunny 2,400, fandisk 2,510 */
#define SUBDIVIDE_BYTES_A_FACE 76.0   /* of the result, the certificate included */
#define ISO_BYTES_A_VERTEX     71.0
#define LOCATION_BYTES_A_POINT 8.0 /* of the others, and of what goes along edges, beside the next */
#define EDGE_BYTES_A_CORNER    8.0 /* an edge has two corners, and takes 8 bytes as a pair and 8 in the graph */
#define INFO_BYTES_A_POINT     6.0 /* the hash table of duplicates */
#define SAMPLE_BYTES           3e6 /* of the triangulations that estimates are told from */

double cli_mesh_bytes(const brio_mesh *mesh) {
    double bytes = COORDINATES * (double)mesh->num_vertices + 4 * INDEX * (double)mesh->num_tetrahedra;
    if (mesh->num_faces)
        bytes += FACE_OFFSET * (double)mesh->num_faces + INDEX * (double)mesh->face_offsets[mesh->num_faces];
    for (size_t i = 0; i < mesh->num_properties; i++)
        bytes += (double)brio_scalar_size(mesh->properties[i].type) * (double)mesh->num_vertices;
    return bytes;
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

double cli_delaunay_bytes(const brio_mesh *mesh, bool weighted, int threads, const triangulation_size *size) {
    double points = (double)mesh->num_vertices, input = cli_mesh_bytes(mesh) + (weighted ? WEIGHT * points : 0);
    double insert = INSERT_BYTES_A_POINT * points + INSERT_BYTES_A_TETRAHEDRON * size->tetrahedra +
                    BYTES_A_HIDDEN_POINT * size->hidden;
    double sort = SORT_BYTES_A_POINT * points + SORT_BYTES_A_TETRAHEDRON * size->tetrahedra;
    if (threads > 1) sort += THREADS_BYTES_A_TETRAHEDRON * size->tetrahedra;
    return PROGRAM + input + (threads > 1 ? THREADS_BYTES_A_POINT * points : 0) + larger(insert, sort);
}

double cli_location_bytes(brio_location location, const brio_mesh *mesh) {
    double points = (double)mesh->num_vertices, corners = 0;
    if (mesh->num_faces) corners = (double)mesh->face_offsets[mesh->num_faces];
    bool keeps_history = location == BRIO_LOCATION_HISTORY || location == BRIO_LOCATION_TRACE;
    bool has_edges = location == BRIO_LOCATION_NEIGHBOUR || location == BRIO_LOCATION_TRACE;
    return points * (keeps_history ? HISTORY_BYTES_A_POINT : LOCATION_BYTES_A_POINT) +
           (has_edges ? corners * EDGE_BYTES_A_CORNER : 0);
}

double cli_crust_bytes(const brio_mesh *mesh) {
    return PROGRAM + (double)mesh->num_vertices * CRUST_BYTES_A_POINT;
}

double cli_cocone_bytes(const brio_mesh *mesh) {
    return PROGRAM + (double)mesh->num_vertices * COCONE_BYTES_A_POINT;
}

double cli_crust_extra_bytes(size_t points, bool simplify, bool triangulate) {
    return (double)points * ((simplify ? SIMPLIFY_BYTES_A_POINT : 0) + (triangulate ? TRIANGLE_BYTES_A_POINT : 0));
}

double cli_info_bytes(const brio_mesh *mesh) {
    double table = INFO_BYTES_A_POINT * (double)mesh->num_vertices;
    return PROGRAM + cli_mesh_bytes(mesh) + larger(table, SAMPLE_BYTES);
}

double cli_subdivide_bytes(const brio_mesh *mesh, int levels) {
    double faces = (double)mesh->num_faces;
    for (int i = 0; i < levels; i++) faces *= 4;
    return PROGRAM + faces * SUBDIVIDE_BYTES_A_FACE;
}

double cli_generate_bytes(size_t points) {
    return PROGRAM + (double)points * COORDINATES;
}

double cli_iso_bytes(size_t vertices) {
    return PROGRAM + (double)vertices * ISO_BYTES_A_VERTEX;
}
