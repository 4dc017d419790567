/* brio/laboratory.h: what serves experiments on the algorithms: counters during an insertion, caches, sparse
 * subgraphs. */
#ifndef BRIO_LABORATORY_H
#define BRIO_LABORATORY_H

#include "triangulation.h"
#include "queries.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/** record_every: one entry at the end of each round; in orders without rounds after 4,096 points, 8,192, and so on. */
#define BRIO_RECORD_ROUNDS UINT64_MAX

/** Counters at a moment of the insertion. They count from the start, as those of brio_delaunay_stats. */
typedef struct brio_round {
    size_t points;     /* inserted so far */
    size_t tetrahedra; /* at that moment, infinite ones included */
    uint64_t created, destroyed, walk_steps, insphere_calls, history;
    double locate_seconds;                     /* as in brio_delaunay_stats */
    double seconds;                            /* since the insertion began */
    uint64_t pages, page_touches, page_faults; /* with page_bytes */
    uint64_t reserved[1];
} brio_round;

/** Returns the counters recorded during the insertion: *count entries of rising `points`, the last one at the end of
 *  the insertion; NULL and 0 unless options.record_every was set. Every number of threads records at the same numbers
 *  of points, but the counters between two records depend on how the threads met. Records at small intervals slow
 *  several threads down, because these insert together only what lies between two records. The view is valid until the
 *  triangulation is freed. */
BRIO_API const brio_round *brio_triangulation_rounds(const brio_triangulation *t, size_t *count);

/** Returns the page faults of the insertion in caches of 1, 2, 4, ... pages that drop the page least recently used:
 *  *count entries, the last one for the first cache that holds all pages. NULL and 0 without page_bytes. Pages and
 *  faults are those of brio_delaunay_stats. The view is valid until the triangulation is freed.
 *  Based on: [Mattson Gecsei Slutz Traiger 1970]. */
BRIO_API const uint64_t *brio_triangulation_cache_faults(const brio_triangulation *t, size_t *count);

/** Sparse subgraphs of the edges of a mesh. */
typedef enum brio_subgraph {
    BRIO_SUBGRAPH_BOUNDED = 0, /* of bounded degree, for oriented surfaces of triangles */
    BRIO_SUBGRAPH_MINIMUM =
        1,                  /* a minimum spanning tree by length, of any mesh; its degree is at most 12 where the mesh
                                  contains the Euclidean minimum spanning tree of its vertices */
    BRIO_SUBGRAPH_TREE = 2, /* a breadth-first tree, of any mesh; its degree is at most the mesh's */
    BRIO_SUBGRAPH_ALL = 3,  /* every edge, once */
    BRIO_SUBGRAPH_END
} brio_subgraph;

/** Finds a subgraph of the edges of a mesh that contains all vertices of faces and connects what the mesh connects. It
 *  is meant for brio_delaunay_options.edges, when the surface of the points is known. BRIO_SUBGRAPH_BOUNDED has degree
 *  at most 3 on disks and on closed components of genus 0, and at most 12 g on closed components of genus g; no bound
 *  is promised where a component has several boundary loops or shares a vertex with another one.
 *  Cost: linear for BOUNDED and TREE; about 20 bytes a corner of the mesh.
 *  out  freed with brio_edges_free.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (BOUNDED: a face is no triangle, an
 *  edge has more than two faces or two faces that run along it in the same direction), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Choi 2003] section 4.3, [Lazarus Pocchiola Vegter Verroust 2001], [Kruskal 1956]. */
BRIO_API brio_status brio_mesh_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out);

#ifdef __cplusplus
}
#endif
#endif
