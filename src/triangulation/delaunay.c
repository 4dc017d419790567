/* Delaunay and regular triangulation: order the points, insert them one by one, sort the result.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include "base/versioned.h"
#include "triangulation/canonical_order.h"
#include "triangulation/canonical_turn.h"
#include "triangulation/insert.h"
#include "triangulation/insertion_part.h"
#include "triangulation/represent.h"
#include "triangulation/start.h"
#include "triangulation/triangulation.h"
#include <assert.h>
#include <string.h>

enum { PROGRESS_EVERY = 8192, MOST_TETRAHEDRA = 1 << 30, NAMES_A_THREAD = 1 << 14 };

static brio_status check_count(brio_context *ctx, size_t n) {
    BRIO_FORWARD(brio_refuse_many(ctx, n));
    /* canonical_order.c numbers two buckets a record in 32 bits */
    BRIO_EXPECT(ctx, ctx->scratch || n < (UINT32_C(1) << 31) - 16, BRIO_ERR_TOO_LARGE,
                "%zu points; at most 2^31 - 17 without a scratch folder", n);
    return BRIO_OK;
}

/* Fills in the defaults. */
static void settle(brio_delaunay_options *o) {
    if (!o->seed) o->seed = BRIO_SEED;
    if (!o->max_tetrahedra) o->max_tetrahedra = MOST_TETRAHEDRA;
}

brio_status brio_delaunay_begin(brio_context *ctx, size_t num_points, const brio_delaunay_options *o) {
    const struct brio_insertion_part *part = BRIO_PART(ctx, insertion);
    BRIO_EXPECT(ctx, (unsigned)o->order < BRIO_ORDER_END, BRIO_ERR_ARGUMENT, "no insertion order %d", (int)o->order);
    BRIO_EXPECT(ctx, o->round_ratio >= 0 && o->round_ratio < 1, BRIO_ERR_ARGUMENT,
                "round ratio %g is not between 0 and 1", o->round_ratio);
    BRIO_EXPECT(ctx, !o->reserved_int, BRIO_ERR_ARGUMENT, "brio_delaunay_options.reserved_int is not 0");
    BRIO_EXPECT(ctx, o->max_tetrahedra <= MOST_TETRAHEDRA, BRIO_ERR_ARGUMENT, "at most 2^30 tetrahedra, not %u",
                o->max_tetrahedra);
    return part ? part->begin(part->user, ctx, num_points) : BRIO_OK;
}

/* --- construction --- */

static inline size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Returns the turn where the records from turn `begin` on stop following the curve, at most `end`. */
static size_t end_of_run(const brio_store *s, size_t begin, size_t end) {
    assert(begin < end && end <= s->num_points && s->rank);
    size_t i = begin + 1;
    while (i < end && s->rank[brio_record_at(s, i)] > s->rank[brio_record_at(s, i - 1)]) i++;
    return i;
}

static brio_status insert_some(brio_inserter *ins, size_t begin, size_t end) {
    for (size_t p = begin; p < end; p++) {
        brio_insertion outcome;
        BRIO_FORWARD(brio_insert(ins, brio_record_at(ins->store, p), &outcome));
        assert(outcome != BRIO_DEFERRED);
        if (brio_inserter_work(ins) >= ins->report_at)
            BRIO_FORWARD(brio_inserter_report(ins, (double)p / (double)ins->store->num_points));
    }
    return BRIO_OK;
}

/* Inserts the records after those of the first tetrahedron, in runs between the numbers of points that an experiment
 * wants to know of. */
static brio_status insert_all(brio_inserter *ins, const struct brio_insertion_part *part) {
    const brio_store *s = ins->store;
    brio_status status = BRIO_OK;
    size_t n = s->num_points, p = (size_t)s->dimension + 1, end;
    if (s->dimension <= 0) return part ? part->note(part->user, ins, n) : BRIO_OK;
    if (part) {
        ins->locator = part->strategy;
        if (ins->locator->start) BRIO_TRY(ins->locator->start(ins));
        BRIO_TRY(part->note(part->user, ins, p));
    }
    bool parallel = s->rank && s->dimension == 3;
    for (; p < n; p = end) {
        BRIO_TRY(brio_inserter_report(ins, (double)p / (double)n));
        end = part ? least(part->next(part->user, p), n) : n;
        if (parallel) {
            end = end_of_run(s, p, end);
            BRIO_TRY(brio_insert_parallel(ins, p, end));
        } else {
            end = least(end, p + PROGRESS_EVERY - p % PROGRESS_EVERY);
            BRIO_TRY(insert_some(ins, p, end));
        }
        if (part) BRIO_TRY(part->note(part->user, ins, end));
    }
    if (ins->locator->release) ins->locator->release(ins); /* the sort needs the room */
    status = brio_progress(s->ctx, "insert", 1);
done:
    return status;
}

