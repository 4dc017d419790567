/* How much memory a command takes, told from the number of points: what --max-memory and `brio info` go by. */
#ifndef BRIO_CLI_ESTIMATE_H
#define BRIO_CLI_ESTIMATE_H

#include "brio/brio.h"
#include <stdbool.h>

/** Bytes of the mesh as it was read: its points, faces, tetrahedra and properties. */
double cli_mesh_bytes(const brio_mesh *mesh);

/** Bytes beside the input that `brio delaunay` takes. */
double cli_delaunay_bytes(size_t points, bool weighted);

/** Bytes that a strategy of point location takes besides, where they are more than a few. */
double cli_location_bytes(size_t points, brio_location locate);

/** Bytes beside the input that `brio surface` takes. */
double cli_surface_bytes(size_t points);

/** Bytes that a power crust takes besides with global labels, and with simplification. */
double cli_crust_extra_bytes(size_t points, bool global, bool simplify);

/** Bytes beside the input that `brio info` takes. */
double cli_info_bytes(size_t points);

/** Bytes beside the input that `brio subdivide` takes. */
double cli_subdivide_bytes(const brio_mesh *mesh, int levels);

/** Bytes of `points` points of brio generate. */
double cli_generate_bytes(size_t points);

#endif
