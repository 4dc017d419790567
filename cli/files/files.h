/* What can be told of an output's path before anything is written there. */
#ifndef BRIO_CLI_FILES_H
#define BRIO_CLI_FILES_H

#include "cli/run/run.h"

/** Fails with BRIO_ERR_WRITE when a file of that name cannot be written: its folder is missing or not writable, the
 *  file itself is protected, or it is a folder. */
brio_status cli_check_target(run *r, const char *path);

/** Returns whether a path names one stream, beside which there are no other files: "-", an open descriptor, a
 *  device. */
bool cli_is_single(const char *path);

/** Returns whether what is written to a path goes to standard output: "-", /dev/stdout, or the file that standard
 *  output leads to. NULL is no path; /dev/null, which keeps nothing, is none either. */
bool cli_goes_to_stdout(const char *path);

/** Returns whether two paths name one regular file or pipe, or one that would be made: through links, and by other
 *  names of its folder.
 *  The .node and the .ele file of TetGen are one. */
bool cli_same_file(const char *a, const char *b);

/** Fails with BRIO_ERR_ARGUMENT when an output of the command line is an input, or another output. Inputs are the
 *  operands and the options of kind OPTION_INPUT, outputs those of kind OPTION_OUTPUT. */
brio_status cli_check_named_twice(run *r);

/** Finds everything wrong with a file that an option wants beside -o: standard output, or it cannot be written. */
brio_status cli_check_beside(run *r, const char *name, const char *path);
/** Finds the same, and whether the file's format holds what is written. */
brio_status cli_check_mesh_beside(run *r, const char *name, const char *path, cli_holds holds);

/** Finds the format that --format or the extension asks for; BRIO_FORMAT_AUTO with the reason stored when there is
 *  none. */
brio_status cli_output_format(run *r, const char *path, const char *extension, brio_format *format);

#endif
