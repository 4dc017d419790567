/* How long tetrahedra need no test while all points move.
 *
 * A tetrahedron that is tested gets a slack, a distance that each point may go before a test could turn out otherwise
 * (triangulation/sound_lanes.h). All points go at most one step in a call, so the sum of the steps is the time until
 * which the test holds: one number for all of them, and one comparison for each tetrahedron. Points that go further
 * than the step end the time of their own stars. A tetrahedron that a change writes has no time (brio_note_slot).
 *
 * Based on: de Castro, Tournois, Alliez, Devillers. Filtering relocations on a Delaunay triangulation. CGF 2009.
 * Differs from the paper: time is of tetrahedra, not of vertices, whose least slack is used up soon. */
#include "base/memory.h"
#include "base/team.h"
#include "dynamic/live.h"
#include "triangulation/ring.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { LEAST = 1 << 14, SLOTS = 16 }; /* slots that are worth a thread; that are looked at together */

void brio_slack_end(brio_dynamic *d) {
    const brio_hole *h = &d->hole;
    for (size_t i = 0; i < h->num_tets; i++) brio_end_time(d, h->tet[i]);
    for (size_t b = 0; b < h->num_border; b++) brio_end_time(d, brio_tet_of(h->border[b]));
}

void brio_slack_end_all(brio_dynamic *d) {
    d->timed = false;
    for (size_t s = 0; s < d->t.count; s++) d->until[s] = -1;
}

/* Returns a float below a time, or -1 where floats are too coarse for that. A later time is above it also as the
 * nearest float: with u = 2^-24, that is at least (1 - u) time, and this at most (1 - 4u) (1 + u) time. */
static inline float below(double time) {
    if (!(time > 1e-30)) return -1;
    return (float)(fmin(time, FLT_MAX) * (1 - 0x1p-22));
}

/* Lets time begin anew, before it is so large that a float cannot tell a further step. */
static void restart(brio_dynamic *d) {
    for (size_t s = 0; s < d->t.count; s++) d->until[s] = below((double)d->until[s] - d->travelled);
    d->travelled = 0;
}

void brio_slack_advance(brio_dynamic *d, double step) {
    static const double MOST_STEPS = 0x1p16;
    if (step > 0 && d->travelled > MOST_STEPS * step) restart(d);
    d->travelled = (d->travelled + step) * (1 + 0x1p-50);
}

/* --- tests --- */

typedef struct {
    brio_dynamic *d;
    brio_slot_list *open, *infinite; /* of each thread */
    brio_status status;
} test_pass;

static brio_status list(brio_context *ctx, brio_slot_list *l, uint32_t slot) {
    BRIO_FORWARD(BRIO_RESERVE(ctx, l->slot, l->capacity, l->count + 1));
    l->slot[l->count++] = slot;
    return BRIO_OK;
}

/* Finite tetrahedra that wait for their tests: their neighbours were called for when they came. */
typedef struct {
    uint32_t slot[BRIO_SOUND_BATCH];
    size_t count;
} queue;

/* Tests those that wait, and says until when each needs no other test. */
static brio_status test_queue(brio_dynamic *d, queue *q, brio_slot_list *open) {
    double slack[BRIO_SOUND_BATCH];
    size_t n = q->count;
    while (q->count % BRIO_BATCH) q->slot[q->count++] = q->slot[0];
    uint64_t sound = d->engine->sound(&d->t, &d->filter, q->slot, q->count, slack);
    for (size_t i = 0; i < n; i++)
        d->until[q->slot[i]] = sound >> i & 1 && slack[i] > 0 ? below(d->travelled + slack[i]) : -1;
    q->count = 0;
    for (size_t i = 0; i < n; i++)
        if (!(sound >> i & 1)) BRIO_FORWARD(list(d->ctx, open, q->slot[i]));
    return BRIO_OK;
}

/* Returns whether the time of some of the next slots is over. */
static inline bool some_over(const float *until, float now) {
    int over = 0;
    for (int i = 0; i < SLOTS; i++) over |= !(until[i] >= now);
    return over;
}

static brio_status test_slots(test_pass *own, size_t begin, size_t end, int thread) {
    brio_dynamic *d = own->d;
    enum { AHEAD = 128 }; /* slots whose tetrahedra are called for */
    queue q = {.count = 0};
    float now = (float)d->travelled; /* times that are over are below it: see below() */
    for (size_t slot = begin; slot < end; slot++) {
        if (slot % SLOTS == 0 && slot + SLOTS <= end && !some_over(d->until + slot, now)) {
            slot += SLOTS - 1;
            continue;
        }
        if (d->until[slot] >= now || d->state[slot] & SLOT_UNUSED) continue;
        if (slot + AHEAD < end) __builtin_prefetch(&d->t.tet[slot + AHEAD]);
        if (brio_is_infinite(&d->t, (uint32_t)slot)) {
            BRIO_FORWARD(list(d->ctx, &own->infinite[thread], (uint32_t)slot));
            continue;
        }
        brio_ring_fetch(&d->t, slot);
        q.slot[q.count++] = (uint32_t)slot;
        if (q.count == BRIO_SOUND_BATCH) BRIO_FORWARD(test_queue(d, &q, &own->open[thread]));
    }
    return q.count ? test_queue(d, &q, &own->open[thread]) : BRIO_OK;
}

static void test_part(void *user, size_t begin, size_t end, int thread) {
    test_pass *own = user;
    brio_report(&own->status, test_slots(own, begin, end, thread));
}

/* Appends the lists of all threads, in their order, which is that of the slots. */
static brio_status append(brio_context *ctx, brio_slot_list *to, const brio_slot_list *from, int threads) {
    for (int i = 0; i < threads; i++) {
        BRIO_FORWARD(BRIO_RESERVE(ctx, to->slot, to->capacity, to->count + from[i].count));
        if (from[i].count) memcpy(to->slot + to->count, from[i].slot, from[i].count * sizeof *to->slot);
        to->count += from[i].count;
    }
    return BRIO_OK;
}

brio_status brio_slack_test(brio_dynamic *d, brio_slot_list *open, brio_slot_list *infinite) {
    int threads = brio_threads(d->ctx, d->t.count, LEAST);
    test_pass own = {.d = d, .status = BRIO_OK};
    brio_status status = BRIO_OK;
    *open = *infinite = (brio_slot_list){0};
    d->timed = true;
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, own.open, 2 * (size_t)threads));
    own.infinite = own.open + threads;
    BRIO_TRY(brio_for(d->ctx, threads, d->t.count, test_part, &own));
    BRIO_TRY(own.status);
    BRIO_TRY(append(d->ctx, open, own.open, threads));
    status = append(d->ctx, infinite, own.infinite, threads);
done:
    for (int i = 0; own.open && i < 2 * threads; i++) brio_release(d->ctx, own.open[i].slot);
    brio_release(d->ctx, own.open);
    return status;
}
