/* What `brio locate` and `brio interpolate` share: the points of two files, the triangulation and the locator of the
 * first. */
#ifndef BRIO_CLI_LOCATED_H
#define BRIO_CLI_LOCATED_H

#include "weights.h"

typedef struct located {
    brio_mesh *points, *at;
    double *weights;   /* NULL: none */
    size_t duplicates; /* points at the positions of others */
    brio_locator *locator;
} located;

/** The row of the option --at for a command's table. */
/* clang-format off */
#define AT_ROW(type, field) {"at", 0, OPTION_INPUT, offsetof(type, field), "FILE", "the places asked about, points of a file", 0}
/* clang-format on */

/** Reads IN and the file --at. Refuses the work over --max-memory.   weights  NULL: points without weights. */
brio_status cli_read_located(run *r, const char *at, const weights_options *weights, located *out);

/** Triangulates the points and makes the locator. */
brio_status cli_make_locator(run *r, located *l);

void cli_located_free(located *l);

/** Reports how many places are inside and outside. */
void cli_report_inside(run *r, size_t inside, size_t all);

#endif
