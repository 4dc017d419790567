/* brio: exact three-dimensional Delaunay and regular triangulations of very large point sets, and surface
 * reconstruction with guarantees on top of them.   MIT licence.
 *
 * This header is the manual. It goes in the order of a user's work: status and context, triangulation, meshes and
 * their certificates, reconstruction, files, test data, predicates.
 *
 * Words, used in one meaning throughout:
 *   points      the rows of the input
 *   duplicates  points minus distinct positions; of coincident points the heaviest represents the others, then the
 *               one with the lowest index
 *   vertices    distinct positions that own a (Voronoi or power) cell
 *   hidden      distinct positions without a cell (never without weights), each represented by the vertex of least
 *               power distance, ties by lexicographic position
 *               points = vertices + duplicates + hidden
 *   infinite    the infinite vertex BRIO_INFINITE closes the convex hull: every hull facet belongs to one infinite
 *               tetrahedron
 *   facet       handle 4*t + i names the facet of tetrahedron t opposite to its vertex i; two facet handles that name
 *               the same triangle from its two sides are mates
 *   oriented    a tetrahedron (a, b, c, d) is positive when det [b-a, c-a, d-a] > 0
 *
 * Promises. Every sign of every predicate is right for every finite double. The same point set gives the same set of
 * tetrahedra for every order of the points, insertion order, location strategy and number of threads: ties are broken
 * by a symbolic perturbation of the lifted coordinate, keyed by lexicographic position [Devillers Teillaud 2011].
 * -0.0 equals 0.0. Arrays of the caller are read only, never kept, never reordered. The library never prints, exits
 * or aborts; every function that can fail returns a status, and the context keeps the sentence that explains it.
 * The caller's floating-point state (rounding, subnormal numbers, traps) does not matter: each function sets the state
 * that it needs, callbacks included, and gives the caller's back. A caller's stack needs 64 KiB.
 */
#ifndef BRIO_H
#define BRIO_H

#include <stddef.h>
#include <stdint.h>

#define BRIO_VERSION "0.1.0"

#if defined(_WIN32)
#define BRIO_API __declspec(dllexport)
#else
#define BRIO_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------------------------
 * Status and context
 */

/** What a function that can fail returns. Numbers are fixed; families have gaps. */
typedef enum brio_status {
    BRIO_OK = 0,
    /* the call */
    BRIO_ERR_ARGUMENT = 10,   /* an argument outside its documented range */
    BRIO_ERR_NOT_FINITE = 11, /* NaN or an infinity among coordinates or weights */
    /* the problem */
    BRIO_ERR_NO_ANSWER = 20, /* the input has no answer of the kind asked for, e.g. no inside found */
    BRIO_ERR_CHECK = 21,     /* a check found the object wrong */
    /* the machine */
    BRIO_ERR_NO_MEMORY = 30, /* the system or the memory limit refused memory */
    BRIO_ERR_TOO_LARGE = 31, /* more objects than indices can name */
    BRIO_ERR_CANCELLED = 32, /* the progress callback asked to stop */
    /* files */
    BRIO_ERR_OPEN = 40,   /* missing or unreadable */
    BRIO_ERR_FORMAT = 41, /* malformed, truncated, or of an unknown format */
    BRIO_ERR_WRITE = 42,  /* could not be written; nothing half-written is left behind */
    /* a fault of this library */
    BRIO_ERR_INTERNAL = 90,
    BRIO_STATUS_END
} brio_status;

/** A static sentence for a status; never NULL. */
BRIO_API const char *brio_status_string(brio_status status);

/** Memory functions of the caller's choice. alloc and realloc return NULL on failure; sizes are in bytes. */
typedef struct brio_allocator {
    void *(*alloc)(size_t size, void *user);
    void *(*realloc)(void *block, size_t size, void *user);
    void (*free)(void *block, void *user);
    void *user;
} brio_allocator;

/** Settings, the last error message and the memory account of one line of work. A context serves one call at a time;
 *  different contexts are independent. Everything made with a context must be freed before it. */
typedef struct brio_context brio_context;

/** Makes a context.   allocator  NULL for the system's memory (large arrays then live in mappings of their own, that
 *  grow without copying).   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_context_new(const brio_allocator *allocator, brio_context **out);

/** Frees a context; NULL is accepted. */
BRIO_API void brio_context_free(brio_context *ctx);

/** The sentence that explains the last failure in this context ("point 1842: y is NaN"); "" when there was none.
 *  Valid until the next call with the context. */
BRIO_API const char *brio_message(const brio_context *ctx);

/** Sets the most threads that work uses, the caller's included; 0 (default) means all processors that the process may run
 *  on. A number above four for each processor (and above 64) is taken for that. Work creates a thread when it is first
 *  worth one; the context keeps the threads, asleep, until it is freed. Where the system refuses a thread, work goes on
 *  with fewer. A child process after fork may go on using its copy of a context that was not in use; its
 *  threads are created anew. */
BRIO_API void brio_context_set_threads(brio_context *ctx, int threads);
/** Returns the number that was set, or the number of processors: at least 1. */
BRIO_API int brio_context_threads(const brio_context *ctx);

/** Called now and then from long work, in the calling thread, with the stage's name and its finished fraction in
 *  [0, 1]. A result other than 0 cancels the work: the function that runs frees everything and returns
 *  BRIO_ERR_CANCELLED. */
typedef int (*brio_progress_fn)(const char *stage, double fraction, void *user);
BRIO_API void brio_context_set_progress(brio_context *ctx, brio_progress_fn progress, void *user);

/** The context's account may not exceed `bytes`; a request beyond it fails with BRIO_ERR_NO_MEMORY. 0 removes the
 *  limit of the caller. The limits of the process' memory cgroup and of the machine hold always. */
