/* Folders of files with names, for what must outlive a process: made, locked, emptied, removed. Functions that return
 * bool or a descriptor leave the reason of a failure in errno. */
#ifndef BRIO_PLATFORM_FOLDER_H
#define BRIO_PLATFORM_FOLDER_H

#include <stdbool.h>
#include <stdint.h>

/** Makes a folder that only its owner may read (`ours`) or one with the usual rights. A folder that is there already is
 *  no failure, except that `ours` refuses a link and the folder of another user: who may write into a folder for all,
 *  such as /tmp, could lay one there under a name that can be guessed.   made  receives whether there was none. */
bool brio_make_folder(const char *path, bool ours, bool *made);

/** Opens a file, makes it if there is none, and locks it until it is closed or the process ends, in whatever way.
 *  Returns the descriptor, or -1; errno is EWOULDBLOCK if another process has it. Does not follow links. */
int brio_lock_file(const char *path);

/** Removes a file that is locked, and ends the lock. No other process gets the lock of the file that is removed. */
void brio_unlock_file(int file, const char *path);

/** Makes an empty file, to read and to write, in place of one of that name. Does not follow links. Returns -1 if it
 *  cannot. */
int brio_make_file(const char *path);

/** Gives a file another name, in place of a file that has it. */
bool brio_rename_file(const char *from, const char *to);

/** Removes a file; the next two functions all files of a folder but the one named `kept`, and an empty folder. */
bool brio_remove_file(const char *path);
void brio_empty_folder(const char *path, const char *kept);
bool brio_remove_folder(const char *path);

/** Finds how many bytes may still be written into a folder's file system. Returns false if that is not known. */
bool brio_free_bytes(const char *path, uint64_t *bytes);

#endif
