/* Page touches: which pages of the records, the tetrahedra and the history an insertion reads and writes, and how many
 * other pages were touched since each was touched before. */
#ifndef BRIO_LABORATORY_PAGE_TOUCHES_H
#define BRIO_LABORATORY_PAGE_TOUCHES_H

#include "brio/laboratory.h"
#include "triangulation/inserter.h"

/** The arrays that are counted: records and tetrahedra of a store, two for each level of a hierarchy; the history. */
enum { BRIO_TOUCH_RECORDS = 0, BRIO_TOUCH_TETRAHEDRA = 1, BRIO_TOUCH_HISTORY = 30, BRIO_TOUCHED_ARRAYS = 31 };

/** Caches of 2^0, 2^1, ... pages that faults are told for. */
enum { BRIO_TOUCH_CACHES = 33 };

typedef struct brio_page_touches brio_page_touches;

/** What an inserter's searches are counted with: its store's records are array `first`, its tetrahedra the one
 *  after. */
typedef struct {
    brio_watch watch; /* first, so that the watch of a walk is the view */
    brio_page_touches *counts;
    int first;
} brio_touch_view;

/** Starts to count. page_bytes is a power of two. The cache holds cache_bytes / page_bytes pages, at least one. */
brio_status brio_page_touches_new(brio_context *ctx, uint64_t page_bytes, uint64_t cache_bytes,
                                  brio_page_touches **out);
/** Frees the counts; NULL is accepted. */
void brio_page_touches_free(brio_page_touches *t);

/** Counts a touch of the byte at an offset of an array. */
void brio_touch(brio_page_touches *t, int array, uint64_t offset);

/** Returns BRIO_OK, or why touches could not be counted. */
brio_status brio_page_touches_status(const brio_page_touches *t);

/** Writes the totals into the statistics. */
void brio_page_touches_total(const brio_page_touches *t, brio_laboratory_stats *stats);

/** Sets faults[k] to the faults in a cache of 2^k pages, up to the first that holds all pages. Returns the number of
 *  caches. */
size_t brio_page_touches_faults(const brio_page_touches *t, uint64_t faults[BRIO_TOUCH_CACHES]);

/** Makes the inserter count page touches from now on, in the view, which stays where it is.   counts  NULL: none. */
void brio_count_touches(brio_inserter *ins, brio_touch_view *view, brio_page_touches *counts, int first);

/** Counts what the insertion of p has read and written, where the inserter counts. A strategy's `filled` begins with
 *  this. */
brio_status brio_count_insertion(brio_inserter *ins, uint32_t p);

/** Returns the view that an inserter counts with, or NULL. */
static inline const brio_touch_view *brio_touches_of(const brio_inserter *ins) {
    return (const brio_touch_view *)ins->walk.watch;
}

static inline void brio_touch_record(const brio_touch_view *view, uint32_t record) {
    if (view) brio_touch(view->counts, view->first + BRIO_TOUCH_RECORDS, (uint64_t)record * sizeof(brio_record));
}

#endif
