/* Binary heaps in arrays, of any items. Includers define first
 *   HEAP_ITEM               the type of an item,
 *   HEAP_ABOVE(a, b, user)  whether item a belongs above item b,
 *   HEAP_DOWN, HEAP_UP      the names of the two functions.
 * Both put an item into a heap that has a hole, and move the hole.
 *
 * Based on: Williams. Algorithm 232: Heapsort. Communications of the ACM 1964. */
#include <stddef.h>

/* Moves the hole at `hole` down, in a heap of n places, until the item fits. */
static inline void HEAP_DOWN(HEAP_ITEM *heap, size_t hole, size_t n, HEAP_ITEM item, const void *user) {
    (void)user;
    for (size_t child; (child = 2 * hole + 1) < n; hole = child) {
        if (child + 1 < n && HEAP_ABOVE(heap[child + 1], heap[child], user)) child++;
        if (!HEAP_ABOVE(heap[child], item, user)) break;
        heap[hole] = heap[child];
    }
    heap[hole] = item;
}

/* Moves the hole at `hole` up until the item fits. */
static inline void HEAP_UP(HEAP_ITEM *heap, size_t hole, HEAP_ITEM item, const void *user) {
    (void)user;
    for (; hole > 0 && HEAP_ABOVE(item, heap[(hole - 1) / 2], user); hole = (hole - 1) / 2)
        heap[hole] = heap[(hole - 1) / 2];
    heap[hole] = item;
}

#undef HEAP_ITEM
#undef HEAP_ABOVE
#undef HEAP_DOWN
#undef HEAP_UP
