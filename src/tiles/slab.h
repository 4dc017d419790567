/* The points of a tile slab after slab, each with the tetrahedra of its points' stars. */
#ifndef BRIO_TILES_SLAB_H
#define BRIO_TILES_SLAB_H

#include "cells/diagram.h"
#include "tiles/work.h"

/** A tile, and one of its slabs. */
typedef struct {
    brio_tiles *t;
    uint32_t tile;
    size_t count; /* slabs */
    /* of the tile */
    brio_tile_result result;
    uint32_t (*border)[4];
    brio_set_point *points; /* by rows: own ones, then the halo; names are indices */
    size_t num_own, num_rows, num_tets, num_border;
    uint64_t *first; /* of each slab, where its tetrahedra begin in the list */
    uint32_t *list;  /* of tetrahedra: of the file, then of the border */
    uint32_t *local; /* of each row its number in the slab; UINT32_MAX: none */
    /* of the slab */
    brio_cell_complex complex; /* without a frame */
    uint32_t *row;             /* of each point of the slab */
    brio_tetrahedron *tet;
    uint32_t *slot; /* hash table of facets */
    double *at, *weights;
    size_t row_capacity, tet_capacity, slot_capacity, at_capacity, weights_capacity;
} brio_slabs;

/** Reads a tile whose stars were kept. Call brio_slabs_free in any case.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_slabs_open(brio_tiles *t, uint32_t tile, brio_slabs *s);
void brio_slabs_free(brio_slabs *s);

/** Makes the complex of a slab, whose sites are the vertices among its points.   Returns as brio_slabs_open. */
brio_status brio_slabs_take(brio_slabs *s, size_t slab);

#endif
