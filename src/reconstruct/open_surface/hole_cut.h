/* Which triangles of a closed surface span what no sample shows. */
#ifndef BRIO_RECONSTRUCT_HOLE_CUT_H
#define BRIO_RECONSTRUCT_HOLE_CUT_H

#include "reconstruct/open_surface/triangle_net.h"

/** What a triangle is. */
typedef enum {
    BRIO_TRIANGLE_SEEN = 0, /* samples carry it */
    BRIO_TRIANGLE_BRIDGE,   /* it spans a gap that samples of a surface would hardly leave, and stays */
    BRIO_TRIANGLE_GONE      /* it spanned a hole that is left open, or belongs to a piece that came off */
} brio_triangle_part;

/** Triangles that span gaps and meet across edges: a hole, whether it is filled or left open. */
typedef struct {
    uint32_t widest;   /* the triangle whose circle is the widest, against what is usual there */
    double ratio;      /* the radius of that circle by the usual one */
    double usual_area; /* in squares of the usual radius */
    double area;
    double facing;  /* the mean of brio_net_facing over the area */
    double viewing; /* the mean of brio_net_viewing over the area */
    double beyond;  /* as brio_rim_beyond finds it; 0 of holes that need not show it */
    bool unlikely;  /* samples of a surface would hardly leave such a gap */
    bool open;
} brio_hole;

typedef struct {
    brio_context *ctx;
    brio_hole *hole;
    size_t count, capacity;
    double proof; /* SEEN: how often the holes make up what proves that a surface is open */
} brio_hole_list;

/** The rule by which holes stay open. FILL: none does. SEEN: those too wide for the samples round them. WIDER: those
 *  with a circle whose radius is over `most`. */
typedef struct {
    enum { BRIO_HOLES_FILL, BRIO_HOLES_SEEN, BRIO_HOLES_WIDER } choice;
    double most;
    bool proven;  /* SEEN: the surface is known to be open, and its holes need not prove that again */
    bool layered; /* SEEN: samples have another sheet close behind theirs, so that holes prove nothing */
} brio_hole_rule;

/** Finds the holes, and leaves each open or fills it, as a whole.
 *  radius, usual  #F: as brio_face_sizes finds them.
 *  part           #F, written: of each triangle.
 *  holes          freed with brio_hole_list_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_cut_holes(const brio_triangle_net *n, const double *radius, const double *usual,
                           const brio_hole_rule *rule, uint8_t *part, brio_hole_list *holes);
void brio_hole_list_free(brio_hole_list *holes);

#endif
