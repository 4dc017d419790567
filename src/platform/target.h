/* The target of an output: an open folder and a name in it.
 *
 * The file is written without a name in that folder, and gets its name when it is complete: whatever ends the process
 * before, even a signal that no process can catch, leaves nothing. Where the system has no files that can be named
 * later, the file has a temporary name and is renamed. The folder is open from the beginning, so that a change of the
 * process' working folder does not matter.
 *
 * A function that returns bool returns false for a failure, with the reason in errno. */
#ifndef BRIO_PLATFORM_TARGET_H
#define BRIO_PLATFORM_TARGET_H

#include "platform/file.h"

/* The temporary name begins with at most BRIO_NAME_IN_TEMPORARY bytes of the name, whole UTF-8 characters: so it is not
 * too long for a file system even if the name has the greatest length. Chosen. */
enum { BRIO_NAME_IN_TEMPORARY = 100, BRIO_TEMPORARY_MOST = BRIO_NAME_IN_TEMPORARY + 32 };

typedef struct brio_target {
    int folder;     /* descriptor, or -1 if there is none */
    bool is_new;    /* whether the output is a new file: one of brio_target_create */
    bool replaces;  /* whether there was a file of that name when the new one was made */
    bool is_named;  /* whether a file has the temporary name: the new one or, once that is published, the old one */
    bool published; /* whether the new file has the target's name */
    char name[BRIO_NAME_MOST]; /* of the file in the folder */
    char temporary[BRIO_TEMPORARY_MOST];
} brio_target;

/** Follows a path through symbolic links to a folder and a name. The file need not exist: if a link leads to no file,
 *  the target is the name that the link leads to. Links of the process file system are not followed: what they say is
 *  no path, and the file that they lead to is open already.
 *  target  closed with brio_target_close, on failure too.
 *  errno   ENOENT for a missing folder and an empty name, EISDIR for a path that ends with its folder, ELOOP. */
bool brio_target_find(brio_target *target, const char *path);

/** Finds the path that a chain of symbolic links leads to, in the same way, for messages. Returns false for more links
 *  than the system follows. */
bool brio_target_path(const char *path, char end[BRIO_PATH_MOST]);

/** Returns the descriptor of this process that a target leads to, such as 1 for /dev/stdout, 7 for /dev/fd/7 and
 *  /proc/self/fd/7; -1 for other targets. What the descriptor has open may be a file, a pipe or a socket. */
int brio_target_descriptor(const brio_target *target);

/** Returns what brio_target_descriptor does for the target of a path. */
int brio_path_descriptor(const char *path);

/** Returns whether a target is a link of the process file system: to an open file, not to a name that can be
 *  replaced. */
bool brio_target_is_open_file(const brio_target *target);

/** Finds what has the target's name now. */
bool brio_target_facts(const brio_target *target, brio_place_facts *facts);

/** Returns whether the file that has the target's name may be written. */
bool brio_target_may_write(const brio_target *target);

/** Makes the new file. The file has the permissions of the file that it will replace, and its owner and group if
 *  the system allows that.
 *  file  receives a descriptor, owned by the caller. */
bool brio_target_create(brio_target *target, int *file);

/** Returns whether the new file has no name yet: closing its descriptor removes it. */
static inline bool brio_target_is_nameless(const brio_target *target) {
    return target->is_new && !target->is_named;
}

/** Gives the new file its name, and replaces the file that has it.
 *  file  the descriptor of brio_target_create, which must be open if the file is nameless. */
bool brio_target_publish(brio_target *target, int file);

/** Gives the target's name to a file that was made elsewhere in the file system, by its path, in place of one of
 *  brio_target_create. The file gets the permissions, owner and group as such a one. */
bool brio_target_adopt(brio_target *target, const char *path);

/** Does what brio_target_publish does, and keeps the file that had the name under the temporary name until
 *  brio_target_close, where the file system can exchange names. Of a set of files the others may still fail. */
bool brio_target_exchange(brio_target *target, int file);

/** Takes the name from a file that brio_target_exchange published, and gives it back to the file that had it. */
void brio_target_undo(brio_target *target);

/** Closes the folder. A new file that was not published disappears. */
void brio_target_close(brio_target *target);

/** Makes the temporary name of a target: a new one at each call (target.c). */
void brio_target_temporary(brio_target *target);

/** Returns a number that others cannot guess, so that they cannot take the temporary names before. Where the system has
 *  none to give, the name is merely new: it is created, never opened. */
uint64_t brio_unguessable(void);

#endif
