/* Some of the points of a file, with their properties, and some of the components of a surface. */
#ifndef BRIO_CLI_SELECTION_H
#define BRIO_CLI_SELECTION_H

#include "cli/run/run.h"

/** Makes a mesh of the points whose flag is set, in their order, with their properties, the metadata of all, and no
 *  faces.
 *  chosen  #V.   out  owned by the caller. */
brio_status cli_select_points(run *r, const brio_mesh *points, const uint8_t *chosen, brio_mesh **out);

/** What a command drops of a surface. */
typedef struct component_options {
    bool largest;
    uint64_t least; /* faces */
} component_options;

/** Rows of a command's option table whose struct has component_options as its member `field`. */
#define COMPONENT_ROWS(type, field)                                                                                    \
    {                                                                                                                  \
        "keep-largest",                                                                                                \
        0,                                                                                                             \
        OPTION_FLAG,                                                                                                   \
        offsetof(type, field.largest),                                                                                 \
        NULL,                                                                                                          \
        "keep only the component of largest area",                                                                     \
        0},                                                                                                            \
    {                                                                                                                  \
        "min-component", 0, OPTION_NATURAL, offsetof(type, field.least), "N", "drop components of fewer than N faces", \
            0                                                                                                          \
    }

/** Drops components as the options say; nothing without options.   dropped  receives components and faces. */
brio_status cli_keep_components(run *r, const component_options *options, brio_mesh *surface, size_t dropped[2]);

/** Reports what was dropped, if the options ask for it. */
void cli_report_dropped(run *r, const component_options *options, const size_t dropped[2]);

#endif
