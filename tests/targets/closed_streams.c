/* closed_streams.exe PROGRAM [ARGUMENT ...]: runs a program of Windows without standard streams, as services and detached programs are, and
 * ends with its status. It asks for kernel32 alone, so that no C library has to be compiled for it. */
#include <windows.h>

static DWORD run(void) {
    wchar_t *line = GetCommandLineW();
    for (wchar_t end = *line == '"' ? *line++ : ' '; *line && *line != end; line++) {}
    if (*line == '"') line++; /* the next quote is the program's */
    while (*line == ' ') line++;
    static STARTUPINFOW start = {.cb = sizeof start, .dwFlags = STARTF_USESTDHANDLES};
    PROCESS_INFORMATION program;
    DWORD status = 1;
    if (!CreateProcessW(NULL, line, NULL, NULL, FALSE, DETACHED_PROCESS, NULL, NULL, &start, &program)) return 126;
    WaitForSingleObject(program.hProcess, INFINITE);
    GetExitCodeProcess(program.hProcess, &status);
    return status;
}

void wWinMainCRTStartup(void) {
    ExitProcess(run());
}
