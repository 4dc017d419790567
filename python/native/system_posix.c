/* The clock and the large pages of POSIX. */
#define _GNU_SOURCE
#include "system.h"
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

long process_now(void) {
    return (long)getpid();
}

void *place_new(size_t bytes) {
    const size_t page = (size_t)2 << 20;
    void *place = NULL;
    if (bytes < 2 * page) return malloc(bytes + 1);
    if (posix_memalign(&place, page, bytes)) return NULL;
#ifdef MADV_HUGEPAGE
    madvise(place, bytes / page * page, MADV_HUGEPAGE);
#endif
    return place;
}

void place_free(void *place) {
    free(place);
}
