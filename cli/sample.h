/* What the triangulation of many points will be like, told from few of them. */
#ifndef BRIO_CLI_SAMPLE_H
#define BRIO_CLI_SAMPLE_H

#include "run.h"

typedef struct {
    double tetrahedra; /* infinite ones included */
    double hidden;     /* points without a cell */
} triangulation_size;

/** Estimates the size of the triangulation of a mesh's points; with weights, of the regular one. weights may be NULL.
 *  Up to 2,048 points are triangulated; of more, the surroundings of twelve.
 *  Cost: some 20,000 insertions, and about fifty passes over the points. */
brio_status cli_sample_size(run *r, const brio_mesh *mesh, const double *weights, triangulation_size *size);

#endif
