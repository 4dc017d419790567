/* The parts of a curve's reconstruction: Delaunay edges, which of them are links of the curve, and the chains of the
 * links.
 *
 * Points are rows in a canonical order, so that nothing here depends on the order of the caller's points. A row at the
 * position of an earlier one has no edges. */
#ifndef BRIO_CURVE_WORK_H
#define BRIO_CURVE_WORK_H

#include "base/context.h"
#include <math.h>

/** Stands for no row. */
#define BRIO_NO_ROW UINT32_MAX

typedef struct {
    brio_context *ctx;
    size_t num_rows;
    const double (*at)[2];
    /* Delaunay edges, each in both directions: those of row p are at start[p] to start[p + 1] - 1 */
    uint32_t *start;
    uint32_t *neighbour;
    uint32_t *apex; /* of each, the third corner of the triangle to its left, or BRIO_NO_ROW outside the hull */
    uint8_t *gap;   /* of each, 1: found to span a gap */
    uint32_t (
        *link)[2]; /* of each row, the rows before and after it on its curve, the first ones first; or BRIO_NO_ROW */
    size_t num_links, num_gaps;
    /* workspace of brio_curve_link */
    uint32_t (*wished)[2]; /* of each row */
    uint32_t *changed;     /* twice as long as the rows: the ends of the links made by the last call */
    size_t num_changed;
    uint8_t *listed; /* of each row */
} brio_curve_work;

/** Returns how many links a row has. */
static inline int brio_curve_degree(const brio_curve_work *w, uint32_t p) {
    return (w->link[p][0] != BRIO_NO_ROW) + (w->link[p][1] != BRIO_NO_ROW);
}

/** Returns the row beyond p, as seen from the linked row q; BRIO_NO_ROW at an end. */
static inline uint32_t brio_curve_beyond(const brio_curve_work *w, uint32_t p, uint32_t q) {
    return w->link[p][w->link[p][0] == q];
}

/** Returns the distance of the rows p and q. Coordinates are below 1; hypot serves where squares would vanish. */
static inline double brio_curve_length(const brio_curve_work *w, uint32_t p, uint32_t q) {
    double x = w->at[q][0] - w->at[p][0], y = w->at[q][1] - w->at[p][1], square = x * x + y * y;
    return square > 0x1p-900 ? sqrt(square) : hypot(x, y);
}

/** Writes the unit vector from row p to row q; returns their distance. */
static inline double brio_curve_direction(const brio_curve_work *w, uint32_t p, uint32_t q, double out[2]) {
    double length = brio_curve_length(w, p, q), scale = length > 0 ? 1 / length : 0;
    if (length < 0x1p-900) return *out = out[1] = 0, length; /* the inverse overflows: no direction */
    out[0] = (w->at[q][0] - w->at[p][0]) * scale;
    out[1] = (w->at[q][1] - w->at[p][1]) * scale;
    return length;
}

/** Returns the turn, in radians from 0 to pi, of a walk from row o over p to q; positive: 1 in *left for a turn to the
 *  left, else -1; `left` may be NULL. */
double brio_curve_turn(const brio_curve_work *w, uint32_t o, uint32_t p, uint32_t q, int *left);

/** Allocates and fills the Delaunay edges of the rows in the plane; allocates the links, none of which is made.
 *  `at`, `num_rows` and `ctx` are set. */
brio_status brio_curve_edges(brio_curve_work *w);

/** Frees what brio_curve_edges allocated. */
void brio_curve_work_free(brio_curve_work *w);

/** Links rows that wish each other, until no two do.   rows  those to begin with: all rows, or those whose neighbours
 *  may have become free since the last call; workspace, as long as all rows. */
brio_status brio_curve_link(brio_curve_work *w, uint32_t *rows, size_t count);

/** Removes links that span gaps, links what that frees, and so on until neither changes.
 *  open  a gap is over that many times as long as the links near it; 0: by how even these are. */
brio_status brio_curve_find_gaps(brio_curve_work *w, double open);

/** Returns the number of links whose Voronoi edges are hardly longer than they: few along curves, many on an area. */
size_t brio_curve_count_fat(const brio_curve_work *w);

/** The chains of links: one curve after the other. */
typedef struct {
    uint32_t *row;   /* the linked rows; a closed curve begins at its first row, an open one at its first end */
    uint32_t *begin; /* of each curve, its place in `row`; then the end */
    uint8_t *closed; /* of each curve */
    uint8_t *corner; /* of each place in `row`: 1 at a corner */
    size_t num_curves, num_corners;
} brio_curve_chains;

/** Lists the chains, in the order of their first rows, and finds their corners. */
brio_status brio_curve_trace(const brio_curve_work *w, brio_curve_chains *out);

void brio_curve_chains_free(brio_context *ctx, brio_curve_chains *chains);

#endif
