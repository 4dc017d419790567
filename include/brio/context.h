/* brio/context.h: status, the context of all calls, structs that grow, versions.
 * The manual begins in brio/brio.h: words, promises, rules.
 */
#ifndef BRIO_CONTEXT_H
#define BRIO_CONTEXT_H

#include <stddef.h>
#include <stdint.h>

#define BRIO_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/** What a function that can fail returns. Numbers are fixed; families have gaps. */
typedef enum brio_status {
    BRIO_OK = 0,
    /* the call */
    BRIO_ERR_ARGUMENT = 10,   /* an argument outside its documented range */
    BRIO_ERR_NOT_FINITE = 11, /* NaN or an infinity among coordinates or weights */
    /* the problem */
    BRIO_ERR_NO_ANSWER = 20, /* the input has no answer of the kind asked for, e.g. no inside found */
    BRIO_ERR_CHECK = 21,     /* a check found the object wrong */
    /* the machine */
    BRIO_ERR_NO_MEMORY = 30, /* the system or the memory limit refused memory */
    BRIO_ERR_TOO_LARGE = 31, /* more objects than indices can name */
    BRIO_ERR_CANCELLED = 32, /* the progress callback asked to stop */
    /* files */
    BRIO_ERR_OPEN = 40,   /* missing or unreadable */
    BRIO_ERR_FORMAT = 41, /* malformed, truncated, or of an unknown format */
    BRIO_ERR_WRITE = 42,  /* could not be written; nothing half-written is left behind */
    /* a fault of this library */
    BRIO_ERR_INTERNAL = 90,
    BRIO_STATUS_END
} brio_status;

/** Returns a static sentence for a status; never NULL. */
BRIO_API const char *brio_status_string(brio_status status);

/** What a failure is about, beside its status: for programs that go by it. Most failures have none. */
typedef enum brio_reason {
    BRIO_REASON_NONE = 0,
    BRIO_REASON_NO_INSIDE = 1,       /* the points, or what their poles tell, bound no solid */
    BRIO_REASON_OPEN_MESH = 2,       /* a mesh that was to bound a solid has no inside: its faces do not close */
    BRIO_REASON_NOT_CLOSED = 3,      /* a surface or a curve that was to be closed has a boundary */
    BRIO_REASON_SWALLOWED = 4,       /* an offset inwards leaves nothing */
    BRIO_REASON_NOT_TRIANGLES = 5,   /* a mesh of triangles is needed */
    BRIO_REASON_SCALE = 6,           /* what is computed is beyond doubles; scaled, the input has an answer */
    BRIO_REASON_NO_VALUE = 7,        /* no tetrahedron has so small a value */
    BRIO_REASON_ALL_HOLES = 8,       /* all faces span holes that were to be left open */
    BRIO_REASON_NO_COMPONENT = 9,    /* no component is large enough to be kept */
    BRIO_REASON_NOT_FLAT = 10,       /* the points are not in a plane */
    BRIO_REASON_UNKNOWN_FORMAT = 11, /* neither the name nor the beginning of a file tells its format */
    BRIO_REASON_END
} brio_reason;

/** Returns a short name for a reason that stays the same, such as "open_mesh"; "" for BRIO_REASON_NONE. */
BRIO_API const char *brio_reason_name(brio_reason reason);

/** What is known of a failure besides its sentence. */
typedef struct brio_failure {
    size_t size;
    brio_status status;
    brio_reason reason;
    size_t num_points; /* points that the sentence names: of these the first four are known */
    size_t points[4];  /* their indices */
    uint64_t bytes;    /* BRIO_ERR_NO_MEMORY: of the block that there was no room for; 0: not known */
} brio_failure;

/** Memory functions of the caller's choice. alloc and realloc return NULL on failure; sizes are in bytes; blocks are
 *  aligned as malloc's. Several threads may call them at a time. The context copies the struct; `user` must outlive the
 *  context. */
typedef struct brio_allocator {
    void *(*alloc)(size_t size, void *user);
    void *(*realloc)(void *block, size_t size, void *user);
    void (*free)(void *block, void *user);
    void *user;
} brio_allocator;

/** A context holds settings, the last error message, the account of memory, and threads. A context serves one call at
 *  a time; different contexts are independent. Everything made with a context must be freed before the context. */
typedef struct brio_context brio_context;

/** Makes a context.   allocator  NULL for the system's memory: large arrays then live in mappings of their own and grow
 *  without being copied.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_context_new(const brio_allocator *allocator, brio_context **out);

/** Frees a context; NULL is accepted. */
BRIO_API void brio_context_free(brio_context *ctx);

/** Returns the sentence that explains the last failure in this context, such as "point 1842: y is NaN"; "" when there
 *  was none. A call that succeeds leaves the sentence as it was, so it tells
 *  something after a failure only. Valid until the next call with the context. */