/* --- result --- */

/* Fills the unused slots before `live` with the tetrahedra behind it. */
static void close_gaps(brio_store *s, size_t live) {
    for (size_t gap = 0, from = live; gap < live; gap++) {
        if (s->state[gap] != TET_UNUSED) continue;
        while (s->state[from] == TET_UNUSED) from++;
        assert(from < s->t.count); /* as many are behind `live` as gaps before it */
        s->t.tet[gap] = s->t.tet[from++];
    }
    s->t.count = live;
}

typedef struct {
    brio_store *store;
    size_t finite; /* atomic */
} naming;

/* Turns some tetrahedra as the canonical order turns them, and gives their vertices the caller's names. */
static void name_some(void *user, size_t begin, size_t end, int thread) {
    naming *n = user;
    const brio_store *s = n->store;
    size_t finite = 0;
    (void)thread;
    for (size_t t = begin; t < end; t++) {
        uint32_t *v = s->t.tet[t].vertex, old[4];
        uint8_t turn;
        memcpy(old, v, sizeof old);
        brio_turn_key(old, s->t.infinite, &turn);
        finite += old[3] != s->t.infinite;
        for (int i = 0; i < 4; i++) {
            uint32_t record = old[BRIO_TURNED[turn][i]];
            v[i] = record == s->t.infinite ? BRIO_INFINITE : s->caller[record];
        }
    }
    __atomic_add_fetch(&n->finite, finite, __ATOMIC_RELAXED);
}

/* Leaves the tetrahedra in the order of their slots. Mates are lost. */
static brio_status leave_order(brio_store *s, size_t live, size_t *finite) {
    naming n = {.store = s};
    close_gaps(s, live);
    brio_status status = brio_for(s->ctx, brio_threads(s->ctx, live, NAMES_A_THREAD), live, name_some, &n);
    *finite = n.finite;
    return status;
}

/* Brings the tetrahedra into their order and counts them. Only names of records matter from here on. */
static brio_status sort_result(brio_inserter *ins, bool any_order) {
    brio_store *s = ins->store;
    brio_delaunay_stats *stats = &ins->stats;
    assert(ins->num_unused <= s->t.count && ins->next_slot == ins->end_slot); /* N3, N4 */
    size_t live = s->t.count - ins->num_unused, finite = 0;
    brio_status status = BRIO_OK;
    brio_store_drop_records(s);
    if (s->dimension < 3) s->t.count = live = 0;
    if (live > 0) status = any_order ? leave_order(s, live, &finite) : brio_canonical_order(s, live, &finite);
    assert(status != BRIO_OK || finite <= live);
    stats->tetrahedra = finite;
    stats->hull_facets = live - finite;
    return status;
}

#ifndef NDEBUG
/* Returns whether mates are mates of each other, finite tetrahedra come first, and infinite ones have their vertex
 * last: I2 and
 * I3 of tetrahedra.h, in the order of the result. */
static bool result_is_valid(const brio_triangulation *t) {
    size_t finite = t->stats.tetrahedra, count = finite + t->stats.hull_facets;
    for (size_t tet = 0; tet < count; tet++)
        for (int i = 0; i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i), mate = t->tet[tet].mate[i];
            if ((t->tet[tet].vertex[i] == BRIO_INFINITE) != (tet >= finite && i == 3)) return false;
            if (brio_tet_of(mate) >= count || t->tet[brio_tet_of(mate)].mate[brio_slot_of(mate)] != facet) return false;
        }
    return true;
}
#endif

#ifndef NDEBUG
/* Returns whether `caller` permutes 0 .. n - 1 (I8), up to collisions of a hash. */
static bool caller_permutes(const brio_store *s) {
    uint64_t sum = 0;
    for (size_t p = 0; p < s->num_points; p++) sum += brio_mix(p) - brio_mix(s->caller[p]);
    return sum == 0;
}
#endif

/* Names the representatives by the caller's indices. */
static brio_status rename_representatives(const brio_store *s, uint32_t **out) {
    brio_status status = BRIO_ALLOC(s->ctx, *out, s->num_points);
    if (status != BRIO_OK) return status;
    assert(caller_permutes(s));
    for (size_t p = 0; p < s->num_points; p++) {
        uint32_t v = s->representative[p];
        assert(s->caller[p] < s->num_points);                                           /* I8 */
        assert(v == BRIO_INFINITE || (v < s->num_points && s->representative[v] == v)); /* I7 */
        (*out)[s->caller[p]] = v == BRIO_INFINITE ? v : s->caller[v];
    }
    return BRIO_OK;
}

