/* Folders of Windows. A file that is locked is one that is opened without sharing. */
#include "platform/folder.h"
#include "platform/wide_names.h"
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdio.h>
#include <string.h>
#include <windows.h>

bool brio_make_folder(const char *path, bool ours, bool *made) {
    brio_wide_path wide;
    (void)ours; /* rights are those of the folder above */
    *made = false;
    if (!brio_wide_path_of(path, &wide)) return false;
    *made = CreateDirectoryW(wide.text, NULL);
    if (*made || GetLastError() == ERROR_ALREADY_EXISTS) return true;
    brio_windows_error();
    return false;
}

/* Opens a file to read and to write. */
static int open_file(const char *path, DWORD sharing, DWORD how) {
    brio_wide_path wide;
    if (!brio_wide_path_of(path, &wide)) return -1;
    HANDLE handle =
        CreateFileW(wide.text, GENERIC_READ | GENERIC_WRITE, sharing, NULL, how, FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle != INVALID_HANDLE_VALUE) return _open_osfhandle((intptr_t)handle, _O_BINARY | _O_RDWR);
    bool busy = GetLastError() == ERROR_SHARING_VIOLATION;
    brio_windows_error();
    if (busy) errno = EWOULDBLOCK;
    return -1;
}

int brio_lock_file(const char *path) {
    return open_file(path, 0, OPEN_ALWAYS);
}

/* Closes the file first. If another process has it by now, it stays: a file that is open without sharing cannot be
 * removed. */
void brio_unlock_file(int file, const char *path) {
    _close(file);
    brio_remove_file(path);
}

int brio_make_file(const char *path) {
    return open_file(path, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, CREATE_ALWAYS);
}

bool brio_rename_file(const char *from, const char *to) {
    brio_wide_path a, b;
    if (!brio_wide_path_of(from, &a) || !brio_wide_path_of(to, &b)) return false;
    if (MoveFileExW(a.text, b.text, MOVEFILE_REPLACE_EXISTING)) return true;
    brio_windows_error();
    return false;
}

bool brio_remove_file(const char *path) {
    brio_wide_path wide;
    if (!brio_wide_path_of(path, &wide)) return false;
    if (DeleteFileW(wide.text)) return true;
    brio_windows_error();
    return false;
}

void brio_empty_folder(const char *path, const char *kept) {
    char name[BRIO_PATH_MOST];
    brio_wide_path wide;
    WIN32_FIND_DATAW found;
    int length = snprintf(name, sizeof name, "%s/*", path);
    if (length >= (int)sizeof name || !brio_wide_path_of(name, &wide)) return;
    HANDLE search = FindFirstFileW(wide.text, &found);
    if (search == INVALID_HANDLE_VALUE) return;
    do {
        char file[BRIO_NAME_MOST];
        if (found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) continue;
        if (!brio_narrow_text(found.cFileName, file, sizeof file) || !strcmp(file, kept)) continue;
        if (snprintf(name, sizeof name, "%s/%s", path, file) < (int)sizeof name) brio_remove_file(name);
    } while (FindNextFileW(search, &found));
    FindClose(search);
}

bool brio_remove_folder(const char *path) {
    brio_wide_path wide;
    if (!brio_wide_path_of(path, &wide)) return false;
    if (RemoveDirectoryW(wide.text)) return true;
    brio_windows_error();
    return false;
}

bool brio_free_bytes(const char *path, uint64_t *bytes) {
    brio_wide_path wide;
    ULARGE_INTEGER available;
    if (!brio_wide_path_of(path, &wide) || !GetDiskFreeSpaceExW(wide.text, &available, NULL, NULL)) return false;
    *bytes = available.QuadPart;
    return true;
}
