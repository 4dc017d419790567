/* What `brio locate` and `brio interpolate` share: the points of two files, the triangulation and the locator of the
 * first. */
#ifndef BRIO_CLI_LOCATED_H
#define BRIO_CLI_LOCATED_H

#include "cli/steps/periodic.h"
#include "cli/steps/weights.h"

typedef struct located {
    brio_mesh *points, *at;
    double *weights;       /* NULL: none */
    size_t duplicates;     /* points at the positions of others */
    brio_locator *locator; /* NULL in a plane */
    brio_locator2 *plane;  /* of the points in their plane; NULL in space */
    double *places;        /* of the file --at in the plane, #at by 2 */
} located;

/** The planes that --plane can name: two coordinates, or the plane nearest to the points. */
enum { LOCATED_XY = 0, LOCATED_YZ = 1, LOCATED_ZX = 2, LOCATED_FIT = 3, LOCATED_SPACE = 4 };

extern const option_choice cli_located_planes[];

/** The row of the option --at for a command's table. */
/* clang-format off */
#define AT_ROW(type, field)                                                                                            \
    {"at", 0, OPTION_INPUT, offsetof(type, field), "FILE", "the places asked about, points of a file", 0}
#define LOCATED_PLANE_ROW(type, field)                                                                                 \
    {"plane", 0, OPTION_CHOICE, offsetof(type, field), "NAME",                                                         \
     "in a plane: xy, xz, yz, or fit, the plane nearest to the points; places are projected to it, and a text needs "  \
     "no z", cli_located_planes}
/* clang-format on */

/** Reads IN and the file --at. Refuses the work over --max-memory.   weights  NULL: points without weights.
 *  periodic  NULL: points do not repeat. */
brio_status cli_read_located(run *r, const char *at, const weights_options *weights, const periodic_options *periodic,
                             int plane, located *out);

/** Triangulates the points and makes the locator, of space or of a plane.
 *  plane  LOCATED_SPACE: with `own_plane`, points that are in a plane are located there. */
brio_status cli_make_locator(run *r, int plane, bool own_plane, located *l);

void cli_located_free(located *l);

/** Reports how many places are inside and outside. */
void cli_report_inside(run *r, size_t inside, size_t all);

#endif
