/* What a file knows of the side from which its points were seen: normals, and places of scanners. */
#ifndef BRIO_CLI_EVIDENCE_H
#define BRIO_CLI_EVIDENCE_H

#include "cli/run/run.h"

typedef struct evidence_options {
    bool ignore_normals, ignore_origins;
    const char *from; /* X,Y,Z, or NULL */
} evidence_options;

/** Rows of a command's option table whose struct has evidence_options as its member `field`. */
/* clang-format off */
#define EVIDENCE_ROWS(type, field)                                                                                     \
    {"from", 0, OPTION_TEXT, offsetof(type, field.from), "X,Y,Z",                                                      \
     "where the scanner stood: the surface faces it (default: what the file says)", 0},                                \
    {"ignore-normals", 0, OPTION_FLAG, offsetof(type, field.ignore_normals), NULL,                                     \
     "do not use normals nx ny nz of the points", 0},                                                                  \
    {"ignore-origins", 0, OPTION_FLAG, offsetof(type, field.ignore_origins), NULL,                                     \
     "do not use the scanners' places in the file", 0}
/* clang-format on */

/** Arrays of the evidence, and the same as the library takes it. */
typedef struct evidence {
    double *normals, *origins;
    uint32_t *origin_of;
    size_t num_origins;
    brio_evidence taken;
} evidence;

/** Fails with BRIO_ERR_ARGUMENT when --from is no place. */
brio_status cli_check_evidence(run *r, const evidence_options *options);

/** Takes the evidence of points from their properties and from the options. Places of scanners that the reader added as
 *  properties are then removed.
 *  out  freed with cli_evidence_free, on failure too. */
brio_status cli_find_evidence(run *r, const evidence_options *options, brio_mesh *points, evidence *out);
void cli_evidence_free(evidence *e);

#endif
