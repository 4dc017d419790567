/* Records the counters during insertion: at the end of each round, at each doubling, or after every `every` points.
 * Insertion itself does no recording: runs of insertions end where an entry is due. */
#include "triangulation/recorder.h"
#include "base/memory.h"
#include <assert.h>

enum { FIRST_DOUBLING = 4096 };

size_t brio_recorder_next(const brio_recorder *r, size_t inserted) {
    assert(r->rounds.count <= BRIO_MOST_ROUNDS);
    size_t next = FIRST_DOUBLING;
    if (r->every == 0) return SIZE_MAX;
    if (r->every != BRIO_RECORD_ROUNDS) {
        uint64_t left = r->every - inserted % r->every;
        return left < SIZE_MAX - inserted ? inserted + (size_t)left : SIZE_MAX;
    }
    if (r->rounds.count > 1) {
        int i = 0;
        while (i < r->rounds.count && r->rounds.end[i] <= inserted) i++;
        return i < r->rounds.count ? r->rounds.end[i] : SIZE_MAX;
    }
    while (next <= inserted) next *= 2;
    return next;
}

brio_status brio_recorder_note(brio_recorder *r, const brio_inserter *ins, size_t inserted) {
    const brio_store *s = ins->store;
    brio_delaunay_stats so_far = {0};
    bool due = inserted > 0 && brio_recorder_next(r, inserted - 1) == inserted;
    if (r->every == 0 || !(due || inserted == s->num_points)) return BRIO_OK;
    if (ins->touches.counts) brio_page_touches_total(ins->touches.counts, &so_far);
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, r->list, r->capacity, r->count + 1));
    r->list[r->count++] = (brio_round){
        .points = inserted,
        .tetrahedra = (size_t)(ins->stats.created - ins->stats.destroyed),
        .created = ins->stats.created,
        .destroyed = ins->stats.destroyed,
        .walk_steps = ins->walk.steps,
        .insphere_calls = ins->stats.insphere_calls,
        .history = ins->stats.history,
        .pages = so_far.pages,
        .page_touches = so_far.page_touches,
        .page_faults = so_far.page_faults,
        .locate_seconds = ins->stats.locate_seconds,
        .seconds = brio_seconds() - r->start,
    };
    return BRIO_OK;
}
