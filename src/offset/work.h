/* The samples of an offset surface, and the surface through them, while it is made. */
#ifndef BRIO_OFFSET_WORK_H
#define BRIO_OFFSET_WORK_H

#include "mesh/solid.h"
#include "base/memory.h"
#include "query/nearest_points.h"

/** A hash table from sets of four numbers to a byte. */
typedef struct brio_seen {
    uint32_t (*key)[4]; /* ascending; BRIO_SEEN_NONE first in an empty place */
    uint8_t *value;
    size_t places; /* a power of two, or 0 */
} brio_seen;

#define BRIO_SEEN_NONE UINT32_MAX

/** Makes a table with room for `count` sets.   out  freed with brio_seen_free, also after a failure. */
brio_status brio_seen_new(brio_context *ctx, size_t count, brio_seen *out);
void brio_seen_free(brio_context *ctx, brio_seen *seen);

/** Returns where a set's value is, or NULL. Any thread may call this while nothing is added. */
const uint8_t *brio_seen_find(const brio_seen *seen, const uint32_t set[4]);

/** Adds a set that is not in the table, which has room for it. */
void brio_seen_add(brio_seen *seen, const uint32_t set[4], uint8_t value);

/** The offset of a solid's surface by `distance` > 0 to one side of it: outside, or with `inwards` inside. That side is
 *  the near side. Points of the other side, and points of the near side whose distance from the surface is less than
 *  `distance`, are covered; the offset is the boundary of what is covered. Any thread may read a field. */
typedef struct brio_offset_field {
    const brio_solid *solid;
    double distance;
    bool inwards;
} brio_offset_field;

/** Returns whether a point is on the far side of the solid's surface. */
bool brio_offset_is_beyond(const brio_offset_field *f, const double *p);

/** Writes a point of the offset close to p: where the way from p, straight away from the surface, reaches the distance;
 *  then, as long as another part of the surface is nearer than the distance, straight away from that part. From a point
 *  of the near side that is not covered, it is the nearest point of the offset.
 *  tolerance  most by which the point's distance may fall short.   normal  receives the direction, of length 1, of the
 *             last
 *  way.   Returns whether there is such a point after a few steps. */
bool brio_offset_reach(const brio_offset_field *f, const double *p, double tolerance, double *out, double *normal);

/** Writes the point of the offset where three sheets of it meet, or the point close to x on the crease of two, between
 *  the places `at`, which are around x. Creases are where balls about different parts of the surface meet; x is not
 *  covered.
 *  tolerance  most by which the distance of the point may be wrong.   Returns whether there is a crease. */
bool brio_offset_crease(const brio_offset_field *f, const double *x, const double *const at[3], double tolerance,
                        double *out);

/** A place of the surface through the samples that is farther from the offset than allowed. */
typedef struct brio_offset_fault {
    double place[3];
    double bound;      /* on the distance from the offset in the triangle */
    uint32_t triangle; /* that the place is in */
} brio_offset_fault;

typedef struct brio_offset_work {
    brio_context *ctx;
    brio_offset_field field;
    double error;   /* most distance allowed between the surface and the offset */
    double *points; /* #n by 3, on the offset up to a small share of the error */
    size_t num_points, point_capacity;
    uint32_t (*triangles)[3]; /* the surface: points, counterclockwise seen from outside of the solid that it bounds */
    size_t num_triangles;
    brio_seen labels; /* of the tetrahedra of the last round */
    brio_seen passed; /* triangles of the last round that passed: 1 the test, 2 the proof */
    brio_offset_fault *faults;
    size_t num_faults, fault_capacity;
    double share;           /* of the work that is done, for the progress bar */
    brio_progress_fn outer; /* the callback of the caller, while a triangulation reports to another */
    void *outer_user;
} brio_offset_work;

/** Samples are on the offset up to this share of the error. Chosen. */
#define BRIO_OFFSET_TOLERANCE 0.02

/** Places of a triangle where it is tested, as shares of its corners. Chosen. */
enum { BRIO_OFFSET_PLACES = 7 };
extern const double brio_offset_places[BRIO_OFFSET_PLACES][3];

/** Checks what the caller of brio_mesh_offset passes, and writes the options with the error settled. */
brio_status brio_offset_settle(brio_context *ctx, const brio_mesh *mesh, double distance,
                               const brio_mesh_offset_options *options, brio_mesh_offset_options *settled);

/** Reports progress; the share done so far. */
brio_status brio_offset_progress(brio_offset_work *w);

/** Adds a sample. */
brio_status brio_offset_add(brio_offset_work *w, const double *p);

/** Samples of later rounds are this share of the error from all others at least. Chosen. */
#define BRIO_OFFSET_APART 0.1

/** Adds those of some points that are so far from the samples there were, and from each other.
 *  tree  of the samples there were.   added  receives how many. */
brio_status brio_offset_add_apart(brio_offset_work *w, const brio_point_tree *tree, const double (*point)[3],
                                  size_t count, size_t *added);

/** Adds the points of the offset over the corners of the faces; where none of a face's corners has one, over its
 *  centroid. Points that lie close together are thinned out. */
brio_status brio_offset_seed(brio_offset_work *w);

/** Makes the surface through the samples: the boundary of the tetrahedra of their Delaunay triangulation that are
 *  covered. No faces where the samples span no tetrahedra. */
brio_status brio_offset_connect(brio_offset_work *w);

/** Bits of a label: of covered tetrahedra; of those that are no matter of doubt. */
enum { BRIO_OFFSET_COVERED = 1, BRIO_OFFSET_CERTAIN = 2 };

/** The tetrahedra of the samples' Delaunay triangulation, finite and infinite ones, and what they are. */
typedef struct brio_offset_labels {
    brio_offset_work *w;
    const brio_tetrahedron *tet;
    size_t count;
    uint8_t *label;
} brio_offset_labels;

/** The least and the greatest height over the offset that were found: negative heights are covered. */
typedef struct brio_offset_heights {
    double least, greatest; /* at most 0, at least 0 */
} brio_offset_heights;

/** Returns the heights of the facets of a finite tetrahedron, at BRIO_OFFSET_PLACES places of each. */
brio_offset_heights brio_offset_heights_of(const brio_offset_work *w, const uint32_t vertex[4]);

/** Changes labels, where the boundary of the covered tetrahedra touches itself, so that it is a manifold. */
brio_status brio_offset_untie(const brio_offset_labels *l);

/** Lists faults of the surface's triangles, found at seven places of each. */
brio_status brio_offset_test(brio_offset_work *w);

/** Proves for every place of the surface that its distance from the offset is at most the error, or lists faults. */
brio_status brio_offset_prove(brio_offset_work *w);

/** Adds samples where the faults are. *added  how many. */
brio_status brio_offset_mend(brio_offset_work *w, size_t *added);

/** Adds points of the offset that are farther from the surface than twice the error, of a net of points about `spacing`
 *  apart.   reached  the spacing of the net, larger than `spacing` where a net of that would have too many points.
 *  added  how many. */
brio_status brio_offset_catch(brio_offset_work *w, double spacing, double *reached, size_t *added);

#endif
