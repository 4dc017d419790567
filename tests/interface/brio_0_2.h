/* brio: exact three-dimensional Delaunay and regular triangulations of very large point sets, and surface
 * reconstruction with guarantees on top of them.   MIT licence.
 *
 * This header is the manual. Its sections follow a user's work: versions, status and context, triangulation, queries, the
 * plane, hulls and alpha shapes, meshes and their certificates, Voronoi and power cells, surface reconstruction,
 * iso-surfaces, files, test data, memory estimates, predicates.
 *
 * Words, used in one meaning throughout:
 *   points      the rows of the input
 *   duplicates  points minus distinct positions. Among coincident points the one with the greatest weight represents
 *               the others; among equal weights, the one with the lowest index.
 *   vertices    distinct positions that own a Voronoi cell or, with weights, a power cell
 *   hidden      distinct positions that own no cell. There are none without weights. Each hidden point is represented
 *               by the vertex of least power distance; among equal distances, by the lexicographically first one.
 *               points = vertices + duplicates + hidden
 *   infinite    The infinite vertex BRIO_INFINITE closes the convex hull: every hull facet belongs to one infinite
 *               tetrahedron, whose fourth vertex is BRIO_INFINITE.
 *   facet       The handle 4*t + i names the facet of tetrahedron t opposite to its vertex i. Two handles that name the
 *               same triangle from its two sides are mates.
 *   positive    A tetrahedron (a, b, c, d) is positive when det [b-a, c-a, d-a] > 0.
 *
 * Promises.
 *   - The sign of every predicate is right for all finite doubles.
 *   - A point set has one set of tetrahedra: it does not depend on the order of the points, the insertion order, the
 *     location strategy or the number of threads. Ties are broken by a symbolic perturbation of the lifted coordinate
 *     whose key is the lexicographic position of the point [Devillers Teillaud 2011]. -0.0 equals 0.0.
 *   - The library reads the caller's arrays during a call. It does not keep, reorder or change them. Some functions bear
 *     that another thread changes the points, the weights or the queries meanwhile, whatever it writes: the result is
 *     then that of some numbers, or an error. They are brio_delaunay, brio_delaunay2, brio_delaunay2_flat and their
 *     checks, brio_points_hash, brio_convex_hull, brio_voronoi_cells without a triangulation, brio_voronoi2, brio_thin,
 *     brio_outliers, and the functions of brio_locator and brio_locator2. For all other functions, and for values,
 *     options and meshes, the arrays must not change. (To C a change that is no atomic store is undefined all the same.)
 *   - The library never prints, exits or aborts. Every function that can fail returns a status, and the context keeps
 *     a sentence that explains the failure.
 *   - The caller's floating-point state (rounding mode, subnormal numbers, traps) does not change a result: each
 *     function sets the state that it needs and restores the caller's state before it returns. Callbacks run in the
 *     library's state.
 *   - A stack of 64 KiB suffices in the calling thread.
 * Rules.
 *   - A pointer is not NULL unless its function says that it may be; arrays of 0 elements may be NULL. An object must not
 *     be used after it or its context was freed.
 *   - After an error every out pointer to an object is NULL, and statistics and results hold nothing to be freed.
 *   - A context serves one call at a time. Functions of a mesh that take no context use the mesh's own, and count as a call
 *     with it; so do the functions that free. Several threads may read one mesh, triangulation or locator.
 *   - Callbacks call no function with the context but brio_message and brio_context_memory. They do not leave by longjmp
 *     or by an exception.
*/
#ifndef BRIO_H
#define BRIO_H

#include <stddef.h>
#include <stdint.h>

#define BRIO_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------------------------
 * Versions. docs/versions.md says what stays the same from one version to the next.
 */

#define BRIO_VERSION_MAJOR 0
#define BRIO_VERSION_MINOR 2
#define BRIO_VERSION_PATCH 0
#define BRIO_VERSION       "0.2.0"
/** The version of this header as one number that grows: 10000 MAJOR + 100 MINOR + PATCH. */
#define BRIO_VERSION_NUMBER (10000 * BRIO_VERSION_MAJOR + 100 * BRIO_VERSION_MINOR + BRIO_VERSION_PATCH)

/** Returns the version of the library that runs, as BRIO_VERSION; it may be newer than this header. */
BRIO_API const char *brio_version(void);
/** Returns the version of the library that runs, as BRIO_VERSION_NUMBER. */
BRIO_API int brio_version_number(void);

/* Structs that grow. Structs of options, statistics and results begin with `size`, the bytes that the caller was
 * compiled with, so that later versions can append fields: the library touches no byte beyond `size`.
 *   - Options:  brio_cocone_options o = brio_cocone_options_default(); then set fields. A pointer to options may be
 *     NULL, which stands for the defaults. Other languages call brio_cocone_options_init(&o, sizeof o).
 *     Options that were only set to 0 are not the defaults.
 *   - Statistics and results:  brio_cocone_stats stats = {.size = sizeof stats};   in C++:  brio_cocone_stats stats = {};
 *     stats.size = sizeof stats;
 *   - Structs that the library made (brio_mesh, brio_delaunay_stats) are as long as their `size`: a program that may run
 *     with an older library looks at it before it reads a field that the older version did not have.
 * A `size` that was not set is BRIO_ERR_ARGUMENT. Fields whose names begin with `reserved` stay 0. Elements of arrays
 * (brio_tetrahedron, brio_round, brio_property) and brio_allocator, brio_edges, brio_incidences, brio_edge_walk never
 * change. */

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

/** Returns a static sentence for a status; never NULL. */
BRIO_API const char *brio_status_string(brio_status status);

/** Memory functions of the caller's choice. alloc and realloc return NULL on failure; sizes are in bytes; blocks are
 *  aligned as malloc's. Several threads may call them at a time. The context copies the struct; `user` must outlive the
 *  context. */
typedef struct brio_allocator {
    void *(*alloc)(size_t size, void *user);
    void *(*realloc)(void *block, size_t size, void *user);
    void (*free)(void *block, void *user);
    void *user;
} brio_allocator;

/** A context holds settings, the last error message, the account of memory, and threads. A context serves one call at
 *  a time; different contexts are independent. Everything made with a context must be freed before the context. */
typedef struct brio_context brio_context;

/** Makes a context.   allocator  NULL for the system's memory: large arrays then live in mappings of their own and grow
 *  without being copied.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_context_new(const brio_allocator *allocator, brio_context **out);

/** Frees a context; NULL is accepted. */
BRIO_API void brio_context_free(brio_context *ctx);

/** Returns the sentence that explains the last failure in this context, such as "point 1842: y is NaN"; "" when there
 *  was none. A call that succeeds leaves the sentence as it was. Valid until the next call with the context. */
BRIO_API const char *brio_message(const brio_context *ctx);

/** Sets the greatest number of threads that a call uses, the calling thread included. 0 (default) means every processor
 *  that the process may run on. The greatest number that counts is four for each processor, or 64 if that is more. A call
 *  creates threads when its work is large enough for them. The context keeps them, asleep, until it is freed. If the
 *  system refuses a thread, the call goes on with fewer. A child process after fork may use its copy of a context if no
 *  call was running in the parent; the child creates new threads. */
BRIO_API void brio_context_set_threads(brio_context *ctx, int threads);
/** Returns the greatest number of threads that a call uses: at least 1. A negative number was taken for 0. */
BRIO_API int brio_context_threads(const brio_context *ctx);

/** A progress callback. Long calls call it from the calling thread, a few times a second or more often, with the name
 *  of the stage and the share of the whole call that is done, in [0, 1]. A result other than 0 cancels the call, which
 *  then frees everything and returns BRIO_ERR_CANCELLED. */
typedef int (*brio_progress_fn)(const char *stage, double fraction, void *user);
/** Sets the progress callback; NULL removes it. */
BRIO_API void brio_context_set_progress(brio_context *ctx, brio_progress_fn progress, void *user);

/** Limits the memory that the context holds, in bytes. A request beyond the limit fails with BRIO_ERR_NO_MEMORY. 0
 *  removes the limit. Memory that the process' memory cgroup or the machine cannot give is refused in any case. */
BRIO_API void brio_context_set_memory_limit(brio_context *ctx, size_t bytes);

/** From now on, places large arrays in unlinked, mapped files in `folder` instead of anonymous memory. Disk space is
 *  allocated before it is touched: a full disk or a limit on the size of files is BRIO_ERR_NO_MEMORY. NULL returns to
 *  anonymous memory. A context with a caller's allocator has no scratch folder. A mapped file whose disk fails, or that
 *  somebody cuts, raises SIGBUS where it is touched next, in any thread: the library handles no signals, the host may.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_OPEN (not a writable folder, such as an empty name), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_context_set_scratch(brio_context *ctx, const char *folder);

/** Returns the bytes that objects and running calls of this context hold now. */
BRIO_API size_t brio_context_memory(const brio_context *ctx);
/** Returns the most bytes that the context ever held. */
BRIO_API size_t brio_context_memory_peak(const brio_context *ctx);

/* ------------------------------------------------------------------------------------------------------------------
 * Delaunay and regular triangulation
 */

#define BRIO_INFINITE UINT32_MAX

/** A tetrahedron: its four vertices as indices of points, and four mates. mate[i] is the handle of the facet opposite to
 *  vertex[i], seen from the tetrahedron on its other side. As an array of numbers: eight to a tetrahedron. */
typedef struct {
    uint32_t vertex[4], mate[4];
} brio_tetrahedron;

/** Insertion orders. All give the same tetrahedra. BRIO_ORDER_RANDOM and BRIO_ORDER_INPUT follow no path through space
 *  and insert with one thread; the others insert with several. Workspace in bytes a point, freed before the insertion
 *  begins: BRIO, HILBERT and RANDOM 16, BRIO_OCTREE 6, BRIO_KDTREE 20, OCTREE 6, INPUT 0. */
typedef enum brio_order {
    BRIO_ORDER_BRIO = 0,    /* random rounds, a Hilbert curve inside each round: the tuned one [Amenta Choi Rote 2003];
                            with weights and walks, heavier neighbours on the curve are inserted in earlier rounds */
    BRIO_ORDER_HILBERT = 1, /* one round along a Hilbert curve */
    BRIO_ORDER_RANDOM = 2,
    BRIO_ORDER_INPUT = 3,
    BRIO_ORDER_BRIO_OCTREE = 4, /* random rounds, octree blocks inside a round, shuffled inside a block [Choi 2003] */
    BRIO_ORDER_BRIO_KDTREE = 5, /* the same with the blocks of a k-d tree */
    BRIO_ORDER_OCTREE = 6,      /* one round of octree blocks, shuffled inside a block */
    BRIO_ORDER_END
} brio_order;

/** Strategies of point location: how the insertion finds the tetrahedron that holds a point. All give the same
 *  tetrahedra. Only the walk works with several threads. TRACE locates a point that no edge reaches as HISTORY does, and
 *  NEIGHBOUR as WALK does. Memory in bytes beyond the walk's: JUMP 4 a point; HIERARCHY about 17 a point; NEIGHBOUR 8 a
 *  point and 8 an edge; TRACE 16 a point and 8 an edge; HISTORY and TRACE also 20 for each tetrahedron ever created and 4
 *  for each tetrahedron of the result. */
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

typedef struct brio_delaunay_options {
    size_t size;
    brio_order order;        /* default BRIO_ORDER_BRIO */
    brio_location locate;    /* default BRIO_LOCATION_WALK */
    double round_ratio;      /* share of the points that is left for the rounds before the last one, below 1; default 0:
                                the order's own ratio, 1/8 for BRIO and 1/2 for BRIO_OCTREE and BRIO_KDTREE */
    uint64_t seed;           /* every random choice follows from it; default 1 */
    uint32_t max_tetrahedra; /* most tetrahedra at any time, infinite ones included; default (and most) 2^30 */
    int all_conflicts;       /* HISTORY and TRACE: 1 follows all conflicts, 0 (default) one search path */
    size_t block_size;       /* most points in a block of an octree or a k-d tree; default 0: 2,000 */
    uint64_t record_every;   /* insertions between two entries of brio_triangulation_rounds, or BRIO_RECORD_ROUNDS;
                                default 0: no entries */
    const uint32_t *edges;   /* TRACE and NEIGHBOUR: num_edges pairs of indices of points; default NULL */
    size_t num_edges;
    int leave_hidden; /* 1 leaves hidden points without a representative: BRIO_INFINITE stands in the array. Where
                         weights hide most points, this saves up to two fifths of the time, and takes 6 to 12 bytes a
                         point when the insertion is over. Default 0 */
    int reserved_int;
} brio_delaunay_options;

/** record_every: one entry at the end of each round; in orders without rounds after 4,096 points, 8,192, and so on. */
#define BRIO_RECORD_ROUNDS UINT64_MAX

BRIO_API void brio_delaunay_options_init(brio_delaunay_options *options, size_t size);
static inline brio_delaunay_options brio_delaunay_options_default(void) {
    brio_delaunay_options options;
    brio_delaunay_options_init(&options, sizeof options);
    return options;
}

/** Facts of a triangulation. Counters are totals over the construction and include infinite tetrahedra. */
typedef struct brio_delaunay_stats {
    size_t size;
    size_t points, vertices, duplicates, hidden;
    int dimension;      /* of the affine hull of the points: -1 (no points) to 3 */
    size_t tetrahedra;  /* finite ones of the result */
    size_t hull_facets; /* = infinite tetrahedra of the result */
    uint64_t created, destroyed, walk_steps, insphere_calls;
    uint64_t exact_calls;         /* calls of predicates that the floating-point filter did not settle */
    uint64_t deferred, serial;    /* several threads: insertions put off to a later pass; done by one thread */
    uint64_t history;             /* nodes of the history DAG, with HISTORY or TRACE */
    uint64_t history_tests;       /* nodes that searches compared with a point */
    uint64_t trace_intersections; /* tetrahedra entered while edges were traced */
    double locate_seconds;        /* of the insertion: point location, extrapolated from every 64th one; 1 thread */
    double order_seconds, insert_seconds; /* insert_seconds includes the canonical sort of the result */
} brio_delaunay_stats;

/** Counters at a moment of the insertion. They count from the start, as those of brio_delaunay_stats. */
typedef struct brio_round {
    size_t points;     /* inserted so far */
    size_t tetrahedra; /* at that moment, infinite ones included */
    uint64_t created, destroyed, walk_steps, insphere_calls, history;
    double locate_seconds; /* as in brio_delaunay_stats */
    double seconds;        /* since the insertion began */
    uint64_t reserved[4];
} brio_round;

