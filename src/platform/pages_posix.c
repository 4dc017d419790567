/* Mappings by mmap; memory limits by /proc and cgroups, where the system is Linux. */
#define _GNU_SOURCE
#include "platform/pages.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __APPLE__
#include <sys/sysctl.h>
#endif
#ifndef MAP_NORESERVE
#define MAP_NORESERVE 0
#endif

/* Uses pages of the usual size: clearing a huge page at its first touch displaces everything else from the caches.
 * Measured: this cost the triangulation of four million points a fifth of its time (docs/measured/performance.md). */
void *brio_pages_map(size_t size) {
    void *base = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return base == MAP_FAILED ? NULL : base;
}

void *brio_pages_map_file(int file, size_t size) {
    void *base = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    return base == MAP_FAILED ? NULL : base;
}

void brio_pages_unmap(void *base, size_t size) {
    munmap(base, size);
}

void brio_pages_unmap_file(void *base, size_t size) {
    munmap(base, size);
}

bool brio_pages_divide(void) {
    return true;
}

#ifdef __linux__
/* Moves the pages and copies nothing. */
void *brio_pages_remap(void *base, size_t size, size_t target, int file) {
    (void)file;
    void *moved = mremap(base, size, target, MREMAP_MAYMOVE);
    return moved == MAP_FAILED ? NULL : moved;
}
#else
void *brio_pages_remap(void *base, size_t size, size_t target, int file) {
    void *moved = file < 0 ? brio_pages_map(target) : brio_pages_map_file(file, target);
    if (!moved) return NULL;
    if (file < 0) memcpy(moved, base, size < target ? size : target);
    munmap(base, size);
    return moved;
}
#endif

void brio_pages_advise(void *base, size_t size, brio_pages_use use) {
    madvise(base, size,
            use == BRIO_PAGES_RANDOM     ? MADV_RANDOM
            : use == BRIO_PAGES_SEQUENCE ? MADV_NORMAL
                                         : MADV_WILLNEED);
}

/* --- how much there is --- */

#ifdef __linux__

static size_t number_in_file(const char *path) {
    FILE *f = fopen(path, "r");
    unsigned long long bytes = 0;
    if (!f) return SIZE_MAX;
    int read = fscanf(f, "%llu", &bytes);
    fclose(f);
    return read == 1 && bytes ? (size_t)bytes : SIZE_MAX;
}

/* Returns the least limit of the process' memory cgroup and its ancestors, or SIZE_MAX. */
static size_t group_memory(void) {
    size_t least = SIZE_MAX;
    char line[512];
    FILE *f = fopen("/proc/self/cgroup", "r");
    if (!f) return least;
    while (fgets(line, sizeof line, f)) {
        char *controllers = strchr(line, ':');
        char *path = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!path) continue;
        *path++ = 0;
        path[strcspn(path, "\n")] = 0;
        bool v2 = controllers[1] == 0;
        if (!v2 && strcmp(controllers + 1, "memory")) continue;
        for (;;) {
            char name[1024];
            snprintf(name, sizeof name,
                     v2 ? "/sys/fs/cgroup%s/memory.max" : "/sys/fs/cgroup/memory%s/memory.limit_in_bytes", path);
            size_t limit = number_in_file(name);
            if (limit < least) least = limit;
            char *slash = strrchr(path, '/');
            if (!slash || path[0] == 0) break;
            *slash = 0;
        }
    }
    fclose(f);
    return least;
}

static size_t machine_memory(void) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (size_t)pages * (size_t)page : SIZE_MAX;
}

/* Returns the kernel's high-water mark of this program's own memory. */
static uint64_t marked_peak(void) {
    unsigned long long kib = 0;
    char line[256];
    FILE *file = fopen("/proc/self/status", "r");
    while (file && !kib && fgets(line, sizeof line, file)) sscanf(line, "VmHWM: %llu", &kib);
    if (file) fclose(file);
    return kib * 1024;
}

enum { PEAK_UNIT = 1024 }; /* bytes of ru_maxrss */

#else

static size_t group_memory(void) {
    return SIZE_MAX;
}

static size_t machine_memory(void) {
    uint64_t bytes = 0;
    size_t size = sizeof bytes;
    return sysctlbyname("hw.memsize", &bytes, &size, NULL, 0) == 0 && bytes ? (size_t)bytes : SIZE_MAX;
}

static uint64_t marked_peak(void) {
    return 0;
}

enum { PEAK_UNIT = 1 };

#endif

void *brio_heap_resize(void *block, size_t size) {
    return realloc(block, size);
}

size_t brio_system_memory(void) {
    size_t machine = machine_memory(), group = group_memory();
    return group < machine ? group : machine;
}

/* Asks getrusage where there is no mark: it also counts what the process held before it became this program. */
uint64_t brio_process_peak(void) {
    struct rusage usage;
    uint64_t peak = marked_peak();
    if (!peak && getrusage(RUSAGE_SELF, &usage) == 0) peak = (uint64_t)usage.ru_maxrss * PEAK_UNIT;
    return peak;
}
