/* The edges of an input mesh, for locations that go along them. */
#ifndef BRIO_CLI_MESH_EDGES_H
#define BRIO_CLI_MESH_EDGES_H

#include "run.h"

/** In place of a brio_subgraph: the one that suits the location. */
enum { SUBGRAPH_FITTING = BRIO_SUBGRAPH_END };

extern const option_choice cli_subgraphs[];

/** Whether a location goes along edges. */
bool cli_needs_edges(brio_location location);

/** The edges of a subgraph; facts tell which. Fitting is for a trace the bounded one or, of a mesh that has none, the
 *  minimum spanning tree; for a neighbour all edges. The time is lapped as `subgraph`. A mesh without faces is a fault
 *  of the file. */
brio_status cli_mesh_edges(run *r, const brio_mesh *mesh, brio_location location, int subgraph, brio_edges *out);

#endif
