/* Zones: against a list of who holds what, over more insertions than their numbers count to, and by many threads at
 * once, of which no two ever hold one segment. */
#include "triangulation/zone.h"
#include "base/team.h"
#include "failing_allocator.h"
#include "points.h"

enum { SHIFT = 3, SEGMENTS = 40, VERTICES = SEGMENTS << SHIFT, ZONES = 3, KEPT = 8, NOBODY = -1 };

static uint32_t rank[VERTICES];

/* The vertices along the curve in a random order. */
static void shuffle_ranks(uint64_t seed) {
    brio_rng rng = brio_rng_new(seed);
    for (uint32_t v = 0; v < VERTICES; v++) rank[v] = v;
    for (uint32_t v = VERTICES; v > 1; v--) {
        uint32_t other = brio_rng_below(&rng, v), swap = rank[v - 1];
        rank[v - 1] = rank[other], rank[other] = swap;
    }
}

static uint32_t segment_of(uint32_t vertex) {
    return rank[vertex] >> SHIFT;
}

/* A vertex of a segment. */
static uint32_t vertex_in(uint32_t segment) {
    for (uint32_t v = 0; v < VERTICES; v++)
        if (segment_of(v) == segment) return v;
    return 0;
}

/* --- against a model --- */

/* Several zones on one curve, and what each segment's holder should be. */
typedef struct {
    brio_context *ctx;
    uint8_t taken[SEGMENTS];
    brio_zone zone[ZONES];
    int holder[SEGMENTS];
    int met[SEGMENTS];     /* insertion of its holder that last met it */
    int insertions[ZONES]; /* ended */
} model;

static void model_new(model *m) {
    *m = (model){.ctx = new_context()};
    shuffle_ranks(1);
    for (int z = 0; z < ZONES; z++)
        EXPECT(brio_zone_new(m->ctx, rank, SHIFT, SEGMENTS, m->taken, &m->zone[z]) == BRIO_OK);
    for (int s = 0; s < SEGMENTS; s++) m->holder[s] = NOBODY;
}

static void model_free(model *m) {
    for (int z = 0; z < ZONES; z++) brio_zone_free(m->ctx, &m->zone[z]);
    EXPECT(brio_context_memory(m->ctx) == 0);
    brio_context_free(m->ctx);
}

static size_t count_held(const model *m, int z) {
    size_t count = 0;
    for (int s = 0; s < SEGMENTS; s++) count += m->holder[s] == z;
    return count;
}

/* The zones hold what the model says; a segment is taken when one holds it. */
static void expect_as_model(const model *m) {
    for (int s = 0; s < SEGMENTS; s++) {
        EXPECT(m->taken[s] == (m->holder[s] != NOBODY), "segment %d", s);
        for (int z = 0; z < ZONES; z++) EXPECT(!m->zone[z].held[s] == (m->holder[s] != z), "segment %d, zone %d", s, z);
    }
    for (int z = 0; z < ZONES; z++) {
        uint8_t listed[SEGMENTS] = {0};
        EXPECT(m->zone[z].count == count_held(m, z), "zone %d", z);
        EXPECT(m->zone[z].now != 0);
        for (size_t i = 0; i < m->zone[z].count; i++) {
            uint32_t s = m->zone[z].segment[i];
            EXPECT(s < SEGMENTS && m->holder[s] == z && !listed[s]++, "zone %d", z);
        }
    }
}

static void meet(model *m, int z, uint32_t vertex) {
    uint32_t s = segment_of(vertex);
    bool has = m->holder[s] == NOBODY || m->holder[s] == z;
    EXPECT(brio_zone_has(&m->zone[z], vertex) == has);
    if (!has) return;
    m->holder[s] = z;
    m->met[s] = m->insertions[z];
}

/* Where more than KEPT are held, those go that the insertion did not meet. Insertions are numbered from 1 to 255 again
 * and again: a segment that was last met a multiple of 255 insertions ago may stay, too. */
static void tidy(model *m, int z) {
    bool many = count_held(m, z) > KEPT, gave_back = false;
    bool gives_back = brio_zone_tidy(&m->zone[z]);
    for (int s = 0; s < SEGMENTS && many; s++) {
        if (m->holder[s] != z || m->met[s] == m->insertions[z]) continue;
        if ((m->insertions[z] - m->met[s]) % 255 == 0 && m->zone[z].held[s]) continue;
        m->holder[s] = NOBODY;
        gave_back = true;
    }
    EXPECT(gives_back == gave_back, "zone %d", z);
    m->insertions[z]++;
}