BRIO_API void brio_context_set_memory_limit(brio_context *ctx, size_t bytes);

/** Large arrays made from now on live in unlinked mapped files in this folder instead of anonymous memory; each growth
 *  is allocated on disk before it is touched. A full disk or a limit on the size of files is BRIO_ERR_NO_MEMORY.
 *  NULL goes back to memory. Not with a caller's allocator.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_OPEN (not a writable folder), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_context_set_scratch(brio_context *ctx, const char *folder);

/** Bytes now held by objects and work of this context, and the most there ever were. */
BRIO_API size_t brio_context_memory(const brio_context *ctx);
BRIO_API size_t brio_context_memory_peak(const brio_context *ctx);

/* ------------------------------------------------------------------------------------------------------------------
 * Delaunay and regular triangulation
 */

#define BRIO_INFINITE UINT32_MAX

/** A tetrahedron: its vertices, as indices of points, and for the facet opposite to each of them its mate, the handle
 *  of the same facet seen from the tetrahedron on the other side. As an array of numbers: eight to a tetrahedron. */
typedef struct {
    uint32_t vertex[4], mate[4];
} brio_tetrahedron;

/** Insertion orders. All give the same tetrahedra. Several threads insert together except with RANDOM and INPUT, which
 *  follow no path through space. Workspace, bytes a point, given back before the insertion: BRIO, HILBERT and
 *  RANDOM 16, BRIO_OCTREE 5, BRIO_KDTREE 20, OCTREE 4, INPUT none. */
typedef enum brio_order {
    BRIO_ORDER_BRIO = 0,    /* random rounds, Hilbert curve inside a round: the tuned one [Amenta Choi Rote 2003] */
    BRIO_ORDER_HILBERT = 1, /* one round */
    BRIO_ORDER_RANDOM = 2,
    BRIO_ORDER_INPUT = 3,
    BRIO_ORDER_BRIO_OCTREE = 4, /* random rounds, octree blocks inside a round, shuffled inside a block [Choi 2003] */
    BRIO_ORDER_BRIO_KDTREE = 5, /* the same with the blocks of a k-d tree */
    BRIO_ORDER_OCTREE = 6,      /* octree blocks, shuffled inside a block; one round */
    BRIO_ORDER_END
} brio_order;

/** How a point finds its tetrahedron. All give the same tetrahedra; those other than the walk work on one thread.
 *  Points that edges do not reach are located as by BRIO_LOCATION_HISTORY (trace) or BRIO_LOCATION_WALK (neighbour).
 *  Memory beyond the walk's, in bytes a point: jump 4, hierarchy about 17, neighbour 8, trace 16, the last two 8 an
 *  edge besides; history and trace also 20 for every tetrahedron that is ever created and 4 for every one there is. */
typedef enum brio_location {
    BRIO_LOCATION_WALK = 0,  /* from the point inserted last [Devillers Pion Teillaud 2002] */
    BRIO_LOCATION_JUMP,      /* from the nearest of i^(1/4) vertices and the last one [Muecke Saias Zhu 1999] */
    BRIO_LOCATION_HIERARCHY, /* through triangulations of ever larger samples [Devillers 2002] */
    BRIO_LOCATION_HISTORY,   /* in the history DAG [Guibas Knuth Sharir 1992, Clarkson Mehlhorn Seidel 1993] */
    BRIO_LOCATION_TRACE,     /* edges are traced now and then, the history DAG does the rest; in BRIO_ORDER_RANDOM
                              O(n log* n) for Delaunay edges that span the points [Choi 2003, chapter 4] */
    BRIO_LOCATION_NEIGHBOUR, /* from the nearest of the point's neighbours along edges and the last point */
    BRIO_LOCATION_END
} brio_location;

typedef struct brio_delaunay_options {
    brio_order order;
    double round_ratio;      /* share of the points left for the rounds before the last, below 1; default 0: the
                                order's own, 1/8 for BRIO and 1/2 for BRIO_OCTREE and BRIO_KDTREE */
    uint64_t seed;           /* every random choice follows from it; default 1 */
    uint32_t max_tetrahedra; /* finite and infinite ones at any time; default (and most) 2^30 */
    size_t block_size;       /* most points of an octree or k-d tree block; default 0: 2,000 */
    uint64_t record_every;   /* insertions between two entries of brio_triangulation_rounds, or BRIO_RECORD_ROUNDS;
                                default 0: none are kept */
    brio_location locate;    /* default BRIO_LOCATION_WALK */
    int all_conflicts;       /* history and trace: follow all conflicts, not one path; default 0 */
    const uint32_t *edges;   /* trace and neighbour: num_edges pairs of indices of points; default NULL */
    size_t num_edges;
} brio_delaunay_options;

/** One entry at the end of each round; of orders without rounds, after 4,096 points, twice as many, and so on. */
#define BRIO_RECORD_ROUNDS UINT64_MAX

BRIO_API brio_delaunay_options brio_delaunay_options_default(void);

/** Facts of a triangulation. Counters are totals and include infinite tetrahedra. */
typedef struct brio_delaunay_stats {
    size_t points, vertices, duplicates, hidden;
    int dimension;      /* of the affine hull: -1 (no points) to 3 */
    size_t tetrahedra;  /* finite ones */
    size_t hull_facets; /* = infinite tetrahedra */
    uint64_t created, destroyed, walk_steps, insphere_calls;
    uint64_t exact_calls;         /* predicate calls that the floating-point filter did not settle */
    uint64_t deferred, serial;    /* with threads: insertions put off to a later pass; left to one thread */
    uint64_t history;             /* nodes of the history DAG, with BRIO_LOCATION_HISTORY or BRIO_LOCATION_TRACE */
    uint64_t history_tests;       /* nodes that searches held against a point */
    uint64_t trace_intersections; /* tetrahedra entered while edges were traced */
    double locate_seconds;        /* of the insertion: point location, from every 64th one; with one thread */
    double order_seconds, insert_seconds; /* the canonical sort of the output is part of the second */
} brio_delaunay_stats;

