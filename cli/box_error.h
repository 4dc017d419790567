/* How far the cells in a box are from filling it. */
#ifndef BRIO_CLI_BOX_ERROR_H
#define BRIO_CLI_BOX_ERROR_H

#include "run.h"

/** What cells in a box were computed from. */
typedef struct boxed_diagram {
    const brio_triangulation *t;
    const brio_mesh *mesh;
    const double *weights;             /* NULL without weights */
    const brio_cells_options *options; /* with a box */
} boxed_diagram;

/** Finds the difference of the cells' volume and the box's, as a share of the box's: NaN where doubles cannot hold what it
 *  needs. */
brio_status cli_box_error(run *r, const boxed_diagram *d, const brio_cells *cells, double *error);

#endif
