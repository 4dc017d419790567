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
/** Computes the volume of the region, where there is no cell that has it. */
brio_status brio_tile_region(brio_context *ctx, const brio_cells_options *options, double *volume);
/** Computes the cells of one tile. stats->region_volume is set where the tile has a cell. */
brio_status brio_tile_run_cells(brio_tiles *t, uint32_t tile, const brio_cells_options *options,
                                const brio_halo_reader *halo, const brio_tile_cells_sink *sink,
                                brio_tiles_cells_stats *stats);
/** Computes the cells of all tiles, but hands them on in ascending order of the sites. No vertices.
 *  with_faces  false: of the faces no more than their number, as brio_tiles_cells does. */
brio_status brio_tiles_run_ordered_cells(brio_tiles *t, const brio_cells_options *options, bool with_faces,
                                         const brio_tile_cells_sink *sink, brio_tiles_cells_stats *stats);

/** Adds cells to the counts. */
void brio_tile_cells_count(const brio_cells *cells, brio_tiles_cells_stats *stats);
/** Refuses cells that do not fill the region, as brio_voronoi_cells does. */
brio_status brio_tile_cells_check(brio_context *ctx, const brio_tiles_cells_stats *stats);

/* --- cells in order --- */

/** Cells on their way into the order of their sites: parts, of which each has the sites of a range, in files. */
typedef struct brio_ordered_cells brio_ordered_cells;

enum { BRIO_ORDERED_PARTS = 2 }; /* for each tile: the cells of a part, with faces, fit where a tile fitted */

/** Makes the files.
 *  end  of all parts but the last, ascending: part i has the sites below end[i] that no part before it has. Copied.
 *  with_faces  false: of the faces no more than their number.
 *  *out  freed by the caller, also on failure. */
brio_status brio_ordered_cells_new(brio_tiles *t, const brio_cells_options *options, bool with_faces,
                                   const uint64_t *end, brio_ordered_cells **out);
/** Removes the files. NULL is accepted. */
void brio_ordered_cells_free(brio_ordered_cells *o);
/** Returns the bytes of the files' buffers. */
double brio_ordered_cells_buffers(const brio_context *ctx, size_t tiles, bool with_faces);

/** Packs a cell into bytes, a multiple of 8, which any process of the same kind can put into its files.
 *  *bytes  valid until the next call. */
brio_status brio_ordered_cells_pack(brio_ordered_cells *o, const brio_cells *cells, size_t c, uint64_t site,
                                    const void **bytes, size_t *size);
/** Puts a cell into its file.   *size  receives how many of the bytes were the cell's. */
brio_status brio_ordered_cells_put(brio_ordered_cells *o, const void *bytes, size_t *size);
/** Hands all cells on in ascending order of their sites; each file is removed when it was read. Call once. */
brio_status brio_ordered_cells_hand_on(brio_ordered_cells *o, const brio_tile_cells_sink *sink);

#endif
