/* The zero set of a function as a closed triangle mesh. */
#ifndef BRIO_ISO_ISO_SURFACE_H
#define BRIO_ISO_ISO_SURFACE_H

#include "base/memory.h"

/** A function of space, negative inside; 0 counts as outside. Several threads call it at once. */
typedef double (*brio_implicit_fn)(const double *p, const void *user);

/** A continuous function on a grid of cubes. It is not negative on the border of the grid. */
typedef struct brio_implicit_grid {
    brio_implicit_fn value;
    const void *user;
    double low[3];     /* least corner */
    double cell;       /* side of a cube */
    uint32_t cells[3]; /* number of cubes along each axis, at least 1 */
} brio_implicit_grid;

enum { BRIO_MOST_CELLS = 1 << 30 /* along an axis of a grid */ };

/** Converts a number of cells to an integer. Returns BRIO_OK, or BRIO_ERR_TOO_LARGE for NaN and for numbers outside 0
 *  to BRIO_MOST_CELLS. */
brio_status brio_implicit_cells(brio_context *ctx, double cells, uint32_t *out);

/** Meshes the zero set. The mesh is closed, manifold and oriented, counterclockwise seen from outside. It has no faces
 *  when no node of the grid is inside. Memory: the mesh and two layers of nodes.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (negative on the border), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
brio_status brio_marched_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out);

/** Meshes the zero set with Delaunay triangles: each triangle is a facet of the Delaunay triangulation of the mesh's
 *  vertices. Vertices are on the edges of the grid only, so there are about a third as many as in
 *  brio_marched_surface. A vertex is at least 1/1024 of an edge from the edge's ends, or one spacing of doubles where
 *  that is more. The grid's corner and side are rounded so that all nodes are doubles.
 *  Memory: the mesh, two layers of nodes, and the triangulation of the cells between them.
 *  Returns what brio_marched_surface returns, and BRIO_ERR_NO_ANSWER where the cells are too small for doubles so far
 *  from 0. */
brio_status brio_conforming_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out);

/* Functions that both kinds of surface use. */

/** Evaluations of the function between two reports of progress. Chosen: at a microsecond each they take
 *  milliseconds. */
enum { BRIO_IMPLICIT_WORK = 1 << 14 };

/** Reports that a share of layer z of cells is done. */
brio_status brio_implicit_progress(brio_context *ctx, const brio_implicit_grid *grid, uint32_t z, double share);

void brio_implicit_node(const brio_implicit_grid *grid, const uint32_t node[3], double *p);

/** Checks a grid. Returns BRIO_OK, BRIO_ERR_TOO_LARGE when a layer has more nodes than indices can name, or
 *  BRIO_ERR_ARGUMENT when a number is not finite or an axis has no cells. */
brio_status brio_implicit_check(brio_context *ctx, const brio_implicit_grid *grid);

/** Evaluates the nodes of layer z and reports progress. Returns BRIO_ERR_ARGUMENT when a node on the border of the
 *  grid is inside. */
brio_status brio_implicit_layer(brio_context *ctx, const brio_implicit_grid *grid, uint32_t z, double *values);

/** Writes the point on the edge from a to b where the function is zero. The values f_a at a and f_b at b have opposite
 *  signs. */
void brio_implicit_root(const brio_implicit_grid *grid, const double *a, const double *b, double f_a, double f_b,
                        double *p);

/** Makes a mesh that takes over the two arrays. After success *vertices and *triangles are NULL. */
brio_status brio_mesh_of_triangles(brio_context *ctx, double **vertices, size_t num_vertices, uint32_t **triangles,
                                   size_t num_triangles, brio_mesh **out);

#endif
