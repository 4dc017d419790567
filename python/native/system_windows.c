/* The clock of Windows. Its large pages are for users with a right that is rarely given. */
#include "system.h"
#include <stdlib.h>
#include <windows.h>

double seconds_now(void) {
    LARGE_INTEGER count, second;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&second);
    return (double)count.QuadPart / (double)second.QuadPart;
}

long process_now(void) {
    return (long)GetCurrentProcessId();
}

void *place_new(size_t bytes) {
    return malloc(bytes + 1);
}

void place_free(void *place) {
    free(place);
}
