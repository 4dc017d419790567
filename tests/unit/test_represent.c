/* Representatives of coincident points after a parallel insertion. */
#include "harness.h"
#include "points.h"
#include "base/memory.h"
#include "triangulation/kernel.h"
#include <string.h>

enum { POINTS = 6, FIRST = 1, LATER = 5, SLOTS = 2, NO_INDEX = 0x7ffda5a5 };

/* A kernel as threads may leave it: record 1 was deferred, its twin 5 became the vertex, and 1 was absorbed by it. */
static void make_kernel(brio_kernel *k, brio_context *ctx) {
    static const double position[POINTS][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}};
    *k = (brio_kernel){.ctx = ctx, .num_points = POINTS, .dimension = 3};
    EXPECT(BRIO_ALLOC_ZERO(ctx, k->record, POINTS + 3) == BRIO_OK && BRIO_ALLOC(ctx, k->caller, POINTS + 3) == BRIO_OK);
    EXPECT(BRIO_ALLOC(ctx, k->representative, POINTS + 3) == BRIO_OK);
    EXPECT(BRIO_ALLOC_ZERO(ctx, k->rank, POINTS + 3) == BRIO_OK && BRIO_ALLOC_ZERO(ctx, k->t.tet, SLOTS) == BRIO_OK);
    EXPECT(BRIO_ALLOC(ctx, k->state, SLOTS) == BRIO_OK);
    for (uint32_t i = 0; i < POINTS + 3; i++) k->caller[i] = 100 + i, k->representative[i] = i;
    for (int i = 0; i < POINTS; i++) memcpy(k->record[i], position[i], sizeof position[i]);
    k->t.record = k->record;
    k->t.infinite = POINTS + 2;
    k->t.count = SLOTS;
    k->num_unused = 1;
    k->state[0] = TET_PLAIN, k->state[1] = TET_UNUSED;
    for (int i = 0; i < 4; i++) k->t.tet[1].vertex[i] = NO_INDEX; /* what an unused slot holds may be anything */
    memcpy(k->t.tet[0].vertex, (uint32_t[]){LATER, 0, 2, 3}, sizeof k->t.tet[0].vertex);
    k->representative[4] = 0;
    k->representative[FIRST] = LATER;
    k->caller[FIRST] = 100 + LATER, k->caller[LATER] = 100 + FIRST; /* the lower index keeps the name */
}

static void free_kernel(brio_kernel *k) {
    brio_release(k->ctx, k->record);
    brio_release(k->ctx, k->caller);
    brio_release(k->ctx, k->representative);
    brio_release(k->ctx, k->rank);
    brio_release(k->ctx, k->t.tet);
    brio_release(k->ctx, k->state);
}

static void the_first_of_coincident_points_becomes_the_vertex(void) {
    brio_context *ctx = new_context();
    brio_kernel k;
    make_kernel(&k, ctx);
    EXPECT(brio_kernel_represent(&k) == BRIO_OK);
    EXPECT(k.representative[FIRST] == FIRST && k.representative[LATER] == FIRST);
    EXPECT(k.t.tet[0].vertex[0] == FIRST, "vertex %u", k.t.tet[0].vertex[0]);
    EXPECT(k.t.tet[1].vertex[0] == NO_INDEX, "an unused slot is left alone");
    EXPECT(k.caller[FIRST] == 100 + FIRST && k.caller[LATER] == 100 + LATER, "the name goes with the vertex");
    EXPECT(k.representative[4] == 0 && k.stats.duplicates == 2 && k.stats.vertices == 4);
    free_kernel(&k);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

int main(void) {
    RUN(the_first_of_coincident_points_becomes_the_vertex);
    return harness_end();
}
