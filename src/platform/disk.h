/* Files as places on a disk: files without a name, their space, transfers past the system's cache, and what the disk is
 * made to take. Where a system lacks one of these, the file is the same and the disk decides when. */
#ifndef BRIO_PLATFORM_DISK_H
#define BRIO_PLATFORM_DISK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Opens an empty file without a name, to read and to write, which is gone when it is closed. Returns -1 if the folder
 *  takes no files. */
int brio_open_nameless(const char *folder);

/** Gives bytes of a file their space, so that a full disk fails here. Returns 0, or what errno would be: EINTR if a
 *  signal ended it early, EFBIG for a limit on the size of files. Raises no signal. */
int brio_allocate_space(int file, uint64_t place, uint64_t size);

/** Cuts a file, or makes it longer. Returns false if the system does not. Raises no signal. */
bool brio_set_size(int file, uint64_t size);

/** Opens a file once more, for transfers past the system's cache, of whole pages at multiples of 4096 bytes. Returns -1
 *  where there are none. */
int brio_open_direct(int file);

/** Make the disk take bytes: start, and wait until it has them. A failure is told once only. Return false for it. */
bool brio_start_writing(int file, uint64_t place, uint64_t size);
bool brio_wait_written(int file, uint64_t place, uint64_t size);

typedef enum {
    BRIO_CACHE_RANDOM, /* bytes are read here and there */
    BRIO_CACHE_SOON,   /* these are read soon */
    BRIO_CACHE_NEVER   /* these are not read again soon */
} brio_cache_use;

/** Returns how many bytes the system reads at once where a page of a mapped file in a folder is missing and no advice
 *  was given: those about it. 0 where that is not known. */
size_t brio_read_around(const char *folder);

/** Says how bytes will be used; size 0 stands for all behind `place`. */
void brio_advise_cache(int file, uint64_t place, uint64_t size, brio_cache_use use);

#endif