static brio_status triangulation_new(brio_inserter *ins, bool any_order, brio_triangulation **out) {
    brio_store *s = ins->store;
    brio_triangulation *t = NULL;
    brio_status status = BRIO_OK;
    ins->stats.size = sizeof ins->stats;
    ins->stats.points = s->num_points;
    ins->stats.dimension = s->dimension;
    ins->stats.walk_steps = ins->walk.steps;
    ins->stats.exact_calls = ins->filter.unsettled + s->filter.unsettled;
    BRIO_TRY(BRIO_RESIZE(s->ctx, s->t.tet, s->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, t, 1));
    t->ctx = s->ctx;
    BRIO_TRY(rename_representatives(s, &t->representative));
    t->tet = s->t.tet;
    t->stats = ins->stats;
    t->points_hash = s->points_hash;
    s->t.tet = NULL;
    assert(any_order || result_is_valid(t));
    (void)any_order;
    *out = t;
    t = NULL;
done:
    brio_triangulation_free(t);
    return status;
}

/* Makes the tetrahedra of a store that has none.   rounds  of its order.   *out  NULL after a failure. */
static brio_status construct(brio_store *store, const brio_delaunay_options *options, double order_seconds,
                             const brio_round_ends *rounds, brio_inserter **out) {
    const struct brio_insertion_part *part = BRIO_PART(store->ctx, insertion);
    brio_inserter *ins = NULL;
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    BRIO_TRY(brio_start(store));
    BRIO_TRY(brio_inserter_new(store, &ins));
    ins->reports = true;
    ins->stats.order_seconds = order_seconds;
    ins->stats.created = store->t.count; /* the first ones */
    if (part) part->start(part->user, ins, options, rounds, start);
    BRIO_TRY(insert_all(ins, part));
    BRIO_TRY(brio_represent(ins, options->leave_hidden != 0));
    ins->stats.insert_seconds = brio_seconds() - start;
    *out = ins;
    ins = NULL;
done:
    brio_inserter_free(ins);
    return status;
}

/* Orders points and triangulates them.   Both results are the caller's; after a failure they may be NULL. */
static brio_status make(brio_context *ctx, const brio_input *input, brio_delaunay_options *o, brio_store **store,
                        brio_inserter **ins) {
    brio_round_ends rounds;
    BRIO_FORWARD(check_count(ctx, input->count));
    BRIO_FORWARD(brio_delaunay_begin(ctx, input->count, o));
    settle(o);
    double start = brio_seconds();
    BRIO_FORWARD(brio_store_new(ctx, input, o, &rounds, store));
    return construct(*store, o, brio_seconds() - start, &rounds, ins);
}

/* Triangulates points, and brings the tetrahedra into their order, or leaves them in any. */
static brio_status triangulate(brio_context *ctx, const brio_input *input, const brio_delaunay_options *options,
                               bool any_order, brio_triangulation **out) {
    brio_delaunay_options o = *options;
    brio_store *store = NULL;
    brio_inserter *ins = NULL;
    brio_status status = BRIO_OK;
    brio_keep_begin(ctx);
    BRIO_TRY(make(ctx, input, &o, &store, &ins));
    double start = brio_seconds();
    BRIO_TRY(sort_result(ins, any_order));
    ins->stats.insert_seconds += brio_seconds() - start;
    BRIO_TRY(triangulation_new(ins, any_order, out));
    (*out)->leaves_hidden = o.leave_hidden != 0;
done:
    brio_inserter_free(ins);
    brio_store_free(store);
    brio_keep_end(ctx);
    return status;
}

brio_status brio_delaunay(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                          const brio_delaunay_options *options, brio_triangulation **out) {
    BRIO_DOOR;
    brio_delaunay_options o = {0};
    *out = NULL;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_delaunay_options, options, &o));
    return triangulate(ctx, &(brio_input){points, weights, num_points}, &o, false, out);
}

brio_status brio_triangulate(brio_context *ctx, const double *points, size_t num_points, uint64_t seed,
                             brio_triangulation **out) {
    const struct brio_triangulator *by = ctx->triangulator;
    brio_delaunay_options o = {.size = sizeof o, .seed = seed};
    return by ? by->make(by->user, ctx, points, num_points, seed, out)
              : brio_delaunay(ctx, points, NULL, num_points, &o, out);
}

