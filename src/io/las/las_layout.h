/* What goes where in a LAS file that is written: the grid of the coordinates, and the fields of its records. */
#ifndef BRIO_IO_LAS_LAYOUT_H
#define BRIO_IO_LAS_LAYOUT_H

#include "base/context.h"
#include "io/las/las.h"

/* --- the grid of the coordinates --- */

/* Scale and offset of the coordinates of a LAS file, found while the points go by, once or several times. */

enum { BRIO_LAS_WITNESSES = 4096 /* chosen */ };

/** The search for a grid. A pass looks at all blocks of points, in the same order in every pass. The first pass finds
 *  the box of the points and tries the grid of the source. Later passes try the candidates: powers of 1/10 and of 1/2
 *  with origins that the box suggests. A candidate is taken that gives back all points of a whole pass. If there is
 *  none, the finest power of 10 is taken for which the whole numbers have 32 bits: coordinates are then rounded to the
 *  nearest multiple. All bytes 0 is the state before the first pass.
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
/** Takes over a grid that was found. The one pass that follows finds the box of the points. */
void brio_las_grid_share(brio_las_grid *grid, const brio_las_grid *found);
void brio_las_grid_free(brio_context *ctx, brio_las_grid *grid);

/** Returns the greatest distance between a vertex and the point that a reader computes. */
double brio_las_grid_moved(const brio_las_grid *grid, const brio_mesh *mesh);

/** Returns the whole number that stands for a coordinate. */
int32_t brio_las_grid_number(const brio_las_grid *grid, int axis, double x);

/* --- fields --- */

/* What goes where in the records of a LAS file that is written. */

/** Where a property goes. */
typedef struct brio_las_place {
    size_t at;
    brio_scalar type;
    uint8_t shift, bits;
    bool extra;                   /* behind the fields of the format */
    bool renamed;                 /* whether a reader finds another name */
    unsigned raw;                 /* the type of an extra number that is scaled or has 64 bits, or 0 */
    double scale, offset;         /* raw: of the number */
    char name[BRIO_LAS_NAME + 1]; /* extra: in the file */
} brio_las_place;

/** What the values of a property are. */
typedef struct brio_las_range {
    bool whole;
    double low, high;
    bool described; /* whether all values are such as its description in the file it comes from allows */
} brio_las_range;

typedef struct brio_las_layout {
    unsigned format;
    size_t record, num_extras;
    brio_las_place *places; /* of each property */
    brio_las_range *ranges;
} brio_las_layout;

/** Widens the ranges by the properties of a block. The first block makes them. */
brio_status brio_las_layout_see(brio_context *ctx, brio_las_layout *l, const brio_mesh *block);
/** Takes over the ranges that were found in more points.   count  properties of a block. */
brio_status brio_las_layout_share(brio_context *ctx, brio_las_layout *l, const brio_las_layout *found, size_t count);
/** Chooses a format and gives every property its place.
 *  name  of the file, for messages.   late  whether the format must be one of version 1.4.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (more properties than a file holds), BRIO_ERR_NO_MEMORY. */
brio_status brio_las_layout_make(brio_context *ctx, brio_las_layout *l, const char *name, const brio_mesh *block,
                                 bool late);
void brio_las_layout_free(brio_context *ctx, brio_las_layout *l);

/** Makes the description of the extra number that a property becomes. */
void brio_las_describe(const brio_las_layout *l, const brio_mesh *block, size_t property, char bytes[BRIO_LAS_EXTRA]);

/** Stores value i of a property in a record whose bytes were 0. */
void brio_las_put(const brio_las_place *place, const brio_property *property, size_t i, char *record);

#endif
