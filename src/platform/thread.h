/* Threads, what they wait at, processors, and time. The functions of one name behave alike on every system.
 *
 * A system without threads (WebAssembly) starts none: brio_thread_start returns false there, and the caller works on
 * alone. Locks are then no work.
 *
 * The room platform/ holds all that depends on the operating system: a header for each subject, the manual; and
 * beside it files of the same functions, _posix.c (Linux, macOS, musl, and what WASI has of POSIX), _windows.c and
 * _wasi.c. No other room asks which system it is. A function that fails returns what its comment says, and errno
 * gives the reason. */
#ifndef BRIO_PLATFORM_THREAD_H
#define BRIO_PLATFORM_THREAD_H

#include <stdbool.h>
#include <stddef.h>

/** A lock that one thread holds at a time, and a condition that threads sleep on: room for those of any system. */
typedef union {
    void *aligned;
    unsigned char bytes[64];
} brio_mutex;
typedef union {
    void *aligned;
    unsigned char bytes[64];
} brio_condition;

void brio_mutex_new(brio_mutex *m);
void brio_mutex_free(brio_mutex *m);
void brio_mutex_lock(brio_mutex *m);
void brio_mutex_unlock(brio_mutex *m);

void brio_condition_new(brio_condition *c);
void brio_condition_free(brio_condition *c);
/** Unlocks m, sleeps until woken, maybe without a reason, and locks m again. */
void brio_condition_wait(brio_condition *c, brio_mutex *m);
void brio_condition_wake_all(brio_condition *c);

/** A thread. The struct stays where it is until brio_thread_join. */
typedef struct {
    void (*work)(void *argument);
    void *argument;
    union {
        void *aligned;
        unsigned char bytes[16];
    } handle;
} brio_thread;

/** Starts a thread that calls work(argument).   stack  bytes of its stack.
 *  The thread takes no signals, so the host's handlers run in the host's threads, except those that its own work can
 *  raise: a thread that blocks such a signal ends the process when it raises one, whatever handler the host has.
 *  Returns whether the system created it. */
bool brio_thread_start(brio_thread *t, void (*work)(void *argument), void *argument, size_t stack);

/** Waits until the thread's work has returned. */
void brio_thread_join(brio_thread *t);

/** Returns the number of processors that this process may run on, at least 1. */
int brio_processors(void);

/** Returns a number of this process that its children by fork do not have. */
long brio_process_number(void);

/** Lets another thread run. */
void brio_yield(void);

/** Sleeps; a signal ends it early. */
void brio_sleep(double seconds);

/** Returns the seconds of a monotonic clock. */
double brio_seconds(void);

#endif
