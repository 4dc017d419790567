/* Targets of outputs of Windows: a temporary name, renamed over the old file when it is complete.
 *
 * The folder is a descriptor, as elsewhere: what it has open tells its path when a name in it is needed, so that a
 * change of the working folder does not matter. Links of files are followed by the system when they are found, and
 * replaced by the new file: Windows has few. */
#include "platform/target.h"
#include "platform/wide_names.h"
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <string.h>
#include <windows.h>
#define RtlGenRandom SystemFunction036 /* the name that advapi32 has for it */
BOOLEAN NTAPI RtlGenRandom(PVOID bytes, ULONG size);

enum { NAME_TRIES = 100 };

/* Makes the path of a name in the target's folder. */
static bool path_in(const brio_target *target, const char *name, brio_wide_path *path) {
    HANDLE folder = (HANDLE)_get_osfhandle(target->folder);
    DWORD length = GetFinalPathNameByHandleW(folder, path->text, BRIO_PATH_MOST, FILE_NAME_NORMALIZED);
    if (length == 0) {
        brio_windows_error();
        return false;
    }
    errno = ENAMETOOLONG;
    if (length + 2 >= BRIO_PATH_MOST) return false;
    if (path->text[length - 1] != L'\\') path->text[length++] = L'\\';
    return MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, name, -1, path->text + length,
                               BRIO_PATH_MOST - (int)length) != 0;
}

bool brio_target_find(brio_target *target, const char *path) {
    char folder[BRIO_PATH_MOST];
    brio_wide_path wide;
    size_t length = brio_folder_length(path);
    *target = (brio_target){.folder = -1};
    errno = ENAMETOOLONG;
    if (length + 2 > sizeof folder || strlen(path + length) >= sizeof target->name) return false;
    memcpy(folder, path, length);
    strcpy(folder + length, length && path[length - 1] != ':' ? "" : ".");
    if (!brio_wide_path_of(folder, &wide)) return false;
    HANDLE handle = CreateFileW(wide.text, FILE_LIST_DIRECTORY, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        brio_windows_error();
        return false;
    }
    target->folder = _open_osfhandle((intptr_t)handle, _O_RDONLY | _O_NOINHERIT);
    if (target->folder < 0) {
        CloseHandle(handle);
        return false;
    }
    strcpy(target->name, path + length);
    errno = length ? EISDIR : ENOENT;
    return target->name[0] != 0;
}

bool brio_target_path(const char *path, char end[BRIO_PATH_MOST]) {
    if (strlen(path) >= BRIO_PATH_MOST) return false;
    strcpy(end, path);
    return true;
}

/* Descriptors have no names here. */
int brio_target_descriptor(const brio_target *target) {
    (void)target;
    return -1;
}

bool brio_target_is_open_file(const brio_target *target) {
    (void)target;
    return false;
}

/* Finds the attributes of what has a name in the folder, or returns INVALID_FILE_ATTRIBUTES with errno. */
static DWORD attributes_in(const brio_target *target) {
    brio_wide_path path;
    if (!path_in(target, target->name, &path)) return INVALID_FILE_ATTRIBUTES;
    DWORD attributes = GetFileAttributesW(path.text);
    if (attributes == INVALID_FILE_ATTRIBUTES) brio_windows_error();
    return attributes;
}

bool brio_target_facts(const brio_target *target, brio_place_facts *facts) {
    DWORD attributes = attributes_in(target);
    if (attributes == INVALID_FILE_ATTRIBUTES) return false;
    *facts = (brio_place_facts){.kind = attributes & FILE_ATTRIBUTE_DIRECTORY ? BRIO_IS_FOLDER : BRIO_IS_FILE};
    return true;
}

bool brio_target_may_write(const brio_target *target) {
    DWORD attributes = attributes_in(target);
    if (attributes == INVALID_FILE_ATTRIBUTES) return false;
    errno = EACCES;
    return !(attributes & FILE_ATTRIBUTE_READONLY);
}

/* --- the new file --- */

uint64_t brio_unguessable(void) {
    uint64_t seed = 0;
    LARGE_INTEGER ticks;
    if (RtlGenRandom(&seed, sizeof seed)) return seed;
    QueryPerformanceCounter(&ticks);
    return (uint64_t)GetCurrentProcessId() << 32 ^ (uint64_t)ticks.QuadPart;
}

bool brio_target_create(brio_target *target, int *file) {
    brio_wide_path path;
    *file = -1;
    target->replaces = attributes_in(target) != INVALID_FILE_ATTRIBUTES;
    if (!target->replaces && errno != ENOENT) return false;
    for (int i = 0; i < NAME_TRIES; i++) {
        brio_target_temporary(target);
        if (!path_in(target, target->temporary, &path)) return false;
        HANDLE handle = CreateFileW(path.text, GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                    NULL, CREATE_NEW, FILE_ATTRIBUTE_NORMAL, NULL);
        if (handle != INVALID_HANDLE_VALUE) {
            target->is_new = target->is_named = true;
            *file = _open_osfhandle((intptr_t)handle, _O_WRONLY | _O_BINARY | _O_NOINHERIT);
            return *file >= 0;
        }
        brio_windows_error();
        if (errno != EEXIST) return false;
    }
    return false;
}

/* Gives the target's name to the file of the temporary name. */
static bool rename_file(brio_target *target) {
    brio_wide_path from, to;
    if (!path_in(target, target->temporary, &from) || !path_in(target, target->name, &to)) return false;
    target->published = MoveFileExW(from.text, to.text, MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH);
    if (!target->published) brio_windows_error();
    if (target->published) target->is_named = false;
    return target->published;
}

bool brio_target_publish(brio_target *target, int file) {
    (void)file;
    return !target->is_new || target->published || rename_file(target);
}

bool brio_target_adopt(brio_target *target, const char *path) {
    brio_wide_path from, to;
    if (!brio_wide_path_of(path, &from) || !path_in(target, target->name, &to)) return false;
    bool moved = MoveFileExW(from.text, to.text, MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH);
    if (!moved) brio_windows_error();
    return moved;
}

/* Replaces: names are not exchanged here. */
bool brio_target_exchange(brio_target *target, int file) {
    return brio_target_publish(target, file);
}

static void remove_name(const brio_target *target, const char *name) {
    brio_wide_path path;
    if (path_in(target, name, &path)) DeleteFileW(path.text);
}

void brio_target_undo(brio_target *target) {
    if (!target->published) return;
    if (!target->replaces) remove_name(target, target->name);
    target->published = false;
}

void brio_target_close(brio_target *target) {
    if (target->is_named) remove_name(target, target->temporary);
    if (target->folder >= 0) _close(target->folder);
    *target = (brio_target){.folder = -1};
}