typedef struct brio_triangulation brio_triangulation;

/** Builds the Delaunay triangulation of a point set or, with weights, the regular triangulation: its power distance is
 *  |x - p|^2 - w. Every finite input has a result; points of dimension 2 or less have vertices, duplicates and hidden
 *  points but no tetrahedra.
 *  points   #P by 3, row after row.   weights  #P, or NULL.
 *  num_points  less than 2^31 - 16, or less than 2^32 - 16 with a scratch folder.
 *  options  NULL for the defaults.    out      owned by the caller, freed with brio_triangulation_free; NULL on error.
 *  Cost: expected O(n log n) time for points of realistic inputs. Memory while points are inserted: 33 bytes a
 *  tetrahedron and 41 a point (45 with several threads; with weights 4 more); while the result is sorted: 41 a tetrahedron and 16 a point. Up
 *  to an eighth is reserved for growth.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Bowyer 1981], [Watson 1981]; [Amenta Choi Rote 2003] for the order, [Devillers Teillaud 2011] for ties. */
BRIO_API brio_status brio_delaunay(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_delaunay_options *options, brio_triangulation **out);

/** Frees a triangulation; NULL is accepted. */
BRIO_API void brio_triangulation_free(brio_triangulation *t);

/** Returns the facts of a triangulation. The view is valid until the triangulation is freed. */
BRIO_API const brio_delaunay_stats *brio_triangulation_stats(const brio_triangulation *t);

/** Returns the counters recorded during the insertion: *count entries of rising `points`, the last one at the end of the
 *  insertion; NULL and 0 unless options.record_every was set. Every number of threads records at the same numbers of
 *  points, but the counters between two records depend on how the threads met. Records at small intervals slow several
 *  threads down, because these insert together only what lies between two records. The view is valid until the
 *  triangulation is freed. */
BRIO_API const brio_round *brio_triangulation_rounds(const brio_triangulation *t, size_t *count);

/** Returns the tetrahedra + hull_facets tetrahedra, finite ones first. A finite tetrahedron is positive. An infinite
 *  tetrahedron (a, b, c, BRIO_INFINITE) has the hull facet abc, and (a, b, c, x) is positive for x outside the hull. The
 *  array is the same for every number of threads. The view is valid until the triangulation is freed. */
BRIO_API const brio_tetrahedron *brio_triangulation_tetrahedra(const brio_triangulation *t);

/** Returns #P indices: for each point the vertex that represents it, which is the point itself if it is a vertex. With
 *  options.leave_hidden, BRIO_INFINITE stands for each hidden point and for its duplicates. The view is valid until the
 *  triangulation is freed. */
BRIO_API const uint32_t *brio_triangulation_representatives(const brio_triangulation *t);

/** Returns the hash of the points and weights that the triangulation was made of, as brio_points_hash has it. So a caller
 *  who keeps points beside a triangulation can see whether they are still its points. */
BRIO_API uint64_t brio_triangulation_points_hash(const brio_triangulation *t);

/** Returns a hash of points in their order.
 *  points  #P by `coordinates`, which is 2 or 3.   weights  #P, or NULL, which counts as weights of 0.   Cost: O(n). */
BRIO_API uint64_t brio_points_hash(const double *points, const double *weights, size_t num_points, int coordinates);

/** Checks a triangulation exactly and completely against its points. It passes if and only if it is the result of
 *  brio_delaunay, up to the order of the finite tetrahedra, the order of the infinite ones, and even permutations of the
 *  vertices of a tetrahedron. Checked are: the tetrahedra cover the convex hull once and meet in common faces; no point is
 *  inside the sphere (orthosphere) of a tetrahedron; ties are broken by the symbolic perturbation; mates, infinite
 *  tetrahedra and every representative are right; the statistics' dimension and numbers of vertices, duplicates, hidden
 *  points, tetrahedra and hull facets are right.
 *  points, weights, num_points  as they were given to brio_delaunay.
 *  Cost: O(t) for t tetrahedra, and one walk for each point that is no vertex; inputs of dimension 1 and 2 are
 *  triangulated again.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (the triangulation has
 *  another number of points), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_check(brio_context *ctx, const brio_triangulation *t, const double *points,
                                              const double *weights, size_t num_points);

/** Checks finite tetrahedra from any source, in any order and either orientation. They pass if and only if they are a
 *  Delaunay (regular) triangulation of the points, however its ties are broken, in which every position has one index,
 *  that of a point with the greatest weight there. For points of dimension 2 or less, only no tetrahedra at all pass.
 *  tetrahedra  Tetrahedron i has four indices of points at tetrahedra + stride * i: stride 4 for a packed array, 8 for
 *              the array of a brio_triangulation.
 *  canonical   receives 1 if ties are broken as brio_delaunay breaks them, so that the tetrahedra are the same up to
 *              coincident points of equal weight, else 0. It is unchanged on failure and may be NULL.
 *  Cost: O(t log t) for t tetrahedra, and one walk for each point that is no vertex.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (stride below 4),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE (2^29 tetrahedra or more), BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tetrahedra_check(brio_context *ctx, const double *points, const double *weights,
                                           size_t num_points, const uint32_t *tetrahedra, size_t stride,
                                           size_t num_tetrahedra, int *canonical);

/** Computes a hash of the set of tetrahedra in terms of the lexicographic ranks of their vertices. It does not depend on
 *  the order of points or tetrahedra, and stays the same when all points are scaled by a power of two.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation_checksum(brio_context *ctx, const brio_triangulation *t, const double *points,
                                                 uint64_t *checksum);

/* ------------------------------------------------------------------------------------------------------------------
 * Queries of a triangulation: location, nearest vertices, interpolation, neighbourhoods
 *
 * A triangulation keeps no points. A locator is made of a triangulation and its points, and keeps copies of both in a
 * form that queries read fast. Queries are arrays of positions; answers stand in the order of the queries. Answers are
 * exact, and the same for every number of threads and every order of the queries.
 */

typedef struct brio_locator brio_locator;

/** Makes a locator. It needs neither the triangulation nor the points afterwards.
 *  points, weights, num_points  as they were given to brio_delaunay.
 *  out  owned by the caller, freed with brio_locator_free; NULL on error. Several threads, each with a context of its
 *       own, may query one locator.
 *  Memory: 32 bytes a tetrahedron, 41 a vertex, 8 more a vertex with weights: about 260 bytes a vertex for evenly spread
 *  points. Before the tetrahedra are copied, 60 bytes a vertex and 32 a point.
 *  Cost: O(n log n).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the points are not those of the triangulation), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_locator_new(brio_context *ctx, const brio_triangulation *t, const double *points,
                                      const double *weights, size_t num_points, brio_locator **out);

/** Frees a locator; NULL is accepted. */
BRIO_API void brio_locator_free(brio_locator *locator);

/* The functions that answer queries take `queries`, #Q by 3, finite. From 32 queries on they are sorted along a space-filling
 * curve first, with 16 bytes of workspace a query, for 2^20 queries at most. They return BRIO_OK, BRIO_ERR_NOT_FINITE (the
 * message names the first such query), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and what their descriptions say. */

/** Finds the tetrahedron that holds each query: the finite one of lowest index whose closure holds it. So a query on a
 *  facet, on an edge or at a vertex belongs to the first of the tetrahedra that share it.
 *  tetrahedra  #Q: indices of brio_triangulation_tetrahedra; BRIO_INFINITE for a query strictly outside the convex hull,
 *              and for every query if the points have dimension 2 or less. Queries on the hull's boundary are inside.
 *  Cost: one walk; for a query on an edge, O(tetrahedra at that edge).
 *  Based on: [Devillers Pion Teillaud 2002]. */
BRIO_API brio_status brio_locator_tetrahedra(brio_context *ctx, const brio_locator *locator, const double *queries,
                                             size_t num_queries, uint32_t *tetrahedra);

/** Finds the `count` vertices nearest to each query, in ascending order of their distance; weights do not count. Among
 *  vertices at equal distances the lexicographically first ones are taken, and come first. Works in every dimension.
 *  count     at least 1.
 *  vertices  #Q by count: indices of points that are vertices, BRIO_INFINITE where there are fewer vertices.
 *  Returns also BRIO_ERR_ARGUMENT (count is 0), BRIO_ERR_TOO_LARGE (count is over 2^32 - 1). Each thread
 *  takes room for `count` vertices, or all if these are fewer.
 *  Based on: [Friedman Bentley Finkel 1977]. */
BRIO_API brio_status brio_locator_nearest(brio_context *ctx, const brio_locator *locator, const double *queries,
                                          size_t num_queries, size_t count, uint32_t *vertices);

/** Finds the vertex of least power distance |x - p|^2 - w from each query x: the vertex in whose power cell the query
 *  lies. Ties are lexicographic. Without weights it is the nearest vertex. Works in every dimension.
 *  vertices  #Q: indices of points that are vertices; BRIO_INFINITE if there are no points. */
BRIO_API brio_status brio_locator_least_power(brio_context *ctx, const brio_locator *locator, const double *queries,
                                              size_t num_queries, uint32_t *vertices);

typedef enum brio_interpolation_method {
    BRIO_INTERPOLATION_NATURAL = 0, /* natural neighbours: smooth except at the points [Sibson 1981] */
    BRIO_INTERPOLATION_LINEAR = 1,  /* barycentric, in the tetrahedron that holds the query */
    BRIO_INTERPOLATION_END
} brio_interpolation_method;

/** What to interpolate, and how. */
typedef struct brio_interpolation {
    size_t size;
    brio_interpolation_method method; /* default BRIO_INTERPOLATION_NATURAL */
    int reserved_int;
    const double *values; /* #P by components: row i at point i. Rows of points that are no vertices do not count. */
    size_t components;    /* numbers a row; default 1 */
} brio_interpolation;

BRIO_API void brio_interpolation_init(brio_interpolation *options, size_t size);
static inline brio_interpolation brio_interpolation_default(void) {
    brio_interpolation options;
    brio_interpolation_init(&options, sizeof options);
    return options;
}

/** Interpolates values at the vertices, at each query. Both methods reproduce the values at the vertices exactly, and
 *  linear functions up to rounding. NATURAL weighs the natural neighbours of the query x by the volumes that the Voronoi
 *  cell of x would take from their cells. On the hull's boundary, and where rounding drowns these volumes very near it,
 *  NATURAL takes the values of LINEAR. LINEAR takes the tetrahedron that brio_locator_tetrahedra names.
 *  options  NULL has no values, which is an error unless there are no points.
 *  results  #Q by components: NaN for queries outside the hull, and for every query if the points have dimension 2 or less.
 *  Cost: LINEAR as brio_locator_tetrahedra; NATURAL some microseconds a query, as the insertion of a point.
 *  Returns also BRIO_ERR_ARGUMENT (options out of range, no values, NATURAL of a triangulation with weights).
 *  Based on: [Sibson 1980], [Sibson 1981], [Ledoux Gold 2005]. */
BRIO_API brio_status brio_locator_interpolate(brio_context *ctx, const brio_locator *locator, const double *queries,
                                              size_t num_queries, const brio_interpolation *options, double *results);

/** Writes for each point a finite tetrahedron that has it: the one of lowest index. BRIO_INFINITE for points that are no
 *  vertices, and for all points if their dimension is 2 or less.   tetrahedra  #P. */
BRIO_API void brio_triangulation_vertex_tetrahedra(const brio_triangulation *t, uint32_t *tetrahedra);

/** A list of numbers for each point: list p is items[offsets[p]] to items[offsets[p + 1] - 1]. */
typedef struct brio_incidences {
    size_t count;      /* lists: #P */
    uint64_t *offsets; /* #P + 1 */
    uint32_t *items;
    brio_context *context;
} brio_incidences;

/** Frees what the lists own and sets their fields to 0; NULL is accepted. */
BRIO_API void brio_incidences_free(brio_incidences *incidences);

/** Lists the finite tetrahedra at each point, in ascending order. The lists of points that are no vertices are empty.
 *  Memory: 8 bytes a point and 16 a tetrahedron.   out  freed with brio_incidences_free.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation_incident_tetrahedra(brio_context *ctx, const brio_triangulation *t,
                                                            brio_incidences *out);

/** Lists the vertices that share an edge with each point, in ascending order. The lists of points that are no vertices are
 *  empty; all are if the dimension is 2 or less.
 *  Memory: 8 bytes a point and 8 an edge; meanwhile, what brio_triangulation_incident_tetrahedra takes.
 *  out  freed with brio_incidences_free.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_neighbours(brio_context *ctx, const brio_triangulation *t,
                                                   brio_incidences *out);

/* Neighbourhoods without memory. `tetrahedra` is what brio_triangulation_tetrahedra returns. */

/** A walk through the ring of tetrahedra round an edge, infinite ones included. A step costs one read of a tetrahedron. */
typedef struct brio_edge_walk {
    const brio_tetrahedron *tetrahedra;
    uint32_t tetrahedron;        /* where the walk is */
    uint32_t pivot, apex, first; /* the next step goes through the facet opposite to vertex `pivot` */
} brio_edge_walk;

/** Begins in a tetrahedron, at the edge from its slot i to its slot j; the walk is counterclockwise seen from j. */
static inline brio_edge_walk brio_edge_walk_begin(const brio_tetrahedron *tetrahedra, uint32_t tetrahedron, int i,
                                                  int j) {
    static const unsigned char K[4][4] = {{0, 2, 3, 1}, {3, 0, 0, 2}, {1, 3, 0, 0}, {2, 0, 1, 0}};
    const uint32_t *v = tetrahedra[tetrahedron].vertex;
    brio_edge_walk walk = {tetrahedra, tetrahedron, v[K[i][j]], v[6 - i - j - K[i][j]], tetrahedron};
    return walk;
}

/** Goes on to the next tetrahedron. Returns 0, and is where it began, after the last one. */
static inline int brio_edge_walk_next(brio_edge_walk *walk) {
    const brio_tetrahedron *tet = &walk->tetrahedra[walk->tetrahedron];
    int slot =
        (tet->vertex[1] == walk->pivot) + 2 * (tet->vertex[2] == walk->pivot) + 3 * (tet->vertex[3] == walk->pivot);
    uint32_t mate = tet->mate[slot];
    walk->pivot = walk->apex;
    walk->tetrahedron = mate >> 2;
    walk->apex = walk->tetrahedra[mate >> 2].vertex[mate & 3];
    return walk->tetrahedron != walk->first;
}

/** Collects the tetrahedra round a vertex, infinite ones included, from one of them. Returns their number, or capacity + 1
 *  if there are more than `capacity`.
 *  star  room for `capacity` tetrahedra.
 *  Cost: quadratic in the number, about 27 for most vertices; for many or large stars use
 *  brio_triangulation_incident_tetrahedra. */
