/* Files with names in a folder of their own: what has to be there when another process goes on. */
#ifndef BRIO_STORE_STORE_H
#define BRIO_STORE_STORE_H

#include "base/context.h"

/** A folder, locked against other processes. */
typedef struct {
    brio_context *ctx;
    char *path;           /* NULL: none */
    int lock;             /* descriptor */
    uint64_t bytes, most; /* in all files, as far as this process wrote them */
} brio_store_folder;

typedef struct {
    brio_store_folder *folder;
    char name[32];
    int file;  /* descriptor, or -1 */
    bool shut; /* no descriptor between calls: see brio_store_shut */
    uint64_t size;
    bool hashes;   /* whether what is appended goes into the hash */
    uint64_t hash; /* of the pieces that were appended, each of whole words of 8 bytes, the last one excepted */
} brio_store_file;

/** Makes a folder, or opens one that a process left.   name  of the folder in `parent`.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY. */
brio_status brio_store_begin(brio_context *ctx, const char *parent, const char *name, brio_store_folder *out);
/** Makes an empty folder that no process has: NAME-1, or with the next number. One that a killed process left is
 *  emptied and taken, so that there are never more than there were at one time. What is no store is left alone.
 *  WASI has no locks: one at a time there.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY. */
brio_status brio_store_begin_free(brio_context *ctx, const char *parent, const char *name, brio_store_folder *out);
/** Removes the folder and all its files. */
void brio_store_end(brio_store_folder *f);
/** Leaves the folder and its files to a process that goes on. */
void brio_store_leave(brio_store_folder *f);
/** Removes all files. */
void brio_store_clear(brio_store_folder *f);

/** Makes an empty file. Returns BRIO_OK or BRIO_ERR_WRITE. */
brio_status brio_store_create(brio_store_folder *folder, const char *name, brio_store_file *out);
/** Opens a file to read it. Returns BRIO_OK or BRIO_ERR_OPEN. */
brio_status brio_store_open(brio_store_folder *folder, const char *name, brio_store_file *out);
/** Returns whether a file is there. */
bool brio_store_has(const brio_store_folder *folder, const char *name);
/** Gives a complete file its name; *f stays open. After a failure of the machine the file may have its name and not its
 *  bytes: brio_store_check tells. Returns BRIO_OK or BRIO_ERR_WRITE. */
brio_status brio_store_publish(brio_store_file *f, const char *name);
/** Returns whether the bytes from an offset on are those whose hash is given. Reads them all.   same  receives it.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_store_check(const brio_store_file *f, uint64_t offset, uint64_t hash, bool *same);
void brio_store_remove(brio_store_folder *folder, const char *name);
void brio_store_close(brio_store_file *f);
/** Takes the descriptor from a file, which then has one during each call alone: a process may have as few as 256, and
 *  there are 65,536 tiles. Such a file is appended to and read, not written over. */
void brio_store_shut(brio_store_file *f);

/** Appends bytes; the next two functions write over and read bytes. Returns BRIO_OK, BRIO_ERR_WRITE (full),
 *  BRIO_ERR_OPEN (cannot be read, or ends early), BRIO_ERR_CANCELLED. */
brio_status brio_store_append(brio_store_file *f, const void *bytes, size_t size);
brio_status brio_store_write(brio_store_file *f, uint64_t offset, const void *bytes, size_t size);
brio_status brio_store_read(const brio_store_file *f, uint64_t offset, void *bytes, size_t size);

#endif
