/* What a completion has met: names of points, and tetrahedra that were asked for. */
#ifndef BRIO_COMPLETION_KNOWN_H
#define BRIO_COMPLETION_KNOWN_H

#include "base/context.h"

/** Numbers of points by name: a hash table. */
typedef struct {
    uint64_t *name;
    uint8_t *taken;
    size_t size, count; /* size: a power of two, or 0 */
} brio_names_met;

/** Enters a name.   is_new  receives whether the table did not have it.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_names_enter(brio_context *ctx, brio_names_met *t, uint64_t name, bool *is_new);

/** Frees a table, which is then an empty one. */
void brio_names_met_free(brio_context *ctx, brio_names_met *t);

/** A tetrahedron as the ascending indices of its vertices; BRIO_INFINITE is the greatest. */
typedef struct {
    uint32_t v[4];
} brio_tet_key;

/** A list of tetrahedra, and their hash table. */
typedef struct {
    brio_tet_key *list;
    size_t count, capacity;
    uint32_t *slot; /* 1 + place in the list; 0 is empty */
    size_t size;    /* of the table */
} brio_tet_set;

/** Returns the key of a tetrahedron.   vertex  in any order. */
brio_tet_key brio_tet_key_of(const uint32_t vertex[4]);

/** Appends a tetrahedron to the list, whose table does not know it yet. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_tet_list_add(brio_context *ctx, brio_tet_set *s, const brio_tet_key *key);

/** Makes the table of the list. What is appended later, the table knows when it is made again.
 *
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_tet_set_index(brio_context *ctx, brio_tet_set *s);

/** Returns whether the table has a tetrahedron. */
bool brio_tet_set_has(const brio_tet_set *s, const brio_tet_key *key);

/** Frees list and table. */
void brio_tet_set_free(brio_context *ctx, brio_tet_set *s);

#endif
