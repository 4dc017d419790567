/* Sibson's coordinates of a query in the plane: the shares of its Voronoi cell that it would take from the cells of its
 * natural neighbours. */
#ifndef BRIO_PLANE_PLANE_NATURAL_H
#define BRIO_PLANE_PLANE_NATURAL_H

#include "plane/plane_holder.h"

/* --- barycentric coordinates --- */

/* Coordinates of a query in the triangle that holds it. */

/** Sets share[i] to the barycentric coordinate of x at vertex i of the triangle. The shares are at least 0 and sum to
 *  1. They are exactly 0 for vertices opposite to an edge whose line holds x.   h  not outside. */
void brio_plane_barycentric(const brio_locator2 *l, const brio_plane_holder *h, const double *x, double share[3]);

/** Sets row to scale (point - x). */
static inline void brio_plane_offset(const brio_locator2 *l, uint32_t point, const double *x, double scale,
                                     double *row) {
    for (int k = 0; k < 2; k++) row[k] = (l->record[point][k] - x[k]) * scale;
}

static inline double brio_plane_cross(const double *a, const double *b) {
    return a[0] * b[1] - a[1] * b[0];
}

/** A step that the search will take: across `edge` of the triangle beyond it or, with BRIO_INFINITE, back to
 *  `centre`. */
typedef struct {
    uint32_t edge, centre;
} brio_plane_step;

/** The workspace of one thread, and the coordinates that were computed last.
 *
 *   corner[c]   of centre c: the points whose circle it is the centre of; BRIO_INFINITE is the query
 *   tour        the centres that are met on the way round the cavity, from inside
 *   border[k]   the place in the tour of the k-th edge of the border; its centre is that of the edge and the query
 *   point[k]    the natural neighbour where border edge k ends and border edge k + 1 begins */
typedef struct {
    brio_context *ctx;
    brio_plane_step *ahead;
    uint32_t (*corner)[3];
    double (*centre)[3]; /* relative to the query, and scaled */
    uint32_t *tour, *border, *point;
    double (*offset)[2], *share; /* of each natural neighbour */
    size_t num_ahead, num_centres, num_tour, num_points;
    size_t ahead_room, corner_room, centre_room, tour_room, border_room, point_room, offset_room, share_room;
} brio_plane_natural;

void brio_plane_natural_free(brio_plane_natural *n);

/** Computes the coordinates of x: share[0 .. num_points) of the points point[0 .. num_points). They are at least 0 and
 *  sum to 1. Sets *found to false where doubles do not suffice, very near the hull.
 *  h  what brio_plane_find_holder found: inside, not on the hull, not at a vertex. The locator has no weights.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_plane_natural_coordinates(brio_plane_natural *n, brio_plane_querent *q, const brio_plane_holder *h,
                                           const double *x, bool *found);

#endif
