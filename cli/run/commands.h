/* The list of commands. A new one is a file that defines `const command cli_NAME` and its name here. */
#ifndef BRIO_CLI_COMMANDS_H
#define BRIO_CLI_COMMANDS_H

#include "cli/run/run.h"

#define COMMANDS(X)                                                                                                    \
    X(delaunay)                                                                                                        \
    X(surface)                                                                                                         \
    X(medial)                                                                                                          \
    X(balls)                                                                                                           \
    X(hull)                                                                                                            \
    X(alpha)                                                                                                           \
    X(offset)                                                                                                          \
    X(restricted)                                                                                                      \
    X(tree)                                                                                                            \
    X(voronoi)                                                                                                         \
    X(check)                                                                                                           \
    X(compare)                                                                                                         \
    X(iso)                                                                                                             \
    X(view)                                                                                                            \
    X(convert)                                                                                                         \
    X(info)                                                                                                            \
    X(generate)                                                                                                        \
    X(subdivide)                                                                                                       \
    X(simplify)                                                                                                        \
    X(terrain)                                                                                                         \
    X(locate)                                                                                                          \
    X(interpolate)

#define COMMAND_DECLARE(name) extern const command cli_##name;
COMMANDS(COMMAND_DECLARE)
#undef COMMAND_DECLARE

/** The commands, closed by NULL. */
extern const command *const cli_commands[];

/** Finds a command. Returns NULL when there is none of that name. */
const command *cli_find_command(const char *name);

#endif
