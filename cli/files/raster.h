/* A raster of heights: Esri's ASCII grid, or GeoTIFF, by the extension. Rows go from north to south. */
#ifndef BRIO_CLI_RASTER_H
#define BRIO_CLI_RASTER_H

#include "cli/run/run.h"

typedef struct {
    size_t columns, rows;
    double west, south, cell; /* the lower left corner, and the side of a cell */
    const brio_mesh *points;  /* whose coordinate system the file names */
} raster;

/** Writes the heights of a row, NaN where there is none.   row  from the north. */
typedef brio_status (*raster_row)(run *r, void *user, size_t row, double *heights);

/** Refuses a name that is no raster's. */
brio_status cli_check_raster(run *r, const char *path);

/** Writes the raster row by row. */
brio_status cli_write_raster(run *r, const char *path, const raster *grid, raster_row fill, void *user);

#endif
