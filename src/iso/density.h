/* The density of a molecule as a sum of Gaussians, one for each atom. */
#ifndef BRIO_ISO_DENSITY_H
#define BRIO_ISO_DENSITY_H

#include "base/memory.h"

typedef struct brio_atom {
    double position[3]; /* finite */
    double radius;      /* positive */
} brio_atom;

/** Options of the surface of a density. */
typedef struct {
    double level;
    double blobbiness; /* B, at most 100; a larger B brings the surface closer to spheres */
    size_t resolution; /* cells along the longest side of the box, at most 2^15; 0: cells of 0.5, at most 1024 */
    bool conforming;   /* Delaunay triangles, by brio_conforming_surface */
} brio_density_options;

/** Meshes the surface where the sum over all atoms of exp(B - B r^2 / R^2) is `level`; r is the distance to the atom
 *  and R its radius. At level 1 a single atom gives the ball of its radius. The mesh is closed, manifold and oriented,
 *  counterclockwise seen from outside. A Gaussian ends, continuously, where it falls below a thousandth of the level.
 *  Memory: the mesh, two layers of cells, 40 bytes an atom.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no atoms; a number out of its range), BRIO_ERR_NO_ANSWER (as
 *  brio_conforming_surface), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_density_surface(brio_context *ctx, const brio_atom *atoms, size_t num_atoms,
                                 const brio_density_options *o, brio_mesh **out);

#endif
