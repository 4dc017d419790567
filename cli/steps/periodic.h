/* Points in space that repeats: --cell and --periodic. */
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
     "--cell: which of the vectors repeat, x, y, z or several, as xy for a slab (default xyz)", 0}
/* clang-format on */

/** Triangulates the points of a mesh in space that repeats, reports it, and laps.
 *  weights  #V, or NULL.   out  NULL on error. */
brio_status cli_periodic(run *r, const periodic_options *options, const brio_mesh *mesh, const double *weights,
                         brio_periodic **out);

/** Fails with wrong usage if --periodic is without --cell, or one of them is no such text. */
brio_status cli_check_periodic(run *r, const periodic_options *options);

#endif
