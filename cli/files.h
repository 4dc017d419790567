/* What can be told of an output's path before anything is written there. */
#ifndef BRIO_CLI_FILES_H
#define BRIO_CLI_FILES_H

#include "run.h"

/** BRIO_ERR_WRITE when a file of that name cannot be written: its folder is missing or not writable, the file itself
 *  is protected, or it is a folder. */
brio_status cli_check_target(run *r, const char *path);

/** Whether two names are those of one file, also through links; standard input, output and devices may be named twice. */
bool cli_same_file(const char *a, const char *b);

/** Finds everything wrong with a file that an option wants beside -o: standard output, the file of -o itself, a format
 *  not among those of the list, a file that cannot be written.   formats  ended by BRIO_FORMAT_AUTO; NULL: any name. */
brio_status cli_check_beside(run *r, const char *name, const char *path, const brio_format *formats);

/** The format that --format or the extension asks for; BRIO_FORMAT_AUTO with the reason stored when there is none. */
brio_status cli_output_format(run *r, const char *path, const char *extension, brio_format *format);

#endif
