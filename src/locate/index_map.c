/* A small map from keys to numbers, see index_map.h. */
#include "locate/index_map.h"
#include <string.h>

enum { FIRST_CAPACITY = 256 };

brio_status brio_map_grow(brio_context *ctx, brio_index_map *map) {
    brio_index_map larger = {.capacity = map->capacity ? 2 * map->capacity : FIRST_CAPACITY, .generation = 1};
    brio_status status = BRIO_ALLOC_ZERO(ctx, larger.entry, larger.capacity);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < map->capacity; i++) {
        if (map->entry[i].generation != map->generation) continue;
        brio_map_entry *e = &larger.entry[brio_map_place(&larger, map->entry[i].key)];
        *e = (brio_map_entry){map->entry[i].key, 1, map->entry[i].value};
        larger.size++;
    }
    brio_release(ctx, map->entry);
    *map = larger;
    return BRIO_OK;
}

void brio_map_clear(brio_index_map *map) {
    map->size = 0;
    if (!map->capacity || ++map->generation) return;
    memset(map->entry, 0, map->capacity * sizeof *map->entry);
    map->generation = 1;
}