/** Counters when so many points were in; those of brio_delaunay_stats, up to then. */
typedef struct brio_round {
    size_t points;     /* inserted so far */
    size_t tetrahedra; /* at that time, infinite ones included */
    uint64_t created, destroyed, walk_steps, insphere_calls, history;
    double locate_seconds; /* as in brio_delaunay_stats */
    double seconds;        /* since the insertion began */
} brio_round;

typedef struct brio_triangulation brio_triangulation;

/** Builds the Delaunay triangulation of a point set; with weights, the regular triangulation (power distance
 *  |x - p|^2 - w).
 *  Any finite input is answered: points of dimension 2 or less have vertices, duplicates and hidden points but no
 *  tetrahedra.
 *  points   #P by 3, row after row.   weights  #P, or NULL.   num_points  less than 2^32 - 16.
 *  options  NULL for the defaults.    out      owned by the caller, freed with brio_triangulation_free; NULL on error.
 *  Cost: O(n log n) expected for points of realistic inputs; 33 bytes a tetrahedron and 41 a point, then, when the result
 *  is sorted, 41 and 16, with up to an eighth more set aside for growth; 4 bytes a point more with several threads.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Bowyer 1981], [Watson 1981], [Amenta Choi Rote 2003] for the order, [Devillers Teillaud 2011] for ties.
 *  */
BRIO_API brio_status brio_delaunay(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_delaunay_options *options, brio_triangulation **out);

/** Frees a triangulation; NULL is accepted. */
BRIO_API void brio_triangulation_free(brio_triangulation *t);

BRIO_API const brio_delaunay_stats *brio_triangulation_stats(const brio_triangulation *t);

/** The counters in the course of the insertion: *count entries of rising `points`, the last one at the end of the
 *  insertion; NULL and 0 unless options.record_every was set. The same numbers of points for every number of threads,
 *  which insert what lies between two entries together: small steps leave little to share, and the counters of a step
 *  depend on who came first. View. */
BRIO_API const brio_round *brio_triangulation_rounds(const brio_triangulation *t, size_t *count);

/** The #T = tetrahedra + hull_facets tetrahedra. The finite tetrahedra come first and are positive; an
 *  infinite tetrahedron has BRIO_INFINITE as its last vertex and the other three see the outside on their negative
 *  side ((a, b, c, x) is positive for x outside). The order is the same for every number of threads. View, valid until
 *  the triangulation is freed. */
BRIO_API const brio_tetrahedron *brio_triangulation_tetrahedra(const brio_triangulation *t);

/** #P: for each point the vertex that represents it: itself for a vertex. View. */
BRIO_API const uint32_t *brio_triangulation_representatives(const brio_triangulation *t);

/** Checks a triangulation exactly and completely against its points. What passes is the result of brio_delaunay, except
 *  that tetrahedra may come in another order (finite ones first) and with their vertices turned evenly: the tetrahedra
 *  cover the convex hull once and meet in common faces, the (ortho)sphere of each is empty of points, ties are broken by
 *  the symbolic perturbation, mates and infinite tetrahedra are right, and so are the representative of every point and
 *  the dimension and the numbers of vertices, duplicates, hidden points, tetrahedra and hull facets in the statistics.
 *  points, weights, num_points  as they were given to brio_delaunay.
 *  Cost: O(n) for n tetrahedra, and a walk for each point that is no vertex; inputs of dimension 1 and 2 are
 *  triangulated once more.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (another num_points than
 *  the triangulation has), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_check(brio_context *ctx, const brio_triangulation *t, const double *points,
                                              const double *weights, size_t num_points);

/** The same check for tetrahedra from anywhere, finite ones only, in any order and either orientation: the four indices
 *  of points of each are at tetrahedra + stride * i (stride 4 where they are packed, 8 for a view of a triangulation).
 *  Every Delaunay (regular) triangulation of the points passes, however its ties are broken, and nothing else: each
 *  position under one index, that of a heaviest of its points. No tetrahedra pass for points of dimension 2 or less.
 *  canonical  receives 1 when the ties are broken as brio_delaunay breaks them, so that the tetrahedra are the same up to
 *             coincident points of equal weight, else 0; unchanged on failure; may be NULL.
 *  Cost: O(n log n) for n tetrahedra, and a walk for each point that is no vertex.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (stride below 4),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE (from 2^29 tetrahedra on), BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tetrahedra_check(brio_context *ctx, const double *points, const double *weights,
                                           size_t num_points, const uint32_t *tetrahedra, size_t stride,
                                           size_t num_tetrahedra, int *canonical);

/** A hash of the set of tetrahedra over the lexicographic ranks of their vertices: independent of the order of the
 *  points and of the tetrahedra, and unchanged by scaling all points with a power of two.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation_checksum(brio_context *ctx, const brio_triangulation *t, const double *points,
                                                 uint64_t *checksum);

/* ------------------------------------------------------------------------------------------------------------------
 * Meshes and their certificates
 */

/** Scalar types of properties, as PLY has them. */
typedef enum brio_scalar {
    BRIO_SCALAR_INT8,
    BRIO_SCALAR_UINT8,
    BRIO_SCALAR_INT16,
    BRIO_SCALAR_UINT16,
    BRIO_SCALAR_INT32,
    BRIO_SCALAR_UINT32,
    BRIO_SCALAR_FLOAT32,
    BRIO_SCALAR_FLOAT64,
    BRIO_SCALAR_END
} brio_scalar;

