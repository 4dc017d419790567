/* Vertices by their positions, in a table with linear probing. -0 and 0 are the same position. */
#include "io/weld.h"
#include "base/memory.h"
#include "base/rng.h"
#include <string.h>

enum { FIRST_SIZE = 1 << 10 }; /* chosen */

static uint64_t hash_of(const double *point) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        double x = point[k] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        hash = brio_mix(hash ^ bits);
    }
    return hash;
}

/* Finds the slot of a position: the one that has its vertex, or the one that is free for it. */
static size_t find_slot(const brio_weld *weld, const double *vertices, const double *point) {
    size_t slot = hash_of(point) & (weld->size - 1);
    for (; weld->slots[slot]; slot = (slot + 1) & (weld->size - 1)) {
        const double *p = vertices + 3 * (size_t)(weld->slots[slot] - 1);
        if (p[0] == point[0] && p[1] == point[1] && p[2] == point[2]) break;
    }
    return slot;
}

static brio_status grow(brio_weld *weld, const brio_builder *b) {
    brio_status status = BRIO_OK;
    size_t size = weld->size ? 2 * weld->size : FIRST_SIZE;
    uint32_t *slots = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, slots, size));
    brio_release(b->ctx, weld->slots);
    *weld = (brio_weld){slots, size};
    for (size_t v = 0; v < b->mesh->num_vertices; v++)
        slots[find_slot(weld, b->mesh->vertices, b->mesh->vertices + 3 * v)] = (uint32_t)v + 1;
done:
    return status;
}

brio_status brio_weld_vertex(brio_weld *weld, brio_builder *b, const double *point, uint32_t *vertex) {
    brio_status status = BRIO_OK;
    if (2 * (b->mesh->num_vertices + 1) > weld->size) BRIO_TRY(grow(weld, b));
    size_t slot = find_slot(weld, b->mesh->vertices, point);
    if (!weld->slots[slot]) {
        BRIO_TRY(brio_builder_vertex(b, point));
        weld->slots[slot] = (uint32_t)b->mesh->num_vertices;
    }
    *vertex = weld->slots[slot] - 1;
done:
    return status;
}

void brio_weld_free(brio_context *ctx, brio_weld *weld) {
    brio_release(ctx, weld->slots);
    weld->slots = NULL;
}
