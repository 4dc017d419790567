/* The target of an output: an open folder and a name in it.
 *
 * The file is written without a name in that folder, and gets its name when it is complete: whatever ends the process
 * before, even a signal that no process can catch, leaves nothing. Where the file system has no files without names,
 * the file has a temporary name and is renamed. The folder is open from the beginning, so that a change of the process'
 * working folder does not matter.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_WRITE or BRIO_ERR_NO_MEMORY. */
#ifndef BRIO_IO_TARGET_H
#define BRIO_IO_TARGET_H

#include "base/context.h"

typedef struct brio_target {
    int folder;      /* descriptor, or -1 if there is none */
    char *name;      /* of the file in the folder */
    bool is_new;     /* whether the output is a new file: one of brio_target_create */
    bool replaces;   /* whether there was a file of that name when the new one was made */
    bool is_named;   /* whether a file has the temporary name: the new one or, once that is published, the old one */
    bool published;  /* whether the new file has the target's name */
    char *temporary; /* room for a temporary name, or NULL */
} brio_target;

enum { BRIO_NAME_IN_TEMPORARY = 100 }; /* the temporary name begins with at most this many bytes of the name; chosen */

/** Follows a path through symbolic links to a folder and a name. The file need not exist: if a link leads to no file,
 *  the target is the name that the link leads to. Links of the process file system are not followed: what they say is
 *  no path, and the file that they lead to is open already.
 *  shown   the path as the caller gave it, for the message.
 *  target  closed with brio_target_close, on failure too.
 *  On failure errno gives the reason, such as a missing folder or a loop of links. */
brio_status brio_target_find(brio_target *target, brio_context *ctx, const char *path, const char *shown);

/** Returns the descriptor of this process that a target leads to, such as 1 for /dev/stdout, 7 for /dev/fd/7 and
 *  /proc/self/fd/7; -1 for other targets. What the descriptor has open may be a file, a pipe or a socket. */
int brio_target_descriptor(const brio_target *target);

/** Returns whether a target is a link of the process file system: to an open file, not to a name that can be
 *  replaced. */
bool brio_target_is_open_file(const brio_target *target);

/** Returns the open descriptor that a path of an output leads to: that of standard output for "-", that of
 *  brio_target_descriptor otherwise, or -1. */
int brio_open_descriptor(brio_context *ctx, const char *path);

/** Makes the new file. The file has the permissions of the file that it will replace, and its owner and group if
 *  the system allows that.
 *  file  receives a descriptor, owned by the caller. */
brio_status brio_target_create(brio_target *target, brio_context *ctx, const char *shown, int *file);

/** Returns whether the new file has no name yet: closing its descriptor removes it. */
static inline bool brio_target_is_nameless(const brio_target *target) {
    return target->is_new && !target->is_named;
}

/** Gives the new file its name, and replaces the file that has it.
 *  file  the descriptor of brio_target_create, which must be open if the file is nameless. */
brio_status brio_target_publish(brio_target *target, brio_context *ctx, const char *shown, int file);

/** Does the same, and keeps the file that had the name under the temporary name until brio_target_close, where the file
 *  system can exchange names. Of a set of files the others may still fail. */
brio_status brio_target_exchange(brio_target *target, brio_context *ctx, const char *shown, int file);

/** Takes the name from a file that brio_target_exchange published, and gives it back to the file that had it. */
void brio_target_undo(brio_target *target);

/** Frees everything. A new file that was not published disappears. */
void brio_target_close(brio_target *target, brio_context *ctx);

#endif
