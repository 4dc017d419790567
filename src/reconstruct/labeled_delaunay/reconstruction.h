/* What the stages of the labeled Delaunay triangulation share: its samples, their axes, the labels, the faces. */
#ifndef BRIO_RECONSTRUCTION_H
#define BRIO_RECONSTRUCTION_H

#include "dual/pole_vectors.h"
#include "reconstruct/cocone/sample_evidence.h"
#include "reconstruct/labeled_delaunay/vote_graph.h"
#include "reconstruct/open_surface/open_surface.h"

/** A labeled Delaunay triangulation while it is made. Its stages are in labeled_delaunay.c. */
typedef struct brio_reconstruction {
    brio_context *ctx;
    const brio_surface_options *options;
    size_t given; /* points of the caller */
    size_t num_points;
    uint32_t *order; /* #P: the caller's index of each sample */
    int exponent;    /* coordinates are scaled by 2^-exponent */
    double *points;  /* #P by 3: the samples, in order and scaled; at the end smoothed */
    double *spacing; /* #P */
    double left;     /* the noise that the triangulated samples have */
    brio_triangulation *delaunay;
    brio_pole_vectors dual;
    uint8_t *turned, *alone; /* #P: as brio_sign_sheets writes them */
    float (*outside)[3];     /* #P: the axes, and once there are labels, which way is outside */
    brio_sample_evidence evidence;
    float *own;            /* #P, or NULL: what evidence, or their sheet, tells of the samples, in BRIO_VOTE_UNIT */
    bool is_layered;       /* most samples have a second sheet close behind theirs */
    double proof;          /* as brio_unseen has it: of the votes alone */
    bool is_closed;        /* all holes are to be filled, at the hull, too */
    bool is_inverted;      /* the inner side of the labels is the outside: a closed surface that is seen from within */
    bool is_open;          /* the surface proved to be open */
    brio_vote_graph graph; /* until the surface is found */
    uint8_t *label;        /* #T and #P */
    uint32_t *faces;       /* #F by 3 */
    size_t num_faces;
    float *confidence; /* #P, or NULL */
    brio_triangle_facts of_faces;
    brio_surface_stats stats;
    double lap;
} brio_reconstruction;

/** Adds the seconds since the last call to *seconds. */
static inline void brio_lap(brio_reconstruction *r, double *seconds) {
    double now = brio_seconds();
    *seconds += now - r->lap;
    r->lap = now;
}

/** Takes the caller's points in their canonical order, scaled. */
brio_status brio_take_samples(brio_reconstruction *r, const double *points);

/** Measures the noise. Where it is beyond what the log-odds were measured for, such as where scans do not fit together,
 *  smooths the samples before they are triangulated. */
brio_status brio_treat_noise(brio_reconstruction *r);

/** Triangulates the samples.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (they bound no solid), and as brio_delaunay. */
brio_status brio_triangulate_samples(brio_reconstruction *r);

/** Measures the spacings of the samples.   second  NULL, or as brio_sample_spacing writes it. */
brio_status brio_measure_spacing(brio_reconstruction *r, float *second);

/** Measures the spacings. Takes the strays out of the samples, and triangulates the others again. */
brio_status brio_drop_strays(brio_reconstruction *r);

/** Finds the axes of the samples, and whether they point outwards as far as their neighbours, or evidence, tell. */
brio_status brio_orient_axes(brio_reconstruction *r);

/** Returns whether evidence says of most of the hull that what is beyond it is inside.
 *  own  #P: of each sample, whether its axis points outwards (over 0) or inwards. */
bool brio_hull_looks_inwards(const brio_pole_vectors *v, const float *own);

/** Tells how well the result agrees with evidence, be it of use or not. */
void brio_compare_with_evidence(brio_reconstruction *r);

#endif
