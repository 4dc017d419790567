/* What is computed of each cell, by threads that do not know where it will stand in the result.
 *
 * Numbers of cells go to their place in the result. Faces, corners and vertices go to arrays of the thread that
 * computed them, and `brio_cell_place` remembers where. assemble.c puts them in the order of the cells. */
#ifndef BRIO_CELLS_CELL_RECORD_H
#define BRIO_CELLS_CELL_RECORD_H

#include "cells/star_cell.h"
#include "cells/sweep.h"
#include <math.h>

/** A face, in the caller's lengths. */
typedef struct brio_cell_face {
    int64_t neighbour; /* a point, or -1 - i for wall i */
    double area, normal[3];
    uint32_t corners;
} brio_cell_face;

/** Set in a corner that is a vertex of its cell alone: the other bits count these vertices within the cell. In other
 *  corners the number is a tetrahedron, which is less. */
#define BRIO_OWN_VERTEX (UINT32_C(1) << 31)

/** Where a thread put the faces of a cell. */
typedef struct brio_cell_place {
    uint64_t face, corner, vertex;
    uint32_t num_faces, num_vertices;
    uint64_t num_corners;
    int thread;
} brio_cell_place;

/** One thread's workspace, and the faces that it computed. */
typedef struct brio_cell_recorder {
    brio_context *ctx;
    brio_star_cell star;
    brio_polyhedron shape;
    uint32_t *own; /* of each vertex of `shape`: its corner number, or UINT32_MAX */
    brio_cell_face *face;
    uint32_t *corner;
    double (*vertex)[3]; /* in scaled lengths */
    size_t num_faces, num_corners, num_vertices;
    size_t own_capacity, face_capacity, corner_capacity, vertex_capacity;
    brio_status status;
} brio_cell_recorder;

/** What all threads share. */
typedef struct brio_cell_job {
    const brio_diagram *d;
    const brio_region *region;
    brio_cells *out;
    const brio_sweep *sweep;                /* the cells that are not left come from it; NULL: none do */
    bool areas, centroids, faces, vertices; /* what is asked for; vertices implies faces */
    bool sizes;                             /* of faces: areas and normals */
    uint32_t *cell_of;                      /* #P: the cell of each vertex */
    brio_cell_place *place;                 /* of each cell that does not come from it; NULL without faces */
    brio_cell_recorder *recorder;           /* one a thread */
    int threads;
} brio_cell_job;

/** Returns a computed volume or area as the result has it. Where doubles cannot hold it, its terms are infinite, of
 *  either sign; where it is nothing, rounding can make it negative. */
static inline double brio_cells_held(double x) {
    return isfinite(x) ? fmax(x, 0) : INFINITY;
}

/** Computes the cell of a vertex and records it.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_cell_record(const brio_cell_job *job, brio_cell_recorder *r, uint32_t site);

void brio_cell_recorder_free(brio_cell_recorder *r);

/** Fills the arrays of faces and vertices of the result from the recorders.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE (2^32 vertices or more), BRIO_ERR_NO_MEMORY. */
brio_status brio_cells_assemble(brio_cell_job *job);

#endif
