/* brio/iso.h: iso-surfaces of maps and of atoms. */
#ifndef BRIO_ISO_H
#define BRIO_ISO_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_iso_surface_options {
    size_t size;
    int deviations; /* 1: `level` counts standard deviations above the mean of the map */
    int conforming; /* 1: every triangle is a facet of the Delaunay triangulation of the mesh's vertices, vertices at one
                          position taken as one [Attali Lachaud 2001] */
    double blobbiness; /* atoms: at most 100; the larger, the closer the surface is to spheres; 0: 2. Not for maps */
    size_t resolution; /* cells along the longest side; 0: the map's own, or half an angstrom for atoms */
    size_t vertices;   /* not 0: chooses the resolution so that the mesh has about this many vertices */
} brio_iso_surface_options;

/** Computes the iso-surface of a density in a file, as a closed triangle mesh. The file is a CCP4 or MRC map (.map .mrc
 *  .ccp4), whose surface is cut off flat where it leaves the map, or atoms in a PDB file (.pdb .ent), each a Gaussian
 *  that alone has level 1 at the atom's van der Waals radius. "-" reads standard input.
 *  level  of the surface, in the unit of the map or of the density of atoms.   options  NULL for the defaults.
 *  Memory: 4 bytes a value of the map or 40 bytes an atom; the mesh; two layers of cells with 36 bytes a cell.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (nothing is above the level, or the map is one value thin),
 *  and as brio_read. */
BRIO_API brio_status brio_iso_surface(brio_context *ctx, const char *path, double level,
                                      const brio_iso_surface_options *options, brio_mesh **out);

#ifdef __cplusplus
}
#endif
#endif