static inline size_t brio_vertex_star(const brio_tetrahedron *tetrahedra, uint32_t vertex, uint32_t first,
                                      uint32_t *star, size_t capacity) {
    size_t count = 0;
    if (!capacity) return 1;
    star[count++] = first;
    for (size_t n = 0; n < count; n++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = tetrahedra[star[n]].mate[i] >> 2;
            size_t k = 0;
            if (tetrahedra[star[n]].vertex[i] == vertex) continue;
            while (k < count && star[k] != other) k++;
            if (k < count) continue;
            if (count == capacity) return capacity + 1;
            star[count++] = other;
        }
    return count;
}

/* ------------------------------------------------------------------------------------------------------------------
 * Triangulations of the plane
 *
 * The words and promises above hold here, with triangles instead of tetrahedra, edges instead of facets and circles
 * instead of spheres. Constrained edges and refinement are not offered.
 */

/** A triangle: its three vertices as indices of points, and three mates. The handle 4*t + i names the edge of triangle t
 *  opposite to vertex i: triangle handle / 4, slot handle % 4 (0 to 2). mate[i] is the handle of the edge opposite to
 *  vertex[i], seen from the triangle on its other side. As an array of numbers: six to a triangle. */
typedef struct {
    uint32_t vertex[3], mate[3];
} brio_triangle;

typedef struct brio_delaunay2_options {
    size_t size;
    double round_ratio; /* share of the points left for the rounds before the last one, below 1; default 0: 1/8 */
    uint64_t seed;      /* every random choice follows from it; default 1 */
} brio_delaunay2_options;

BRIO_API void brio_delaunay2_options_init(brio_delaunay2_options *options, size_t size);
static inline brio_delaunay2_options brio_delaunay2_options_default(void) {
    brio_delaunay2_options options;
    brio_delaunay2_options_init(&options, sizeof options);
    return options;
}

/** Facts of a triangulation of the plane. Counters are totals over the construction and include infinite triangles. */
typedef struct brio_delaunay2_stats {
    size_t size;
    size_t points, vertices, duplicates, hidden;
    int dimension;     /* of the affine hull of the points: -1 (no points) to 2 */
    int coordinates;   /* of a point: 2 from brio_delaunay2, 3 from brio_delaunay2_flat */
    size_t triangles;  /* finite ones of the result */
    size_t hull_edges; /* = infinite triangles of the result */
    uint64_t created, destroyed, walk_steps, incircle_calls;
    uint64_t exact_calls; /* calls of predicates that the floating-point filter did not settle */
    double order_seconds, insert_seconds;
} brio_delaunay2_stats;

typedef struct brio_triangulation2 brio_triangulation2;

/** Builds the Delaunay triangulation of points in the plane or, with weights, the regular triangulation. Every finite
 *  input has a result. Points on a line have no triangles, but brio_triangulation2_line; ties are broken as in three
 *  dimensions. One thread works.
 *  points   #P by 2, row after row.   weights  #P, or NULL.   num_points  less than 2^29 - 16.
 *  options  NULL for the defaults.    out      owned by the caller, freed with brio_triangulation2_free; NULL on error.
 *  Cost: expected O(n log n) time for points of realistic inputs. Memory: 88 bytes a point, with weights at most
 *  98; of the result 52 a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Bowyer 1981], [Watson 1981]; [Amenta Choi Rote 2003] for the order, [Devillers Teillaud 2011] for ties. */
BRIO_API brio_status brio_delaunay2(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                    const brio_delaunay2_options *options, brio_triangulation2 **out);

/** Builds the same for points in space that lie in one plane, exactly: inputs for which brio_delaunay returns dimension 2
 *  or less and no tetrahedra. Circles and weights are those of the plane in space, and representatives are those of
 *  brio_delaunay. Triangles are counterclockwise as seen from the side to which the plane's normal points; of the two
 *  normals the one whose last coordinate that is not 0 is positive. So a plane of constant z is seen as its x and y are
 *  by brio_delaunay2.
 *  points   #P by 3.
 *  Returns what brio_delaunay2 returns, and BRIO_ERR_NO_ANSWER when the points are not in one plane (the message names
 *  one that is off it). */
BRIO_API brio_status brio_delaunay2_flat(brio_context *ctx, const double *points, const double *weights,
                                         size_t num_points, const brio_delaunay2_options *options,
                                         brio_triangulation2 **out);

/** Frees a triangulation of the plane; NULL is accepted. */
BRIO_API void brio_triangulation2_free(brio_triangulation2 *t);

/** Returns the facts of a triangulation. The view is valid until the triangulation is freed. */
BRIO_API const brio_delaunay2_stats *brio_triangulation2_stats(const brio_triangulation2 *t);

/** Returns the triangles + hull_edges triangles, finite ones first. A finite triangle is counterclockwise. An infinite
 *  triangle (a, b, BRIO_INFINITE) has the hull edge ab, and (a, b, x) is counterclockwise for x outside the hull. The view
 *  is valid until the triangulation is freed. */
BRIO_API const brio_triangle *brio_triangulation2_triangles(const brio_triangulation2 *t);

/** Returns #P indices: for each point the vertex that represents it, which is the point itself if it is a vertex. The
 *  view is valid until the triangulation is freed. */
BRIO_API const uint32_t *brio_triangulation2_representatives(const brio_triangulation2 *t);

/** Returns the hash of the points and weights that the triangulation was made of, as brio_points_hash has it. */
BRIO_API uint64_t brio_triangulation2_points_hash(const brio_triangulation2 *t);

/** Returns the vertices of points on a line, in lexicographic order, each joined to the next by an edge of the
 *  triangulation; NULL and 0 for other dimensions than 1. The view is valid until the triangulation is freed. */
BRIO_API const uint32_t *brio_triangulation2_line(const brio_triangulation2 *t, size_t *count);

/** Checks a triangulation of the plane exactly and completely against its points. It passes if and only if it is the
 *  result of brio_delaunay2 (brio_delaunay2_flat), up to the order of the finite triangles, the order of the infinite
 *  ones, and rotations of the vertices of a triangle. What is checked is what brio_triangulation_check checks, one
 *  dimension lower.
 *  points, weights, num_points  as they were given.
 *  Cost: O(t) for t triangles, and one walk for each point that is no vertex; points on a line are triangulated again.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (the triangulation has
 *  another number of points), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation2_check(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                               const double *weights, size_t num_points);

/** Computes a hash of the set of triangles in terms of the lexicographic ranks of their vertices; of points on a line, a
 *  hash of their number of vertices. It does not depend on the order of points or triangles, and stays the same when all
 *  points are scaled by a power of two.
 *  points  as they were given.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation2_checksum(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                                  uint64_t *checksum);

/* Queries of a triangulation of the plane. What is said of brio_locator and of its queries holds here, with `queries` #Q by
 * 2, but queries are not sorted. Only NATURAL takes workspace: for each thread, lists as long as its largest cavity. */

typedef struct brio_locator2 brio_locator2;

/** Makes a locator of a triangulation of the plane. It needs neither the triangulation nor the points afterwards.
 *  points, weights, num_points  as they were given to brio_delaunay2; triangulations by brio_delaunay2_flat are refused.
 *  out  owned by the caller, freed with brio_locator2_free; NULL on error. Several threads, each with a context of its own,
 *       may query one locator.
 *  Memory: 25 bytes a triangle and 36 a point, for points on a line 36 a point.   Cost: O(n).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the points are not those of the triangulation, or they are points in space),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_locator2_new(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                       const double *weights, size_t num_points, brio_locator2 **out);

/** Frees a locator; NULL is accepted. */
BRIO_API void brio_locator2_free(brio_locator2 *locator);

/** Finds the triangle that holds each query: the finite one of lowest index whose closure holds it.
 *  triangles  #Q: indices of brio_triangulation2_triangles; BRIO_INFINITE for a query strictly outside the convex hull,
 *             and for every query if the points have dimension 1 or less. Queries on the hull's boundary are inside.
 *  Cost: one walk; a few steps where points are spread evenly. For a query at a vertex, O(triangles at that vertex).
 *  Based on: [Devillers Pion Teillaud 2002]. */
BRIO_API brio_status brio_locator2_triangles(brio_context *ctx, const brio_locator2 *locator, const double *queries,
                                             size_t num_queries, uint32_t *triangles);

/** Finds the vertex of least power distance |x - p|^2 - w from each query x; without weights, the nearest vertex. Ties are
 *  lexicographic. Works in every dimension.
 *  vertices  #Q: indices of points that are vertices; BRIO_INFINITE if there are no points.
 *  Cost: one walk, and a descent along edges from there. */
BRIO_API brio_status brio_locator2_least_power(brio_context *ctx, const brio_locator2 *locator, const double *queries,
                                               size_t num_queries, uint32_t *vertices);

/** Interpolates values at the vertices, at each query, as brio_locator_interpolate does: NATURAL weighs the natural
 *  neighbours of the query x by the areas that the Voronoi cell of x would take from their cells.
 *  results  #Q by components: NaN for queries outside the hull, and for every query if the points have dimension 1 or less.
 *  Returns also BRIO_ERR_ARGUMENT (options out of range, no values, NATURAL of a triangulation with weights).
 *  Based on: [Sibson 1980], [Sibson 1981]. */
BRIO_API brio_status brio_locator2_interpolate(brio_context *ctx, const brio_locator2 *locator, const double *queries,
                                               size_t num_queries, const brio_interpolation *options, double *results);

/** The Voronoi diagram of points in the plane or, with weights, their power diagram. Triangles with one circle, decided
 *  exactly, have one vertex. */
typedef struct brio_diagram2 {
    size_t size;
    size_t num_vertices, num_triangles, num_points;
    double *vertices;          /* #V by 2: the centres of the circles, in the order of their first triangles */
    uint32_t *triangle_vertex; /* #T: of each finite triangle, the vertex at the centre of its circle */
    uint64_t *offsets;         /* #P + 1: the region of point p is items[offsets[p]] to items[offsets[p + 1] - 1] */
    uint32_t *items; /* vertices, counterclockwise, each once; BRIO_INFINITE first in an unbounded region. Points
                                  that are no vertices of the triangulation have no items. */
    brio_context *context;
} brio_diagram2;

/** Computes the Voronoi diagram from a triangulation. Points of dimension 1 or less have no vertices and empty regions.
 *  points, weights, num_points  as they were given to brio_delaunay2; triangulations by brio_delaunay2_flat are refused.
 *  out  owned by the caller, freed with brio_diagram2_free; NULL on error.
 *  A vertex is wrong by at most 2^-44 times its distance from the points, plus one rounding; NaN where doubles cannot hold
 *  it. The bits of a vertex of three points depend on their positions alone.
 *  Cost: O(n). Memory: 4 bytes a triangle, 16 a vertex, 8 a point and 4 an item; meanwhile 36 a point more.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the points are not those of the triangulation, or they are points in space),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Aurenhammer 1987]. */
BRIO_API brio_status brio_voronoi2(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                   const double *weights, size_t num_points, brio_diagram2 **out);

/** Frees a diagram with all its arrays; NULL is accepted. */
BRIO_API void brio_diagram2_free(brio_diagram2 *diagram);

/* ------------------------------------------------------------------------------------------------------------------
 * Meshes and their certificates
 */

/** Scalar types of properties, as in PLY. */
typedef enum brio_scalar {
    BRIO_SCALAR_INT8 = 0,
    BRIO_SCALAR_UINT8 = 1,
    BRIO_SCALAR_INT16 = 2,
    BRIO_SCALAR_UINT16 = 3,
    BRIO_SCALAR_INT32 = 4,
    BRIO_SCALAR_UINT32 = 5,
    BRIO_SCALAR_FLOAT32 = 6,
    BRIO_SCALAR_FLOAT64 = 7,
    BRIO_SCALAR_END
} brio_scalar;

/** Returns the bytes of a scalar type. */
BRIO_API size_t brio_scalar_size(brio_scalar type);

/** One named number for each vertex. */
typedef struct brio_property {
    char name[64];
    brio_scalar type;
    int reserved_int;
    void *data; /* #V scalars of `type` */
    uint64_t reserved[2];
} brio_property;

/** What a file holds: points, polygons, tetrahedra or edges over them, and properties of the points. Polygons are stored
 *  one after the other: face f has the vertices face_vertices[face_offsets[f]] to face_vertices[face_offsets[f+1] - 1].
 *  Vertices at the same position stay distinct. The mesh owns all arrays; the array of an absent part is NULL. A program
 *  may change the numbers in the arrays, but neither pointers nor counts. Later versions may append fields. */
typedef struct brio_mesh {
    size_t size; /* of the struct in the library that runs */
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
    size_t num_edges; /* edges of their own, such as those of a medial axis; edges of polygons are not listed */
    uint32_t *edges;  /* #E by 2 */
    double coordinate_step[3];   /* of a LAS file: every coordinate is a whole number times the step, */
    double coordinate_origin[3]; /* plus the origin. brio_write keeps both. Steps are 0 if they are not known. */
} brio_mesh;

/** Makes an empty mesh. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_new(brio_context *ctx, brio_mesh **out);
/** Frees a mesh with all its arrays; NULL is accepted. */
BRIO_API void brio_mesh_free(brio_mesh *mesh);

/* The functions that set a part of a mesh return BRIO_OK, BRIO_ERR_ARGUMENT (the mesh has that part already, or as said),
 * BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. They leave indices unchecked; the functions that use them check. */

/** Copies vertices into a mesh without vertices and properties; vertices NULL sets them to 0. */
BRIO_API brio_status brio_mesh_set_vertices(brio_mesh *mesh, const double *vertices, size_t num_vertices);
/** Copies polygons into a mesh.   offsets  #F + 1, from 0 on, not decreasing; NULL without faces.   indices  offsets[#F]. */
BRIO_API brio_status brio_mesh_set_faces(brio_mesh *mesh, const uint64_t *offsets, const uint32_t *indices,
                                         size_t num_faces);
/** Copies tetrahedra into a mesh. Tetrahedron i has four vertices at tetrahedra + stride * i: stride 4 for a packed
 *  array, 8 for the array of a brio_triangulation. */
BRIO_API brio_status brio_mesh_set_tetrahedra(brio_mesh *mesh, const uint32_t *tetrahedra, size_t stride,
                                              size_t num_tetrahedra);
