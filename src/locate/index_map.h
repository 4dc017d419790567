/* A small map from keys to numbers, for sets that are built and forgotten once a query. Open addressing; a clear is one
 * step, because each entry knows the generation that wrote it. */
#ifndef BRIO_LOCATE_INDEX_MAP_H
#define BRIO_LOCATE_INDEX_MAP_H

#include "base/memory.h"

typedef struct {
    uint64_t key;
    uint32_t generation, value;
} brio_map_entry;

/** I1  The entries whose generation is the map's are in use; at most half of the entries are. */
typedef struct {
    brio_map_entry *entry;
    size_t capacity, size; /* capacity: 0 or a power of two */
    uint32_t generation;   /* not 0 once there are entries */
} brio_index_map;

/** Grows the map so that one more key fits. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_map_grow(brio_context *ctx, brio_index_map *map);

/** Forgets all keys. */
void brio_map_clear(brio_index_map *map);

static inline size_t brio_map_place(const brio_index_map *map, uint64_t key) {
    size_t i = (size_t)((key * UINT64_C(0x9e3779b97f4a7c15)) >> 32) & (map->capacity - 1);
    while (map->entry[i].generation == map->generation && map->entry[i].key != key) i = (i + 1) & (map->capacity - 1);
    return i;
}

/** Sets *value to where the number of a key is kept; a new key has the number `fresh`, and *is_new is set. The pointer is
 *  valid until the next call.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
static inline brio_status brio_map_find(brio_context *ctx, brio_index_map *map, uint64_t key, uint32_t fresh,
                                        uint32_t **value, bool *is_new) {
    if (2 * map->size >= map->capacity) {
        brio_status status = brio_map_grow(ctx, map);
        if (status != BRIO_OK) return status;
    }
    brio_map_entry *e = &map->entry[brio_map_place(map, key)];
    if ((*is_new = e->generation != map->generation)) {
        *e = (brio_map_entry){key, map->generation, fresh};
        map->size++;
    }
    *value = &e->value;
    return BRIO_OK;
}

#endif