/** Bytes of a scalar type. */
BRIO_API size_t brio_scalar_size(brio_scalar type);

/** One named number for each vertex. */
typedef struct brio_property {
    char name[64];
    brio_scalar type;
    void *data; /* #V scalars of `type` */
} brio_property;

/** Points, with polygons, tetrahedra or edges over them, and properties of the points: what a file holds. Polygons are
 *  stored one after the other: face f has the vertices face_vertices[face_offsets[f] .. face_offsets[f+1]). Vertices are
 *  never merged by position. All arrays are owned by the mesh; arrays of absent parts are NULL. */
typedef struct brio_mesh {
    brio_context *context;
    size_t num_vertices;
    double *vertices; /* #V by 3 */
    size_t num_faces;
    uint64_t *face_offsets; /* #F + 1 */
    uint32_t *face_vertices;
    size_t num_tetrahedra;
    uint32_t *tetrahedra; /* #T by 4 */
    size_t num_properties;
    brio_property *properties;
    size_t num_edges; /* that are drawn by themselves; those of polygons are not listed */
    uint32_t *edges;  /* #E by 2 */
} brio_mesh;

/** An empty mesh. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_new(brio_context *ctx, brio_mesh **out);
/** Frees a mesh with all its arrays; NULL is accepted. */
BRIO_API void brio_mesh_free(brio_mesh *mesh);

/** Gives an empty mesh its vertices (copied; vertices may be NULL: zeros). */
BRIO_API brio_status brio_mesh_set_vertices(brio_mesh *mesh, const double *vertices, size_t num_vertices);
/** Gives a mesh polygons (copied): offsets #F + 1, indices offsets[#F]. */
BRIO_API brio_status brio_mesh_set_faces(brio_mesh *mesh, const uint64_t *offsets, const uint32_t *indices,
                                         size_t num_faces);
/** Gives a mesh tetrahedra (copied): the four vertices of each are at tetrahedra + stride * i (4 where they are packed, 8
 *  for a view of a triangulation). */
BRIO_API brio_status brio_mesh_set_tetrahedra(brio_mesh *mesh, const uint32_t *tetrahedra, size_t stride,
                                              size_t num_tetrahedra);
/** Gives a mesh edges (copied): #E by 2. */
BRIO_API brio_status brio_mesh_set_edges(brio_mesh *mesh, const uint32_t *edges, size_t num_edges);
/** Adds a property of the vertices, zeroed, and returns where its numbers go in *data; a name that is there already is
 *  BRIO_ERR_ARGUMENT. */
BRIO_API brio_status brio_mesh_add_property(brio_mesh *mesh, const char *name, brio_scalar type, void **data);
/** The property of that name, or NULL. */
BRIO_API const brio_property *brio_mesh_property(const brio_mesh *mesh, const char *name);
/** Scalar i of a property as a double. */
BRIO_API double brio_property_value(const brio_property *property, size_t i);

/** Adds the properties nx, ny, nz (float32) of the vertices: unit normals, the mean of the faces round a vertex by
 *  area, to the side from which faces are seen counterclockwise; 0 where there is none. Returns BRIO_OK,
 *  BRIO_ERR_ARGUMENT (an index out of range, normals that are there already), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_add_normals(brio_mesh *mesh);

/** What can be said of a surface by connectivity alone, vertices never being merged by position.
 *  genus = sum over components (faces joined across edges) of (2 - chi - boundary loops) / 2. */
typedef struct brio_certificate {
    int closed;   /* there are faces, and every edge has two */
    int manifold; /* no edge has more than two faces; the faces round each vertex form one fan */
    int oriented; /* the two faces of an edge run along it in opposite directions */
    size_t components;
    int64_t genus;
    int64_t *genera; /* of each component, largest component (by faces) first; owned by the certificate */
    size_t boundary_edges, boundary_loops;
    size_t nonmanifold_edges, nonmanifold_vertices, flipped_edges;
    int64_t self_intersections; /* -1: not counted; see brio_mesh_self_intersections */
    double area, volume;        /* volume is signed: positive when the faces are seen counterclockwise from outside */
    brio_context *context;
} brio_certificate;

/** Certifies the polygons of a mesh. Cost O(F log F).
 *  Returns BRIO_OK (whatever the certificate says), BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out);
/** Counts the pairs of faces that meet in more than common corners and edges, exactly: faces that run through each
 *  other, touch, or overlap in one plane. Corners are common when their positions are equal. Polygons count as fans of
 *  triangles from their first corners; triangles without area meet nothing. Cost: near-linear in faces of about equal
 *  size; 100 bytes a face.   Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_self_intersections(brio_context *ctx, const brio_mesh *mesh, int64_t *pairs);

/** Frees what a certificate owns; a zeroed certificate is accepted. */
BRIO_API void brio_certificate_free(brio_certificate *certificate);

/** Distances between two surfaces, both ways, in the unit of the coordinates. */
typedef struct brio_distance {
    double mean, rms, p95, hausdorff; /* of the samples of either from the triangles of the other, exactly */
    double normal_consistency;        /* mean |cos| between the normals at a sample and at its nearest point */
    double diagonal;                  /* of the bounding box of b */
} brio_distance;

