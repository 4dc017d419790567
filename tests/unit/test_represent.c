/* Representatives of coincident points after a parallel insertion. */
#include "base/memory.h"
#include "insertion.h"
#include "points.h"
#include "triangulation/represent.h"
#include <string.h>

enum { POINTS = 6, FIRST = 1, LATER = 5, NO_INDEX = 0x7ffda5a5 };

static const double position[3 * POINTS] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};

/* An insertion as threads may leave it: record 1 was deferred, its twin 5 became the vertex, and 1 was absorbed by it. The
 * caller's lower index keeps the name. *unused is a slot without a tetrahedron, which may hold anything. */
static brio_inserter *leave_insertion(brio_context *ctx, size_t *unused) {
    trial_options o = {0};
    brio_inserter *ins = insertion_begin(ctx, position, NULL, POINTS, &o);
    brio_store *s = ins->store;
    insert_records(ins, 0, POINTS);
    EXPECT(s->representative[4] == 0 && s->representative[LATER] == FIRST);
    EXPECT(s->rank || BRIO_ALLOC_ZERO(ctx, s->rank, POINTS + 3) == BRIO_OK);
    for (size_t t = 0; t < s->t.count; t++)
        for (int i = 0; i < 4; i++)
            if (s->t.tet[t].vertex[i] == FIRST) s->t.tet[t].vertex[i] = LATER;
    s->representative[FIRST] = s->representative[LATER] = LATER;
    s->caller[FIRST] = LATER, s->caller[LATER] = FIRST;
    EXPECT(brio_store_reserve(s, 1) == BRIO_OK && brio_store_take(s, 1, unused));
    s->state[*unused] = TET_UNUSED;
    for (int i = 0; i < 4; i++) s->t.tet[*unused].vertex[i] = NO_INDEX;
    return ins;
}

static void the_first_of_coincident_points_becomes_the_vertex(void) {
    brio_context *ctx = new_context();
    size_t unused, with_first = 0, with_later = 0;
    brio_inserter *ins = leave_insertion(ctx, &unused);
    const brio_store *s = ins->store;
    EXPECT(brio_represent(ins, false) == BRIO_OK);
    EXPECT(s->representative[FIRST] == FIRST && s->representative[LATER] == FIRST);
    for (size_t t = 0; t < unused; t++)
        for (int i = 0; i < 4; i++) {
            with_first += s->t.tet[t].vertex[i] == FIRST;
            with_later += s->t.tet[t].vertex[i] == LATER;
        }
    EXPECT(with_first == 4 && with_later == 0, "%zu and %zu corners", with_first, with_later);
    EXPECT(s->t.tet[unused].vertex[0] == NO_INDEX, "an unused slot is left alone");
    EXPECT(s->caller[FIRST] == FIRST && s->caller[LATER] == LATER, "the name goes with the vertex");
    EXPECT(s->representative[4] == 0 && ins->stats.duplicates == 2 && ins->stats.vertices == 4);
    insertion_end(ins);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_represent) {
    RUN(the_first_of_coincident_points_becomes_the_vertex);
    return harness_end();
}
