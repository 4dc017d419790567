/* Mappings where the memory is one array that grows: blocks of the allocator, all zero. Files are not mapped. */
#include "platform/pages.h"
#include <errno.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 4096, SMALL = 1 << 16 };

void *brio_pages_map(size_t size) {
    void *base = aligned_alloc(ALIGNMENT, size);
    if (base) memset(base, 0, size);
    return base;
}

void *brio_pages_map_file(int file, size_t size) {
    (void)file, (void)size;
    errno = ENOSYS;
    return NULL;
}

void brio_pages_unmap(void *base, size_t size) {
    (void)size;
    free(base);
}

void brio_pages_unmap_file(void *base, size_t size) {
    (void)base, (void)size;
}

bool brio_pages_divide(void) {
    return false;
}

void *brio_pages_remap(void *base, size_t size, size_t target, int file) {
    void *moved = file < 0 ? aligned_alloc(ALIGNMENT, target) : NULL;
    if (!moved) return NULL;
    memcpy(moved, base, size < target ? size : target);
    if (target > size) memset((char *)moved + size, 0, target - size);
    free(base);
    return moved;
}

void brio_pages_advise(void *base, size_t size, brio_pages_use use) {
    (void)base, (void)size, (void)use;
}

/* Moves what becomes small: the allocator of the C library that comes with ziglang leaves it in its place of 64 KiB,
 * and takes that for a small one when it is freed. A module lost 64 KiB with each call that shrank such a block. */
void *brio_heap_resize(void *block, size_t size) {
    void *moved = size < SMALL ? malloc(size) : NULL;
    if (!moved) return realloc(block, size);
    size_t old = malloc_usable_size(block);
    memcpy(moved, block, size < old ? size : old);
    free(block);
    return moved;
}

/* Returns no limit: the addresses are of 32 bits. */
size_t brio_system_memory(void) {
    return SIZE_MAX;
}

uint64_t brio_process_peak(void) {
    return (uint64_t)__builtin_wasm_memory_size(0) << 16; /* it never shrinks */
}