/** Copies edges into a mesh.   edges  #E by 2. */
BRIO_API brio_status brio_mesh_set_edges(brio_mesh *mesh, const uint32_t *edges, size_t num_edges);
/** Adds a property of the vertices, filled with 0.   data  receives the array, #V scalars, owned by the mesh.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the mesh has a property of that name, the name is empty or has over 63 bytes, or
 *  there is no such type), BRIO_ERR_NO_MEMORY. Names are UTF-8: in one that is not, other bytes are taken for Latin-1. */
BRIO_API brio_status brio_mesh_add_property(brio_mesh *mesh, const char *name, brio_scalar type, void **data);
/** Returns the property of that name, or NULL. */
BRIO_API const brio_property *brio_mesh_property(const brio_mesh *mesh, const char *name);
/** Returns scalar i of a property as a double. */
BRIO_API double brio_property_value(const brio_property *property, size_t i);

/** Adds the properties nx, ny, nz (float32) to the vertices: the unit mean of the normals of the faces at a vertex,
 *  weighted by area. A normal points to the side from which the faces are seen counterclockwise. A vertex whose
 *  faces have no area has the normal of the vertices at its position that edges join to it. A vertex without faces has the
 *  normal 0.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT (an index out of range, or the mesh has such properties) and BRIO_ERR_NO_MEMORY, after
 *  which the mesh is as it was. */
BRIO_API brio_status brio_mesh_add_normals(brio_mesh *mesh);

/** Gives the vertices of a mesh the properties of points, such as the colours of the samples of a surface. The values are
 *  copied in their types, not averaged. A property whose name the mesh has becomes input_NAME, or input_NAME_2 and so on.
 *  points   whose properties are wanted; only its vertices and properties count.
 *  samples  NULL: each vertex takes the properties of the point nearest to it, of the lexicographically first one among
 *           points at equal distances (distances are rounded to doubles), and of the lowest index among coincident
 *           points. Or #V: for each vertex of the mesh the index of its point.
 *  mesh     receives the properties. After a failure it has those that it had.
 *  Cost: with samples linear; else O(n log n) for the points and expected O(log n) a vertex, with all threads; 57 bytes a
 *  point and 4 a vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, or vertices and no points), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Friedman Bentley Finkel 1977]. */
BRIO_API brio_status brio_mesh_carry_properties(brio_context *ctx, const brio_mesh *points, const uint32_t *samples,
                                                brio_mesh *mesh);

/** Drops components of a mesh: sets of faces joined across edges. Also drops the vertices, with their properties, that
 *  only dropped faces used; the rest keeps its order.
 *  largest      1: keeps one component, that of the largest area (among equal areas, the one of more faces, then the
 *               first one); 0: keeps all.
 *  least_faces  drops the components of fewer faces, before the largest one is looked for.
 *  dropped_components, dropped_faces  NULL, or receive what was dropped.
 *  Cost: near-linear; about 30 bytes a corner.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, or the mesh has edges or tetrahedra), BRIO_ERR_NO_ANSWER (no
 *  component has so many faces; a mesh without any stays as it is), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. After a failure the mesh is as it was. */
BRIO_API brio_status brio_mesh_keep_components(brio_mesh *mesh, int largest, size_t least_faces,
                                               size_t *dropped_components, size_t *dropped_faces);

/** What the connectivity of a mesh's polygons says about the surface. Vertices at the same position count as distinct.
 *  Components are sets of faces joined across edges. The genus is the sum over the components of
 *  (2 - chi - boundary loops) / 2. */
typedef struct brio_certificate {
    size_t size;
    brio_context *context; /* that `genera` belongs to */
    int closed;            /* there are faces, none of fewer than three corners, and every edge has two of them */
    int manifold;          /* no edge has more than two faces; the faces at each vertex form one fan */
    int oriented;          /* the two faces of an edge run along it in opposite directions */
    size_t components;
    int64_t genus;
    int64_t *genera; /* of each component, the component with the most faces first; owned by the certificate */
    size_t boundary_edges, boundary_loops;
    size_t nonmanifold_edges, nonmanifold_vertices, flipped_edges;
    int64_t self_intersections; /* -1: for the caller, who may store here what brio_mesh_self_intersections counts */
    double area, volume;        /* volume is positive when the faces are seen counterclockwise from outside */
} brio_certificate;

/** Certifies the polygons of a mesh. Cost O(F log F).   out  initialised with = {.size = sizeof c}; freed with
 *  brio_certificate_free, also before it receives another certificate.
 *  Returns BRIO_OK (whatever the certificate says), BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out);

/** Counts, exactly, the pairs of faces that meet in more than common corners and edges: faces that cross each other,
 *  touch, or overlap in one plane. Corners at equal positions are common corners. A polygon counts as the fan of triangles
 *  from its first corner; triangles of area 0 meet nothing.
 *  Cost: near-linear for faces of about equal size; 100 bytes a face.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_self_intersections(brio_context *ctx, const brio_mesh *mesh, int64_t *pairs);

/** Frees what a certificate owns and sets all fields but `size` to 0; NULL is accepted. */
BRIO_API void brio_certificate_free(brio_certificate *certificate);

/** Distances between two surfaces, in the unit of the coordinates. */
typedef struct brio_distance {
    size_t size;
    double mean, rms, p95, hausdorff; /* from random points of each surface to the nearest point of the other one */
    double normal_consistency;        /* mean |cos| of the angle between the normals at a point and its nearest point */
    double diagonal;                  /* of the bounding box of mesh b */
} brio_distance;

/** Compares two surfaces. Takes `samples` random points of each (0: 100,000), uniform by area, and computes their exact
 *  distances from the triangles of the other surface.   out  its `size` set.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (a mesh without triangles, or whose faces have no area), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_NO_ANSWER (doubles cannot hold the distances), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_distance(brio_context *ctx, const brio_mesh *a, const brio_mesh *b, size_t samples,
                                        uint64_t seed, brio_distance *out);

/** Subdivides a mesh of triangles by the butterfly scheme. Each level adds one vertex on every edge and divides every
 *  triangle into four. Old vertices keep their indices and positions; the limit surface is smooth, also at vertices
 *  without six neighbours. Boundaries are subdivided as curves. A new vertex receives the mean of the properties of its
 *  edge's ends or, for integer properties, those of one end. Of two triangles with the same corners the result has different
 *  edges with the same ends, which a second level refuses.
 *  levels  1 to 15.   out  owned by the caller.
 *  Cost: linear in the result; 64 bytes a vertex of the result and 118 a vertex of the level before.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (a face is no triangle, an edge has more than two faces or two
 *  faces that run along it in the same direction, doubles cannot hold a new vertex), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Dyn Levin Gregory 1990], [Zorin Schroeder Sweldens 1996]. */
BRIO_API brio_status brio_mesh_subdivide(brio_context *ctx, const brio_mesh *mesh, int levels, brio_mesh **out);

typedef struct brio_mesh_simplify_options {
    size_t size;
    size_t target_faces; /* stops at this number of faces; default 0: as few as the tolerance allows */
    double
        tolerance; /* most distance of a new vertex from the planes of the triangles that it stands for, as the root of
                            the mean of squares, in the unit of the mesh; default 0: any distance */
} brio_mesh_simplify_options;

BRIO_API void brio_mesh_simplify_options_init(brio_mesh_simplify_options *options, size_t size);
static inline brio_mesh_simplify_options brio_mesh_simplify_options_default(void) {
    brio_mesh_simplify_options options;
    brio_mesh_simplify_options_init(&options, sizeof options);
    return options;
}

/** Simplifies a mesh of triangles in place: edges collapse, about in the order of their errors. The mesh stays manifold and oriented,
 *  and keeps its components, genus and boundary; triangles do not turn over. Vertices of the boundary stay. Vertices that
 *  no triangle uses are dropped. A vertex keeps the properties of one of those that it stands for.
 *  The result does not depend on the number of threads, nor on the numbers of the vertices; the order of the faces and of
 *  their corners breaks ties.
 *  Cost: O(n log n); 175 bytes a vertex beside the mesh, and 24 more for each vertex that is left when the last edges
 *  collapse.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT (neither target nor tolerance, a negative one, a face is no triangle or has a vertex
 *  twice, an index is out of range, the mesh is not manifold and oriented at an edge or a vertex), BRIO_ERR_TOO_LARGE (2^32 corners) and
 *  BRIO_ERR_NOT_FINITE, after which the mesh is
 *  what it was; BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, BRIO_ERR_NO_ANSWER (doubles cannot hold a new vertex), after which
 *  it can only be freed.
 *  Based on: [Garland Heckbert 1997], [Dey Edelsbrunner Guha Nekhayev 1999]. */
BRIO_API brio_status brio_mesh_simplify(brio_context *ctx, brio_mesh *mesh, const brio_mesh_simplify_options *options);

/** Edges between vertices. */
typedef struct brio_edges {
    size_t count;
    uint32_t *ends; /* count by 2 */
    brio_context *context;
} brio_edges;

/** Frees what edges own and sets their fields to 0; NULL is accepted. */
BRIO_API void brio_edges_free(brio_edges *edges);

/** Lists the edges of a triangulation: every edge between two vertices once, as (a, b) with a < b, in lexicographic order.
 *  There are none if the dimension is 2 or less.   out  freed with brio_edges_free.
 *  Memory: as brio_triangulation_neighbours, which it calls, and 8 bytes an edge.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_edges(brio_context *ctx, const brio_triangulation *t, brio_edges *out);

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

/** Finds a subgraph of the edges of a mesh that contains all vertices of faces and connects what the mesh connects. It is
 *  meant for brio_delaunay_options.edges, when the surface of the points is known. BRIO_SUBGRAPH_BOUNDED has degree at
 *  most 3 on disks and on closed components of genus 0, and at most 12 g on closed components of genus g; no bound is
 *  promised where a component has several boundary loops or shares a vertex with another one.
 *  Cost: linear for BOUNDED and TREE; about 20 bytes a corner of the mesh.
 *  out  freed with brio_edges_free.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (BOUNDED: a face is no triangle, an edge
 *  has more than two faces or two faces that run along it in the same direction), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Choi 2003] section 4.3, [Lazarus Pocchiola Vegter Verroust 2001], [Kruskal 1956]. */
BRIO_API brio_status brio_mesh_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out);

/* ------------------------------------------------------------------------------------------------------------------
 * Voronoi and power cells
 */

typedef struct brio_cells_options {
    size_t size;
    int areas;            /* 1 (default): computes `area` */
    int centroids;        /* 1 (default): computes `centroid` */
    int faces;            /* 1 (default): computes the faces */
    int vertices;         /* 1: computes the vertices, and the faces; default 0 */
    const double *box;    /* x0 y0 z0 x1 y1 z1, low before high: clips the cells; default NULL */
    const double *planes; /* #planes by 4, n and d: clips the cells to n . x <= d; default NULL */
    size_t num_planes;    /* box and planes together must bound a polytope with a volume */
} brio_cells_options;

BRIO_API void brio_cells_options_init(brio_cells_options *options, size_t size);
static inline brio_cells_options brio_cells_options_default(void) {
    brio_cells_options options;
    brio_cells_options_init(&options, sizeof options);
    return options;
}

/** Cells and their faces, #C cells and #F faces. Cell c has the faces face_offsets[c] to face_offsets[c+1] - 1, and face f
 *  has the corners corner_offsets[f] to corner_offsets[f+1] - 1, counterclockwise seen from outside the cell. Arrays that
 *  were not asked for are NULL. A face between two cells is listed in both. Later versions may append fields. */
typedef struct brio_cells {
    size_t size; /* of the struct in the library that runs */
    brio_context *context;
    size_t num_cells;
    uint32_t *site;         /* #C, ascending: the point that owns the cell */
    double *volume;         /* #C: infinite for unbounded cells, and where doubles cannot hold it */
    uint8_t *bounded;       /* #C: 1, or 0 for a cell that reaches infinity. Clipped cells are bounded. */
    double *area;           /* #C: of the cell's surface; infinite for unbounded cells */
    double *centroid;       /* #C by 3: NaN for cells of no volume or an infinite one */
    double volume_sum;      /* of the bounded cells */
    double region_volume;   /* of the polytope that clips; infinite without one */
    uint64_t *face_offsets; /* #C + 1 */
    int64_t
        *face_neighbours; /* #F: the site on the other side, or -1 - i for wall i of the region: the box' walls low x,
                                 high x, low y, high y, low z, high z are -1 to -6, then come the planes */
    double *face_areas;   /* #F: infinite for unbounded faces */
    double *face_normals; /* #F by 3: unit vectors out of the cell */
    uint64_t *corner_offsets; /* #F + 1 */
    uint32_t *face_vertices;  /* of each corner */
    size_t num_vertices;
    double *vertices; /* #vertices by 3 */
} brio_cells;

/** Computes the Voronoi cell of every vertex or, with weights, the power cell: the points of space whose distance (power
 *  distance) from the vertex is the least. Duplicates and hidden points have no cells. Without a region (box or planes),
 *  cells of vertices on the convex hull are unbounded.
 *  Faces: two cells share a face if they meet in a polygon; cells that meet in an edge or a point, as many cells of a
 *  lattice do, share none. This is decided exactly. A face can have a computed area of 0 if it is too small for doubles.
 *  In a region, a cell that lies outside has the volume 0 and no faces. What the walls cut off is decided by rounded
 *  coordinates.
 *  Vertices: a vertex at the centre of tetrahedra is listed once, however many tetrahedra share it; a vertex that
 *  clipping made belongs to one cell. An unbounded face lists its finite vertices in order, from the end of one ray to the
 *  end of the other; unbounded cells of points of dimension 2 or less list none.
 *  Accuracy: vertices are rounded to doubles, after an error of 2^-44 of their distance from their sites. Errors of
 *  vertices cancel in the sum of the volumes: in a region it is region_volume up to about 1e-13 relative, if all cells are
 *  there, and up to about 2^-50 times the distance from 0 or from the sites to the region, divided by its side, where that is
 *  more. Compare volume_sum with region_volume to see; more than 1 % is BRIO_ERR_NO_ANSWER.
 *  Points of dimension 2 or less have cells too: prisms, slabs, or all of space, bounded in a region alone.
 *  t  the result of brio_delaunay for these points and weights, or NULL to compute it.
 *  points, weights, num_points, and limits as brio_delaunay.   options  NULL for the defaults.
 *  out  owned by the caller, freed with brio_cells_free; NULL on error.
 *  The result has the same bits for every number of threads.
 *  Cost: linear in the tetrahedra, beside brio_delaunay; about 52 bytes a tetrahedron, 110 a cell, 24 a point (32 with
 *  weights), and for faces 130 a face, 70 more with vertices. Least without areas, centroids and faces: then volumes take one pass over
 *  the facets, about as long as brio_delaunay.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (t has another number of points; the region is empty, too flat, unbounded, or too
 *  small or, 2^600 times, too large beside the points), BRIO_ERR_NO_ANSWER (see Accuracy), and as brio_delaunay.
 *  Based on: [Aurenhammer 1987], [Choi 2003] sections 2.1 and 2.2. */
