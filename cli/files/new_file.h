/* A file that the program writes by itself, and that appears only when it is complete: written without a name in the
 * folder of its target, and named at the end. Where the file system has no files without names, it has a temporary name
 * until then. */
#ifndef BRIO_CLI_NEW_FILE_H
#define BRIO_CLI_NEW_FILE_H

#include "cli/run/run.h"
#include "platform/target.h"

typedef struct {
    FILE *file; /* NULL if there is none */
    brio_target target;
} new_file;

/** Opens a file for writing. Call cli_new_file_close even if this fails. */
brio_status cli_new_file_open(run *r, const char *path, new_file *out);

/** Flushes the file to the disk and gives it its name. */
brio_status cli_new_file_publish(run *r, const char *path, new_file *f);

/** Frees everything. A file that was not published disappears. */
void cli_new_file_close(new_file *f);

#endif
