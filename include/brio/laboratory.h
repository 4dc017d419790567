/* brio/laboratory.h: what the experiments of [Choi 2003] need and no user does: other strategies of location, other
 * orders, labelings and extractions, and counters during an insertion. They are a library beside libbrio, which the
 * program, the tests and the Python module are linked with, and which is not installed. The structs are of its build. */
#ifndef BRIO_LABORATORY_H
#define BRIO_LABORATORY_H

#include "mesh.h"
#include "queries.h"
#include "surface.h"
#include "triangulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Strategies of point location: how the insertion finds the tetrahedron that holds a point. All give the same
 *  tetrahedra. Only the walk works with several threads. TRACE locates a point that no edge reaches as HISTORY does,
 *  and NEIGHBOUR as WALK does. Memory in bytes beyond the walk's: JUMP 4 a point; HIERARCHY about 17 a point; NEIGHBOUR
 *  8 a point and 8 an edge; TRACE 16 a point and 8 an edge; HISTORY and TRACE also 20 for each tetrahedron ever created
 *  and 4 for each tetrahedron of the result. */
typedef enum brio_location {
    BRIO_LOCATION_WALK = 0,      /* from the point inserted last [Devillers Pion Teillaud 2002] */
    BRIO_LOCATION_JUMP = 1,      /* from the nearest of i^(1/4) vertices and the last one [Muecke Saias Zhu 1999] */
    BRIO_LOCATION_HIERARCHY = 2, /* through triangulations of ever larger samples [Devillers 2002] */
    BRIO_LOCATION_HISTORY = 3,   /* in the history DAG [Guibas Knuth Sharir 1992, Clarkson Mehlhorn Seidel 1993] */
    BRIO_LOCATION_TRACE =
        4, /* traces the given edges now and then and uses the history DAG between; in BRIO_ORDER_RANDOM
                                O(n log* n) when the edges are Delaunay edges that span the points [Choi 2003, ch. 4] */
    BRIO_LOCATION_NEIGHBOUR =
        5, /* from the nearest of the point's neighbours along the given edges and the last point */
    BRIO_LOCATION_END
} brio_location;

/** Insertion orders by blocks of points, shuffled inside a block. They insert with several threads. */
typedef enum brio_laboratory_order {
    BRIO_BLOCKS_NONE = 0,        /* the order of the call's own options */
    BRIO_BLOCKS_BRIO_OCTREE = 1, /* random rounds, octree blocks inside a round [Choi 2003] */
    BRIO_BLOCKS_BRIO_KDTREE = 2, /* the same with the blocks of a k-d tree */
    BRIO_BLOCKS_OCTREE = 3,      /* one round of octree blocks */
    BRIO_BLOCKS_END
} brio_laboratory_order;

/** Ways to label poles as inner or outer, in place of brio_pole_options.labeling. */
typedef enum brio_laboratory_labeling {
    BRIO_LABELS_NONE = 0,        /* the labeling of the call's own options */
    BRIO_LABELS_NAIVE = 1,       /* breadth first from outside [Choi 2003, section 3.3.3] */
    BRIO_LABELS_THEORETICAL = 2, /* breadth first from one sample [Choi 2003, appendix B.3] */
    BRIO_LABELS_END
} brio_laboratory_labeling;

/** How the co-cone makes a surface of its candidate triangles. */
typedef enum brio_extraction {
    BRIO_EXTRACTION_LABELS = 0, /* the candidates between tetrahedra labeled outer and inner, and small gaps filled */
    BRIO_EXTRACTION_CANDIDATES = 1, /* all candidates, as [Choi 2003] has implemented it; not oriented, no manifold */
    BRIO_EXTRACTION_PRUNED = 2,     /* those left when triangles at sharp edges are removed, recursively; likewise */
    BRIO_EXTRACTION_WALK = 3,       /* of these, each component's outside, by a walk from edge to edge
                                       [Amenta Choi Dey Leekha 2000]: a manifold on dense samples */
    BRIO_EXTRACTION_END
} brio_extraction;

/** record_every: one entry at the end of each round; in orders without rounds after 4,096 points, 8,192, and so on. */
#define BRIO_RECORD_ROUNDS UINT64_MAX

