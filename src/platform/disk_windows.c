/* Space on disk of Windows. */
#include "platform/disk.h"
#include "platform/wide_names.h"
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <windows.h>

static HANDLE handle_of(int file) {
    return (HANDLE)_get_osfhandle(file);
}

/* Makes a file with a name that nobody else uses, which the system removes when it is closed, however that happens. */
int brio_open_nameless(const char *folder) {
    enum { TRIES = 100 };
    brio_wide_path wide, name;
    if (!*folder) {
        errno = ENOENT;
        return -1;
    }
    if (!brio_wide_path_of(folder, &wide)) return -1;
    LARGE_INTEGER ticks;
    QueryPerformanceCounter(&ticks);
    for (unsigned i = 0; i < TRIES; i++) {
        int length = _snwprintf(name.text, BRIO_PATH_MOST, L"%ls\\brio-%08lx%08lx%02x", wide.text,
                                GetCurrentProcessId(), (unsigned long)ticks.LowPart, i);
        if (length < 0 || length >= BRIO_PATH_MOST) {
            errno = ENAMETOOLONG;
            return -1;
        }
        HANDLE handle = CreateFileW(name.text, GENERIC_READ | GENERIC_WRITE | DELETE,
                                    FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL, CREATE_NEW,
                                    FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
        if (handle != INVALID_HANDLE_VALUE)
            return _open_osfhandle((intptr_t)handle, _O_RDWR | _O_BINARY | _O_NOINHERIT);
        brio_windows_error();
        if (errno != EEXIST) break;
    }
    return -1;
}

bool brio_set_size(int file, uint64_t size) {
    FILE_END_OF_FILE_INFO end = {.EndOfFile = {.QuadPart = (int64_t)size}};
    if (SetFileInformationByHandle(handle_of(file), FileEndOfFileInfo, &end, sizeof end)) return true;
    brio_windows_error();
    return false;
}

int brio_allocate_space(int file, uint64_t place, uint64_t size) {
    LARGE_INTEGER now;
    if (!GetFileSizeEx(handle_of(file), &now)) return EIO;
    if ((uint64_t)now.QuadPart >= place + size) return 0;
    return brio_set_size(file, place + size) ? 0 : errno;
}

int brio_open_direct(int file) {
    (void)file;
    errno = ENOTSUP;
    return -1;
}

bool brio_start_writing(int file, uint64_t place, uint64_t size) {
    (void)file, (void)place, (void)size;
    return true;
}

bool brio_wait_written(int file, uint64_t place, uint64_t size) {
    (void)file, (void)place, (void)size;
    return true;
}

size_t brio_read_around(const char *folder) {
    (void)folder;
    return 0;
}

void brio_advise_cache(int file, uint64_t place, uint64_t size, brio_cache_use use) {
    (void)file, (void)place, (void)size, (void)use;
}
