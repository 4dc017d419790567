/* One edge collapse: its point, its error, what it must not do. Threads may work on one mesh together if none of them
 * tries an edge with a triangle at either end that another thread's edges share. */
#ifndef BRIO_MESH_COLLAPSE_H
#define BRIO_MESH_COLLAPSE_H

#include "mesh/collapse_mesh.h"

/** Sets m->error of the edge of h to the error of its collapse, or to INFINITY if it may not be tried. Returns the
 *  half-edge that names the edge. */
uint32_t brio_collapse_measure(brio_collapse_mesh *m, uint32_t h);

/** Collapses the edge of h, which may be tried, if that keeps the topology and turns no triangle over. Returns the
 *  vertex that is left, whose edges have old errors, or BRIO_COLLAPSE_NONE. */
uint32_t brio_collapse_try(brio_collapse_mesh *m, uint32_t h);

#endif