BRIO_API brio_status brio_voronoi_cells(brio_context *ctx, const brio_triangulation *t, const double *points,
                                        const double *weights, size_t num_points, const brio_cells_options *options,
                                        brio_cells **out);

/** Frees cells with all their arrays; NULL is accepted. */
BRIO_API void brio_cells_free(brio_cells *cells);

/** File formats of cells. BRIO_CELLS_FORMAT_AUTO decides by the extension. */
typedef enum brio_cells_format {
    BRIO_CELLS_FORMAT_AUTO = 0,
    BRIO_CELLS_FORMAT_VTU = 1,       /* polyhedra of VTK; cells have `vertices`. Left out are unbounded and empty
                                  cells, and those with a vertex that doubles cannot hold. */
    BRIO_CELLS_FORMAT_NPY = 2,       /* a table of NumPy, a structured array of one dimension */
    BRIO_CELLS_FORMAT_CSV = 3,       /* a text with a header */
    BRIO_CELLS_FORMAT_FACES_CSV = 4, /* the faces as a text with a header; never chosen by the extension */
    BRIO_CELLS_FORMAT_END
} brio_cells_format;

/** Returns the format of a file name or of an extension with or without its dot; BRIO_CELLS_FORMAT_AUTO if it is
 *  unknown. */
BRIO_API brio_cells_format brio_cells_format_of(const char *path);

/** Writes cells to a file, with the care of brio_write. CSV and NPY have a row for each cell: site, volume, area, faces
 *  (their number), bounded, cx, cy, cz (the centroid). FACES_CSV has a row for each face of each cell: site, neighbour, area,
 *  nx, ny, nz. VTU has site, volume, area and faces as data of the cells. The cells
 *  have areas, centroids and faces; for VTU also vertices.
 *  comment  a line for the header of a VTU file; NULL: none.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an unknown format, or an array is missing), BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_cells_write(brio_context *ctx, const char *path, const brio_cells *cells,
                                      brio_cells_format format, const char *comment);

/* ------------------------------------------------------------------------------------------------------------------
 * Convex hull
 */

typedef struct brio_convex_hull_options {
    size_t size;
    int polygons; /* 1: a facet is one polygon; default 0: a facet is a fan of triangles from its first corner */
    int reserved_int;
    uint32_t
        *samples; /* room for #P indices: receives for each vertex of the mesh the index of its point; default NULL */
} brio_convex_hull_options;

BRIO_API void brio_convex_hull_options_init(brio_convex_hull_options *options, size_t size);
static inline brio_convex_hull_options brio_convex_hull_options_default(void) {
    brio_convex_hull_options options;
    brio_convex_hull_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_convex_hull_stats {
    size_t size;
    size_t points;
    size_t candidates; /* points that were not skipped as certainly inside; the others cost nothing more */
    size_t vertices;   /* strictly extreme positions */
    size_t facets;     /* convex polygons of which the hull consists; at most one lies in a plane */
    int dimension;     /* of the affine hull of the points: -1 (no points) to 3 */
    int reserved_int;
    double skip_seconds, hull_seconds, mesh_seconds;
} brio_convex_hull_stats;

/** Computes the convex hull of a point set, exactly. Vertices are the strictly extreme points, in ascending order of their
 *  indices; points inside a facet or an edge of the hull are none, and of coincident points the one with the lowest index
 *  is the vertex. Facets are convex polygons, counterclockwise as seen from outside; the lexicographically least vertex
 *  of a facet comes first, and the facets are sorted by their first two vertices. So the hull depends on the points only,
 *  not on their order or the number of threads.
 *  Points of dimension 2 have one facet. It is seen counterclockwise from the end of the first of the axes z, x, y that is
 *  not parallel to its plane. Its boundary is open: the hull has area and no inside. Points of dimension 1 have two
 *  vertices and one edge (brio_mesh.edges), points of dimension 0 one vertex, no points none.
 *  points   #P by 3.   num_points  less than 2^32 - 16.   options  NULL for the defaults.
 *  out      owned by the caller.
 *  stats    NULL, or its `size` set.
 *  Cost: three passes over the points, in which those inside a polytope of 26 extreme points are skipped, with all
 *  threads; expected O(c log c) time for the c candidates that are left, with one thread. Memory: 4 bytes a point, and
 *  about 80 a candidate and 90 a vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE (2^30 triangles or more),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Akl Toussaint 1978] for the points inside, [Clarkson Shor 1989], [Amenta Choi Rote 2003]. */
BRIO_API brio_status brio_convex_hull(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_convex_hull_options *options, brio_mesh **out,
                                      brio_convex_hull_stats *stats);

/* ------------------------------------------------------------------------------------------------------------------
 * Alpha complexes and alpha shapes
 *
 * Alpha is a squared radius, as in the papers, GUDHI and CGAL. Programs that take a radius (PyVista's delaunay_3d, Open3D,
 * MeshLab) mean its square root: their alpha 0.1 is 0.01 here. Values carry the squared unit of the coordinates.
 */

/** The simplices of a Delaunay or regular triangulation with their values in the alpha filtration. The alpha complex of
 *  alpha is the simplices with values of at most alpha. Index k of an array is the dimension: 0 vertices, 1 edges, 2
 *  facets, 3 tetrahedra. The arrays of the four dimensions lie one after the other in one block, so that values[0] has
 *  all values; the number of a simplex is its place there. */
typedef struct brio_alpha_complex {
    size_t size;
    brio_context *context;
    const brio_triangulation *triangulation; /* not owned; must outlive the complex; NULL in the plane */
    size_t counts[4];
    /** counts[k] by k + 1: indices of points, ascending in each simplex; tetrahedra in the triangulation's order. */
    uint32_t *simplices[4];
    /** counts[k]: the least alpha at which the simplex is in the complex. */
    double *values[4];
    /** counts[k]: the least value of a tetrahedron that contains the simplex. From its own value to this one the simplex is
     *  singular: in the complex, and a face of no tetrahedron there. */
    double *solid[4];
    /** counts[k]: 1 if no vertex is strictly inside the smallest orthosphere of the simplex. */
    uint8_t *gabriel[4];
    const brio_triangulation2 *triangulation2; /* of points in the plane; else NULL; as `triangulation` */
} brio_alpha_complex;

/** Computes the alpha filtration. A simplex that is Gabriel, which is decided exactly, has the squared radius of its
 *  smallest circumscribed sphere or, with weights, of its smallest orthosphere: the sphere of a vertex of weight w has the
 *  squared radius -w, and values may be negative. Any other simplex has the least value of the simplices that contain it.
 *  Vertices have the value 0 without weights. Values are rounded from double-doubles, to a few units in the last place
 *  except in tetrahedra too flat for those; a value that doubles cannot hold is INFINITY, and one below 2^-1022, which has
 *  fewer bits, may be 0: such values may be equal where the squared radii are not, so scale points whose radii are beyond
 *  2^511 or below 2^-511. Rounding leaves every value at most that of the simplices that contain the simplex. Duplicates
 *  and hidden points are in no simplex.
 *  t        the triangulation of these points and weights, of dimension 3.   weights  #P, or NULL.
 *  out      its `size` set; freed with brio_alpha_complex_free.
 *  Cost: a few times that of the triangulation, most of it with all threads. For the result and the work 48 bytes a
 *  tetrahedron, 45 a facet, 37 an edge and 24 a vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (another number of points), BRIO_ERR_NO_ANSWER (the points have dimension 2 or
 *  less), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE (2^32 - 1 simplices or more), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Edelsbrunner Muecke 1994], [Edelsbrunner 1995] for weights. */
BRIO_API brio_status brio_alpha_values(brio_context *ctx, const brio_triangulation *t, const double *points,
                                       const double *weights, size_t num_points, brio_alpha_complex *out);

/** Computes the alpha filtration of points in the plane: as brio_alpha_values, with triangles in place of tetrahedra and
 *  circles in place of spheres. counts[3] is 0, and `solid` is the least value of a triangle. brio_alpha_order and
 *  brio_alpha_auto take the complex, brio_alpha_shape does not.
 *  t        made of these points and weights by brio_delaunay2 or brio_delaunay2_flat, of dimension 2.
 *  points   #P by the coordinates of t.   weights  #P, or NULL.   out  its `size` set; freed with brio_alpha_complex_free.
 *  Cost: linear, one thread. For the result and the work 29 bytes a triangle, 25 an edge and 57 a point.
 *  Returns what brio_alpha_values returns; BRIO_ERR_NO_ANSWER for points on a line.
 *  Based on: [Edelsbrunner Kirkpatrick Seidel 1983], [Edelsbrunner 1995] for weights. */
BRIO_API brio_status brio_alpha_values2(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                        const double *weights, size_t num_points, brio_alpha_complex *out);

/** Frees what a complex owns and sets its fields but `size` to 0; NULL is accepted. */
BRIO_API void brio_alpha_complex_free(brio_alpha_complex *complex);

/** Sorts the simplices as they enter the complex: by value, then dimension, then lexicographically by vertices. So a
 *  simplex comes after all its faces, and the order is the same for every number of threads.
 *  order  receives the numbers of all simplices, room for the sum of the counts.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_alpha_order(brio_context *ctx, const brio_alpha_complex *complex, uint32_t *order);

/** Finds the least alpha at which the tetrahedra of the complex are one solid, joined across facets, that has all
 *  vertices of the triangulation; in the plane, at which the triangles are one region, joined across edges. There is one:
 *  the greatest value of a tetrahedron (triangle) at the latest.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (alpha is INFINITY, or alpha and the values of all vertices are closer to 0 than
 *  2^-1022: scale the points), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_alpha_auto(brio_context *ctx, const brio_alpha_complex *complex, double *alpha);

typedef struct brio_alpha_shape_stats {
    size_t size;
    double alpha;
    size_t tetrahedra; /* in the complex */
    size_t vertices;   /* points on the surface */
    size_t split;      /* vertices of the mesh beyond these: where parts of the solid touch, each sheet has its own */
    size_t uncovered;  /* vertices of the triangulation that are in no tetrahedron of the complex */
    size_t singular_vertices, singular_edges, singular_facets; /* in the complex, bounding no tetrahedron of it */
} brio_alpha_shape_stats;

/** Makes the boundary of an alpha shape: of the union of the tetrahedra with values of at most alpha. Its triangles are
 *  seen counterclockwise from outside. The mesh is closed and manifold: where parts of the solid touch in a vertex or an
 *  edge only, vertices are doubled. Singular simplices are counted, and are not in the mesh.
 *  points  as they were given to brio_alpha_values.   out  owned by the caller.   stats  NULL, or its `size` set.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (alpha is NaN, or the complex is of the plane), BRIO_ERR_NO_ANSWER (no tetrahedron
 *  has a value of at most alpha, or alpha is closer to 0 than brio_alpha_auto finds one), BRIO_ERR_NO_MEMORY.
 *  Based on: [Edelsbrunner Muecke 1994]. */
BRIO_API brio_status brio_alpha_shape(brio_context *ctx, const double *points, const brio_alpha_complex *complex,
                                      double alpha, brio_mesh **out, brio_alpha_shape_stats *stats);

/** Text formats of filtrations. */
typedef enum brio_filtration_format {
    BRIO_FILTRATION_GUDHI = 0, /* a line a simplex, "dimension vertices value", as GUDHI's simplex tree reads it */
    BRIO_FILTRATION_RIPSER =
        1, /* a line an edge, "i j value", a sparse distance matrix as ripser --format sparse reads it. Ripser enters every
              vertex at 0, and every clique with its last edge: dimension 0 is that of the alpha complex without weights,
              and higher dimensions are those of the flag complex of its edges. */
    BRIO_FILTRATION_END
} brio_filtration_format;

/** Writes the simplices of a complex with their values, in an order from brio_alpha_order. Vertices are indices of points,
 *  from 0 on. Replaces the file when it is complete, as brio_write does; "-" writes to standard output.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write_filtration(brio_context *ctx, const char *path, const brio_alpha_complex *complex,
                                           const uint32_t *order, brio_filtration_format format);

/* ------------------------------------------------------------------------------------------------------------------
 * Surface reconstruction
 *
 * The power crust, offset surfaces and the power shape begin alike: with the Delaunay triangulation of the samples, the
 * poles of the samples (the vertices of a sample's Voronoi cell that are farthest from it on either side of the surface),
 * the power diagram of the polar balls, and a label, inner or outer, for each pole. What they share is in
 * brio_pole_options and brio_pole_stats.
 *
 * The result of every method is the same for every order of the points and every number of threads.
 */

/** Ways to label poles as inner or outer. */
typedef enum brio_labeling {
    BRIO_LABELING_GLOBAL = 0,      /* seeks labels of least energy by roof duality [Boros Hammer 2002] */
    BRIO_LABELING_GREEDY = 1,      /* labels the most certain pole first [Choi 2003, figure 3.8] */
    BRIO_LABELING_NAIVE = 2,       /* breadth first from outside [Choi 2003, section 3.3.3] */
    BRIO_LABELING_THEORETICAL = 3, /* breadth first from one sample [Choi 2003, appendix B.3] */
    BRIO_LABELING_END
} brio_labeling;

/** What to do about noise in the samples. Smoothing moves each sample onto a quadratic surface through the middle of its
 *  48 nearest samples [Alexa et al. 2003]. */
typedef enum brio_noise {
    BRIO_NOISE_AUTO = 0,   /* smooths if it finds noise: if the quadratic surfaces are off the samples by a tenth of the
                              spacing or more, and by no more than quadratic surfaces of half as many samples are. Keeps
                              the samples when the option `solid` is set. */
    BRIO_NOISE_KEEP = 1,   /* the surface follows the samples as they are */
    BRIO_NOISE_SMOOTH = 2, /* smooths */
    BRIO_NOISE_END
} brio_noise;

