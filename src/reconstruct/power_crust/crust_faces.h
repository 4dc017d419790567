/* The faces of the power diagram between inner and outer cells. */
#ifndef BRIO_RECONSTRUCT_CRUST_FACES_H
#define BRIO_RECONSTRUCT_CRUST_FACES_H

#include "dual/power_diagram.h"
#include "reconstruct/labels/label.h"

typedef struct {
    bool triangulate;
    double open;           /* > 0: leaves out the faces that span a hole of the samples. The two balls of such a face
                              intersect at more than pi / 4, and the smaller radius is more than `open` spacings. */
    const double *spacing; /* #poles, or NULL; needed if open > 0, and given to the mesh as property "spacing" */
} brio_crust_options;

typedef struct {
    size_t faces;    /* polygons of the crust, before they are cut into triangles */
    size_t left_out; /* polygons that span holes */
} brio_crust_counts;

/** Writes the crust into an empty mesh: polygons seen counterclockwise from the outer side, or triangles. The crust is
 *  a closed manifold, unless faces are left out.
 *  label  #poles: inner or outer for every pole, outer for every hull vertex of the regular triangulation.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no pole with a cell is inner, or every face spans a hole), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_crust_faces(const brio_power_diagram *d, const uint8_t *label, const brio_crust_options *options,
                             brio_mesh *mesh, brio_crust_counts *counts);

#endif