BRIO_API const char *brio_message(const brio_context *ctx);

/** Writes what is known of the failure that brio_message explains; zeros when there was none.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an impossible size). */
BRIO_API brio_status brio_last_failure(brio_context *ctx, brio_failure *out);

/** Sets the greatest number of threads that a call uses, the calling thread included. 0 (default) means every processor
 *  that the process may run on. The greatest number that counts is four for each processor, or 64 if that is more. A
 *  call creates threads when its work is large enough for them. The context keeps them, asleep, until it is freed. If
 *  the system refuses a thread, the call goes on with fewer. A child process after fork may use its copy of a context
 *  if no call was running in the parent; the child creates new threads. */
BRIO_API void brio_context_set_threads(brio_context *ctx, int threads);
/** Returns the greatest number of threads that a call uses: at least 1. A negative number was taken for 0. */
BRIO_API int brio_context_threads(const brio_context *ctx);

/** A progress callback. Long calls call it from the calling thread, many times a second, with the name of the stage and
 *  the share of the whole call that is done, in [0, 1]. Between stages they repeat what they said last; before the
 *  first stage that is "start" and 0, or what the call before said last. A result other than 0 cancels the call, which
 *  then frees everything and returns BRIO_ERR_CANCELLED: at the latest half a second of processor time after the
 *  callback would have said so, on the machines and inputs of docs/measured/reliability.md. */
typedef int (*brio_progress_fn)(const char *stage, double fraction, void *user);
/** Sets the progress callback; NULL removes it. */
BRIO_API void brio_context_set_progress(brio_context *ctx, brio_progress_fn progress, void *user);

/** Limits the memory that the context holds, in bytes. A request beyond the limit fails with BRIO_ERR_NO_MEMORY. 0
 *  removes the limit. Memory that the process' memory cgroup or the machine cannot give is refused in any case. */
BRIO_API void brio_context_set_memory_limit(brio_context *ctx, size_t bytes);

/** From now on, places large arrays in unlinked, mapped files in `folder` instead of anonymous memory. Disk space is
 *  allocated before it is touched: a full disk or a limit on the size of files is BRIO_ERR_NO_MEMORY. NULL returns to
 *  anonymous memory. A context with a caller's allocator has no scratch folder. A mapped file whose disk fails, or that
 *  somebody cuts, raises SIGBUS where it is touched next, in any thread: the library handles no signals, the host may.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_OPEN (not a writable folder, such as an empty name),
 *  BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_context_set_scratch(brio_context *ctx, const char *folder);

/** Returns the bytes that objects and running calls of this context hold now. */
BRIO_API size_t brio_context_memory(const brio_context *ctx);
/** Returns the most bytes that the context ever held. */
BRIO_API size_t brio_context_memory_peak(const brio_context *ctx);

/* Structs that grow. Structs of options, statistics and results begin with `size`, the bytes that the caller was
 * compiled with, so that later versions can append fields: the library touches no byte beyond `size`.
 *   - Options:  brio_surface_options o = {.method = BRIO_SURFACE_COCONE};   A field of 0 is its default, and NULL in
 *     place of options stands for all defaults. The default of a seed is 1.
 *   - Statistics and results:  brio_surface_stats stats = {0};
 *   - A `size` of 0 stands for the fields that the struct had in version 0.3. Fields that came later say so; a program
 *     that uses one of them sets the size:  {.size = sizeof o, ...}. The library ignores them without it.
 *   - Structs that the library made (brio_mesh, brio_delaunay_stats) are as long as their `size`: a program that may
 *     run with an older library looks at it before it reads a field that the older version did not have.
 * An impossible `size`, as of a struct that was not set to zeros, is BRIO_ERR_ARGUMENT. Fields whose names begin with
 * `reserved` stay 0. Elements of arrays (brio_tetrahedron, brio_round, brio_property) and brio_allocator, brio_edges,
 * brio_incidences, brio_edge_walk never change. */

/* Versions. docs/versions.md says what stays the same from one version to the next. */

#define BRIO_VERSION_MAJOR 0
#define BRIO_VERSION_MINOR 3
#define BRIO_VERSION_PATCH 0
#define BRIO_VERSION       "0.3.0"
/** The version of this header as one number that grows: 10000 MAJOR + 100 MINOR + PATCH. */
#define BRIO_VERSION_NUMBER (10000 * BRIO_VERSION_MAJOR + 100 * BRIO_VERSION_MINOR + BRIO_VERSION_PATCH)

/** Returns the version of the library that runs, as BRIO_VERSION; it may be newer than this header. */
BRIO_API const char *brio_version(void);
/** Returns the version of the library that runs, as BRIO_VERSION_NUMBER. */
BRIO_API int brio_version_number(void);

#ifdef __cplusplus
}
#endif
#endif
