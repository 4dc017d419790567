/* A hash table of sets of four numbers, with linear probing.
 *
 * Based on: Knuth. The art of computer programming, volume 3. 1973, section 6.4 (linear probing). */
#include "offset/work.h"
#include "base/rng.h"
#include <string.h>

brio_status brio_seen_new(brio_context *ctx, size_t count, brio_seen *out) {
    *out = (brio_seen){.places = 16};
    while (out->places < 2 * count) out->places *= 2;
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->key, out->places));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->value, out->places));
    for (size_t i = 0; i < out->places; i++) out->key[i][0] = BRIO_SEEN_NONE;
    return BRIO_OK;
}

void brio_seen_free(brio_context *ctx, brio_seen *seen) {
    brio_release(ctx, seen->key);
    brio_release(ctx, seen->value);
    *seen = (brio_seen){0};
}

static void sort_key(const uint32_t set[4], uint32_t *key) {
    memcpy(key, set, 4 * sizeof *key);
    for (int i = 1; i < 4; i++)
        for (int j = i; j > 0 && key[j] < key[j - 1]; j--) {
            uint32_t swap = key[j];
            key[j] = key[j - 1];
            key[j - 1] = swap;
        }
}

/* Returns the place of a key, or the empty place where it would be. */
static size_t place_of(const brio_seen *seen, const uint32_t *key) {
    uint64_t hash = brio_mix((uint64_t)key[0] << 32 | key[1]);
    size_t i = (size_t)brio_mix(hash ^ ((uint64_t)key[2] << 32 | key[3])) & (seen->places - 1);
    while (seen->key[i][0] != BRIO_SEEN_NONE && memcmp(seen->key[i], key, sizeof seen->key[i]) != 0)
        i = (i + 1) & (seen->places - 1);
    return i;
}

const uint8_t *brio_seen_find(const brio_seen *seen, const uint32_t set[4]) {
    uint32_t key[4];
    if (!seen->places) return NULL;
    sort_key(set, key);
    size_t i = place_of(seen, key);
    return seen->key[i][0] == BRIO_SEEN_NONE ? NULL : &seen->value[i];
}

void brio_seen_add(brio_seen *seen, const uint32_t set[4], uint8_t value) {
    uint32_t key[4];
    sort_key(set, key);
    size_t i = place_of(seen, key);
    memcpy(seen->key[i], key, sizeof key);
    seen->value[i] = value;
}
