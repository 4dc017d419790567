/* Threads of Windows: slim locks and condition variables, which need no freeing. */
#include "platform/thread.h"
#include <process.h>
#include <stdint.h>
#include <windows.h>

_Static_assert(sizeof(SRWLOCK) <= sizeof(brio_mutex), "a mutex has its room");
_Static_assert(sizeof(CONDITION_VARIABLE) <= sizeof(brio_condition), "a condition has its room");

static SRWLOCK *mutex_of(brio_mutex *m) {
    return (SRWLOCK *)m->bytes;
}
static CONDITION_VARIABLE *condition_of(brio_condition *c) {
    return (CONDITION_VARIABLE *)c->bytes;
}

void brio_mutex_new(brio_mutex *m) {
    InitializeSRWLock(mutex_of(m));
}
void brio_mutex_free(brio_mutex *m) {
    (void)m;
}
void brio_mutex_lock(brio_mutex *m) {
    AcquireSRWLockExclusive(mutex_of(m));
}
void brio_mutex_unlock(brio_mutex *m) {
    ReleaseSRWLockExclusive(mutex_of(m));
}

void brio_condition_new(brio_condition *c) {
    InitializeConditionVariable(condition_of(c));
}
void brio_condition_free(brio_condition *c) {
    (void)c;
}
void brio_condition_wait(brio_condition *c, brio_mutex *m) {
    SleepConditionVariableSRW(condition_of(c), mutex_of(m), INFINITE, 0);
}
void brio_condition_wake_all(brio_condition *c) {
    WakeAllConditionVariable(condition_of(c));
}

/* --- threads --- */

static unsigned __stdcall live(void *argument) {
    brio_thread *t = argument;
    t->work(t->argument);
    return 0;
}

bool brio_thread_start(brio_thread *t, void (*work)(void *argument), void *argument, size_t stack) {
    t->work = work;
    t->argument = argument;
    uintptr_t handle = _beginthreadex(NULL, (unsigned)stack, live, t, STACK_SIZE_PARAM_IS_A_RESERVATION, NULL);
    t->handle.aligned = (void *)handle;
    return handle != 0;
}

void brio_thread_join(brio_thread *t) {
    WaitForSingleObject((HANDLE)t->handle.aligned, INFINITE);
    CloseHandle((HANDLE)t->handle.aligned);
}

int brio_processors(void) {
    DWORD_PTR own, all;
    int count = 0;
    if (GetProcessAffinityMask(GetCurrentProcess(), &own, &all))
        for (; own; own &= own - 1) count++;
    int every = (int)GetActiveProcessorCount(ALL_PROCESSOR_GROUPS); /* a mask is of one group of 64 */
    return count > 0 && count < 64 ? count : every > 0 ? every : 1;
}

long brio_process_number(void) {
    return (long)GetCurrentProcessId();
}

/* --- time --- */

void brio_yield(void) {
    SwitchToThread();
}

void brio_sleep(double seconds) {
    Sleep((DWORD)(1000 * seconds));
}

double brio_seconds(void) {
    LARGE_INTEGER ticks, a_second;
    QueryPerformanceFrequency(&a_second);
    QueryPerformanceCounter(&ticks);
    return (double)ticks.QuadPart / (double)a_second.QuadPart;
}
