/* The stars of the points in the domain, in the triangulation of all translates. */
#ifndef BRIO_PERIODIC_STARS_H
#define BRIO_PERIODIC_STARS_H

#include "periodic/images.h"

/** Tetrahedra from two sources. Those of `t` at points that are not `redone` are right where they have a vertex in the
 *  domain; those at redone points are in `extra`. */
typedef struct brio_stars {
    brio_images images;
    size_t num_known;      /* images that `t` is made of */
    brio_triangulation *t; /* of the first num_known images */
    uint8_t *redone;       /* #points, or NULL for none */
    uint8_t *is_vertex;    /* #points */
    size_t num_redone;
    uint32_t (*extra)[4]; /* images: finite ones with four vertices, infinite ones with BRIO_INFINITE last */
    size_t num_extra, extra_capacity;
    size_t triangulated;
    int rounds;
} brio_stars;

/** Finds the stars.   home  #points: their translates in the domain.   halo  in spacings.
 *  Returns BRIO_OK, and as brio_delaunay; freed with brio_stars_free in any case. */
brio_status brio_stars_new(brio_context *ctx, const brio_lattice *lattice, const double (*home)[3],
                           const double *weights, size_t num_points, double halo, uint64_t seed, brio_stars *stars);
void brio_stars_free(brio_stars *stars);

#endif