/** How poles are found and labeled. Part of other options. */
typedef struct brio_pole_options {
    brio_labeling labeling; /* default BRIO_LABELING_GLOBAL */
    brio_noise noise;       /* default BRIO_NOISE_AUTO */
    const brio_mesh *solid; /* a closed mesh in the unit of the points: poles inside it are inner, and `labeling` is not
                                used; BRIO_ERR_NO_ANSWER if it is not closed; default NULL */
    double
        sampling_density; /* R in (0, 1): the Voronoi cell of a sample is badly shaped if its radius within the co-cone
                                is more than 1.3 R / (1 - R) times the distance to the nearer pole, which no cell of an
                                R-sample is; the nearer pole of such a sample is discarded. Smaller R find more such
                                cells; default 0: none */
    int sharp;            /* 1: discards both poles of a badly shaped cell, so that the faces on either side of a sharp
                                edge without samples are extended until they meet; sampling_density 0 then stands for 0.5.
                                default 0 */
    int reserved_int;
    uint64_t reserved[4];
} brio_pole_options;

/** What was counted while poles were found and labeled. Part of other statistics. */
typedef struct brio_pole_stats {
    size_t samples;      /* distinct positions */
    size_t poles;        /* polar balls */
    size_t hidden_poles; /* polar balls without a power cell */
    size_t bad_cells;    /* samples with badly shaped cells, whose poles were discarded */
    size_t inner, outer; /* poles by label */
    size_t confused;     /* poles that had evidence for both labels when they were labeled */
    size_t unreached;    /* NAIVE, THEORETICAL: poles that were left to the greedy labeling */
    size_t undecided;    /* GLOBAL: poles that the last roof duality did not decide */
    size_t toggled;      /* GLOBAL: poles whose label differs from the greedy one */
    double energy;       /* sum of the weights of the pairs of poles whose labels contradict the evidence. GLOBAL weighs
                             pairs differently from the other labelings: compare its energies with each other only
                             (docs/algorithms.md). */
    double energy_greedy; /* GLOBAL: the energy of the greedy labels that it started from */
    double noise;         /* AUTO: the standard deviation of the noise found, in spacings of the samples; 0: none */
    size_t smoothed;      /* 1: the samples were smoothed */
    double noise_seconds; /* for the search for noise, and for smoothing */
    double delaunay_seconds, poles_seconds, power_seconds, label_seconds;
    uint64_t reserved[4];
} brio_pole_stats;

typedef struct brio_power_crust_options {
    size_t size;
    uint64_t seed;           /* default 1 */
    brio_pole_options poles; /* how the poles are found and labeled */
    int triangulate;         /* 1: cuts the polygons into triangles; default 0 */
    int simplify; /* 1: triangles, about a quarter as many as the crust has polygons: collapses edges that are
                                much shorter than the local spacing of the samples; the surface stays the same as a
                                manifold; default 0 */
    double open;  /* K > 0, finite: leaves out the faces whose two balls intersect at an angle over pi / 4 while the
                                smaller ball's radius is over K local spacings, so that large holes of the samples stay
                                open; default 0: the surface is closed */
} brio_power_crust_options;

BRIO_API void brio_power_crust_options_init(brio_power_crust_options *options, size_t size);
static inline brio_power_crust_options brio_power_crust_options_default(void) {
    brio_power_crust_options options;
    brio_power_crust_options_init(&options, sizeof options);
    return options;
}

/** What the power crust counts. */
typedef struct brio_power_crust_stats {
    size_t size;
    brio_pole_stats poles;
    size_t left_out; /* faces that the option `open` left out */
    double crust_seconds, simplify_seconds;
} brio_power_crust_stats;

/** Reconstructs a closed surface from samples: the power crust. Its faces are the faces of the power diagram of the polar
 *  balls between a cell of an inner pole and a cell of an outer pole, as polygons seen counterclockwise from outside.
 *  Guarantees: for every input that has an inside, the mesh is closed, manifold and oriented as a combinatorial object
 *  (with the option `open`: manifold and oriented). On a dense sample of a smooth closed surface the power crust is
 *  homeomorphic and close to the surface (appendix B of [Choi 2003]).
 *  Vertices that only rounding keeps apart from a sample are at the sample, and the faces between them have no area.
 *  Does not guarantee: triangular faces, faces above a least size, freedom from self-intersections. Faces cross each other
 *  where samples are too few; on dense samples crossing faces are a rare accident of rounding.
 *  brio_mesh_self_intersections counts the pairs.
 *  points   #P by 3.   options  NULL for the defaults.   out  owned by the caller.
 *  normals  NULL, or receives #P by 3: the oriented unit normal of the surface at each point.
 *  stats    NULL, or its `size` set.
 *  Cost: two triangulations, of the samples and of their about 2 n poles; 1,300 to 1,700 bytes a sample at the peak.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, or doubles cannot hold a vertex), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] sections 3.3 and 5. */
BRIO_API brio_status brio_power_crust(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_crust_options *options, brio_mesh **out, double *normals,
                                      brio_power_crust_stats *stats);

typedef struct brio_offset_surface_options {
    size_t size;
    uint64_t seed;           /* default 1 */
    brio_pole_options poles; /* how the poles are found and labeled */
    int triangulate;         /* as in brio_power_crust_options */
    int simplify;            /* as in brio_power_crust_options */
} brio_offset_surface_options;

