/* The sanitizers of this build: each macro is 1 or 0. */
#ifndef BRIO_BASE_SANITIZERS_H
#define BRIO_BASE_SANITIZERS_H

#if defined(__has_feature)
#define BRIO_HAS_FEATURE(x) __has_feature(x)
#else
#define BRIO_HAS_FEATURE(x) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || BRIO_HAS_FEATURE(address_sanitizer)
#define BRIO_ASAN 1
#else
#define BRIO_ASAN 0
#endif
#if defined(__SANITIZE_THREAD__) || BRIO_HAS_FEATURE(thread_sanitizer)
#define BRIO_TSAN 1
#else
#define BRIO_TSAN 0
#endif
#define BRIO_MSAN BRIO_HAS_FEATURE(memory_sanitizer)

#endif
