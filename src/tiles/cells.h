/* Cells of tiles: what cells.c and ordered_cells.c share. */
#ifndef BRIO_TILES_CELLS_H
#define BRIO_TILES_CELLS_H

#include "tiles/work.h"

/** Receives cells: `site` has the index of each cell's point; neighbours are indices. */
typedef struct {
    brio_status (*take)(void *user, brio_cells *cells, const uint64_t *site);
    void *user;
} brio_tile_cells_sink;

/** Computes the cells of all tiles, and hands them on in the order of places.
 *  stats  receives the volume of the region, and how many sites are outside the box. */
brio_status brio_tiles_run_cells(brio_tiles *t, const brio_cells_options *options, const brio_tile_cells_sink *sink,
                                 brio_tiles_cells_stats *stats);
/** The same, in ascending order of the sites. No vertices. */
brio_status brio_tiles_run_ordered_cells(brio_tiles *t, const brio_cells_options *options,
                                         const brio_tile_cells_sink *sink, brio_tiles_cells_stats *stats);

/** Adds cells to the counts and to the sum of volumes, whose rounding errors go to *lost [Neumaier 1974]. */
void brio_tile_cells_count(const brio_cells *cells, brio_tiles_cells_stats *stats, double *lost);

#endif
