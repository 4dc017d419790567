/* Mappings of Windows: memory by VirtualAlloc, files by sections. A mapping is given back as a whole. */
#include "platform/pages.h"
#include "platform/wide_names.h"
#include <errno.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>
#define PSAPI_VERSION 2 /* of kernel32, without another library */
#include <psapi.h>

void *brio_pages_map(size_t size) {
    return VirtualAlloc(NULL, size, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
}

void *brio_pages_map_file(int file, size_t size) {
    HANDLE of_file = (HANDLE)_get_osfhandle(file);
    HANDLE section =
        CreateFileMappingW(of_file, NULL, PAGE_READWRITE, (DWORD)((uint64_t)size >> 32), (DWORD)size, NULL);
    if (!section) {
        brio_windows_error();
        return NULL;
    }
    void *base = MapViewOfFile(section, FILE_MAP_READ | FILE_MAP_WRITE, 0, 0, size);
    if (!base) brio_windows_error();
    CloseHandle(section); /* the view keeps it */
    return base;
}

void brio_pages_unmap(void *base, size_t size) {
    (void)size;
    VirtualFree(base, 0, MEM_RELEASE);
}

void brio_pages_unmap_file(void *base, size_t size) {
    (void)size;
    UnmapViewOfFile(base);
}

bool brio_pages_divide(void) {
    return false;
}

/* Copies memory. Two views of one file show the same bytes. */
void *brio_pages_remap(void *base, size_t size, size_t target, int file) {
    void *moved = file < 0 ? brio_pages_map(target) : brio_pages_map_file(file, target);
    if (!moved) return NULL;
    if (file < 0) {
        memcpy(moved, base, size < target ? size : target);
        brio_pages_unmap(base, size);
    } else {
        UnmapViewOfFile(base);
    }
    return moved;
}

void brio_pages_advise(void *base, size_t size, brio_pages_use use) {
    (void)base, (void)size, (void)use;
}

/* --- how much there is --- */

void *brio_heap_resize(void *block, size_t size) {
    return realloc(block, size);
}

size_t brio_system_memory(void) {
    MEMORYSTATUSEX facts = {.dwLength = sizeof facts};
    return GlobalMemoryStatusEx(&facts) && facts.ullTotalPhys < SIZE_MAX ? (size_t)facts.ullTotalPhys : SIZE_MAX;
}

uint64_t brio_process_peak(void) {
    PROCESS_MEMORY_COUNTERS facts = {.cb = sizeof facts};
    return GetProcessMemoryInfo(GetCurrentProcess(), &facts, sizeof facts) ? (uint64_t)facts.PeakWorkingSetSize : 0;
}