/** Compares two surfaces by `samples` random points on each (0: 100,000), uniform by area, and their nearest points on
 *  the other. Returns BRIO_OK, BRIO_ERR_ARGUMENT (a mesh without faces), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_distance(brio_context *ctx, const brio_mesh *a, const brio_mesh *b, size_t samples,
                                        uint64_t seed, brio_distance *out);

/** Subdivides a mesh of triangles by the butterfly scheme: each level gives every edge a vertex and makes four
 *  triangles of one. The surface goes through the old vertices, which stay where they are, with the same indices; its
 *  limit is smooth, also at vertices that have not six neighbours. Boundaries are curves of their own. Properties go
 *  along: new vertices have the mean of their edge's ends, or for whole numbers that of one end. levels  1 to 15.   out
 *  owned by the caller. Cost: linear in the result; 64 bytes a vertex of it and 118 a vertex of the level before.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (faces that are no triangles, edges of more than two faces or
 *  of faces that disagree), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Dyn Levin Gregory 1990], [Zorin Schroeder Sweldens 1996]. */
BRIO_API brio_status brio_mesh_subdivide(brio_context *ctx, const brio_mesh *mesh, int levels, brio_mesh **out);

/** Edges between vertices. Zeroed to begin with. */
typedef struct brio_edges {
    size_t count;
    uint32_t *ends; /* count by 2 */
} brio_edges;

/** Frees edges and zeroes the struct; zeroed ones are accepted. */
BRIO_API void brio_edges_free(brio_context *ctx, brio_edges *edges);

/** Sparse subgraphs of the edges of a mesh. */
typedef enum brio_subgraph {
    BRIO_SUBGRAPH_BOUNDED = 0, /* of bounded degree, for oriented surfaces of triangles */
    BRIO_SUBGRAPH_MINIMUM = 1, /* a minimum spanning tree by length, of any mesh; its degree is at most 12 where the
                                  mesh holds the Euclidean minimum spanning tree of its vertices */
    BRIO_SUBGRAPH_TREE = 2,    /* a breadth-first tree, of any mesh: of bounded degree where the mesh is */
    BRIO_SUBGRAPH_ALL = 3,     /* every edge, once */
    BRIO_SUBGRAPH_END
} brio_subgraph;

/** A subgraph of the edges of a mesh that reaches all vertices on faces and joins what the mesh joins: the way along a
 *  known surface, for brio_delaunay_options.edges. The bounded one has degree at most 3 on closed surfaces of genus 0 and 12 g
 *  on those of genus g, each component for itself, at most 3 on disks; where a surface has several boundary loops, or
 *  components that share a vertex, no bound is promised.
 *  Cost: linear for the bounded one and the breadth-first tree; about 20 bytes a corner of the mesh.
 *  out  freed with brio_edges_free.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (bounded: faces that are no
 *  triangles, edges of more than two faces or of faces that disagree), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Choi 2003] section 4.3, [Lazarus Pocchiola Vegter Verroust 2001], [Kruskal 1956]. */
BRIO_API brio_status brio_mesh_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out);

/* ------------------------------------------------------------------------------------------------------------------
 * Surface reconstruction
 */

/** Ways to label the poles of a power crust as inner or outer. */
typedef enum brio_labeling {
    BRIO_LABELING_GLOBAL = 0,      /* low sum of violated weights, by roof duality [Boros Hammer 2002] */
    BRIO_LABELING_GREEDY = 1,      /* the surest pole first [Choi 2003, figure 3.8] */
    BRIO_LABELING_NAIVE = 2,       /* breadth first from outside [Choi 2003, section 3.3.3] */
    BRIO_LABELING_THEORETICAL = 3, /* breadth first from one sample [Choi 2003, appendix B.3] */
    BRIO_LABELING_END
} brio_labeling;

/** What to do about noise of the samples. */
typedef enum brio_noise {
    BRIO_NOISE_AUTO = 0,   /* samples are smoothed if noise is found in them; never with the option `solid` */
    BRIO_NOISE_KEEP = 1,   /* the surface goes through the samples as they are */
    BRIO_NOISE_SMOOTH = 2, /* samples are smoothed */
    BRIO_NOISE_END
} brio_noise;

typedef struct brio_power_crust_options {
    uint64_t seed;          /* default 1 */
    int triangulate;        /* 1: cut the polygons into triangles; default 0 */
    brio_labeling labeling; /* default global */
    /* A closed mesh in the unit of the points, its vertices being the points or not: poles within it are inner, whatever
     * the labeling; default NULL. BRIO_ERR_NO_ANSWER when it is not closed. */
    const brio_mesh *solid;
    /* Cells of samples whose radius in the co-cone is over 1.3 R / (1 - R) times the distance to the nearer pole are
     * badly shaped, for a surface that is an R-sample; R in (0, 1), smaller for more of them; default 0: none is. */
    double sampling_density;
    int sharp;   /* 1: both poles of badly shaped cells are discarded, not the nearer one only, so that the faces beside
                  an edge without samples meet in it; sampling_density 0 then stands for 0.5 */
    double open; /* K > 0: faces are left out whose two balls intersect at more than pi / 4, the smaller one's radius
                        being over K local spacings: large holes of the samples stay open; default 0: closed */
    int simplify; /* 1: triangles, about a quarter as many as the crust has polygons; edges far shorter than the local
                        spacing collapse, the surface stays the same as a manifold; default 0 */
    double *normals; /* #P by 3, the caller's: receives the oriented unit normal of each point; NULL: not wanted */
    /* Smoothed samples lie on quadratic pieces of surface through the middle of their 48 nearest samples [Alexa et al.
     * 2003]; the surface is then the power crust of these. Noise is found where such pieces are off the samples by a
     * tenth of the spacing or more and by no more than pieces of half as many are; default auto. */
    brio_noise noise;
} brio_power_crust_options;

BRIO_API brio_power_crust_options brio_power_crust_options_default(void);

