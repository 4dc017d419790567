/* The faces of the power diagram between inner and outer cells. */
#ifndef BRIO_RECONSTRUCT_CRUST_FACES_H
#define BRIO_RECONSTRUCT_CRUST_FACES_H

#include "reconstruct/pole_graph.h"

/** Writes the crust into an empty mesh, as polygons seen counterclockwise from the outer side, or as triangles. Every
 *  pole must be labelled and every hull vertex of the power triangulation be outer. BRIO_ERR_NO_ANSWER when no pole
 *  with a cell is inner. */
brio_status brio_crust_faces(const brio_pole_graph *g, const uint8_t *label, bool triangulate, brio_mesh *mesh);

#endif
