/* Structs of the public interface that can grow.
 *
 * Each begins with `size_t size`, the bytes that the caller was compiled with. New fields are appended. The library
 * reads and writes no byte of the caller beyond that size, so that a program built for an older header goes on working
 * with a newer library. A program built for a newer header works with an older library as long as it leaves the fields
 * that this library does not know at zero. */
#ifndef BRIO_BASE_VERSIONED_H
#define BRIO_BASE_VERSIONED_H

#include "base/context.h"

/** Fills the caller's struct of `size` bytes with the library's defaults, a struct of `mine_size` bytes that begins with
 *  its size. Bytes beyond the library's struct become 0; the caller's size field becomes `size`. */
void brio_versioned_init(void *given, size_t size, const void *defaults, size_t mine_size);

/** Copies the caller's options over `mine`, the library's struct of `mine_size` bytes that holds the defaults. given
 *  NULL leaves the defaults.   name  of the struct, for the message.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT when the size cannot be that of such a struct, or a field that this library
 *  does not know is not 0. */
brio_status brio_versioned_take(brio_context *ctx, const void *given, void *mine, size_t mine_size, const char *name);

/** Checks the size of the struct in which the caller wants a result; NULL is accepted. Returns as brio_versioned_take. */
brio_status brio_versioned_check(brio_context *ctx, const void *given, const char *name);

/** Copies a result into the caller's struct as far as that goes: its size stays, bytes beyond the library's struct become
 *  0. Does nothing for NULL and for a size that brio_versioned_check refuses. */
void brio_versioned_give(void *given, const void *mine, size_t mine_size);

/** The public initialiser of a struct of options whose defaults are the static constant STANDARD of the file. */
#define BRIO_OPTIONS_INIT(type)                                                                                        \
    void type##_init(type *options, size_t size) {                                                                     \
        brio_versioned_init(options, size, &STANDARD, sizeof STANDARD);                                                \
    }

/** brio_versioned_take, _check and _give for a variable `mine` of type `type`. */
#define BRIO_TAKE(ctx, type, given, mine)   brio_versioned_take(ctx, given, mine, sizeof(type), #type)
#define BRIO_CHECK_RESULT(ctx, type, given) brio_versioned_check(ctx, given, #type)
#define BRIO_GIVE(type, given, mine)        brio_versioned_give(given, mine, sizeof(type))

#endif
