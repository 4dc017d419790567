/* Hash tables with linear probing: see known.h. */
#include "completion/known.h"
#include "base/memory.h"
#include "base/rng.h"
#include <string.h>

/* --- names --- */

static size_t place_of(const brio_names_met *t, uint64_t name) {
    size_t at = brio_mix(name) & (t->size - 1);
    while (t->taken[at] && t->name[at] != name) at = (at + 1) & (t->size - 1);
    return at;
}

static brio_status grow(brio_context *ctx, brio_names_met *t) {
    brio_names_met old = *t, new = {.size = old.size ? 2 * old.size : 1024, .count = old.count};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, new.name, new.size));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, new.taken, new.size));
    for (size_t i = 0; i < old.size; i++) {
        if (!old.taken[i]) continue;
        size_t at = place_of(&new, old.name[i]);
        new.name[at] = old.name[i];
        new.taken[at] = 1;
    }
    *t = new;
    new = old;
done:
    brio_names_met_free(ctx, &new);
    return status;
}

brio_status brio_names_enter(brio_context *ctx, brio_names_met *t, uint64_t name, bool *is_new) {
    if (2 * t->count >= t->size) BRIO_FORWARD(grow(ctx, t));
    size_t at = place_of(t, name);
    *is_new = !t->taken[at];
    t->count += *is_new;
    t->taken[at] = 1;
    t->name[at] = name;
    return BRIO_OK;
}

void brio_names_met_free(brio_context *ctx, brio_names_met *t) {
    brio_release(ctx, t->name);
    brio_release(ctx, t->taken);
    *t = (brio_names_met){0};
}

/* --- tetrahedra --- */

static void order_two(uint32_t *a, uint32_t *b) {
    uint32_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
    *a = low, *b = high;
}

brio_tet_key brio_tet_key_of(const uint32_t vertex[4]) {
    brio_tet_key key;
    uint32_t *v = key.v;
    memcpy(v, vertex, sizeof key.v);
    order_two(&v[0], &v[1]), order_two(&v[2], &v[3]);
    order_two(&v[0], &v[2]), order_two(&v[1], &v[3]);
    order_two(&v[1], &v[2]);
    return key;
}

brio_status brio_tet_list_add(brio_context *ctx, brio_tet_set *s, const brio_tet_key *key) {
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->list, s->capacity, s->count + 1));
    s->list[s->count++] = *key;
    return BRIO_OK;
}

static size_t slot_of(const brio_tet_set *s, const brio_tet_key *key) {
    uint64_t low = (uint64_t)key->v[0] << 32 | key->v[1], high = (uint64_t)key->v[2] << 32 | key->v[3];
    size_t at = brio_mix(brio_mix(low) + high) & (s->size - 1);
    while (s->slot[at] && memcmp(&s->list[s->slot[at] - 1], key, sizeof *key)) at = (at + 1) & (s->size - 1);
    return at;
}

brio_status brio_tet_set_index(brio_context *ctx, brio_tet_set *s) {
    size_t size = 64;
    BRIO_EXPECT(ctx, s->count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu tetrahedra asked for at a time", s->count);
    while (size < 2 * s->count) size *= 2;
    brio_release(ctx, s->slot);
    s->size = 0;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, s->slot, size));
    s->size = size;
    for (size_t i = 0; i < s->count; i++) s->slot[slot_of(s, &s->list[i])] = (uint32_t)i + 1;
    return BRIO_OK;
}

bool brio_tet_set_has(const brio_tet_set *s, const brio_tet_key *key) {
    return s->size && s->slot[slot_of(s, key)] != 0;
}

void brio_tet_set_free(brio_context *ctx, brio_tet_set *s) {
    brio_release(ctx, s->list);
    brio_release(ctx, s->slot);
    *s = (brio_tet_set){0};
}