static void leave(model *m, int z) {
    brio_zone_leave(&m->zone[z]);
    for (int s = 0; s < SEGMENTS; s++)
        if (m->holder[s] == z) m->holder[s] = NOBODY;
}

static void zones_hold_what_they_met(void) {
    model m;
    brio_rng rng = brio_rng_new(2);
    model_new(&m);
    expect_as_model(&m);
    for (int step = 0; step < 4000; step++) {
        int z = (int)brio_rng_below(&rng, ZONES), many = (int)brio_rng_below(&rng, 14);
        for (int i = 0; i < many; i++) meet(&m, z, brio_rng_below(&rng, VERTICES));
        expect_as_model(&m);
        tidy(&m, z);
        expect_as_model(&m);
        if (brio_rng_below(&rng, 50) == 0) leave(&m, z);
    }
    for (int z = 0; z < ZONES; z++) leave(&m, z);
    expect_as_model(&m);
    model_free(&m);
}

/* --- one by one --- */

static void a_vertex_brings_its_whole_segment(void) {
    model m;
    model_new(&m);
    for (uint32_t v = 0; v < VERTICES; v++)
        if (segment_of(v) == 5) EXPECT(brio_zone_has(&m.zone[0], v) && m.zone[0].count == 1);
    for (uint32_t v = 0; v < VERTICES; v++)
        EXPECT(brio_zone_has(&m.zone[1], v) == (segment_of(v) != 5), "vertex %u", v);
    EXPECT(m.zone[1].count == SEGMENTS - 1);
    model_free(&m);
}

static void a_taken_segment_is_refused_until_it_is_given_back(void) {
    model m;
    model_new(&m);
    EXPECT(brio_zone_take(&m.zone[0], 7) && !brio_zone_take(&m.zone[1], 7) && m.zone[1].count == 0);
    brio_zone_leave(&m.zone[1]);
    EXPECT(!brio_zone_take(&m.zone[1], 7), "only its holder gives a segment back");
    brio_zone_leave(&m.zone[0]);
    EXPECT(brio_zone_take(&m.zone[1], 7) && !brio_zone_take(&m.zone[0], 7));
    model_free(&m);
}

static void few_segments_are_kept_many_are_tidied(void) {
    model m;
    model_new(&m);
    for (uint32_t s = 0; s < KEPT; s++) meet(&m, 0, vertex_in(s));
    for (int i = 0; i < 600; i++) tidy(&m, 0); /* the number of the insertion starts again twice */
    EXPECT(m.zone[0].count == KEPT);
    expect_as_model(&m);
    meet(&m, 0, vertex_in(KEPT));
    EXPECT(brio_zone_tidy(&m.zone[0]) && m.zone[0].count == 1 && m.zone[0].segment[0] == KEPT);
    EXPECT(!m.taken[0] && m.taken[KEPT]);
    model_free(&m);
}

/* --- threads --- */

enum { THREADS = 8, ROUNDS = 2000, MEETINGS = 6 };

typedef struct {
    uint8_t taken[SEGMENTS];
    brio_zone zone[THREADS];
    int holder[SEGMENTS]; /* plain numbers: whoever holds a segment may write them */
    size_t visits[SEGMENTS];
    size_t met, refused, stolen; /* of all threads */
} shared_curve;

/* Counts of one thread. */
typedef struct {
    size_t met, refused, stolen;
} tally;

/* Marks the segments that an insertion meets and finds its marks at its end; what others marked meanwhile is stolen.
 * Where all are to hold their segments at the same time, each waits for the others before it looks. */
static void one_insertion(shared_curve *c, const brio_member *m, brio_rng *rng, bool together, tally *t) {
    uint32_t segments[MEETINGS];
    size_t count = 0;
    for (int i = 0; i < MEETINGS; i++) {
        uint32_t vertex = brio_rng_below(rng, VERTICES), s = segment_of(vertex);
        if (!brio_zone_has(&c->zone[m->thread], vertex)) {
            t->refused++;
            continue;
        }
        c->holder[s] = m->thread;
        c->visits[s]++;
        segments[count++] = s;
    }
    if (together) brio_barrier(m);
    for (size_t i = 0; i < count; i++) t->stolen += c->holder[segments[i]] != m->thread;
    t->met += count;
}

