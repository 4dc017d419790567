/* Memory without contents in debug and sanitizer builds. The sanitizers do not see inside the library's own mappings,
 * which are kept and reused.
 *
 * Bytes of new blocks, and bytes by which blocks grow, are filled with a pattern that is no number, no valid index and
 * no small count. Bytes that a block has given back are poisoned: the address sanitizer stops at the first access, and
 * in other builds they hold the pattern. The memory sanitizer treats filled bytes as uninitialised. */
#ifndef BRIO_BASE_POISON_H
#define BRIO_BASE_POISON_H

#include "base/sanitizers.h"
#include <stddef.h>
#include <stdint.h>
#include <string.h>
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

/** Makes bytes usable and fills them with the pattern. */
static inline void brio_poison_fill(void *bytes, size_t size) {
    if (!BRIO_POISON) return;
#if BRIO_ASAN
    ASAN_UNPOISON_MEMORY_REGION(bytes, size);
#endif
    const wchar_t pattern = 0x7ffda5a5; /* two floats or a double of these bytes are NaN */
    uint8_t *at = bytes, *end = at + size;
    for (; at < end && (uintptr_t)at % sizeof pattern; at++) *at = 0xa5;
    wmemset((wchar_t *)(void *)at, pattern, (size_t)(end - at) / sizeof pattern);
    for (at += (size_t)(end - at) / sizeof pattern * sizeof pattern; at < end; at++) *at = 0xa5;
#if BRIO_MSAN
    __msan_allocated_memory(bytes, size);
#endif
}

/** Makes bytes unusable until brio_poison_fill or brio_poison_show. */
static inline void brio_poison_hide(void *bytes, size_t size) {
    if (!BRIO_POISON) return;
    brio_poison_fill(bytes, size);
#if BRIO_ASAN
    ASAN_POISON_MEMORY_REGION(bytes, size);
#endif
}

/** Makes bytes usable and leaves them as they are. */
static inline void brio_poison_show(void *bytes, size_t size) {
#if BRIO_ASAN
    ASAN_UNPOISON_MEMORY_REGION(bytes, size);
#endif
    (void)bytes, (void)size;
}

#endif
