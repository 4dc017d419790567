/* Programs of Windows: the command line in UTF-16, Ctrl-C in a thread of the system's. */
#include "platform/program.h"
#include "platform/wide_names.h"
#include <fcntl.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>
#include <shellapi.h>

/* --- what the handlers call: a handler can reach nothing but what is global --- */

static void (*program_stop)(void), (*program_lost)(void);

/* Converts the arguments, to be kept until the process ends. Returns NULL where they cannot be. */
static char **narrow_arguments(int *count) {
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), count);
    char **arguments = wide ? calloc((size_t)*count + 1, sizeof *arguments) : NULL;
    for (int i = 0; arguments && i < *count; i++) {
        size_t most = 4 * wcslen(wide[i]) + 1;
        arguments[i] = malloc(most);
        if (!arguments[i] || !brio_narrow_text(wide[i], arguments[i], most)) arguments = NULL;
    }
    LocalFree(wide);
    return arguments;
}

void brio_program_begin(int *argc, char ***argv) {
    int count;
    char **arguments = narrow_arguments(&count);
    if (arguments) *argc = count, *argv = arguments;
    SetConsoleOutputCP(CP_UTF8);
    for (int stream = 0; stream < 3; stream++) /* of one that the caller closed the C runtime keeps the number */
        if (_get_osfhandle(stream) >= 0) _setmode(stream, _O_BINARY);
}

static BOOL WINAPI on_control(DWORD event) {
    (void)event;
    program_stop();
    return TRUE; /* it was heard */
}

void brio_program_on_stop(void (*stop)(void)) {
    program_stop = stop;
    SetConsoleCtrlHandler(on_control, TRUE);
}

static LONG WINAPI on_exception(EXCEPTION_POINTERS *facts) {
    if (facts->ExceptionRecord->ExceptionCode == EXCEPTION_IN_PAGE_ERROR) program_lost();
    return EXCEPTION_CONTINUE_SEARCH;
}

void brio_program_on_lost_page(void (*lost)(void)) {
    program_lost = lost;
    SetUnhandledExceptionFilter(on_exception);
}

bool brio_program_say(int file, const char *text) {
    return brio_write_bytes(file, text, strlen(text)) >= 0;
}

void brio_program_end(int code) {
    _exit(code);
}

/* Streams into memory there are none: a temporary file, which is removed when it is closed. */
char *brio_program_text(void (*write)(FILE *stream, void *object), void *object) {
    char *text = NULL;
    FILE *file = tmpfile();
    if (!file) return NULL;
    write(file, object);
    long size = ftell(file);
    if (!ferror(file) && size >= 0) text = malloc((size_t)size + 1);
    rewind(file);
    if (text && fread(text, 1, (size_t)size, file) != (size_t)size) {
        free(text);
        text = NULL;
    }
    if (text) text[size] = 0;
    fclose(file);
    return text;
}

bool brio_is_terminal(int file) {
    DWORD mode;
    return GetConsoleMode((HANDLE)_get_osfhandle(file), &mode);
}

int brio_terminal_columns(FILE *stream) {
    CONSOLE_SCREEN_BUFFER_INFO info;
    if (!GetConsoleScreenBufferInfo((HANDLE)_get_osfhandle(_fileno(stream)), &info)) return 0;
    return info.srWindow.Right - info.srWindow.Left + 1;
}
