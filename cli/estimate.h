/* How much memory a command takes, the program and its input included: what --max-memory and `brio info` go by. */
#ifndef BRIO_CLI_ESTIMATE_H
#define BRIO_CLI_ESTIMATE_H

#include "brio/brio.h"
#include "sample.h"
#include <stdbool.h>

/** Bytes of the mesh as it was read: its points, faces, tetrahedra and properties. */
double cli_mesh_bytes(const brio_mesh *mesh);

/** Of `brio delaunay`, for a triangulation of that size. */
double cli_delaunay_bytes(const brio_mesh *mesh, bool weighted, int threads, const triangulation_size *size);

/** Bytes that a location takes besides; of one that goes along edges, those of the mesh. */
double cli_location_bytes(brio_location location, const brio_mesh *mesh);

/** Of `brio surface`: a power crust, and of what begins as one does (medial, offset); or a co-cone. */
double cli_crust_bytes(const brio_mesh *mesh);
double cli_cocone_bytes(const brio_mesh *mesh);

/** Bytes that a power crust takes besides with simplification, and with triangulated faces. */
double cli_crust_extra_bytes(size_t points, bool simplify, bool triangulate);

/** Of `brio info`. */
double cli_info_bytes(const brio_mesh *mesh);

/** Of `brio subdivide`. */
double cli_subdivide_bytes(const brio_mesh *mesh, int levels);

/** Of `brio generate`: points of a kind, and an iso-surface of so many vertices. */
double cli_generate_bytes(size_t points);
double cli_iso_bytes(size_t vertices);

#endif
