/* Point location by jump-and-walk, as in the program pyramid.
 *
 * With i points inserted, the walk starts from the nearest of the last inserted vertex and i^(1/4) random vertices
 * among these points. The expected walk has O(i^(1/4)) steps among uniform points.
 *
 * Based on: Muecke, Saias, Zhu. Fast randomized point location without preprocessing in two- and three-dimensional
 * Delaunay triangulations. CGTA 1999. */
#include "base/memory.h"
#include "base/rng.h"
#include "laboratory/location/trial.h"
#include "triangulation/vertex_tets.h"
#include <assert.h>

typedef struct {
    uint32_t *vertex_tet, last;
    brio_rng rng;
} jump;

static brio_status start_jump(brio_inserter *ins) {
    const brio_store *s = ins->store;
    jump *own = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, own, 1));
    ins->location = own;
    own->rng = brio_rng_new(brio_trial_of(ins)->seed);
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, own->vertex_tet, s->num_points + 3));
    brio_vertex_tets_fill(s, own->vertex_tet);
    return BRIO_OK;
}

static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    const brio_store *s = ins->store;
    jump *own = ins->location;
    const double *point = s->record[p];
    uint32_t best = own->last;
    double least = brio_square_distance(point, s->record[best]);
    for (int samples = (int)sqrt(sqrt(p)); samples > 0; samples--) {
        uint32_t v = brio_rng_below(&own->rng, p);
        double square = brio_square_distance(point, s->record[v]);
        brio_touch_record(brio_touches_of(ins), v);
        if (s->representative[v] == v && square < least) best = v, least = square;
    }
    assert(s->representative[best] == best); /* a vertex has a tetrahedron */
    ins->walk.start = own->vertex_tet[best];
    *tet = brio_inserter_walk(ins, point, UINT64_MAX);
    return BRIO_OK;
}

static brio_status filled(brio_inserter *ins, uint32_t p) {
    jump *own = ins->location;
    BRIO_FORWARD(brio_count_insertion(ins, p));
    brio_vertex_tets_filled(ins, own->vertex_tet);
    own->last = p;
    return BRIO_OK;
}

static void free_jump(brio_inserter *ins) {
    const brio_store *s = ins->store;
    jump *own = ins->location;
    if (own) brio_release(s->ctx, own->vertex_tet);
    brio_release(s->ctx, own);
    ins->location = NULL;
}

const brio_strategy brio_strategy_jump = {start_jump, locate, filled, free_jump};
