/* Structs of the public interface that can grow.
 *
 * Each struct begins with `size_t size`, the bytes of the struct that the caller was compiled with. New fields are
 * appended. The library reads and writes no byte of the caller beyond `size`, so a program built for an older header
 * works with a newer library. A program built for a newer header works with an older library if the fields unknown to
 * that library are zero. */
#ifndef BRIO_BASE_VERSIONED_H
#define BRIO_BASE_VERSIONED_H

#include "base/context.h"
#include <stddef.h>

/** Fills the caller's struct of `size` bytes with defaults, a struct of `mine_size` bytes. Bytes beyond the library's
 *  struct become 0. The caller's field `size` becomes `size`. */
void brio_versioned_init(void *given, size_t size, const void *defaults, size_t mine_size);

/** Copies the caller's options over the library's struct `mine`, which holds the defaults. given NULL leaves the
 *  defaults.
 *  name  of the struct, for the message.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT if the size is impossible or an unknown field is not 0. */
brio_status brio_versioned_take(brio_context *ctx, const void *given, void *mine, size_t mine_size, const char *name);

/** Checks the size of the struct that the caller passed for a result; NULL is accepted.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT if the size is impossible. */
brio_status brio_versioned_check(brio_context *ctx, const void *given, const char *name);

/** Does what brio_versioned_check does for a result that owns memory and is never NULL. The size must be at least `least`: then
 *  the struct has all fields by which the result is freed. */
brio_status brio_versioned_check_owner(brio_context *ctx, const void *given, size_t least, const char *name);

/** Returns whether the caller's struct has `least` bytes, and a size that brio_versioned_check accepts. */
bool brio_versioned_reaches(const void *given, size_t least);

/** Copies a result into the caller's struct, up to the caller's size, which stays. Bytes beyond the library's struct
 *  become 0. Does nothing for NULL or a size that brio_versioned_check refuses. */
void brio_versioned_give(void *given, const void *mine, size_t mine_size);

/** Defines the public initialiser of a struct of options. Its defaults are the file's static constant STANDARD. */
#define BRIO_OPTIONS_INIT(type)                                                                                        \
    void type##_init(type *options, size_t size) {                                                                     \
        brio_versioned_init(options, size, &STANDARD, sizeof STANDARD);                                                \
    }

/** brio_versioned_take, _check and _give for a variable `mine` of type `type`. */
#define BRIO_TAKE(ctx, type, given, mine)   brio_versioned_take(ctx, given, mine, sizeof(type), #type)
#define BRIO_CHECK_RESULT(ctx, type, given) brio_versioned_check(ctx, given, #type)
#define BRIO_GIVE(type, given, mine)        brio_versioned_give(given, mine, sizeof(type))

/** For a result that owns memory: `last` is the last of its fields by which it is freed. */
#define BRIO_END_OF(type, field)                 (offsetof(type, field) + sizeof(((type *)0)->field))
#define BRIO_CHECK_OWNER(ctx, type, given, last) brio_versioned_check_owner(ctx, given, BRIO_END_OF(type, last), #type)
#define BRIO_OWNS(type, given, last)             brio_versioned_reaches(given, BRIO_END_OF(type, last))

#endif
