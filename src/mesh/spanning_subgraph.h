/* Sparse connected subgraphs of the edges of a mesh, as plain arrays of vertex pairs. */
#ifndef BRIO_MESH_SPANNING_SUBGRAPH_H
#define BRIO_MESH_SPANNING_SUBGRAPH_H

#include "base/memory.h"

/** All edges of a mesh of polygons, each once, in the order of their first half-edges.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_edges(brio_context *ctx, const brio_mesh *mesh, brio_edges *out);

/** A breadth-first tree of each component of a graph, from the vertex of least index. The edges come in the order of
 *  the search, as (parent, child): the parent is a root, or the child of an edge before. Linear time.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an end that is no vertex), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_breadth_first_tree(brio_context *ctx, const brio_edges *edges, size_t num_vertices, brio_edges *out);

/** A minimum spanning tree of each component of a graph by the length of its edges, shortest first; it is the Euclidean
 *  minimum spanning tree of the points when the graph holds that. Of edges equally long to the precision of doubles the
 *  one that comes first is taken.   points  num_vertices by 3, finite.   Time O(E a(E)).
 *  Returns as brio_breadth_first_tree. */
brio_status brio_minimum_spanning_tree(brio_context *ctx, const brio_edges *edges, const double *points,
                                       size_t num_vertices, brio_edges *out);

/** What the making of a spanning subgraph counts. */
typedef struct brio_subgraph_stats {
    size_t vertices;  /* on faces */
    size_t copies;    /* of vertices, after cutting */
    size_t cut_edges; /* edges cut, those of spheres' triangles and boundaries among them */
    uint64_t steps;   /* half-edges that were visited, the sort of the edges left aside */
    uint32_t max_degree;
} brio_subgraph_stats;

/** A subgraph of the edges of a triangulated surface that reaches every vertex on a face, is connected in each
 *  component (components joined at a single vertex count as one) and has bounded degree: at most 3 on closed surfaces
 *  of genus 0, 12 g on those of genus g, each component for itself; at most 3 on disks. On other surfaces with
 *  boundary, and at pinched vertices, three times the number of pieces that the cut leaves of the vertex. Linear time;
 *  about 15 bytes a corner of the mesh.   stats  may be NULL.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (faces that are no triangles, edges
 *  of more than two faces or of faces that disagree), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_spanning_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_edges *out,
                                   brio_subgraph_stats *stats);

#endif
