/* Where an output file goes: a folder, held open, and a name in it.
 *
 * The file is written under a temporary name in the same folder and renamed when it is complete. The folder is held open
 * from the beginning, so that a change of the process' working folder meanwhile does not matter. */
#ifndef BRIO_IO_TARGET_H
#define BRIO_IO_TARGET_H

#include "base/context.h"

typedef struct brio_target {
    int folder;      /* descriptor; -1 while there is none */
    char *name;      /* of the file, in the folder */
    char *temporary; /* name of the temporary file; NULL while there is none */
} brio_target;

enum { BRIO_NAME_IN_TEMPORARY = 100 }; /* most bytes of the name that the temporary name begins with */

/** Follows a path through its symbolic links to the folder and name that they lead to. A file need not be there: of a
 *  link that leads to no file, the target is the file that the link names.
 *  On failure errno says why (a missing folder, a loop of links), and the message is stored under `shown`, the path as
 *  the caller gave it. The target is to be closed even then. */
brio_status brio_target_find(brio_target *target, brio_context *ctx, const char *path, const char *shown);

/** Makes the temporary file and returns its descriptor in *file. It has the permissions of the file that it will
 *  replace, and its owner and group where the system allows that. */
brio_status brio_target_create(brio_target *target, brio_context *ctx, const char *shown, int *file);

/** Gives the temporary file its name, in place of the file that has it. */
brio_status brio_target_publish(brio_target *target, brio_context *ctx, const char *shown);

/** Frees everything; a temporary file that is not published disappears. */
void brio_target_close(brio_target *target, brio_context *ctx);

#endif
