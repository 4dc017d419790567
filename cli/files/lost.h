/* What a file's format cannot hold, said when the file has been written. */
#ifndef BRIO_CLI_LOST_H
#define BRIO_CLI_LOST_H

#include "cli/run/run.h"

/** Says which parts of a mesh its file leaves out. Properties that no input had are not worth a word. */
void cli_tell_lost(run *r, const char *path, const brio_mesh *mesh, brio_format format);

/** Says that --ascii or --float32 were given for nothing.   ascii, float32  whether the file has a choice. */
void cli_tell_idle(run *r, const char *path, bool ascii, bool float32);

#endif
