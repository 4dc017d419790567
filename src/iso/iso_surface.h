/* The zero set of a function as a closed triangle mesh. */
#ifndef BRIO_ISO_ISO_SURFACE_H
#define BRIO_ISO_ISO_SURFACE_H

#include "base/memory.h"

/** A function of space, negative inside; 0 counts as outside. Called from several threads at once. */
typedef double (*brio_implicit_fn)(const double *p, const void *user);

/** A function on a grid of cubes. The function is continuous, and not negative on the border of the grid. */
typedef struct brio_implicit_grid {
    brio_implicit_fn value;
    const void *user;
    double low[3];     /* the corner of least coordinates */
    double cell;       /* side of a cube */
    uint32_t cells[3]; /* number of cubes along each axis, at least 1 */
} brio_implicit_grid;

enum { BRIO_MOST_CELLS = 1 << 30 /* along an axis of a grid */ };

/** Turns a number of cells into an integer. Fails for a number that is not at least 0 and at most BRIO_MOST_CELLS, NaN
 *  among them, with BRIO_ERR_TOO_LARGE. */
brio_status brio_implicit_cells(brio_context *ctx, double cells, uint32_t *out);

/** Meshes the zero set. The mesh is closed, manifold and oriented, and seen counterclockwise from outside; it has no
 *  faces when no node of the grid is inside. Memory: the mesh and two layers of nodes.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (negative on the border), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
brio_status brio_marched_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out);

/** The same with Delaunay triangles: each is a facet of the Delaunay triangulation of the mesh's vertices. These are on
 *  the edges of the grid, so that there are about a third as many; at least a thousandth of an edge from its ends, where
 *  doubles can tell such places apart. The grid's corner and side are rounded so that all nodes are doubles.
 *  Memory: the mesh, two layers of nodes, and the triangulation of the cells between them.
 *  Returns as brio_marched_surface, and BRIO_ERR_NO_ANSWER where the cells are too small for doubles so far from 0. */
brio_status brio_conforming_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out);

/* What the two have in common. */

/** Work between two reports of progress, in evaluations of the function: milliseconds, where one takes a microsecond. */
enum { BRIO_IMPLICIT_WORK = 1 << 14 };

/** Reports progress of a surface: a share of layer z of cells is done. */
brio_status brio_implicit_progress(brio_context *ctx, const brio_implicit_grid *grid, uint32_t z, double share);

void brio_implicit_node(const brio_implicit_grid *grid, const uint32_t node[3], double *p);

/** BRIO_ERR_TOO_LARGE when a grid has more nodes in a layer than indices can name, BRIO_ERR_ARGUMENT when its numbers
 *  are not finite or it has no cells. */
brio_status brio_implicit_check(brio_context *ctx, const brio_implicit_grid *grid);

/** Evaluates the nodes of layer z and reports progress; BRIO_ERR_ARGUMENT when one on the border of the grid is inside.
 */
brio_status brio_implicit_layer(brio_context *ctx, const brio_implicit_grid *grid, uint32_t z, double *values);

/** Where on the edge from a (value f_a) to b (value f_b, of the other sign) the function is zero. */
void brio_implicit_root(const brio_implicit_grid *grid, const double *a, const double *b, double f_a, double f_b,
                        double *p);

/** A mesh that takes the two arrays over; they are then NULL. */
brio_status brio_mesh_of_triangles(brio_context *ctx, double **vertices, size_t num_vertices, uint32_t **triangles,
                                   size_t num_triangles, brio_mesh **out);

#endif