/** What an experiment does otherwise. A field of 0 leaves the library's own way. */
typedef struct brio_laboratory_options {
    /* Triangulations of space. */
    brio_location locate;
    int all_conflicts;  /* HISTORY and TRACE: 1 follows all conflicts, 0 one search path */
    int first_conflict; /* HISTORY and TRACE: 1 searches depth first through conflicts, up to the first one that is
                              alive, as the program hull of Clarkson does. Not with all_conflicts */
    int reserved_int;
    const uint32_t *edges; /* TRACE and NEIGHBOUR: num_edges pairs of indices of points; kept, not copied */
    size_t num_edges;
    uint64_t record_every; /* insertions between two entries of brio_laboratory_rounds, or BRIO_RECORD_ROUNDS */
    uint64_t page_bytes;   /* counts page touches of so large pages, a power of two from 64 on, with one thread */
    uint64_t cache_bytes;  /* of the cache for page_faults; 0: of one page */
    /* Insertion orders, also of hulls and of triangulations of the plane. round_ratio 0 is then 1/2. */
    brio_laboratory_order order;
    int reserved_int2;
    size_t block_size; /* most points in a block; 0: 2,000 */
    /* Surfaces. */
    brio_laboratory_labeling labeling; /* of poles, where no solid labels them */
    brio_extraction extraction;        /* of BRIO_SURFACE_COCONE in one piece; of others BRIO_ERR_ARGUMENT */
} brio_laboratory_options;

/** What an experiment counted, in the last triangulation of space and in the last labeling. */
typedef struct brio_laboratory_stats {
    uint64_t history;             /* nodes of the history DAG, with HISTORY or TRACE */
    uint64_t history_tests;       /* nodes that searches compared with a point */
    uint64_t history_conflicts;   /* of these, with first_conflict or all_conflicts: nodes in conflict */
    uint64_t trace_intersections; /* tetrahedra entered while edges were traced */
    /* With page_bytes: pages of the records, of the tetrahedra and of the history; how often one was touched; and how
     * often the cache, which drops the page that was least recently used, did not have it. An insertion touches what
     * its location comes to, what it tests in conflict, what lies behind that, and what it writes. These depend on the
     * sequence of insertions alone, not on the machine. */
    uint64_t pages, page_touches, page_faults;
    size_t unreached; /* NAIVE, THEORETICAL: poles that were left to the greedy labeling */
} brio_laboratory_stats;

/** Counters at a moment of the insertion. They count from the start, as those of brio_delaunay_stats. */
typedef struct brio_round {
    size_t points;     /* inserted so far */
    size_t tetrahedra; /* at that moment, infinite ones included */
    uint64_t created, destroyed, walk_steps, insphere_calls, history;
    double locate_seconds;                     /* as in brio_delaunay_stats */
    double seconds;                            /* since the insertion began */
    uint64_t pages, page_touches, page_faults; /* with page_bytes */
} brio_round;

typedef struct brio_laboratory brio_laboratory;

/** Begins an experiment: the calls with this context do as the options say, and so do their memory estimates, until
 *  brio_laboratory_end. A context has one experiment at a time.   options  copied.   out  owned by the caller.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_TOO_LARGE (the edges), BRIO_ERR_NO_MEMORY. A triangulation returns
 *  BRIO_ERR_ARGUMENT besides if an edge ends at a point that there is not. */
BRIO_API brio_status brio_laboratory_new(brio_context *ctx, const brio_laboratory_options *options,
                                         brio_laboratory **out);

/** Ends the experiment: the context's calls are as ever. What was recorded stays. NULL is accepted. */
BRIO_API void brio_laboratory_end(brio_laboratory *lab);

/** Ends an experiment and frees what it recorded; NULL is accepted. */
BRIO_API void brio_laboratory_free(brio_laboratory *lab);

/** Returns what was counted. The view is valid until the experiment is freed, and changes with its context's calls. */
BRIO_API const brio_laboratory_stats *brio_laboratory_results(brio_laboratory *lab);

/** Returns the counters recorded during the last triangulation: *count entries of rising `points`, the last one at the
 *  end of the insertion; NULL and 0 unless options.record_every was set. Every number of threads records at the same
 *  numbers of points, but the counters between two records depend on how the threads met. Records at small intervals
 *  slow several threads down, because these insert together only what lies between two records. The view is valid
 *  until the context's next triangulation. */
BRIO_API const brio_round *brio_laboratory_rounds(const brio_laboratory *lab, size_t *count);

/** Returns the page faults of the last triangulation in caches of 1, 2, 4, ... pages that drop the page least recently
 *  used: *count entries, the last one for the first cache that holds all pages. NULL and 0 without page_bytes. The
 *  view is valid as that of brio_laboratory_rounds.   Based on: [Mattson Gecsei Slutz Traiger 1970]. */
BRIO_API const uint64_t *brio_laboratory_cache_faults(brio_laboratory *lab, size_t *count);

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
 *  is meant for brio_laboratory_options.edges, when the surface of the points is known. BRIO_SUBGRAPH_BOUNDED has
 *  degree at most 3 on disks and on closed components of genus 0, and at most 12 g on closed components of genus g; no
 *  bound is promised where a component has several boundary loops or shares a vertex with another one.
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