/** What the power crust counts. */
typedef struct brio_power_crust_stats {
    size_t samples;             /* distinct positions */
    size_t poles, hidden_poles; /* polar balls; of these without a power cell */
    size_t bad_cells;           /* samples with badly shaped cells, whose poles were discarded */
    size_t inner, outer;        /* labels */
    size_t confused;            /* poles that had evidence for both labels when they were labeled */
    size_t unreached;           /* naive, theoretical: poles that were left to the greedy labeling */
    size_t open, toggled;       /* global: poles that the last roof duality left open; that changed their label */
    double energy_greedy;       /* global: sum of the violated weights of the greedy labels that it began with */
    double energy;              /* sum of the violated weights of the labels; global: of weights of its own */
    size_t left_out;            /* faces that `open` left out */
    double noise;               /* auto: standard deviation of the noise that was found, in spacings; 0: none */
    size_t smoothed;            /* 1: the samples were */
    double delaunay_seconds, poles_seconds, power_seconds, label_seconds, crust_seconds, simplify_seconds;
    double noise_seconds; /* to look for noise, and to smooth */
} brio_power_crust_stats;

/** Reconstructs a closed surface from samples: the power crust. The faces of the power diagram of the polar balls that
 *  separate cells of inner poles from cells of outer poles, as polygons seen counterclockwise from outside.
 *  Guarantees: the mesh is closed, manifold and oriented as a combinatorial object, for every input that has an inside;
 *  on a dense sample of a smooth closed surface it is homeomorphic and close to it (appendix B of [Choi 2003]).
 *  Does not guarantee: triangular faces, absence of tiny faces, absence of self-intersections. Faces run through each
 *  other where samples are too few, and on dense samples where vertices lie so close together that rounding their
 *  coordinates turns tiny faces over: an r-sample of a torus, r = 0.08, has 13 such pairs of 1.4 million faces.
 *  brio_mesh_self_intersections counts the pairs.
 *  points  #P by 3.   options  NULL for the defaults.   stats  may be NULL.   out  owned by the caller.
 *  Cost: two triangulations, of the samples and of their about 2 n poles; 1,300 to 1,700 bytes a sample at the peak.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] sections 3.3 and 5. */
BRIO_API brio_status brio_power_crust(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_crust_options *options, brio_mesh **out,
                                      brio_power_crust_stats *stats);

/** The surface at a distance from the one that the power crust of the samples is: outwards for distance > 0, inwards
 *  for distance < 0. Its parts merge where they meet, and it vanishes where the object is too thin. Guarantees: as the
 *  power crust, closed, manifold and oriented whatever the distance. It is as far off the exact offset as the
 *  polar balls are off the maximal ones.
 *  distance  in the unit of the points.   options  NULL for the defaults; not `open`, not `normals`.   stats  may be
 *  NULL: of the balls that are left.   out  owned by the caller.
 *  Cost: as brio_power_crust and one more triangulation of the poles.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, or the offset swallows the object), and as brio_delaunay.
 *  Based on: [Choi 2003] section 3.3.4. */
BRIO_API brio_status brio_offset_surface(brio_context *ctx, const double *points, size_t num_points, double distance,
                                         const brio_power_crust_options *options, brio_mesh **out,
                                         brio_power_crust_stats *stats);

/** The sides of the surface that a power shape is made of. */
typedef enum brio_sides { BRIO_SIDES_INNER = 0, BRIO_SIDES_OUTER = 1, BRIO_SIDES_BOTH = 2, BRIO_SIDES_END } brio_sides;

typedef struct brio_power_shape_options {
    uint64_t seed;          /* default 1 */
    brio_labeling labeling; /* as in brio_power_crust_options, and so are the next three */
    const brio_mesh *solid;
    double sampling_density;
    int sharp;
    brio_sides sides; /* default inner */
    /* Balls that one larger ball of the same side can stand for are left out: */
    double scale;      /* S > 1: it holds them when both are scaled by S, which is what noise comes to; default 1 */
    double redundancy; /* E > 0: it holds them when its radius grows by E of itself; default 0 */
    brio_noise noise;  /* as in brio_power_crust_options */
} brio_power_shape_options;

BRIO_API brio_power_shape_options brio_power_shape_options_default(void);

typedef struct brio_power_shape_stats {
    size_t samples;                      /* distinct positions */
    size_t poles, hidden_poles;          /* polar balls; of these without a power cell */
    size_t inner, outer, unlabeled;      /* labels of all poles; with the labelings that there are, none is unlabeled */
    size_t left_out;                     /* by `scale` and `redundancy` */
    size_t edges, triangles, tetrahedra; /* of the shape */
    double noise;                        /* as in brio_power_crust_stats, and so is the next */
    size_t smoothed;
    double delaunay_seconds, poles_seconds, power_seconds, label_seconds, simplify_seconds, shape_seconds,
        noise_seconds;
} brio_power_shape_stats;

/** The power shape of samples of a surface, an approximation of its medial axis: the poles on the sides asked for that
 *  have a cell in the power diagram of all polar balls, and the edges, triangles and tetrahedra of its dual between
 *  those of one side. The inner shape is homotopy equivalent to the union of the inner cells: its Euler characteristic,
 *  vertices - edges + triangles - tetrahedra, is that of the solid which the power crust bounds, unless an inner pole is
 *  on the hull of the poles. Poles of a dense sample of a smooth surface converge to the medial axis as the sampling
 *  gets denser; those of bounding points beyond the hull are left out.
 *  points   #P by 3.   options  NULL for the defaults.   stats  may be NULL.
 *  shape    owned by the caller: vertices with the properties "radius" (float64) and "side" (int8; -1 inner, 1 outer),
 *           edges, triangles as faces, positive tetrahedra.
 *  crust    NULL, or receives the power crust of the balls, after simplification: closed, manifold, oriented; owned by
 *           the caller.
 *  Every ball left out by simplification is within max ((S - 1) (R - r), E R) of a larger one that stays, r and R being
 *  their radii; those without a cell, which lie within the union of the others, go first.
 *  Cost: as brio_power_crust; one more triangulation of the poles with simplification.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid, none is on the side asked for, or the mesh `solid` is
 *  not closed), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] section 3.3.2, [Miklos Giesen Pauly 2010]. */
