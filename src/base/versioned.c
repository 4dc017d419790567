/* Structs of the public interface that can grow: see versioned.h.
 *
 * Based on: the system calls clone3 and openat2 of Linux, which copy structs of any size. */
#include "base/versioned.h"
#include <assert.h>
#include <string.h>

/* Chosen: no struct of this interface is larger, in any version. A larger size means a struct that was not
 * initialised. */
enum { MOST_BYTES = 4096 };

/* Returns the size that the caller gave; 0 stands for the first fields. */
static size_t size_of(const void *given, const brio_layout *layout) {
    size_t size;
    memcpy(&size, given, sizeof size);
    return size ? size : layout->first;
}

static bool is_plausible(size_t size) {
    return size > sizeof size && size <= MOST_BYTES;
}

static bool all_zero(const void *bytes, size_t from, size_t to) {
    for (size_t i = from; i < to; i++)
        if (((const unsigned char *)bytes)[i]) return false;
    return true;
}

static void copy_fields(void *to, size_t to_size, const void *from, size_t from_size) {
    size_t common = to_size < from_size ? to_size : from_size;
    if (common > sizeof(size_t))
        memcpy((char *)to + sizeof(size_t), (const char *)from + sizeof(size_t), common - sizeof(size_t));
}

brio_status brio_versioned_check(brio_context *ctx, const void *given, const brio_layout *layout) {
    if (!given) return BRIO_OK;
    size_t size = size_of(given, layout);
    if (is_plausible(size)) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "%s.size is %zu: set the struct to zeros, or its size to sizeof(%s)",
                     layout->name, size, layout->name);
}

bool brio_versioned_reaches(const void *given, size_t least, const brio_layout *layout) {
    size_t size = size_of(given, layout);
    return is_plausible(size) && size >= least;
}

brio_status brio_versioned_check_owner(brio_context *ctx, const void *given, size_t least, const brio_layout *layout) {
    if (brio_versioned_reaches(given, least, layout)) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "%s.size is %zu: set the struct to zeros, or its size to sizeof(%s)",
                     layout->name, size_of(given, layout), layout->name);
}

brio_status brio_versioned_take(brio_context *ctx, const void *given, void *mine, const brio_layout *layout) {
    if (!given) return BRIO_OK;
    brio_status status = brio_versioned_check(ctx, given, layout);
    if (status != BRIO_OK) return status;
    size_t size = size_of(given, layout);
    assert(is_plausible(layout->size) && layout->first <= layout->size);
    if (size > layout->size && !all_zero(given, layout->size, size))
        return brio_fail(ctx, BRIO_ERR_ARGUMENT, "%s sets a field that this version of the library does not know",
                         layout->name);
    copy_fields(mine, layout->size, given, size);
    return BRIO_OK;
}

void brio_versioned_give(void *given, const void *mine, const brio_layout *layout) {
    assert(is_plausible(layout->size) && layout->first <= layout->size);
    size_t size = given ? size_of(given, layout) : 0;
    if (!is_plausible(size)) return;
    memset((char *)given + sizeof size, 0, size - sizeof size);
    copy_fields(given, size, mine, layout->size);
}
