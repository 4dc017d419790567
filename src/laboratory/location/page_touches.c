/* Counts page touches with their distances in the stack of least recently used pages.
 *
 * The distance of a touch is the number of other pages that were touched since the same page was touched before. A
 * cache of C pages that drops the least recently used one misses exactly the first touches and those of distance C and
 * more. So one run tells the faults of all caches. Each page keeps the time of its last touch; a tree of partial sums
 * over the times, in which the last touches count 1 and all others 0, tells a distance in O(log #pages). When the times
 * are used up, the last touches are numbered anew, from 1 on.
 *
 * What is counted depends on the sequence of insertions alone, not on the machine: an address is an offset into an
 * array.
 *
 * Based on: Mattson, Gecsei, Slutz, Traiger. Evaluation techniques for storage hierarchies. IBM Systems Journal 1970.
 *           Olken. Efficient methods for calculating the success function of fixed-space replacement policies. 1981. */
#include "laboratory/location/page_touches.h"
#include "base/memory.h"

typedef struct {
    uint32_t array, page;
} page_name;

struct brio_page_touches {
    brio_context *ctx;
    int shift;                           /* a page has 2^shift bytes */
    uint64_t cache_pages;                /* of the cache whose faults are counted one by one */
    uint32_t *last[BRIO_TOUCHED_ARRAYS]; /* of each page, the time of its last touch; 0: none */
    size_t capacity[BRIO_TOUCHED_ARRAYS];
    page_name *touched; /* the page of each time, from 1 on */
    uint32_t *sum;      /* partial sums over the times [Fenwick 1994] */
    uint32_t now, times;
    uint64_t pages, touches, faults;
    uint64_t far[BRIO_TOUCH_CACHES + 1]; /* touches of distance 0; of those in [2^(k - 1), 2^k) */
    brio_status status;
};

enum { FIRST_TIMES = 1 << 12 };

static void add(brio_page_touches *t, uint32_t time, uint32_t what) {
    for (; time <= t->times; time += time & -time) t->sum[time] += what;
}

static uint32_t marks_up_to(const brio_page_touches *t, uint32_t time) {
    uint32_t sum = 0;
    for (; time > 0; time -= time & -time) sum += t->sum[time];
    return sum;
}

/* Makes room for `times` times. */
static brio_status reserve_times(brio_page_touches *t, uint32_t times) {
    BRIO_EXPECT(t->ctx, times < UINT32_C(1) << 31, BRIO_ERR_TOO_LARGE, "page touches of more than 2^30 pages");
    BRIO_FORWARD(BRIO_RESIZE(t->ctx, t->touched, (size_t)times + 1));
    BRIO_FORWARD(BRIO_RESIZE(t->ctx, t->sum, (size_t)times + 1));
    t->times = times;
    return BRIO_OK;
}

/* Numbers the last touches anew. At least half of the times are free afterwards. */
static brio_status renumber(brio_page_touches *t) {
    uint32_t count = 0;
    for (uint32_t time = 1; time <= t->now; time++) {
        page_name name = t->touched[time];
        uint32_t *last = &t->last[name.array][name.page];
        if (*last != time) continue;
        t->touched[++count] = name;
        *last = count;
    }
    if (count > t->times / 2) {
        brio_status status = reserve_times(t, 2 * t->times);
        if (status != BRIO_OK) return status;
    }
    t->now = count;
    for (uint32_t time = 1; time <= t->times; time++) t->sum[time] = 0;
    for (uint32_t time = 1; time <= count; time++) add(t, time, 1);
    return BRIO_OK;
}

brio_status brio_page_touches_new(brio_context *ctx, uint64_t page_bytes, uint64_t cache_bytes,
                                  brio_page_touches **out) {
    brio_page_touches *t = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t, 1));
    t->ctx = ctx;
    t->shift = __builtin_ctzll(page_bytes);
    t->cache_pages = cache_bytes >> t->shift ? cache_bytes >> t->shift : 1;
    BRIO_TRY(reserve_times(t, FIRST_TIMES));
    BRIO_TRY(renumber(t));
    *out = t;
    t = NULL;
done:
    brio_page_touches_free(t);
    return status;
}

void brio_page_touches_free(brio_page_touches *t) {
    if (!t) return;
    for (int a = 0; a < BRIO_TOUCHED_ARRAYS; a++) brio_release(t->ctx, t->last[a]);
    brio_release(t->ctx, t->touched);
    brio_release(t->ctx, t->sum);
    brio_release(t->ctx, t);
}