BRIO_API brio_status brio_power_shape(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_shape_options *options, brio_mesh **shape, brio_mesh **crust,
                                      brio_power_shape_stats *stats);

typedef struct brio_cocone_options {
    uint64_t seed;  /* default 1 */
    double theta;   /* half the opening of the co-cone, radians, in (0, pi/2); default pi/8 */
    int tight;      /* 1: the tight co-cone, a watertight surface; default 0: surfaces may come out open */
    int boundaries; /* 1: samples at boundaries and where the sampling is too sparse are found by the shape of their
                       Voronoi cells, and triangles among them alone are no candidates; default 0 */
    int density;    /* 1: the sampling condition is estimated: the mesh gets vertex properties; default 0 */
    size_t pieces;  /* over 1: in about so many pieces that are triangulated one after the other and matched at their
                       seams (super co-cone); not with tight; default 0: the whole at once */
} brio_cocone_options;

BRIO_API brio_cocone_options brio_cocone_options_default(void);

/** What the co-cone counts. Shares are of the samples. */
typedef struct brio_cocone_stats {
    size_t samples;           /* distinct positions */
    size_t unused;            /* of these, on no triangle of the surface */
    size_t candidates;        /* triangles that pass the test */
    size_t pruned;            /* of these, dropped at sharp edges */
    size_t boundary_samples;  /* found with options.boundaries */
    size_t relabeled;         /* tetrahedra whose side was changed to keep the surface a manifold */
    size_t pieces, unmatched; /* with options.pieces: cells of the octree; triangles at their seams left out because
                                 the pieces disagree on them */
    size_t outside_guarantee; /* with options.density: samples on the surface where the estimate of r is over 0.08 */
    double r_median, r_p95;   /* with options.density: of the estimates of r over the samples on the surface */
    double delaunay_seconds, poles_seconds, candidates_seconds, labels_seconds, manifold_seconds, density_seconds;
} brio_cocone_stats;

/** Reconstructs a surface out of Delaunay triangles of the samples: the co-cone, or the tight co-cone. Guarantees: the
 *  mesh is manifold and oriented as a combinatorial object, for every input; the tight co-cone is closed besides. On an
 *  r-sample of a smooth closed surface, r <= 0.08, the co-cone is homeomorphic to it and within 1.3 r / (1 - r) of the
 *  local feature size (theorem 19 of [Choi 2003]). Does not guarantee: a closed mesh on sparser samples, absence of
 *  self-intersections, that every sample is used.
 *  points  #P by 3.   options  NULL for the defaults.   stats  may be NULL.
 *  out     owned by the caller. Its vertices are the points, with the same indices; those that no face has are left
 *          where they are. With options.density: "feature_size", the distance to the nearest pole; "r", an estimate
 *          of the sampling density there (0 where the sample is on no face); "boundary", 1 for a boundary sample (with
 *          options.boundaries too).
 *  Cost: one triangulation; about 50 bytes a tetrahedron more. In N pieces the memory is that of 1/N of the samples and
 *  their surroundings, and 60 bytes a point; on a dense sample the triangles are the same.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no triangle found, or no inside), and as brio_delaunay.
 *  Based on: [Amenta Choi Dey Leekha 2000], [Choi 2003] section 3.2 and appendix A, [Dey Giesen 2001],
 *            [Dey Giesen Hudson 2001], [Dey Goswami 2003]. */
BRIO_API brio_status brio_cocone(brio_context *ctx, const double *points, size_t num_points,
                                 const brio_cocone_options *options, brio_mesh **out, brio_cocone_stats *stats);

/* ------------------------------------------------------------------------------------------------------------------
 * Files
 */

/** File formats. BRIO_FORMAT_AUTO goes by the extension, and by the content where that tells. */
typedef enum brio_format {
    BRIO_FORMAT_AUTO = 0,
    BRIO_FORMAT_PLY,
    BRIO_FORMAT_XYZ, /* .xyz .pts .txt .csv */
    BRIO_FORMAT_OBJ,
    BRIO_FORMAT_OFF,
    BRIO_FORMAT_VTU,  /* read back when its arrays are appended raw, as they are written */
    BRIO_FORMAT_NODE, /* TetGen's .node, with .ele beside it */
    BRIO_FORMAT_VTP,  /* written, not read */
    BRIO_FORMAT_END
} brio_format;

/** The format of a file's name, BRIO_FORMAT_AUTO when the extension is unknown. A leading dot or path is optional. */
BRIO_API brio_format brio_format_of(const char *path);

/** Reads a file. Vertices, polygons, tetrahedra, and every other scalar property of the vertices are kept; other
 *  elements are skipped. "-" reads standard input.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT (the message names file, line or byte offset, and what was
 *  expected), BRIO_ERR_NOT_FINITE (the first such point and how many there are), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_read(brio_context *ctx, const char *path, brio_format format, brio_mesh **out);

typedef struct brio_write_options {
    brio_format format;  /* AUTO: by the extension */
    int ascii;           /* 1: text where the format has both; default 0 */
    int float32;         /* 1: coordinates in single precision where the format has both; default 0 */
    const char *comment; /* a line for the header, or NULL */
} brio_write_options;

