/* The faces of the power diagram between inner and outer cells. */
#ifndef BRIO_RECONSTRUCT_CRUST_FACES_H
#define BRIO_RECONSTRUCT_CRUST_FACES_H

#include "dual/power_diagram.h"
#include "reconstruct/labels/label.h"

typedef struct {
    bool triangulate;
    double open;           /* > 0: faces are left out that a hole of the samples has let through: their balls intersect
                              at more than pi / 4 and the smaller one's radius is over `open` spacings */
    const double *spacing; /* of each pole, or NULL; needed for `open`, and given to the mesh as property "spacing" */
} brio_crust_options;

typedef struct {
    size_t faces;    /* polygons, also where they are cut into triangles */
    size_t left_out; /* polygons of holes */
} brio_crust_counts;

/** Writes the crust into an empty mesh, as polygons seen counterclockwise from the outer side, or as triangles. Every
 *  pole must be labeled and every hull vertex of the power triangulation be outer.
 *  BRIO_ERR_NO_ANSWER when no pole with a cell is inner, or nothing is left. */
brio_status brio_crust_faces(const brio_power_diagram *d, const uint8_t *label, const brio_crust_options *options,
                             brio_mesh *mesh, brio_crust_counts *counts);

#endif
