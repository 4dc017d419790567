/* Names in UTF-16 and errors of Windows. */
#include "platform/wide_names.h"
#include <errno.h>
#include <string.h>
#include <windows.h>

enum { LONG_FROM = 240 };

/* Makes a long path absolute: only such ones may begin with \\?\, which lifts the limit of 260 characters. */
static bool lengthen(brio_wide_path *wide) {
    static const wchar_t begin[] = L"\\\\?\\", of_share[] = L"\\\\?\\UNC\\";
    wchar_t whole[BRIO_PATH_MOST];
    if (!wcsncmp(wide->text, begin, 4)) return true;
    DWORD length = GetFullPathNameW(wide->text, BRIO_PATH_MOST, whole, NULL);
    bool share = length > 2 && whole[0] == L'\\' && whole[1] == L'\\';
    const wchar_t *front = share ? of_share : begin, *rest = share ? whole + 2 : whole;
    if (length == 0 || length + wcslen(front) >= BRIO_PATH_MOST) return false;
    wcscpy(wide->text, front);
    wcscat(wide->text, rest);
    return true;
}

bool brio_wide_path_of(const char *path, brio_wide_path *wide) {
    int length = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide->text, BRIO_PATH_MOST);
    if (length == 0 || (length > LONG_FROM && !lengthen(wide))) {
        errno = GetLastError() == ERROR_NO_UNICODE_TRANSLATION ? EILSEQ : ENAMETOOLONG;
        return false;
    }
    return true;
}

bool brio_narrow_text(const wchar_t *wide, char *text, size_t size) {
    return WideCharToMultiByte(CP_UTF8, 0, wide, -1, text, (int)size, NULL, NULL) != 0;
}

int brio_windows_error(void) {
    static const struct {
        DWORD windows;
        int number;
    } errors[] = {
        {ERROR_FILE_NOT_FOUND, ENOENT},
        {ERROR_PATH_NOT_FOUND, ENOENT},
        {ERROR_INVALID_NAME, ENOENT},
        {ERROR_BAD_PATHNAME, ENOENT},
        {ERROR_BAD_NETPATH, ENOENT},
        {ERROR_ACCESS_DENIED, EACCES},
        {ERROR_SHARING_VIOLATION, EACCES},
        {ERROR_LOCK_VIOLATION, EACCES},
        {ERROR_WRITE_PROTECT, EROFS},
        {ERROR_FILE_EXISTS, EEXIST},
        {ERROR_ALREADY_EXISTS, EEXIST},
        {ERROR_TOO_MANY_OPEN_FILES, EMFILE},
        {ERROR_NOT_ENOUGH_MEMORY, ENOMEM},
        {ERROR_OUTOFMEMORY, ENOMEM},
        {ERROR_COMMITMENT_LIMIT, ENOMEM},
        {ERROR_DISK_FULL, ENOSPC},
        {ERROR_HANDLE_DISK_FULL, ENOSPC},
        {ERROR_BROKEN_PIPE, EPIPE},
        {ERROR_NO_DATA, EPIPE},
        {ERROR_INVALID_HANDLE, EBADF},
        {ERROR_DIRECTORY, ENOTDIR},
        {ERROR_NOT_SUPPORTED, ENOTSUP},
        {ERROR_FILENAME_EXCED_RANGE, ENAMETOOLONG},
    };
    DWORD last = GetLastError();
    errno = EIO;
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++)
        if (errors[i].windows == last) errno = errors[i].number;
    return -1;
}
