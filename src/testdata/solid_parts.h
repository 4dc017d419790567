/* Judgement of a random solid's mesh: its parts, its box, its thin places. */
#ifndef BRIO_TESTDATA_SOLID_PARTS_H
#define BRIO_TESTDATA_SOLID_PARTS_H

#include "brio/testdata.h"
#include "iso/iso_surface.h"

/** Which components of a mesh are kept. */
typedef struct {
    double least; /* diagonal of a component's box */
    int most;     /* number of components, the largest ones, kept voids included: 1 to BRIO_SOLID_MOST_PARTS */
    bool voids;   /* also keep voids, the components that face inwards */
} brio_solid_parts;

enum { BRIO_SOLID_MOST_PARTS = 3 };

/** Drops the other components of a closed triangle mesh, and vertices that no triangle uses.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_solid_keep_parts(brio_context *ctx, brio_mesh *mesh, const brio_solid_parts *keep);

/** Writes the corners of the vertices' box. */
void brio_solid_box_of(const brio_mesh *mesh, double *low, double *high);

double brio_solid_area(const brio_mesh *mesh);

/** Returns the share of vertices from which a line along the normal, inwards or outwards, crosses the surface within
 *  `thickness`, where the two tangent planes are about parallel. */
brio_status brio_solid_thin_share(brio_context *ctx, const brio_implicit_grid *grid, const brio_mesh *mesh,
                                  double thickness, double *out);

#endif
