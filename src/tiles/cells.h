/* Cells of tiles: slabs of points with the tetrahedra of their stars (slab.c), whose cells are computed (cells.c), and
 * put in order (ordered_cells.c). */
#ifndef BRIO_TILES_CELLS_H
#define BRIO_TILES_CELLS_H

#include "cells/diagram.h"
#include "tiles/work.h"

/* --- slabs --- */

enum { BRIO_SLAB_SITES = 1 << 14 }; /* Chosen: a fifth of its tetrahedra are of other slabs, too */

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

/** Reads a tile whose stars were kept, and by `halo` the points of its halo. Call brio_slabs_free in any case.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_slabs_open(brio_tiles *t, uint32_t tile, const brio_halo_reader *halo, brio_slabs *s);
void brio_slabs_free(brio_slabs *s);

/** Makes the complex of a slab, whose sites are the vertices among its points.
 *  sorted  whether the order of its tetrahedra is free of threads.   Returns as brio_slabs_open. */
brio_status brio_slabs_take(brio_slabs *s, size_t slab, bool sorted);

/* --- cells --- */

/** Receives cells: `site` has the index of each cell's point; neighbours are indices. */
typedef struct {
    brio_status (*take)(void *user, brio_cells *cells, const uint64_t *site);
    void *user;
} brio_tile_cells_sink;

/** Computes the cells of all tiles, and hands them on in the order of places.
 *  stats  receives the volume of the region, and how many sites are outside the box.
 *  Returns what brio_tiles_cells does. */
brio_status brio_tiles_run_cells(brio_tiles *t, const brio_cells_options *options, const brio_tile_cells_sink *sink,
                                 brio_tiles_cells_stats *stats);
/** Computes the cells of one tile. stats->region_volume is set where the tile has a cell. */
brio_status brio_tile_run_cells(brio_tiles *t, uint32_t tile, const brio_cells_options *options,
                                const brio_halo_reader *halo, const brio_tile_cells_sink *sink,
                                brio_tiles_cells_stats *stats);
/** Computes the cells of all tiles, but hands them on in ascending order of the sites. No vertices.
 *  with_faces  false: of the faces no more than their number, as brio_tiles_cells does. */
brio_status brio_tiles_run_ordered_cells(brio_tiles *t, const brio_cells_options *options, bool with_faces,
                                         const brio_tile_cells_sink *sink, brio_tiles_cells_stats *stats);

/** Returns the bytes that wait for the files into which brio_tiles_run_ordered_cells divides. */
double brio_ordered_cells_buffers(size_t tiles, bool with_faces);

/** Adds cells to the counts and to the sum of volumes, whose rounding errors go to *lost [Neumaier 1974]. */
void brio_tile_cells_count(const brio_cells *cells, brio_tiles_cells_stats *stats, double *lost);
/** Refuses cells that do not fill the region, as brio_voronoi_cells does. */
brio_status brio_tile_cells_check(brio_context *ctx, const brio_tiles_cells_stats *stats);

#endif
