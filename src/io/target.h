/* The target of an output: an open folder and a name in it.
 *
 * The file is written under a temporary name in that folder and renamed when it is complete. The folder is open from
 * the beginning, so that a change of the process' working folder does not matter.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_WRITE or BRIO_ERR_NO_MEMORY. */
#ifndef BRIO_IO_TARGET_H
#define BRIO_IO_TARGET_H

#include "base/context.h"

typedef struct brio_target {
    int folder;      /* descriptor, or -1 if there is none */
    char *name;      /* of the file in the folder */
    char *temporary; /* name of the temporary file, or NULL if there is none */
} brio_target;

enum { BRIO_NAME_IN_TEMPORARY = 100 }; /* the temporary name begins with at most this many bytes of the name; chosen */

/** Follows a path through symbolic links to a folder and a name. The file need not exist: if a link leads to no file,
 *  the target is the name that the link leads to.
 *  shown   the path as the caller gave it, for the message.
 *  target  closed with brio_target_close, on failure too.
 *  On failure errno gives the reason, such as a missing folder or a loop of links. */
brio_status brio_target_find(brio_target *target, brio_context *ctx, const char *path, const char *shown);

/** Makes the temporary file. The file has the permissions of the file that it will replace, and its owner and group if
 *  the system allows that.
 *  file  receives a descriptor, owned by the caller. */
brio_status brio_target_create(brio_target *target, brio_context *ctx, const char *shown, int *file);

/** Renames the temporary file to the name, and replaces the file that has it. */
brio_status brio_target_publish(brio_target *target, brio_context *ctx, const char *shown);

/** Frees everything. A temporary file that was not published disappears. */
void brio_target_close(brio_target *target, brio_context *ctx);

#endif