/* Makes a page of an array known. */
static brio_status reserve_page(brio_page_touches *t, int array, uint64_t page) {
    size_t old = t->capacity[array];
    BRIO_EXPECT(t->ctx, page < UINT32_MAX, BRIO_ERR_TOO_LARGE, "page touches of more than 2^32 pages");
    BRIO_FORWARD(BRIO_RESERVE(t->ctx, t->last[array], t->capacity[array], page + 1));
    for (size_t i = old; i < t->capacity[array]; i++) t->last[array][i] = 0;
    return BRIO_OK;
}

/* Counts a touch of a page that `distance` others were touched since, or that was never touched. */
static void count(brio_page_touches *t, bool first, uint32_t distance) {
    t->touches++;
    t->faults += first || distance >= t->cache_pages;
    if (first)
        t->pages++;
    else
        t->far[distance ? 32 - __builtin_clz(distance) : 0]++;
}

void brio_touch(brio_page_touches *t, int array, uint64_t offset) {
    uint64_t page = offset >> t->shift;
    if (t->status != BRIO_OK) return;
    if (page >= t->capacity[array]) t->status = reserve_page(t, array, page);
    if (t->status == BRIO_OK && t->now == t->times) t->status = renumber(t);
    if (t->status != BRIO_OK) return;
    uint32_t *last = &t->last[array][page];
    if (*last && *last == t->now) return count(t, false, 0);
    count(t, !*last, *last ? (uint32_t)t->pages - marks_up_to(t, *last) : 0);
    if (*last) add(t, *last, (uint32_t)-1);
    *last = ++t->now;
    t->touched[t->now] = (page_name){(uint32_t)array, (uint32_t)page};
    add(t, t->now, 1);
}

brio_status brio_page_touches_status(const brio_page_touches *t) {
    return t->status;
}

void brio_page_touches_total(const brio_page_touches *t, brio_laboratory_stats *stats) {
    stats->pages = t->pages;
    stats->page_touches = t->touches;
    stats->page_faults = t->faults;
}

size_t brio_page_touches_faults(const brio_page_touches *t, uint64_t faults[BRIO_TOUCH_CACHES]) {
    uint64_t misses = t->touches - t->far[0];
    size_t k = 0;
    for (; k < BRIO_TOUCH_CACHES; k++) {
        faults[k] = misses;
        if (misses == t->pages) return k + 1;
        misses -= t->far[k + 1];
    }
    return k;
}

/* --- of an inserter --- */

/* Counts a tetrahedron, or the slot where one was. */
static void touch_slot(const brio_touch_view *view, uint32_t tet) {
    brio_touch(view->counts, view->first + BRIO_TOUCH_TETRAHEDRA, (uint64_t)tet * sizeof(brio_tetrahedron));
}

/* Counts a tetrahedron and the records of its vertices. */
static void touch_tet(const brio_touch_view *view, const brio_tetrahedra *t, uint32_t tet) {
    touch_slot(view, tet);
    for (int i = 0; i < 4; i++)
        if (t->tet[tet].vertex[i] != t->infinite) brio_touch_record(view, t->tet[tet].vertex[i]);
}

static void came_to(const brio_watch *watch, const brio_tetrahedra *t, uint32_t tet) {
    touch_tet((const brio_touch_view *)watch, t, tet);
}

void brio_count_touches(brio_inserter *ins, brio_touch_view *view, brio_page_touches *counts, int first) {
    *view = (brio_touch_view){{came_to}, counts, first};
    ins->walk.watch = counts ? &view->watch : NULL;
}

/* Counts p, the slots of the tetrahedra in conflict, those behind the border and the new ones with their vertices,
 * which are those of the old ones. */
brio_status brio_count_insertion(brio_inserter *ins, uint32_t p) {
    const brio_cavity *c = &ins->cavity;
    const brio_tetrahedra *t = &ins->store->t;
    const brio_touch_view *view = brio_touches_of(ins);
    if (!view) return BRIO_OK;
    brio_touch_record(view, p);
    for (size_t i = 0; i < c->num_tets; i++) touch_slot(view, brio_tet_of(c->entry[i]));
    for (size_t i = 0; i < c->num_border; i++) touch_tet(view, t, brio_tet_of(c->border[i]));
    for (size_t i = 0; i < c->num_created; i++) touch_tet(view, t, c->created[i]);
    return brio_page_touches_status(view->counts);
}
