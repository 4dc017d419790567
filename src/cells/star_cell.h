/* A cell as the star of its site gives it, before it is clipped. One thread owns a star_cell and fills it again for
 * each site. Positions are relative to the site. */
#ifndef BRIO_CELLS_STAR_CELL_H
#define BRIO_CELLS_STAR_CELL_H

#include "cells/diagram.h"

/** What a cell shares with one neighbour. */
typedef struct brio_side {
    uint32_t site;     /* the neighbour */
    uint32_t tet;      /* a tetrahedron of the edge to the neighbour: where its polygon begins */
    uint32_t vertices; /* distinct centres round the edge: fewer than 3 have no area */
    bool open;         /* an infinite tetrahedron is round the edge: a face of infinite area */
    double foot[3];    /* the point of the line through both sites on the plane of the face */
    double area[3];    /* twice the area times the unit normal, which points to the neighbour */
} brio_side;

/** An edge of a cell, between the centres of two tetrahedra. Seen from side `a` it runs counterclockwise round a's face
 *  from `from` to `to`. */
typedef struct brio_cell_edge {
    uint32_t a, b; /* sides, a < b */
    uint32_t from, to;
} brio_cell_edge;

/** Sides are in the lexicographic order of the neighbours' positions, the infinite vertex last. So numbers of a cell
 *  depend on its star alone, not on the order of the points or the tetrahedra. */
typedef struct brio_star_cell {
    const brio_diagram *d;
    uint32_t site;
    brio_side *side;
    size_t num_sides, side_capacity;
    uint32_t (*slot)[2]; /* hash table from a site to one more than its number; 0 is an empty slot */
    size_t num_slots, slot_capacity;
    uint32_t *neighbour;     /* of each number */
    uint32_t *order, *rank;  /* numbers in the order of the sides; of each number its side */
    uint32_t (*corner)[3];   /* of each tetrahedron of the star, the numbers of its other vertices */
    brio_cell_edge *edge[2]; /* in the order of their sides; and workspace */
    uint32_t *bucket;
    size_t neighbour_capacity, order_capacity, rank_capacity, corner_capacity, edge_capacity[2], bucket_capacity;
    bool open;         /* the cell is unbounded */
    brio_place place;  /* the greatest place of its vertices */
    double moment[3];  /* if asked for: the integral of the position over the cell */
    uint32_t *polygon; /* the vertices of a face, as tetrahedra: brio_star_cell_polygon */
    size_t polygon_capacity;
} brio_star_cell;

void brio_star_cell_free(brio_star_cell *c);

/** Finds the sides of the cell of a vertex.   moments  whether to compute `moment`.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_star_cell_fill(brio_star_cell *c, uint32_t site, bool moments);

/** Returns the volume of a bounded cell. */
double brio_star_cell_volume(const brio_star_cell *c);

/** Writes to c->polygon the distinct finite vertices of a face, counterclockwise seen from the neighbour; an open face
 *  begins at the end of one of its rays. Vertices are tetrahedra, of those that share a centre the first one.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_star_cell_polygon(brio_star_cell *c, const brio_side *side, size_t *count);

/** Makes the polyhedron of a cell in the region. Neighbours of its faces are indices of points, or -1 - i for wall i of
 *  the region. Named vertices are Voronoi vertices: their name is the tetrahedron that speaks for the centre.
 *  c  filled; its place is not BRIO_PLACE_INSIDE.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_clip_cell(brio_star_cell *c, const brio_region *region, brio_polyhedron *p);

#endif
