/* The samples of an offset surface, and the surface through them, while it is made. */
#ifndef BRIO_OFFSET_WORK_H
#define BRIO_OFFSET_WORK_H

#include "base/memory.h"
#include "offset/field.h"
#include "offset/seen.h"

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

/** Adds the points of the offset over the corners of the faces; where none of a face's corners has one, over its
 *  centroid. Points that lie close together are thinned out. */
brio_status brio_offset_seed(brio_offset_work *w);

/** Makes the surface through the samples: the boundary of the tetrahedra of their Delaunay triangulation that are
 *  covered. No faces where the samples span no tetrahedra. */
brio_status brio_offset_connect(brio_offset_work *w);

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
