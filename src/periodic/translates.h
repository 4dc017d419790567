/* All translates that a tetrahedron at a point of the domain can have for a vertex, without a list of them: boxes about
 * the points in the domain, and shifts. The source of a completion (completion/completion.h). */
#ifndef BRIO_PERIODIC_TRANSLATES_H
#define BRIO_PERIODIC_TRANSLATES_H

#include "completion/completion.h"
#include "periodic/images.h"

typedef struct brio_translates {
    brio_context *ctx;
    const brio_lattice *lattice;
    size_t count;
    double (*site)[4];  /* records, along a curve through the domain */
    uint32_t *point;    /* of each site */
    brio_ball_box *box; /* about runs of sites, then about runs of boxes, level after level */
    int levels;
    size_t first[16];  /* of each level */
    int32_t most[3];   /* shifts are at most this, either way */
    brio_ball_box all; /* holds all these translates */
    brio_filter filter;
} brio_translates;

/** Makes the translates of those points of the domain that may be vertices.
 *  ctx       holds their memory; the images may be those of a triangulation of another context.
 *  left_out  #points: 1 for points that are none.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED; freed with brio_translates_free in any case. */
brio_status brio_translates_new(brio_context *ctx, const brio_images *images, const uint8_t *left_out,
                                brio_translates *out);
void brio_translates_free(brio_translates *t);

/** Returns a box that holds all translates that matter.   low, high, heaviest  of the points in the domain. */
brio_ball_box brio_translates_box(const brio_lattice *lattice, const double low[3], const double high[3],
                                  double heaviest);

/** Finds the translate deepest in conflict with a tetrahedron. Returns whether there is one.
 *  filter  a copy of t->filter; each thread has its own. */
bool brio_translates_deepest(const brio_translates *t, brio_filter *filter, const brio_ball *ball, brio_set_point *out);

/** Finds the translate of least power distance from a position, ties by lexicographic order. There is a site. */
void brio_translates_nearest(const brio_translates *t, const double *x, brio_image *nearest);

/** Finds, as the source of a completion, the deepest translate for each ball.   user  a brio_translates. */
brio_status brio_translates_find(void *user, brio_ball *balls, size_t count, brio_found *found);

/** Return the name of a translate, and the translate of a name. */
uint64_t brio_translate_name(uint32_t point, const int32_t shift[3]);
brio_image brio_translate_of(uint64_t name);

#endif
