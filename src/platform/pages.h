/* Memory from the system: mappings in pages, what is expected of them, and how much memory there is. All sizes are
 * multiples of BRIO_PAGE (base/context.h), and all mappings begin at a multiple of 4096 bytes. */
#ifndef BRIO_PLATFORM_PAGES_H
#define BRIO_PLATFORM_PAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Maps new memory, all zero, of pages of the usual size. Returns NULL if there is none. */
void *brio_pages_map(size_t size);

/** Maps the first `size` bytes of a file, to read and to write. Returns NULL if the system cannot. */
void *brio_pages_map_file(int file, size_t size);

/** Changes the size of a mapping and keeps what it holds; it may move. New bytes are zero, those of a file what the
 *  file holds.   file  that of brio_pages_map_file, which has `target` bytes; -1 for memory.
 *  Returns the mapping, or NULL, and then the old one is as it was. */
void *brio_pages_remap(void *base, size_t size, size_t target, int file);

/** Unmaps memory: a whole mapping or, where brio_pages_divide, any pages of it. */
void brio_pages_unmap(void *base, size_t size);
/** Unmaps a mapping of a file. */
void brio_pages_unmap_file(void *base, size_t size);

/** Returns whether a mapping can be given back in parts. */
bool brio_pages_divide(void);

typedef enum {
    BRIO_PAGES_RANDOM,   /* a page that is missing is read alone */
    BRIO_PAGES_SEQUENCE, /* those behind it are read, too */
    BRIO_PAGES_SOON      /* these pages are read now */
} brio_pages_use;

/** Says how a mapping of a file will be used. Systems that take no advice go on as they do. */
void brio_pages_advise(void *base, size_t size, brio_pages_use use);

/** Changes the size of a block of malloc, as realloc does. */
void *brio_heap_resize(void *block, size_t size);

/** Returns the memory that this process may use: the least of the machine's memory and, on Linux, the limits of its
 *  cgroups (v1 and v2). SIZE_MAX if the system does not tell. */
size_t brio_system_memory(void);

/** Returns the most memory that this process has had, in bytes; 0 if the system does not tell. */
uint64_t brio_process_peak(void);

#endif
