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

/** What a pass may do. The blocks are runs of `block_size` vertices of the list. Edges with an end that has a neighbour
 *  in another block stay. */
typedef struct {
    const uint32_t *list; /* vertices that have not vanished; each is in the list once */
    size_t count, block_size;
    float limit;  /* collapses edges of at most this error, in each block those of least error first */
    double share; /* most collapses in a block, as a share of its edges of at most this error at the beginning */
    size_t most;  /* most collapses in a block */
} brio_collapse_pass;

/** Runs a pass, its blocks in threads. The result does not depend on the number of threads.
 *  report(user) is called now and then, in the caller's thread; a status other than BRIO_OK ends the pass.
 *  collapses  receives the number of collapses.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, or what `report` returned. */
brio_status brio_collapse_blocks(brio_collapse_mesh *m, const brio_collapse_pass *pass,
                                 brio_status (*report)(void *user), void *user, size_t *collapses);

#endif