BRIO_API void brio_offset_surface_options_init(brio_offset_surface_options *options, size_t size);
static inline brio_offset_surface_options brio_offset_surface_options_default(void) {
    brio_offset_surface_options options;
    brio_offset_surface_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_offset_surface_stats {
    size_t size;
    brio_pole_stats poles; /* of the balls that are left after the offset */
    double crust_seconds, simplify_seconds;
} brio_offset_surface_stats;

/** Computes the offset of the power crust of the samples: the surface at `distance` outside it or, for a negative
 *  distance, inside it. Parts of an offset that meet are merged, and parts of the object that are too thin vanish.
 *  Guarantees: as the power crust, closed, manifold and oriented for every distance. The error of the offset is that of the
 *  polar balls as an approximation of the maximal balls.
 *  distance  in the unit of the points.   options  NULL for the defaults.   out  owned by the caller.
 *  stats     NULL, or its `size` set.
 *  Cost: as brio_power_crust, and one more triangulation of the poles.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, doubles cannot hold a vertex, or an inward offset leaves
 *  nothing), and as brio_delaunay.
 *  Based on: [Choi 2003] section 3.3.4. */
BRIO_API brio_status brio_offset_surface(brio_context *ctx, const double *points, size_t num_points, double distance,
                                         const brio_offset_surface_options *options, brio_mesh **out,
                                         brio_offset_surface_stats *stats);

/** Sides of a surface. */
typedef enum brio_sides { BRIO_SIDES_INNER = 0, BRIO_SIDES_OUTER = 1, BRIO_SIDES_BOTH = 2, BRIO_SIDES_END } brio_sides;

typedef struct brio_power_shape_options {
    size_t size;
    uint64_t seed;           /* default 1 */
    brio_pole_options poles; /* how the poles are found and labeled */
    brio_sides sides;        /* whose poles make the shape; default BRIO_SIDES_INNER */
    /* Simplification leaves out a ball if a larger ball of the same side */
    double scale;      /* S > 1: contains it after the radii of both are multiplied by S, for noise; default 1: none */
    double redundancy; /* E > 0: contains it after the larger radius grows by E times itself; default 0: none */
} brio_power_shape_options;

BRIO_API void brio_power_shape_options_init(brio_power_shape_options *options, size_t size);
static inline brio_power_shape_options brio_power_shape_options_default(void) {
    brio_power_shape_options options;
    brio_power_shape_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_power_shape_stats {
    size_t size;
    brio_pole_stats poles;               /* before simplification */
    size_t unlabeled;                    /* poles without a label; 0 with every labeling there is */
    size_t left_out;                     /* poles that simplification left out */
    size_t edges, triangles, tetrahedra; /* of the shape */
    double simplify_seconds, shape_seconds;
} brio_power_shape_stats;

/** Computes the power shape of samples of a surface, an approximation of its medial axis. Its vertices are the poles on
 *  the chosen sides that have a power cell; its edges, triangles and tetrahedra are those of the regular triangulation of
 *  the poles whose vertices are all on one side. The inner shape is homotopy equivalent to the union of the inner cells:
 *  unless an inner pole is on the hull of the poles, its Euler characteristic (vertices - edges + triangles - tetrahedra)
 *  is that of the solid inside the power crust. As samples of a smooth surface get denser, their poles converge to the
 *  medial axis. Poles of the bounding points around the samples are not part of the shape.
 *  points   #P by 3.   options  NULL for the defaults.   stats  NULL, or its `size` set.
 *  shape    owned by the caller: vertices with the properties "radius" (float64) and "side" (int8: -1 inner, 1 outer),
 *           edges, triangles as faces, positive tetrahedra.
 *  crust    NULL, or receives the power crust of the balls that simplification left: closed, manifold, oriented; owned by
 *           the caller.
 *  Simplification leaves a larger ball within max((S - 1) (R - r), E R) of every ball that it leaves out, r being the
 *  radius of the smaller and R of the larger ball. It leaves out balls without a power cell first; these lie within the
 *  union of the others.
 *  Cost: as brio_power_crust; with simplification, one more triangulation of the poles.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid, no pole is on a chosen side, doubles cannot hold a vertex, or
 *  the mesh `solid` is not closed), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] section 3.3.2, [Miklos Giesen Pauly 2010]. */
BRIO_API brio_status brio_power_shape(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_shape_options *options, brio_mesh **shape, brio_mesh **crust,
                                      brio_power_shape_stats *stats);

typedef struct brio_labeled_delaunay_options {
    size_t size;
    uint64_t seed;    /* default 1 */
    brio_noise noise; /* what to do about noisy samples; default BRIO_NOISE_AUTO */
    int confidence;   /* 1: adds the vertex property "confidence"; default 0 */
    double
        open; /* K > 0, finite: leaves out the triangles that span holes of the samples: their circles have radii over K
                         spacings of their samples, and they are joined to a triangle with a side over K spacings. The
                         surface is then manifold and oriented, with boundary; default 0: it is closed */
    int simplify; /* 1: collapses edges of up to four spacings while the vertices stay within a tenth of a spacing
                         of the planes of their triangles, until a quarter of the triangles is left; the surface stays
                         the same as a manifold; default 0 */
    int reserved_int;
} brio_labeled_delaunay_options;

BRIO_API void brio_labeled_delaunay_options_init(brio_labeled_delaunay_options *options, size_t size);
static inline brio_labeled_delaunay_options brio_labeled_delaunay_options_default(void) {
    brio_labeled_delaunay_options options;
    brio_labeled_delaunay_options_init(&options, sizeof options);
    return options;
}

/** What the labeled Delaunay triangulation counts. */
typedef struct brio_labeled_delaunay_stats {
    size_t size;
    size_t samples;   /* distinct positions */
    size_t unused;    /* samples on no triangle of the surface */
    size_t undecided; /* samples and tetrahedra that the last roof duality did not decide */
    size_t specks;    /* regions, inner or outer, that were dropped: of under 30 triangles of 40,000, of under 42 of
                         2 million, and of under a hundredth of all */
    size_t relabeled; /* tetrahedra whose side was changed to make the surface a manifold or simpler */
    size_t handles;   /* handles, tunnels, crumbs, bubbles that were removed: little evidence held them */
    double energy;    /* of the labels, before these changes: a twenty-first of the log-odds of the votes that they
                         contradict, and of the area */
    double noise;     /* AUTO: the standard deviation of the noise found, in spacings of the samples; 0: none */
    size_t smoothed;  /* 1: the samples were smoothed */
    double noise_seconds, delaunay_seconds, poles_seconds, labels_seconds, manifold_seconds;
    size_t left_out;         /* triangles that the option `open` left out */
    double uncertain_share;  /* with options.confidence: the share of the vertices whose confidence is under 0.7 */
    double simplify_seconds; /* for the mesh, and for its simplification */
} brio_labeled_delaunay_stats;

/** Reconstructs a closed surface from samples: the boundary of the Delaunay tetrahedra that are labeled inner. A sample
 *  votes on the sides of the tetrahedra in its Voronoi cell, with log-odds that were measured on generated solids; the
 *  labels are those of low energy, votes and area together.
 *  Guarantees: for every input that has an inside, the mesh is closed, manifold and oriented as a combinatorial object
 *  (with the option `open`: manifold and oriented).
 *  Does not guarantee: the right topology where walls or gaps are under two spacings of the samples, freedom from
 *  self-intersections, that every sample is used.
 *  points   #P by 3.   options  NULL for the defaults.   stats  NULL, or its `size` set.
 *  out      owned by the caller: triangles, about two a sample, counterclockwise seen from outside. The vertices are the
 *           samples that the surface uses; with smoothing, where smoothing moved them. With options.confidence, their
 *           property "confidence" (float32) is the probability that the surface is right there, between 0 and 1: a
 *           logistic regression on the share of the votes round the vertex that the labels contradict and on the
 *           log-odds of the labels beside its triangles, measured on generated solids. Vertices under 0.7 are
 *           guesses (docs/algorithms.md tells how often those of real models were wrong).
 *  samples  NULL, or room for #P: receives for each vertex the index of its sample, ascending; with options.simplify, of
 *           the sample whose vertex it was before edges collapsed.
 *  Cost: one triangulation, and the labels, about as long; about 1,000 bytes a sample at the peak.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, or options.open leaves nothing), and as brio_delaunay.
 *  Based on: [Labatut Pons Keriven 2009], [Dey Goswami 2003], [Amenta Bern 1999]. */
BRIO_API brio_status brio_labeled_delaunay(brio_context *ctx, const double *points, size_t num_points,
                                           const brio_labeled_delaunay_options *options, brio_mesh **out,
                                           uint32_t *samples, brio_labeled_delaunay_stats *stats);

/** Finds the oriented unit normals of the points that a surface was made from. A point that is a vertex has the vertex's
 *  normal, as brio_mesh_add_normals finds it, and so have its duplicates. Every other point has the normal of the surface
 *  where the surface is nearest to it, interpolated between vertices.
 *  surface  its vertices are points, maybe moved.
 *  samples  #V: the point of each vertex; NULL: vertex v is point v, as in the co-cone.
 *  normals  #P by 3, written.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_ANSWER (no vertex has a
 *  normal), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_point_normals(brio_context *ctx, const double *points, size_t num_points,
                                        const brio_mesh *surface, const uint32_t *samples, double *normals);

/** How the co-cone makes a surface of its candidate triangles. */
typedef enum brio_extraction {
    BRIO_EXTRACTION_LABELS = 0, /* the candidates between tetrahedra labeled outer and inner, and small gaps filled */
    BRIO_EXTRACTION_CANDIDATES = 1, /* all candidates, as [Choi 2003] has implemented it; not oriented, no manifold */
    BRIO_EXTRACTION_PRUNED = 2,     /* those left when triangles at sharp edges are removed, recursively; likewise */
    BRIO_EXTRACTION_WALK = 3,       /* of these, each component's outside, by a walk from edge to edge
                                       [Amenta Choi Dey Leekha 2000]: a manifold on dense samples */
    BRIO_EXTRACTION_END
} brio_extraction;

typedef struct brio_cocone_options {
    size_t size;
    uint64_t seed;  /* default 1 */
    double theta;   /* half the opening angle of the co-cone in radians, in (0, pi/2); default pi/8 */
    int tight;      /* 1: the tight co-cone, a closed surface; default 0: the co-cone, which may come out open */
    int boundaries; /* 1: finds samples at boundaries and where the sampling is too sparse by the shape of their Voronoi
                       cells, and rejects triangles all of whose vertices are such samples; default 0 */
    int density;    /* 1: estimates the sampling density and adds it as vertex properties; default 0 */
    size_t pieces;  /* N > 1: the super co-cone, which triangulates the samples in about N pieces, one after the other,
                       and matches the surfaces at the seams; not with `tight`; default 0: one piece */
    brio_extraction extraction; /* default BRIO_EXTRACTION_LABELS; the others not with `tight` or `pieces` */
    int reserved_int;
} brio_cocone_options;

BRIO_API void brio_cocone_options_init(brio_cocone_options *options, size_t size);
static inline brio_cocone_options brio_cocone_options_default(void) {
    brio_cocone_options options;
    brio_cocone_options_init(&options, sizeof options);
    return options;
}

/** What the co-cone counts. */
typedef struct brio_cocone_stats {
    size_t size;
    size_t samples;           /* distinct positions */
    size_t unused;            /* samples on no triangle of the surface */
    size_t candidates;        /* triangles that pass the co-cone test */
    size_t pruned;            /* candidates rejected at sharp edges */
    size_t boundary_samples;  /* found with options.boundaries */
    size_t relabeled;         /* tetrahedra whose side was changed to keep the surface a manifold */
    size_t pieces;            /* with options.pieces: cells of the octree */
    size_t unmatched;         /* with options.pieces: triangles at seams left out because the pieces disagree on them */
    size_t outside_guarantee; /* with options.density: samples on the surface where the estimate of r is over 0.08 */
    double r_median, r_p95;   /* with options.density: of the estimates of r at the samples on the surface */
    double delaunay_seconds, poles_seconds, candidates_seconds, labels_seconds, manifold_seconds, density_seconds;
} brio_cocone_stats;

/** Reconstructs a surface from Delaunay triangles of the samples: the co-cone or the tight co-cone.
 *  Guarantees: for every input, the mesh is manifold and oriented as a combinatorial object, and the tight co-cone is
 *  closed; not so with another extraction than BRIO_EXTRACTION_LABELS. On an r-sample of a smooth closed surface with
 *  r <= 0.08, the co-cone is homeomorphic to the surface and within
 *  1.3 r / (1 - r) times the local feature size of it (theorem 19 of [Choi 2003]).
 *  Does not guarantee: a closed mesh on sparser samples, freedom from self-intersections, that every sample is used.
 *  points  #P by 3.   options  NULL for the defaults.   stats  NULL, or its `size` set.
 *  out     owned by the caller. Its vertices are the points, with the same indices, also those that no face uses.
 *          options.density adds three properties: "feature_size", the distance to the nearest pole; "r", an estimate of
 *          the sampling density, 0 at a sample on no face; "boundary", 1 at a boundary sample. options.boundaries adds
 *          "boundary" alone.
 *  Cost: one triangulation, and about 50 bytes a tetrahedron. In N pieces the memory is that of 1/N of the samples and
 *  their surroundings, and 60 bytes a point; on a dense sample the triangles are the same as in one piece.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no triangle found, or no inside), and as brio_delaunay.
 *  Based on: [Amenta Choi Dey Leekha 2000], [Choi 2003] section 3.2 and appendix A, [Dey Giesen 2001],
 *            [Dey Giesen Hudson 2001], [Dey Goswami 2003]. */
BRIO_API brio_status brio_cocone(brio_context *ctx, const double *points, size_t num_points,
                                 const brio_cocone_options *options, brio_mesh **out, brio_cocone_stats *stats);

/* ------------------------------------------------------------------------------------------------------------------
 * Iso-surfaces
 */

typedef struct brio_iso_surface_options {
    size_t size;
    double level;   /* of the surface, in the unit of the map or of the density of atoms; default 1 */
    int deviations; /* 1: `level` counts standard deviations above the mean of the map; default 0 */
    int conforming; /* 1: every triangle is a facet of the Delaunay triangulation of the mesh's vertices, vertices at one
                          position taken as one [Attali Lachaud 2001]; default 0 */
    double blobbiness; /* atoms: above 0 and at most 100; the larger, the closer the surface is to spheres; default 2 */
    size_t resolution; /* cells along the longest side; default 0: the map's own, or half an angstrom for atoms */
    size_t vertices;   /* not 0: chooses the resolution so that the mesh has about this many vertices; default 0 */
} brio_iso_surface_options;

BRIO_API void brio_iso_surface_options_init(brio_iso_surface_options *options, size_t size);
static inline brio_iso_surface_options brio_iso_surface_options_default(void) {
    brio_iso_surface_options options;
    brio_iso_surface_options_init(&options, sizeof options);
    return options;
}

/** Computes the iso-surface of a density in a file, as a closed triangle mesh. The file is a CCP4 or MRC map (.map .mrc
 *  .ccp4), whose surface is cut off flat where it leaves the map, or atoms in a PDB file (.pdb .ent), each a Gaussian that
 *  alone has level 1 at the atom's van der Waals radius. "-" reads standard input.   options  NULL for the defaults.
 *  Memory: 4 bytes a value of the map or 40 bytes an atom; the mesh; two layers of cells with 36 bytes a cell.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (nothing is above the level, or the map is one value thin),
 *  and as brio_read. */
BRIO_API brio_status brio_iso_surface(brio_context *ctx, const char *path, const brio_iso_surface_options *options,
                                      brio_mesh **out);

/* ------------------------------------------------------------------------------------------------------------------
 * Choosing points
 */

/** Thins points to a spacing: chooses points that are at least `spacing` from each other, such that every other point is
 *  less than `spacing` from a chosen one. (Distances as computed in doubles.) No other point can be added, so the set has no
 *  holes that the points do not have. The chosen positions depend on the set of positions and the spacing only, and not on
 *  the order of the points or the number of threads; of coincident points the first one is chosen.
 *  points   #P by 3, finite.   spacing  finite, greater than 0.
 *  chosen   #P: receives 1 for chosen points, 0 for others.   num_chosen  NULL, or receives their number.
 *  Cost: linear in the number of points, if cells as wide as the spacing can be numbered in 63 bits; otherwise cells are
 *  wider, and cost the square of the points chosen in them. Memory: 24 bytes a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Cook 1986] for the property; docs/algorithms.md. */
BRIO_API brio_status brio_thin(brio_context *ctx, const double *points, size_t num_points, double spacing,
                               uint8_t *chosen, size_t *num_chosen);

typedef struct brio_outliers_options {
    size_t size;
    double factor; /* finite, 1 or more; default 3 */
} brio_outliers_options;

BRIO_API void brio_outliers_options_init(brio_outliers_options *options, size_t size);
static inline brio_outliers_options brio_outliers_options_default(void) {
    brio_outliers_options options;
    brio_outliers_options_init(&options, sizeof options);
    return options;
}

/** Finds outliers. The spacing of a point is its mean distance to its nearest points, `neighbours` of them. A point is an
 *  outlier if its spacing is more than `factor` times the lower quartile of the spacings of these points, or if it is far
 *  beyond the spacings of all points: in logarithms 8 robust standard deviations above their median, and more than factor^2
 *  times the median. So where points become sparse by and by none is an outlier. More than `neighbours` stray points that
 *  are close together are not found. Which positions are outliers does not depend on the order of the points or the
 *  number of threads.
 *  points   #P by 3, finite.   neighbours  1 to 63; 8 to 16 are usual.
 *  outlier  #P: receives 1 for outliers, 0 for others.
 *  Cost: O(n log n). Memory: 45 bytes a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Breunig 2000]; docs/algorithms.md. */
BRIO_API brio_status brio_outliers(brio_context *ctx, const double *points, size_t num_points, int neighbours,
                                   const brio_outliers_options *options, uint8_t *outlier);

/* ------------------------------------------------------------------------------------------------------------------
 * Files
 */

/** File formats. BRIO_FORMAT_AUTO decides by the extension, and by the content of the file where it tells the format. */
typedef enum brio_format {
    BRIO_FORMAT_AUTO = 0,
    BRIO_FORMAT_PLY = 1,
    BRIO_FORMAT_XYZ = 2, /* .xyz .pts .txt .csv */
    BRIO_FORMAT_OBJ = 3,
    BRIO_FORMAT_OFF = 4,
    BRIO_FORMAT_VTU = 5,
    BRIO_FORMAT_NODE = 6, /* TetGen's .node, with .ele beside it */
    BRIO_FORMAT_VTP = 7,
    BRIO_FORMAT_LAS = 8,       /* versions 1.0 to 1.4, point formats 0 to 10 without waveforms */
    BRIO_FORMAT_LAZ = 9,       /* read, not written */
    BRIO_FORMAT_PCD = 10,      /* read, not written */
    BRIO_FORMAT_PTX = 11,      /* read, not written */
    BRIO_FORMAT_STL = 12,      /* corners at the same position become one vertex */
    BRIO_FORMAT_NPY = 13,      /* NumPy: an array of rows of coordinates, or of records with names */
    BRIO_FORMAT_GLB = 14,      /* glTF 2.0: .glb; .gltf is read, not written. Single precision about an origin */
    BRIO_FORMAT_E57 = 15,      /* read, not written; where brio was built with the library expat */
    BRIO_FORMAT_CHEMICAL = 16, /* .xyz with element symbols or atomic numbers: read, not written */
    BRIO_FORMAT_BNPTS = 17,    /* oriented points of Kazhdan's Poisson programs: read, not written */
    BRIO_FORMAT_NPZ = 18,      /* NumPy's zip of arrays: read, not written */
    BRIO_FORMAT_END
} brio_format;

/** Returns the format of a file name or of an extension with or without its dot; BRIO_FORMAT_AUTO if it is unknown. */
BRIO_API brio_format brio_format_of(const char *path);

typedef struct brio_read_options {
    size_t size;
    brio_format format; /* default BRIO_FORMAT_AUTO */
    const char
        *columns; /* texts of points (BRIO_FORMAT_XYZ): the names of the columns in their order, "x,y,z,-,nx"; - and
                            _ leave a column out, as it happens to columns behind the last name. x, y and z have to be
                            there. Default NULL: by the file's line of names, or else the first three */
} brio_read_options;

BRIO_API void brio_read_options_init(brio_read_options *options, size_t size);
static inline brio_read_options brio_read_options_default(void) {
    brio_read_options options;
    brio_read_options_init(&options, sizeof options);
    return options;
}

/** Reads a file. Keeps vertices, polygons, tetrahedra and every scalar property of the vertices; skips other elements.
 *  What is read, kept and lost of each format is in docs/formats.md. Chunks of LAZ files are decoded in threads. A file
 *  compressed by gzip or zstd is decompressed while it is read, if the library was built with zlib or libzstd; messages
 *  then count lines and bytes of what was decompressed.
 *  path  "-" reads standard input.   options  NULL for the defaults.   out  owned by the caller; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (columns of a format that has none, or that lack x, y or z), BRIO_ERR_OPEN,
 *  BRIO_ERR_FORMAT (the message names the file, the line or byte offset, and what was expected), BRIO_ERR_NOT_FINITE
 *  (the message names the first such point and their number), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_read_as(brio_context *ctx, const char *path, const brio_read_options *options,
                                  brio_mesh **out);

/** brio_read_as with a format and else the defaults. */
BRIO_API brio_status brio_read(brio_context *ctx, const char *path, brio_format format, brio_mesh **out);

/** brio_read_as of a file's bytes in memory, compressed ones included. No file is opened: a .node file's tetrahedra, which
 *  are in another file, are not read.
 *  bytes  size of them, not kept.
 *  name   what messages call the file, "scan.ply"; its extension tells the format where the content does not. NULL is for
 *         none: then bytes in no known format are rows of numbers.
 *  Returns what brio_read_as returns, but not BRIO_ERR_OPEN. */
BRIO_API brio_status brio_read_memory(brio_context *ctx, const void *bytes, size_t size, const char *name,
                                      const brio_read_options *options, brio_mesh **out);

/** What a file is. */
typedef struct brio_file_facts {
    size_t size;
    brio_format format;
    int streamed;     /* 1: the callback received the points block by block */
    char version[64]; /* of the file, where the format has versions, such as "1.2, point format 3"; else "" */
} brio_file_facts;

/** Receives a part of a file. `block` is valid during the call. A result other than 0 cancels the reading. */
typedef int (*brio_rows_fn)(const brio_mesh *block, void *user);

/** Reads a file as brio_read does, and hands over its points in blocks of some 65,536, in the order of the file, each with
 *  its part of the properties: a file of any size needs the memory of a few blocks. All blocks have the same properties; a
 *  file without points is one empty block. Files with polygons or tetrahedra, and formats and orders that do not hold one
 *  point after the other (OBJ, OFF, VTU, NODE, STL, NPZ, NPY in Fortran's order), are one block.
 *  facts  NULL, or receives what the file is.
 *  Returns what brio_read returns; BRIO_ERR_CANCELLED if the callback asked for it; BRIO_ERR_FORMAT if a row of a text lacks
 *  a column that earlier blocks have. Earlier blocks were handed over when an error is found. */
BRIO_API brio_status brio_read_blocks(brio_context *ctx, const char *path, const brio_read_options *options,
                                      brio_rows_fn take, void *user, brio_file_facts *facts);

typedef struct brio_write_options {
    size_t size;
    brio_format format;  /* default BRIO_FORMAT_AUTO: by the extension */
    int ascii;           /* 1: text, in formats with a text and a binary form; default 0 */
    int float32;         /* 1: coordinates in single precision, in formats with both; default 0 */
    const char *comment; /* a line for the header; default NULL: none */
    double *moved;       /* receives the greatest distance between a vertex and the point that a reader gets: not 0
                            where the format or `float32` rounds coordinates; default NULL */
    int compress;        /* 1: compressed by zlib: VTU and VTP, if the library was built with zlib; default 0 */
    /* NODE, 1: TetGen's .neigh, .face and .edge too, beside .ele; default 0. They are found from the tetrahedra, with 40
     * bytes a tetrahedron. Facets of one tetrahedron alone are the hull, whose faces and edges have the marker 1. */
    int neighbours, faces, edges;
    const char
        *separator; /* XYZ: "," or " " between numbers; with "," there is no comment; default NULL: by the name, ","
                              for .csv */
} brio_write_options;

BRIO_API void brio_write_options_init(brio_write_options *options, size_t size);
static inline brio_write_options brio_write_options_default(void) {
    brio_write_options options;
    brio_write_options_init(&options, sizeof options);
    return options;
}

/** Writes a mesh. Writes a temporary file beside the target, flushes it, and renames it to the target, so that no
 *  half-written file is ever left. A symbolic link stays, and the file that it leads to is made or replaced. The
 *  permissions of an existing file stay. "-" writes to standard output; the format must then be given. Standard output,
 *  pipes and devices are written in place, and the progress callback can cancel a wait for their readers. The process
 *  receives neither SIGPIPE nor SIGXFSZ. Edges are written to PLY, VTU, VTP and GLB only; faces not to
 *  texts of points, LAS, NPY and NODE, those of fewer than three corners not to STL and GLB. In the names of properties, formats
 *  that cannot quote have _ for blanks and commas, and _2 behind a name that is taken, also by a coordinate; a comment of
 *  several lines becomes several comments. Of several files (.node and those beside it) none gets its name before all are
 *  complete.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the format cannot hold the mesh, an index is out of range, or three tetrahedra
 *  whose neighbours are asked for share a facet), BRIO_ERR_NOT_FINITE, before a file is opened, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write(brio_context *ctx, const char *path, const brio_mesh *mesh,
                                const brio_write_options *options);

/** Receives the name of something that a file cannot hold. */
typedef void (*brio_lost_fn)(const char *name, void *user);

typedef struct brio_convert_options {
    size_t size;
    const brio_read_options *from;         /* default NULL: the defaults of reading */
    const brio_write_options *to;          /* default NULL: the defaults of writing */
    int crop;                              /* 1: keeps what is in the box; default 0 */
    int drop_outliers;                     /* neighbours by which brio_outliers judges; default 0: keeps outliers */
    double box[6];                         /* x0, y0, z0, x1, y1, z1; its border belongs to it */
    const brio_outliers_options *outliers; /* default NULL: the defaults of brio_outliers */
    double thin;                           /* spacing of brio_thin; default 0: keeps all points */
    brio_lost_fn lost; /* default NULL: called once for each part that is lost, before the file gets its name */
    void *lost_user;
} brio_convert_options;

BRIO_API void brio_convert_options_init(brio_convert_options *options, size_t size);
static inline brio_convert_options brio_convert_options_default(void) {
    brio_convert_options options;
    brio_convert_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_convert_stats {
    size_t size;
    uint64_t points_read, points, faces, tetrahedra, edges; /* read; written */
    uint64_t outliers, thinned;                             /* points dropped by the options of these names */
    int streamed;                                           /* 1: block by block; 0: the whole file was in memory */
    int passes;                                             /* how often the file was read */
    double select_seconds, seconds;                         /* finding outliers and thinning, reading included; all */
} brio_convert_stats;

/** Converts a file to another format, or chooses among its points, or both. First come the points in the box, of these
 *  those that are no outliers, of these a thinned set; the points keep their order and all properties. A polygon, tetrahedron
 *  or edge stays if all its vertices stay.
 *  Memory: files of points are converted block by block, in less than 64 MB with two threads, from LAS, LAZ, PLY, text, NPY,
 *  PCD (uncompressed) and PTX to LAS, PLY, text and NPY. The input is read twice or three times if the output must know all
 *  points before the first one (LAS; PLY and NPY into a pipe, if their number is not known), or if outliers are dropped or
 *  points are thinned. Outliers and thinning need the coordinates in memory: 24 bytes a point, and what brio_outliers and
 *  brio_thin take. Where an input that must be read again is no regular file, and for other formats and meshes, the whole
 *  file is in memory.
 *  What the other format cannot hold is left out and named to options->lost: "faces", "tetrahedra", "edges", the names of
 *  properties, and "precision" if coordinates are rounded.
 *  Progress begins anew where a text is read again because late rows lack a column.
 *  from, to  paths of different files; "-" as in brio_read and brio_write.
 *  stats     NULL, or receives facts.
 *  Returns what brio_read, brio_write, brio_outliers and brio_thin return, and BRIO_ERR_FORMAT if the input changed between
 *  two readings. */
BRIO_API brio_status brio_convert(brio_context *ctx, const char *from, const char *to,
                                  const brio_convert_options *options, brio_convert_stats *stats);

/* ------------------------------------------------------------------------------------------------------------------
 * Test data
 */

typedef enum brio_kind {
    BRIO_KIND_CUBE = 0,     /* uniform in the unit cube */
    BRIO_KIND_BALL = 1,     /* uniform in the unit ball */
    BRIO_KIND_SPHERE = 2,   /* uniform on the unit sphere */
    BRIO_KIND_TORUS = 3,    /* uniform by area on the torus of radii 1 and 0.4 */
    BRIO_KIND_CYLINDER = 4, /* uniform on the side of the cylinder of radius 1 and height 4 */
    BRIO_KIND_GRID = 5,     /* the first n points of the smallest cubic integer grid that has n */
    BRIO_KIND_SCAN = 6,     /* a simulated laser scan of a sculpture of genus 3 */
    BRIO_KIND_CLUSTERS = 7, /* uniform in 256 balls in the unit cube, whose radii are log-uniform from 1e-7 to 0.1 */
    BRIO_KIND_MOMENT = 8,   /* (t, t^2, t^3), t uniform in [0, 1): about n^2 / 2 tetrahedra */
    BRIO_KIND_DEPTH = 9,    /* a frame of a depth camera, row by row, in mm, its depths rounded to 1 mm */
    BRIO_KIND_END
} brio_kind;

typedef struct brio_generate_options {
    size_t size;
    uint64_t seed; /* default 1 */
    double noise;  /* scan: standard deviation along the ray, in spacings of the samples; default 0.05 */
    int views;     /* scan: number of sensor positions; default 12 */
    int reserved_int;
} brio_generate_options;

BRIO_API void brio_generate_options_init(brio_generate_options *options, size_t size);
static inline brio_generate_options brio_generate_options_default(void) {
    brio_generate_options options;
    brio_generate_options_init(&options, sizeof options);
    return options;
}

/** Makes n points of a kind; the same seed gives the same points. A scan has about n points, as many as its rays hit, and
 *  the property "view".   options  NULL for the defaults.   out  owned by the caller.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (also where noise moves points of a scan farther than doubles can hold),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_generate(brio_context *ctx, brio_kind kind, size_t n, const brio_generate_options *options,
                                   brio_mesh **out);

/** Makes the surface that BRIO_KIND_SCAN scans: a closed triangle mesh from a grid of `resolution` cells along the longest
 *  side of its box (4 to 32,768; 0: 160).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_generate_truth(brio_context *ctx, size_t resolution, brio_mesh **out);

/** Families of random solids. */
typedef enum brio_solid_kind {
    BRIO_SOLID_IMPLICIT = 0, /* organic: smooth blends of balls, tubes, rings and sheets, hollowed, trimmed, textured */
    BRIO_SOLID_MACHINED = 1, /* parts with sharp edges: plates, housings, turned parts, gears, frames */
    BRIO_SOLID_END
} brio_solid_kind;

/** Makes the surface of a random solid, to judge surface reconstruction by. It is a closed, manifold, oriented mesh of
 *  triangles, centred, in a box of diagonal 1. It has one to three components, seldom a void; its genus is what the
 *  certificate counts. Where an even sampling of 20,000 points has the spacing s, walls, gaps and bars are at least 1.2 s
 *  thick, most of them 3 to 10 s. Sharp edges and corners are on edges and vertices of the mesh.
 *  The seed determines the solid, and with the resolution the mesh, for any number of threads.
 *  resolution  cells along the longest side of the box, 16 to 1,024; 0: 144.   out  owned by the caller.
 *  Cost: some seconds; about 8 R^2 triangles at resolution R.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (the resolution is too coarse to show anything),
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Ricci 1973], [Doi Koide 1991], [Ohtake Belyaev 2002]. */
BRIO_API brio_status brio_generate_solid(brio_context *ctx, brio_solid_kind kind, uint64_t seed, size_t resolution,
                                         brio_mesh **out);

/* ------------------------------------------------------------------------------------------------------------------
 * Memory estimates
 *
 * Each estimates the bytes that the function of its name holds at its peak, the result included and the caller's arrays
 * not. The estimates are within 15 % on the inputs of docs/measured/performance.md; other inputs can need more. To make sure, set
 * the limit of the context: work over it fails with BRIO_ERR_NO_MEMORY.
 */

/** Estimates the memory of brio_delaunay for these points and the threads of the context. Triangulates the surroundings
 *  of twelve points to learn how many tetrahedra a point there are.   options  NULL for the defaults.
 *  Cost: about 20,000 insertions and fifty passes over the points.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (as brio_delaunay), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_estimate_delaunay(brio_context *ctx, const double *points, const double *weights,
                                            size_t num_points, const brio_delaunay_options *options, uint64_t *bytes);

/** Estimates how many tetrahedra, infinite ones included, brio_delaunay will have for these points: 6.8 a point where they are
 *  spread evenly or scanned, and up to as many as there are points on curves. Cost and errors as brio_estimate_delaunay. */
BRIO_API brio_status brio_estimate_tetrahedra(brio_context *ctx, const double *points, const double *weights,
                                              size_t num_points, uint64_t *tetrahedra);

/** Returns the estimate for brio_delaunay2 and brio_delaunay2_flat of points without duplicates. */
BRIO_API uint64_t brio_estimate_delaunay2(size_t num_points, int weighted);

/** Estimates the memory of a reconstruction from num_points samples, as the functions below for other methods. Samples of
 *  6.8 tetrahedra each are assumed; where brio_estimate_tetrahedra has more, the estimate for as many samples as these are enough
 *  for is nearer to what is needed. Where poles coincide, as those of exact cylinders and tori do, power crusts need more.
 *  options  NULL for the defaults.   Returns BRIO_OK or BRIO_ERR_ARGUMENT (options.size was not set). */
BRIO_API brio_status brio_estimate_labeled_delaunay(brio_context *ctx, size_t num_points,
                                                    const brio_labeled_delaunay_options *options, uint64_t *bytes);

/** Estimates the memory of a reconstruction from num_points samples.   options  NULL for the defaults. Of the options,
 *  `triangulate` and `simplify` count; `pieces`, `scale` and `redundancy` do not.
*  Returns BRIO_OK or BRIO_ERR_ARGUMENT (options.size was not set). */
BRIO_API brio_status brio_estimate_power_crust(brio_context *ctx, size_t num_points,
                                               const brio_power_crust_options *options, uint64_t *bytes);
BRIO_API brio_status brio_estimate_offset_surface(brio_context *ctx, size_t num_points,
                                                  const brio_offset_surface_options *options, uint64_t *bytes);
BRIO_API brio_status brio_estimate_power_shape(brio_context *ctx, size_t num_points,
                                               const brio_power_shape_options *options, uint64_t *bytes);
BRIO_API brio_status brio_estimate_cocone(brio_context *ctx, size_t num_points, const brio_cocone_options *options,
                                          uint64_t *bytes);

/** Returns the estimate for brio_mesh_subdivide of a mesh of num_faces triangles; levels below 1 count as 1, above 15 as
 *  15. */
BRIO_API uint64_t brio_estimate_mesh_subdivide(size_t num_faces, int levels);
/** Returns the estimate for a brio_iso_surface of num_vertices vertices, the map or the atoms not included. */
BRIO_API uint64_t brio_estimate_iso_surface(size_t num_vertices);
/** Returns the estimate for brio_generate. */
BRIO_API uint64_t brio_estimate_generate(size_t num_points);

/* ------------------------------------------------------------------------------------------------------------------
 * Predicates, exact for all finite doubles. Points are 3 doubles each.
 */

/** Returns the sign (-1, 0, 1) of det [b-a, c-a, d-a]. */
BRIO_API int brio_orient3d(const double *a, const double *b, const double *c, const double *d);

/** Returns the sign of the in-sphere determinant: for a positive tetrahedron (a, b, c, d) it is 1 if e is inside the
 *  sphere through a, b, c, d, -1 if e is outside, 0 if e is on it; for a negative tetrahedron the opposite.
 *  weights  NULL, or the weights of a, b, c, d, e: then the orthosphere takes the sphere's place (power test). */
BRIO_API int brio_insphere(const double *a, const double *b, const double *c, const double *d, const double *e,
                           const double *weights);

/** Returns what brio_insphere returns, with ties broken by the symbolic perturbation: never 0. The tetrahedron must be
 *  positive and e must be none of its vertices. */
BRIO_API int brio_insphere_perturbed(const double *a, const double *b, const double *c, const double *d,
                                     const double *e, const double *weights);

/** Computes the circumcentre of a tetrahedron that is not flat or, with 4 weights, its orthocentre. The result has the
 *  same bits for every order of the four points.   weights  4, or NULL.
 *  error  NULL, or receives a bound on the error of each coordinate: at most 2^-44 times the distance from the centre to
 *         the lexicographically first of the points, plus one rounding. Where doubles do not reach that bound, the
 *         computation uses higher precision.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT for a flat tetrahedron or a centre that doubles cannot hold. */
BRIO_API brio_status brio_circumcentre(const double *a, const double *b, const double *c, const double *d,
                                       const double *weights, double *centre, double *error);

/* In the plane; points are 2 doubles each. */

/** Returns the sign of det [b-a, c-a]: 1 when the triangle (a, b, c) is counterclockwise, 0 when it is flat. */
BRIO_API int brio_orient2d(const double *a, const double *b, const double *c);

/** Returns the sign of the in-circle determinant: for a counterclockwise triangle (a, b, c) it is 1 if d is inside the
 *  circle through a, b, c, -1 if d is outside, 0 if d is on it; for a clockwise triangle the opposite.
 *  weights  NULL, or the weights of a, b, c, d: then the orthocircle takes the circle's place (power test). */
BRIO_API int brio_incircle(const double *a, const double *b, const double *c, const double *d, const double *weights);

/** Returns what brio_incircle returns, with ties broken by the symbolic perturbation: never 0. The triangle must be
 *  counterclockwise and d must be none of its vertices. */
BRIO_API int brio_incircle_perturbed(const double *a, const double *b, const double *c, const double *d,
                                     const double *weights);

#ifdef __cplusplus
}
#endif
#endif
