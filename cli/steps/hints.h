/* What to try after a failure. */
#ifndef BRIO_CLI_HINTS_H
#define BRIO_CLI_HINTS_H

#include "cli/run/run.h"

/** Keeps hints for the failure of a run, besides those that the command itself has kept. */
void cli_suggest(run *r, brio_status status);

/** Looks for what explains a failure in the input, and keeps the hint that follows: points that lie in a plane or on a
 *  line, where a solid was wanted; vertices at the positions of others, where a mesh was to be closed. */
void cli_examine(run *r, brio_status status, const brio_mesh *input);

/** Warns of a mesh that is not closed and has vertices at the positions of others. */
void cli_tell_apart(run *r, const brio_mesh *mesh, bool closed);

/** Has the sentence of the failure begin with the name of the input where it does not name it. */
void cli_name_input(run *r, brio_status status);

#endif
