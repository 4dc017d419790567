/* Memory and threads that are refused by plan. */
#define _GNU_SOURCE
#include "fault.h"
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *block);

static fault_plan own;
fault_plan *fault = &own;

bool fault_strikes(int64_t kind) {
    if (fault->kind != kind) return false;
    int64_t n = __atomic_add_fetch(&fault->count, 1, __ATOMIC_RELAXED);
    if (n < fault->k || n > fault->last) return false;
    __atomic_add_fetch(&fault->struck, 1, __ATOMIC_RELAXED);
    return true;
}

/* --- memory --- */

static bool refused(void) {
    if (!fault_strikes(FAULT_MEMORY)) return false;
    errno = ENOMEM;
    return true;
}

static void *counted(void *block) {
    if (block) __atomic_add_fetch(&fault->live, 1, __ATOMIC_RELAXED);
    return block;
}

void *malloc(size_t size) {
    return refused() ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t count, size_t size) {
    return refused() ? NULL : counted(__libc_calloc(count, size));
}

void *realloc(void *block, size_t size) {
    if (refused()) return NULL;
    void *moved = __libc_realloc(block, size);
    return block ? moved : counted(moved);
}

void *memalign(size_t alignment, size_t size) {
    return refused() ? NULL : counted(__libc_memalign(alignment, size));
}

void *aligned_alloc(size_t alignment, size_t size) {
    return memalign(alignment, size);
}

int posix_memalign(void **out, size_t alignment, size_t size) {
    void *block = memalign(alignment, size);
    if (block) *out = block;
    return block ? 0 : ENOMEM;
}

void free(void *block) {
    if (block) __atomic_sub_fetch(&fault->live, 1, __ATOMIC_RELAXED);
    __libc_free(block);
}

/* --- threads --- */

typedef int (*create_fn)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument) {
    static create_fn create;
    if (!create) create = (create_fn)dlsym(RTLD_NEXT, "pthread_create");
    return fault_strikes(FAULT_THREAD) ? EAGAIN : create(thread, attributes, start, argument);
}
