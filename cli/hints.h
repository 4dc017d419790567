/* What to try after a failure. */
#ifndef BRIO_CLI_HINTS_H
#define BRIO_CLI_HINTS_H

#include "run.h"

/** Keeps hints for the failure of a run, besides those that the command itself has kept. */
void cli_suggest(run *r, brio_status status);

/** Has the sentence of the failure begin with the name of the input where it does not name it. */
void cli_name_input(run *r, brio_status status);

#endif
