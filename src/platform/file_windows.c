/* Files of Windows. A descriptor is one of its C library, so that streams of C and of this room mix; the bytes are
 * moved by calls of the system. */
#include "platform/file.h"
#include "platform/wide_names.h"
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <string.h>
#include <windows.h>

static HANDLE handle_of(int file) {
    return (HANDLE)_get_osfhandle(file);
}

/* --- what is there --- */

/* Finds what a handle leads to. The time counts from 1601 in units of 100 ns. */
static bool find_facts_of(HANDLE handle, brio_place_facts *facts) {
    BY_HANDLE_FILE_INFORMATION info;
    DWORD type = GetFileType(handle);
    memset(facts, 0, sizeof *facts);
    facts->number = (uint64_t)(uintptr_t)handle;
    facts->kind = type == FILE_TYPE_PIPE ? BRIO_IS_PIPE : type == FILE_TYPE_CHAR ? BRIO_IS_CHARACTERS : BRIO_IS_OTHER;
    if (type == FILE_TYPE_PIPE || type == FILE_TYPE_CHAR) return true;
    if (type != FILE_TYPE_DISK || !GetFileInformationByHandle(handle, &info)) {
        brio_windows_error();
        return false;
    }
    uint64_t time = (uint64_t)info.ftLastWriteTime.dwHighDateTime << 32 | info.ftLastWriteTime.dwLowDateTime;
    facts->kind = info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY ? BRIO_IS_FOLDER : BRIO_IS_FILE;
    facts->volume = (uint64_t)info.dwVolumeSerialNumber;
    facts->number = (uint64_t)info.nFileIndexHigh << 32 | info.nFileIndexLow;
    facts->size = (uint64_t)info.nFileSizeHigh << 32 | info.nFileSizeLow;
    facts->seconds = (int64_t)(time / 10000000);
    facts->nanoseconds = (int64_t)(time % 10000000 * 100);
    return true;
}

bool brio_find_facts(const char *path, brio_place_facts *facts) {
    brio_wide_path wide;
    if (!brio_wide_path_of(path, &wide)) return false;
    /* the flag is for folders; no rights are asked for, so that a file that others hold is found, too */
    HANDLE handle = CreateFileW(wide.text, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                                OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        brio_windows_error();
        return false;
    }
    bool found = find_facts_of(handle, facts);
    CloseHandle(handle);
    return found;
}

bool brio_find_facts_open(int file, brio_place_facts *facts) {
    HANDLE handle = handle_of(file);
    if (handle != INVALID_HANDLE_VALUE) return find_facts_of(handle, facts);
    errno = EBADF;
    return false;
}

/* Returns the attributes of what has a name, or INVALID_FILE_ATTRIBUTES with errno. */
static DWORD attributes_of(const char *path) {
    brio_wide_path wide;
    if (!brio_wide_path_of(path, &wide)) return INVALID_FILE_ATTRIBUTES;
    DWORD attributes = GetFileAttributesW(wide.text);
    if (attributes == INVALID_FILE_ATTRIBUTES) brio_windows_error();
    return attributes;
}

bool brio_is_there(const char *path) {
    return attributes_of(path) != INVALID_FILE_ATTRIBUTES;
}

bool brio_may_write(const char *path) {
    DWORD attributes = attributes_of(path);
    if (attributes == INVALID_FILE_ATTRIBUTES) return false;
    errno = EACCES;
    return !(attributes & FILE_ATTRIBUTE_READONLY);
}

/* Says no where there is no folder. Who may make files in it is a matter of lists, which the writer tries. */
bool brio_may_make_files(const char *folder) {
    DWORD attributes = attributes_of(folder);
    if (attributes == INVALID_FILE_ATTRIBUTES) return false;
    errno = ENOTDIR;
    return attributes & FILE_ATTRIBUTE_DIRECTORY;
}

bool brio_is_link(const char *path) {
    DWORD attributes = attributes_of(path);
    return attributes != INVALID_FILE_ATTRIBUTES && attributes & FILE_ATTRIBUTE_REPARSE_POINT;
}

size_t brio_folder_length(const char *path) {
    size_t length = 0;
    for (size_t i = 0; path[i]; i++)
        if (path[i] == '/' || path[i] == '\\' || (path[i] == ':' && i == 1)) length = i + 1;
    return length;
}

/* --- descriptors --- */

/* Opens a file for what others may do besides: also rename and remove it, as on other systems. */
static int open_path(const char *path, DWORD access, int flags) {
    brio_wide_path wide;
    if (!brio_wide_path_of(path, &wide)) return -1;
    HANDLE handle = CreateFileW(wide.text, access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                                OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle == INVALID_HANDLE_VALUE) return brio_windows_error();
    int file = _open_osfhandle((intptr_t)handle, flags | _O_BINARY | _O_NOINHERIT);
    if (file < 0) CloseHandle(handle);
    return file;
}

int brio_open_input(const char *path) {
    brio_place_facts facts;
    if (brio_find_facts(path, &facts) && facts.kind == BRIO_IS_FOLDER) {
        errno = EISDIR;
        return -1;
    }
    return open_path(path, GENERIC_READ, _O_RDONLY);
}

