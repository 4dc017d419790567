/* Faults by plan: the k-th request for memory, the k-th thread, the k-th call of the system.
 *
 * The shared library `fault` stands before the C library: loaded with LD_PRELOAD into the program, or linked with a program of
 * its own. fault.c has memory and threads, fault_calls.c the calls of the system, fault_server.c starts a program again and
 * again without loading it anew. */
#ifndef BRIO_TESTS_FAULT_H
#define BRIO_TESTS_FAULT_H

#include <stdbool.h>
#include <stdint.h>

/** What goes wrong. */
enum {
    FAULT_NONE,
    FAULT_MEMORY,    /* malloc, calloc, realloc and their like return NULL */
    FAULT_THREAD,    /* pthread_create returns EAGAIN */
    FAULT_ERROR,     /* a call of the classes `detail` fails */
    FAULT_SHORT,     /* a read or a write moves some of the bytes only */
    FAULT_INTERRUPT, /* a call that may wait returns EINTR */
    FAULT_SIGNAL,    /* the signal `detail` comes before a call */
    FAULT_CUT        /* before a call every file that is mapped to be shared is cut to nothing */
};

/** Classes of calls, for FAULT_ERROR. */
enum { FAULT_OPEN = 1, FAULT_READ = 2, FAULT_WRITE = 4, FAULT_MAP = 8, FAULT_OTHER = 16 };

/** The plan, and what came of it. In shared memory; faults.py knows the layout. */
typedef struct {
    int64_t kind, detail;
    int64_t k;       /* the call that fails, counted from 1 */
    int64_t last;    /* the last call that fails: k for one fault */
    int64_t count;   /* calls of the kind so far */
    int64_t struck;  /* faults so far */
    int64_t live;    /* blocks of memory that are not freed */
    int64_t call;    /* number of the first call that failed, as the system counts calls */
    int64_t caught;  /* whether the program handled or ignored the signal when it came */
    int64_t is_on;   /* whether calls of the system are seen at all */
    char path[1024]; /* the file of that call, where it has one */
} fault_plan;

extern fault_plan *fault;

/** Counts one call of a kind; whether it is to fail. */
bool fault_strikes(int64_t kind);

/** From now on the calls of this process pass through the plan. False where this machine cannot do that. */
bool fault_see_calls(void);

#endif