static void insert_and_tidy(void *user, const brio_member *m) {
    shared_curve *c = user;
    brio_rng rng = brio_rng_new((uint64_t)m->thread + 1);
    tally t = {0, 0, 0};
    for (int round = 0; round < ROUNDS; round++) {
        if (round % 4 == 0) brio_barrier(m);
        one_insertion(c, m, &rng, round % 4 == 0, &t);
        brio_zone_tidy(&c->zone[m->thread]);
        if (brio_rng_below(&rng, 16) == 0) brio_zone_leave(&c->zone[m->thread]);
    }
    brio_zone_leave(&c->zone[m->thread]);
    __atomic_fetch_add(&c->met, t.met, __ATOMIC_RELAXED);
    __atomic_fetch_add(&c->refused, t.refused, __ATOMIC_RELAXED);
    __atomic_fetch_add(&c->stolen, t.stolen, __ATOMIC_RELAXED);
}

static void no_two_threads_hold_one_segment(void) {
    brio_context *ctx = new_context();
    static shared_curve c;
    size_t visits = 0;
    brio_context_set_threads(ctx, THREADS);
    shuffle_ranks(3);
    int threads = brio_threads(ctx, THREADS, 1);
    for (int t = 0; t < threads; t++) EXPECT(brio_zone_new(ctx, rank, SHIFT, SEGMENTS, c.taken, &c.zone[t]) == BRIO_OK);
    brio_run(ctx, threads, insert_and_tidy, &c);
    for (int s = 0; s < SEGMENTS; s++) {
        visits += c.visits[s];
        EXPECT(!c.taken[s], "segment %d", s);
    }
    EXPECT(c.stolen == 0, "%zu", c.stolen);
    EXPECT(visits == c.met, "%zu of %zu", visits, c.met);
    EXPECT(c.met > 0 && (threads == 1 || c.refused > 0), "%zu met, %zu refused", c.met, c.refused);
    for (int t = 0; t < threads; t++) brio_zone_free(ctx, &c.zone[t]);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

enum { LONG_CURVE = 1 << 14, SWEEPS = 20 };

/* Every thread asks for every segment in the same order, all at the same time. */
static void take_all(void *user, const brio_member *m) {
    brio_zone *zone = user;
    brio_barrier(m);
    for (uint32_t s = 0; s < LONG_CURVE; s++) brio_zone_take(&zone[m->thread], s);
}

static void of_all_that_ask_for_a_segment_one_gets_it(void) {
    static uint8_t taken[LONG_CURVE], listed[LONG_CURVE];
    brio_zone zone[THREADS];
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        brio_context *ctx = new_context();
        brio_context_set_threads(ctx, sweep % 2 ? 2 : THREADS);
        int threads = brio_threads(ctx, THREADS, 1);
        size_t twice = 0, all = 0;
        memset(listed, 0, sizeof listed);
        for (int t = 0; t < threads; t++) EXPECT(brio_zone_new(ctx, NULL, 0, LONG_CURVE, taken, &zone[t]) == BRIO_OK);
        brio_run(ctx, threads, take_all, zone);
        for (int t = 0; t < threads; t++) {
            for (size_t i = 0; i < zone[t].count; i++) twice += listed[zone[t].segment[i]]++;
            all += zone[t].count;
            brio_zone_leave(&zone[t]);
            brio_zone_free(ctx, &zone[t]);
        }
        EXPECT(twice == 0 && all == LONG_CURVE, "%zu taken, %zu of them twice", all, twice);
        brio_context_free(ctx);
    }
}

/* --- memory that runs out --- */

static brio_status make_zone(brio_context *ctx) {
    uint8_t taken[SEGMENTS] = {0};
    brio_zone zone;
    brio_status status = brio_zone_new(ctx, rank, SHIFT, SEGMENTS, taken, &zone);
    brio_zone_free(ctx, &zone);
    return status;
}

static void refused_memory_is_a_status_and_leaves_nothing(void) {
    expect_clean_failures(make_zone);
}

SUITE(test_zone) {
    RUN(zones_hold_what_they_met);
    RUN(a_vertex_brings_its_whole_segment);
    RUN(a_taken_segment_is_refused_until_it_is_given_back);
    RUN(few_segments_are_kept_many_are_tidied);
    RUN(no_two_threads_hold_one_segment);
    RUN(of_all_that_ask_for_a_segment_one_gets_it);
    RUN(refused_memory_is_a_status_and_leaves_nothing);
    return harness_end();
}
