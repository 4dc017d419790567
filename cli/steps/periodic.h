/* Points in space that repeats: --cell and --periodic. The cell may be that of the file (brio_mesh_cell). */
#ifndef BRIO_CLI_PERIODIC_H
#define BRIO_CLI_PERIODIC_H

#include "cli/run/run.h"

typedef struct periodic_options {
    const char *cell, *directions; /* NULL without */
} periodic_options;

/** Rows of a command's option table whose struct has periodic_options as its member `field`. */
/* clang-format off */
#define PERIODIC_ROWS(type, field)                                                                                     \
    {"cell", 0, OPTION_TEXT, offsetof(type, field.cell), "V",                                                          \
     "points repeat by three vectors, ax,ay,az,bx,by,bz,cx,cy,cz, or by the lengths lx,ly,lz of a box", 0},            \
    {"periodic", 0, OPTION_TEXT, offsetof(type, field.directions), "DIRS",                                             \
     "which of the vectors repeat, x, y, z or several, as xy for a slab (default with --cell: xyz); without --cell "   \
     "the cell is that of the file", 0}
/* clang-format on */

/** Triangulates the points of a mesh in space that repeats, reports it, and laps.
 *  weights  #V, or NULL.   out  NULL on error. */
brio_status cli_periodic(run *r, const periodic_options *options, const brio_mesh *mesh, const double *weights,
                         brio_periodic **out);

/** Returns whether points repeat. */
static inline bool cli_is_periodic(const periodic_options *options) {
    return options->cell || options->directions;
}

/** Estimates the triangulation, and what commands make of it; writes bytes in all.
 *  vertices  whether the cells get vertices.   filtration  whether it is written.   places  that are located. */
brio_status cli_periodic_delaunay_bytes(run *r, const periodic_options *options, const brio_mesh *mesh,
                                        const double *weights, double *bytes);
brio_status cli_periodic_cells_bytes(run *r, const periodic_options *options, const brio_mesh *mesh,
                                     const double *weights, bool vertices, double *bytes);
brio_status cli_periodic_alpha_bytes(run *r, const periodic_options *options, const brio_mesh *mesh,
                                     const double *weights, bool filtration, double *bytes);
brio_status cli_periodic_locate_bytes(run *r, const periodic_options *options, const brio_mesh *mesh,
                                      const double *weights, const brio_mesh *places, double *bytes);

/** Fails with wrong usage if --cell or --periodic is no such text. */
brio_status cli_check_periodic(run *r, const periodic_options *options);

/** Says that the file of the points has a cell that is not used. */
void cli_tell_cell(run *r, const periodic_options *options, const brio_mesh *points);

#endif