BRIO_API brio_write_options brio_write_options_default(void);

/** Writes a mesh: to a temporary name beside the target, flushed, then renamed, so that nothing half-written is ever
 *  left. Symbolic links stay: the file that they lead to is made or replaced. An old file's permissions are kept.
 *  "-" writes to standard output (the format must then be given); it, pipes and devices are written in place, and a wait
 *  for their readers can be cancelled. Neither SIGPIPE nor SIGXFSZ reaches the process.
 *  Edges go into PLY, VTU and VTP alone.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (a format that cannot hold the mesh), BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write(brio_context *ctx, const char *path, const brio_mesh *mesh,
                                const brio_write_options *options);

/* ------------------------------------------------------------------------------------------------------------------
 * Test data
 */

typedef enum brio_kind {
    BRIO_KIND_CUBE,     /* uniform in the unit cube */
    BRIO_KIND_BALL,     /* uniform in the unit ball */
    BRIO_KIND_SPHERE,   /* uniform on the unit sphere */
    BRIO_KIND_TORUS,    /* uniform by area on the torus of radii 1 and 0.4 */
    BRIO_KIND_CYLINDER, /* uniform on the side of the cylinder of radius 1 and height 4 */
    BRIO_KIND_GRID,     /* the first n points of the smallest cubic integer grid that has them */
    BRIO_KIND_SCAN,     /* a simulated laser scan of a sculpture of genus 3 */
    BRIO_KIND_CLUSTERS, /* uniform in 256 balls in the unit cube, their radii log-uniform from 1e-7 to 0.1 */
    BRIO_KIND_MOMENT,   /* (t, t^2, t^3), t uniform in [0, 1): about n^2 / 2 tetrahedra */
    BRIO_KIND_END
} brio_kind;

typedef struct brio_generate_options {
    uint64_t seed; /* default 1 */
    double noise;  /* scan: standard deviation along the ray, in units of the sample spacing; default 0.05 */
    int views;     /* scan: number of sensor positions; default 12 */
} brio_generate_options;

BRIO_API brio_generate_options brio_generate_options_default(void);

/** Makes n points of a kind; the same seed gives the same points. A scan has about n points (as many as its rays hit)
 *  and the property "view".   Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_generate(brio_context *ctx, brio_kind kind, size_t n, const brio_generate_options *options,
                                   brio_mesh **out);

/** The surface that BRIO_KIND_SCAN scans, as a closed triangle mesh on a grid of `resolution` cells along the longest
 *  side of its box (0: 160).   Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_generate_truth(brio_context *ctx, size_t resolution, brio_mesh **out);

typedef struct brio_iso_options {
    double level;      /* of the surface, in the unit of the map or the density of atoms; default 1 */
    int deviations;    /* 1: the level counts standard deviations above the mean of the map; default 0 */
    double blobbiness; /* atoms: above 0 and at most 100, the larger the more the surface is that of balls; default 2 */
    size_t resolution; /* cells along the longest side; default 0: the map's own, or half an angstrom for atoms */
    size_t vertices;   /* not 0: the resolution is chosen so that there are about so many vertices; default 0 */
    int conforming;    /* 1: all triangles are Delaunay, for vertices at the same place taken as one: facets of the
                          Delaunay triangulation of the mesh's vertices [Attali Lachaud 2001]; default 0 */
} brio_iso_options;

BRIO_API brio_iso_options brio_iso_options_default(void);

/** The iso-surface of a file's density, as a closed triangle mesh: of a CCP4 or MRC map (.map .mrc .ccp4), cut off flat
 *  where it leaves the map, or of the atoms in a PDB file (.pdb .ent), each a Gaussian that alone has level 1 at its
 *  van der Waals radius. "-" reads standard input.   options  NULL for the defaults.
 *  Memory: the map with 4 bytes a value, or 40 bytes an atom; the mesh; two layers of cells with 36 bytes each.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (nothing is above the level, or the map is one value thin),
 *  and as brio_read. */
BRIO_API brio_status brio_iso_surface(brio_context *ctx, const char *path, const brio_iso_options *options,
                                      brio_mesh **out);

/* ------------------------------------------------------------------------------------------------------------------
 * Predicates, exact for every finite double
 */

/** Sign (-1, 0, 1) of det [b-a, c-a, d-a]; a, b, c, d are 3 doubles each. */
BRIO_API int brio_orient3d(const double *a, const double *b, const double *c, const double *d);

/** Sign of the in-sphere determinant: 1 when e is inside the sphere through the positive tetrahedron (a, b, c, d), -1
 *  outside, 0 on it; the opposite for a negative one.   weights  NULL, or the five weights in the order a to e: then e
 *  is held against the orthosphere (power test). */
BRIO_API int brio_insphere(const double *a, const double *b, const double *c, const double *d, const double *e,
                           const double *weights);

/** As brio_insphere for a positive tetrahedron and a point that is none of its vertices, with ties broken by the
 *  symbolic perturbation: never 0. */
BRIO_API int brio_insphere_perturbed(const double *a, const double *b, const double *c, const double *d,
                                     const double *e, const double *weights);

/** Circumcentre of a tetrahedron that is not flat or, with 4 weights, its orthocentre. A function of the set of points:
 *  the same bits for every order of them. Each coordinate is off by at most `*error` (may be NULL): at most 2^-44 of
 *  the centre's distance to the lexicographically first point, plus one rounding; higher precision is used where
 *  doubles do not reach it.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT for a flat tetrahedron or a centre that doubles cannot hold. */
BRIO_API brio_status brio_circumcentre(const double *a, const double *b, const double *c, const double *d,
                                       const double *weights, double *centre, double *error);

#ifdef __cplusplus
}
#endif
#endif
