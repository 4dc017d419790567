/* Scale and offset of the coordinates of a LAS file, found while the points go by, once or several times. */
#ifndef BRIO_IO_LAS_GRID_H
#define BRIO_IO_LAS_GRID_H

#include "base/context.h"

enum { BRIO_LAS_WITNESSES = 4096 /* chosen */ };

/** The search for a grid. A pass looks at all blocks of points, in the same order in every pass. The first pass finds
 *  the box of the points and tries the grid of the source. Later passes try the candidates: powers of 1/10 and of 1/2
 *  with origins that the box suggests. A candidate is taken that gives back all points of a whole pass. If there is none,
 *  the finest power of 10 is taken for which the whole numbers have 32 bits: coordinates are then rounded to the nearest
 *  multiple. All bytes 0 is the state before the first pass.
 *  All coordinates are finite: brio_write and the readers refuse others. */
typedef struct brio_las_grid {
    double step[3], origin[3]; /* the candidates of the axes that are being tried, in the end the result */
    double low[3], high[3];    /* box of the points */
    size_t candidate[3];       /* their numbers; 0 is the source's grid */
    bool found[3];             /* whether the search of an axis has ended */
    bool failed[3];            /* whether a candidate failed in this pass, behind the first block */
    bool rounds[3];            /* whether coordinates are rounded */
    uint64_t points;           /* of all blocks seen in the first pass */
    int pass;
    bool begun;             /* whether this pass has seen a block */
    double (*witnesses)[3]; /* some points of the first pass, on which candidates are tried first */
    size_t num_witnesses;
} brio_las_grid;

/** Looks at a block of points.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_las_grid_survey(brio_context *ctx, brio_las_grid *grid, const brio_mesh *block);
/** Ends a pass. Returns whether the grid is found; otherwise another pass is needed. */
bool brio_las_grid_end_pass(brio_las_grid *grid);
void brio_las_grid_free(brio_context *ctx, brio_las_grid *grid);

/** Returns the greatest distance between a vertex and the point that a reader computes. */
double brio_las_grid_moved(const brio_las_grid *grid, const brio_mesh *mesh);

/** Returns the whole number that stands for a coordinate. */
int32_t brio_las_grid_number(const brio_las_grid *grid, int axis, double x);

#endif
