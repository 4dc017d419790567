/* What debug and sanitizer builds do to memory that holds nothing: the sanitizers do not see into the library's own
 * mappings, which are kept and handed out again.
 *
 * Bytes that are handed out or grown into are filled with a pattern, which is no number, no index of anything and no
 * small count. Bytes that a block has given back are poisoned: the address sanitizer stops at the first touch, and in
 * other builds they hold the pattern. The memory sanitizer takes filled bytes as never written. */
#ifndef BRIO_BASE_POISON_H
#define BRIO_BASE_POISON_H

#include "base/sanitizers.h"
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <wchar.h>
#if BRIO_ASAN
#include <sanitizer/asan_interface.h>
#endif
#if BRIO_MSAN
#include <sanitizer/msan_interface.h>
#endif

#if BRIO_ASAN || BRIO_TSAN || BRIO_MSAN || !defined(NDEBUG)
#define BRIO_POISON 1
#else
#define BRIO_POISON 0
#endif

/** Makes bytes usable, with nothing in them. */
static inline void brio_poison_fill(void *bytes, size_t size) {
    if (!BRIO_POISON) return;
#if BRIO_ASAN
    ASAN_UNPOISON_MEMORY_REGION(bytes, size);
#endif
    const wchar_t pattern = 0x7ffda5a5; /* as two floats, or a double: not a number */
    uint8_t *at = bytes, *end = at + size;
    for (; at < end && (uintptr_t)at % sizeof pattern; at++) *at = 0xa5;
    wmemset((wchar_t *)(void *)at, pattern, (size_t)(end - at) / sizeof pattern);
    for (at += (size_t)(end - at) / sizeof pattern * sizeof pattern; at < end; at++) *at = 0xa5;
#if BRIO_MSAN
    __msan_allocated_memory(bytes, size);
#endif
}

/** Makes bytes unusable until they are filled or shown. */
static inline void brio_poison_hide(void *bytes, size_t size) {
    if (!BRIO_POISON) return;
    brio_poison_fill(bytes, size);
#if BRIO_ASAN
    ASAN_POISON_MEMORY_REGION(bytes, size);
#endif
}

/** Makes bytes usable as they are. */
static inline void brio_poison_show(void *bytes, size_t size) {
#if BRIO_ASAN
    ASAN_UNPOISON_MEMORY_REGION(bytes, size);
#endif
    (void)bytes, (void)size;
}

/** munmap, after which the addresses may serve others. */
static inline void brio_unmap(void *base, size_t size) {
    brio_poison_show(base, size);
    munmap(base, size);
}

#endif