brio_status brio_delaunay_any_order(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                    const brio_delaunay_options *options, brio_triangulation **out) {
    *out = NULL;
    return triangulate(ctx, &(brio_input){points, weights, num_points}, options, true, out);
}

brio_status brio_delaunay_unordered(brio_context *ctx, const brio_input *input, brio_store **store,
                                    brio_inserter **ins) {
    brio_delaunay_options o = {0};
    *store = NULL;
    *ins = NULL;
    brio_keep_begin(ctx);
    brio_status status = make(ctx, input, &o, store, ins);
    brio_keep_end(ctx);
    return status;
}

/* --- tetrahedra that are known --- */

struct brio_adoption {
    brio_store *store;
    uint32_t *record; /* of each point of the caller */
    size_t count;
};

static brio_status begin_adoption(brio_context *ctx, const brio_input *input, uint64_t seed, brio_adoption *a) {
    brio_delaunay_options o = {.seed = seed};
    size_t count = a->count;
    BRIO_FORWARD(check_count(ctx, input->count));
    settle(&o);
    BRIO_FORWARD(brio_store_new(ctx, input, &o, NULL, &a->store));
    BRIO_FORWARD(brio_start(a->store));
    assert(a->store->dimension == 3);
    if (count > a->store->t.count) BRIO_FORWARD(brio_store_reserve(a->store, count - a->store->t.count));
    BRIO_FORWARD(BRIO_ALLOC(ctx, a->record, input->count));
    for (uint32_t r = 0; r < input->count; r++) a->record[a->store->caller[r]] = r;
    return BRIO_OK;
}

brio_status brio_adoption_begin(brio_context *ctx, const brio_input *input, uint64_t seed, size_t count,
                                brio_adoption **out) {
    brio_adoption *a;
    *out = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, a, 1));
    a->count = count;
    brio_keep_begin(ctx);
    brio_status status = begin_adoption(ctx, input, seed, a);
    brio_keep_end(ctx);
    if (status == BRIO_OK)
        *out = a;
    else
        brio_adoption_free(ctx, a);
    return status;
}

void brio_adoption_free(brio_context *ctx, brio_adoption *a) {
    if (!a) return;
    brio_store_free(a->store);
    brio_release(ctx, a->record);
    brio_release(ctx, a);
}

brio_tetrahedron *brio_adoption_tetrahedra(const brio_adoption *a) {
    return a->store->t.tet;
}

const uint32_t *brio_adoption_records(const brio_adoption *a) {
    return a->record;
}

uint32_t brio_adoption_infinite(const brio_adoption *a) {
    return a->store->t.infinite;
}

/* Begins what follows the last insertion, as if the tetrahedra had been inserted. */
static void take_tetrahedra(brio_context *ctx, brio_adoption *a, const uint32_t *vertex_of) {
    brio_store *s = a->store;
    memset(s->state, TET_PLAIN, a->count * sizeof *s->state);
    s->t.count = a->count;
    s->adopted = true;
    for (size_t p = 0; vertex_of && p < s->num_points; p++) s->representative[a->record[p]] = a->record[vertex_of[p]];
    brio_release(ctx, a->record);
    a->record = NULL;
}

brio_status brio_adoption_end(brio_context *ctx, brio_adoption *a, const uint32_t *vertex_of,
                              brio_triangulation **out) {
    brio_inserter *ins = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    brio_keep_begin(ctx);
    take_tetrahedra(ctx, a, vertex_of);
    BRIO_TRY(brio_inserter_new(a->store, &ins));
    ins->reports = true;
    BRIO_TRY(brio_represent(ins, false));
    BRIO_TRY(sort_result(ins, false));
    BRIO_TRY(triangulation_new(ins, false, out));
done:
    brio_inserter_free(ins);
    brio_keep_end(ctx);
    return status;
}

void brio_triangulation_free(brio_triangulation *t) {
    if (!t) return;
    brio_release(t->ctx, t->tet);
    brio_release(t->ctx, t->representative);
    brio_release(t->ctx, t);
}

const brio_delaunay_stats *brio_triangulation_stats(const brio_triangulation *t) {
    return &t->stats;
}
const brio_tetrahedron *brio_triangulation_tetrahedra(const brio_triangulation *t) {
    return t->tet;
}
const uint32_t *brio_triangulation_representatives(const brio_triangulation *t) {
    return t->representative;
}
uint64_t brio_triangulation_points_hash(const brio_triangulation *t) {
    return t->points_hash;
}