int brio_open_device(const char *path) {
    return open_path(path, GENERIC_WRITE, _O_WRONLY);
}

int brio_open_end(const char *path) {
    return open_path(path, FILE_APPEND_DATA, _O_WRONLY | _O_APPEND);
}

/* Asks for a write of no bytes: handles do not tell their rights. */
bool brio_is_writable(int file) {
    DWORD done;
    if (handle_of(file) != INVALID_HANDLE_VALUE && WriteFile(handle_of(file), "", 0, &done, NULL)) return true;
    errno = EBADF;
    return false;
}

int brio_copy_descriptor(int file) {
    return _dup(file);
}

FILE *brio_stream_of(int file) {
    return _fdopen(file, "wb");
}
int brio_descriptor_of(FILE *stream) {
    return _fileno(stream);
}

/* Opens in binary mode: a line ends with a line feed on every system. */
FILE *brio_open_stream(const char *path, const char *mode) {
    brio_wide_path wide;
    wchar_t binary[8] = {0};
    size_t length = strlen(mode);
    if (length > 4 || !brio_wide_path_of(path, &wide)) return NULL;
    for (size_t i = 0; i < length; i++) binary[i] = (wchar_t)mode[i];
    if (!strchr(mode, 'b')) binary[length] = L'b';
    return _wfopen(wide.text, binary);
}

bool brio_close(int file) {
    return _close(file) == 0;
}

/* --- bytes --- */

enum { MOST_AT_ONCE = 1 << 30 }; /* the calls count in 32 bits */

static DWORD at_once(size_t size) {
    return size < MOST_AT_ONCE ? (DWORD)size : MOST_AT_ONCE;
}

static OVERLAPPED overlapped_at(uint64_t place) {
    OVERLAPPED at;
    memset(&at, 0, sizeof at);
    at.Offset = (DWORD)place;
    at.OffsetHigh = (DWORD)(place >> 32);
    return at;
}

/* Returns where a file stands, and puts it back there: a call at a place moves it. */
static int64_t stand(HANDLE handle, const int64_t *back) {
    LARGE_INTEGER by = {.QuadPart = back ? *back : 0}, now;
    return SetFilePointerEx(handle, by, &now, back ? FILE_BEGIN : FILE_CURRENT) ? now.QuadPart : -1;
}

int64_t brio_read_bytes(int file, void *bytes, size_t size) {
    DWORD done = 0;
    if (ReadFile(handle_of(file), bytes, at_once(size), &done, NULL)) return (int64_t)done;
    if (GetLastError() == ERROR_BROKEN_PIPE || GetLastError() == ERROR_HANDLE_EOF) return 0;
    return brio_windows_error();
}

int64_t brio_read_bytes_at(int file, void *bytes, size_t size, uint64_t place) {
    DWORD done = 0;
    HANDLE handle = handle_of(file);
    OVERLAPPED at = overlapped_at(place);
    int64_t here = stand(handle, NULL);
    bool read = ReadFile(handle, bytes, at_once(size), &done, &at);
    DWORD error = read ? 0 : GetLastError();
    if (here >= 0) stand(handle, &here);
    if (read) return (int64_t)done;
    SetLastError(error);
    return error == ERROR_HANDLE_EOF ? 0 : brio_windows_error();
}

int64_t brio_write_bytes(int file, const void *bytes, size_t size) {
    DWORD done = 0;
    if (WriteFile(handle_of(file), bytes, at_once(size), &done, NULL)) return (int64_t)done;
    return brio_windows_error();
}

int64_t brio_write_bytes_at(int file, const void *bytes, size_t size, uint64_t place) {
    DWORD done = 0;
    HANDLE handle = handle_of(file);
    OVERLAPPED at = overlapped_at(place);
    int64_t here = stand(handle, NULL);
    bool written = WriteFile(handle, bytes, at_once(size), &done, &at);
    DWORD error = written ? 0 : GetLastError();
    if (here >= 0) stand(handle, &here);
    if (written) return (int64_t)done;
    SetLastError(error);
    return brio_windows_error();
}

int64_t brio_place_in(int file) {
    return stand(handle_of(file), NULL);
}

size_t brio_pipe_room(void) {
    return 4096;
}

/* Looks at a pipe that is read; all else is taken as ready: its calls wait themselves, and Ctrl-C ends them. */
bool brio_wait_ready(int file, bool writes, int milliseconds) {
    enum { TURN = 10 };
    HANDLE handle = handle_of(file);
    if (writes || GetFileType(handle) != FILE_TYPE_PIPE) return true;
    for (int waited = 0;; waited += TURN) {
        DWORD there = 0;
        if (!PeekNamedPipe(handle, NULL, 0, NULL, &there, NULL) || there) return true;
        if (waited >= milliseconds) return false;
        Sleep(TURN);
    }
}

void brio_wait_milliseconds(int milliseconds) {
    Sleep((DWORD)milliseconds);
}

bool brio_flush_to_disk(int file) {
    if (FlushFileBuffers(handle_of(file))) return true;
    brio_windows_error();
    return false;
}
