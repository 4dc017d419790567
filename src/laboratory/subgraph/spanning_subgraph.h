/* Sparse connected subgraphs of the edges of a mesh, as arrays of vertex pairs. */
#ifndef BRIO_LABORATORY_SPANNING_SUBGRAPH_H
#define BRIO_LABORATORY_SPANNING_SUBGRAPH_H

#include "brio/laboratory.h"
#include "mesh/twins.h"

/** Lists all edges of a mesh of polygons, each once, in the order of the last half-edges of the edges.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_edges(brio_context *ctx, const brio_mesh *mesh, brio_edges *out);

/** Makes a breadth-first tree of each component of a graph, from the vertex of least index. Edges are listed in the
 *  order of the search, as (parent, child): the parent is a root or the child of an earlier edge. Linear time.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an end that is no vertex), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_breadth_first_tree(brio_context *ctx, const brio_edges *edges, size_t num_vertices, brio_edges *out);

/** Makes a minimum spanning tree of each component of a graph by edge length; lists its edges shortest first. The
 *  result is the Euclidean minimum spanning tree of the points when the graph contains that tree. Among edges whose
 *  computed lengths are equal, the first is taken.   points  num_vertices by 3, finite.   Time O(E a(E)).
 *  Returns what brio_breadth_first_tree returns. */
brio_status brio_minimum_spanning_tree(brio_context *ctx, const brio_edges *edges, const double *points,
                                       size_t num_vertices, brio_edges *out);

/** Counts from brio_spanning_subgraph. */
typedef struct brio_subgraph_stats {
    size_t vertices;  /* vertices on faces */
    size_t copies;    /* copies of vertices after cutting */
    size_t cut_edges; /* edges cut, including boundary edges and the edges of the triangles cut out of spheres */
    uint64_t steps;   /* half-edges visited, without the sort of the edges */
    uint32_t max_degree;
} brio_subgraph_stats;

/** Finds a subgraph of the edges of a triangulated surface that reaches every vertex on a face, is connected in each
 *  component and has bounded degree. Components joined at a single vertex count as one component. The degree is at
 *  most 3 on disks and on closed components of genus 0, and at most 12 g on closed components of genus g. At pinched
 *  vertices, and on other surfaces with boundary, it is at most three times the number of copies that the cut makes of
 *  the vertex. Linear time; about 15 bytes a corner of the mesh.   stats  may be NULL.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (a face that is not a triangle, an
 *  edge of more than two faces, or two faces that disagree on the direction of an edge), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_spanning_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_edges *out,
                                   brio_subgraph_stats *stats);

enum { BRIO_EDGE_CUT = 1 }; /* bit 0 of brio_disk_cut.flags; the user of the cut may use the other bits */

typedef struct brio_disk_cut {
    uint32_t *twin;     /* from brio_mesh_twins */
    uint8_t *flags;     /* of each half-edge; BRIO_EDGE_CUT is equal on the two half-edges of an edge */
    uint32_t *sector;   /* of each corner */
    size_t num_corners; /* number of corners, which is the number of half-edges */
    size_t num_sectors;
    uint64_t steps; /* half-edges visited */
} brio_disk_cut;

/** Cuts every component of a surface into one disk; cuts a sphere into one triangle and the rest. The cut of a closed
 *  component of genus g > 0 is a connected graph with 2 g independent cycles and no loose ends. So no vertex has more
 *  than 4 g sectors. Linear time; 9 bytes a corner in the result, and up to 16 more during the call.
 *  out  freed with brio_disk_cut_free, also after a failure.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (a face that is not a triangle, an
 *  edge of more than two faces, or two faces that disagree on the direction of an edge), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_disk_cut_make(brio_context *ctx, const brio_mesh *mesh, brio_disk_cut *out);
void brio_disk_cut_free(brio_context *ctx, brio_disk_cut *cut);

#endif
