/* The incremental kernel: everything one construction works on.
 *
 * In a parallel pass each thread has a kernel of its own, with its own workspace, and shares the arrays. */
#ifndef BRIO_TRIANGULATION_KERNEL_H
#define BRIO_TRIANGULATION_KERNEL_H

#include "base/read_ahead.h"
#include "triangulation/engine.h"
#include "triangulation/locate.h"
#include "triangulation/locator.h"
#include "triangulation/star.h"
#include "triangulation/tetrahedra.h"

/** Workspace of one insertion, kept from one to the next. */
typedef struct {
    uint32_t *entry;   /* of each tetrahedron in conflict, the facet through which it was found */
    uint32_t *created; /* a tetrahedron for each border facet: the star of the last point that was inserted */
    uint32_t *facet;   /* outer sides of the facets that left the cavity; then codes of the border's vertices */
    uint32_t *border;  /* those of them that lead to no conflict */
    size_t num_tets, num_border, num_created;
    size_t capacity;         /* of entry, a quarter of that of the other lists */
    size_t pause;            /* number of tets, at most the capacity, at which the dig looks up: brio_cavity_pause */
    uint32_t *cavity_vertex; /* the vertices of all tets, with repetitions; weighted only */
    size_t cavity_vertex_capacity;
    uint8_t *local;         /* of each vertex: its number in the cavity it was last in */
    uint8_t infinite_local; /* the infinite vertex', which all threads meet */
    uint32_t *table;        /* facet handle of each directed edge of the border, BRIO_TABLE of them */
    uint64_t *edge_key;     /* hash table of directed edges, for large borders */
    uint32_t *edge_facet;
    size_t hash_capacity, hash_facet_capacity;
} brio_cavity;

enum { BRIO_TABLE = 1 << 16 };

struct brio_kernel {
    brio_context *ctx;
    brio_tetrahedra t;
    size_t capacity, max_tetrahedra; /* slots from t.count to capacity are fresh */
    struct brio_pass *pass;          /* the parallel pass, or NULL */
    uint8_t *state;                  /* of each tetrahedron: brio_tet_state */
    uint32_t *unused;                /* slots of destroyed tetrahedra */
    size_t num_unused, unused_capacity;
    brio_record *record; /* the points in insertion order, then up to two apexes, then room for the infinite vertex */
    uint32_t *rank;      /* of each record along the curve; NULL with one thread */
    uint32_t *caller;    /* index of each record's point in the caller's arrays */
    uint32_t *representative; /* of each record: itself, or a record that took its place */
    size_t num_points;
    bool weighted;
    int dimension;
    brio_filter filter;
    const brio_engine *engine;
    brio_walk walk;
    const brio_locator *locator; /* the strategy of point location */
    void *location;              /* what it keeps */
    unsigned long_walks;         /* how often of late a walk was given up, see locator.c */
    brio_star star;              /* workspace of the descent; its marks are the states */
    brio_cavity cavity;
    brio_read_ahead read_ahead;
    bool goes_on; /* in scratch files: the next point is often close to the last one */
    brio_delaunay_stats stats;
    bool reports;       /* progress is told from this thread, the caller's */
    double done;        /* share of the points that were in at the last report */
    uint64_t report_at; /* work at which the next report is due */
};

/** Work between two reports of progress: milliseconds. Points are no measure of time, since one insertion can destroy
 *  millions of tetrahedra. */
enum { BRIO_INSERT_WORK = 1 << 18 };

/** The work of a kernel so far: conflict tests, tetrahedra created, steps of walks, nodes of the history; a predicate that
 *  the floating-point filter leaves open counts as 64 of these. */
static inline uint64_t brio_kernel_work(const brio_kernel *k) {
    const brio_delaunay_stats *s = &k->stats;
    return s->insphere_calls + s->created + k->walk.steps + s->history_tests + s->trace_intersections +
           64 * k->filter.unsettled;
}

/** Reports the share of the points that are in, where this kernel reports. */
brio_status brio_kernel_report(brio_kernel *k, double done);

/** Not an error: the point touches what may be another thread's, and waits for a later pass. */
#define BRIO_DEFERRED ((brio_status)-1)

typedef enum { TET_PLAIN = 0, TET_CAVITY = 1, TET_UNUSED = 2 } brio_tet_state;

/** Room for what the insertion of k->num_points records needs, before any tetrahedra. */
brio_status brio_kernel_workspace(brio_kernel *k);

/** Frees all that a kernel holds, but not the kernel. */
void brio_kernel_free(brio_kernel *k);

/** Finds four points in general position, or the dimension that they have instead; adds apexes off the points' affine
 *  hull so that every input of at least two distinct positions becomes three-dimensional; makes the first tetrahedron.
 *  */
brio_status brio_kernel_start(brio_kernel *k);

/** Makes room for at least `more` further tetrahedra. */
brio_status brio_kernel_reserve(brio_kernel *k, size_t more);

/** The same in a parallel pass: a new stretch of fresh slots; BRIO_DEFERRED when there are no more. */
brio_status brio_pass_reserve(brio_kernel *k, size_t more);

/** Inserts the records [begin, end), which follow the curve, by all threads of the context. */
brio_status brio_kernel_insert_parallel(brio_kernel *k, size_t begin, size_t end);

/** Inserts record p, which is not yet in: as a vertex, a duplicate, or a hidden point. */
brio_status brio_kernel_insert(brio_kernel *k, uint32_t p);

/** The vertex that took the place of record p, or a record on the way to it: p itself for a vertex. */
static inline uint32_t brio_alive(const brio_kernel *k, uint32_t p) {
    uint32_t *representative = k->representative;
    while (representative[p] != p) p = representative[p] = representative[representative[p]];
    return p;
}

/** A tetrahedron in conflict with p near the last insertion, or what brio_locate_walk gives. */
brio_status brio_locate_descent(brio_kernel *k, const double *p, uint32_t *tet);

/** Room for the lists of a cavity of at most `tets` tetrahedra. */
brio_status brio_cavity_reserve(brio_context *ctx, brio_cavity *c, size_t tets);

/** Makes room for a cavity that grows, and reports progress from a large one. */
brio_status brio_cavity_pause(brio_kernel *k);

/** Leaves everything as it was before the dig; BRIO_DEFERRED. */
brio_status brio_cavity_defer(brio_kernel *k);

/** Replaces the cavity by the star of record p; vertices that lose their last tetrahedron become hidden. */
brio_status brio_cavity_fill(brio_kernel *k, uint32_t p);

void brio_cavity_free(brio_context *ctx, brio_cavity *c);

/** Gives every point that is no vertex the vertex that represents it; counts duplicates and hidden points. */
brio_status brio_kernel_represent(brio_kernel *k);

/** Sorts the tetrahedra into their canonical order, finite ones first. The last step:
 *  the states are given back. */
brio_status brio_kernel_sort(brio_kernel *k);

/** The same in scratch files, which are read and written in sequence. */
brio_status brio_kernel_sort_files(brio_kernel *k);

#endif
