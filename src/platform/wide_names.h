/* Names for calls of Windows: UTF-8 to UTF-16, long paths; and its errors as errno. */
#ifndef BRIO_PLATFORM_WIDE_NAMES_H
#define BRIO_PLATFORM_WIDE_NAMES_H

#include "platform/file.h"

/** Room for a path in UTF-16, with the beginning of long ones. */
typedef struct {
    wchar_t text[BRIO_PATH_MOST];
} brio_wide_path;

/** Converts a path. One of more than 240 characters becomes absolute, with the beginning that lifts the limit of 260.
 *  Returns false, with errno, for what is no UTF-8 and for what is too long. */
bool brio_wide_path_of(const char *path, brio_wide_path *wide);

/** Converts a text to UTF-8. Returns false if it does not fit. */
bool brio_narrow_text(const wchar_t *wide, char *text, size_t size);

/** Sets errno to what the last error of Windows is. Returns -1. */
int brio_windows_error(void);

#endif
