/* Point location from a neighbour: the walk starts from the nearest of the last inserted vertex and the point's
 * inserted neighbours along the caller's edges.
 *
 * If the edges belong to a surface from which the points were taken, most of the edges are in the final triangulation.
 * Then a walk crosses few tetrahedra.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 4.5. */
#include "base/memory.h"
#include "laboratory/location/point_graph.h"
#include "laboratory/location/trial.h"
#include "triangulation/vertex_tets.h"
#include <assert.h>

typedef struct {
    brio_point_graph graph;
    uint32_t *vertex_tet, last;
} neighbours;

static brio_status start_neighbours(brio_inserter *ins) {
    const brio_store *s = ins->store;
    neighbours *own = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, own, 1));
    ins->location = own;
    BRIO_TRY(BRIO_ALLOC(s->ctx, own->vertex_tet, s->num_points + 3));
    brio_vertex_tets_fill(s, own->vertex_tet);
    status = brio_point_graph_new(s, brio_trial_of(ins)->options, &own->graph);
done:
    return status;
}

static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    const brio_store *s = ins->store;
    const neighbours *own = ins->location;
    const brio_point_graph *graph = &own->graph;
    const double *point = s->record[p];
    uint32_t best = own->last;
    double least = brio_square_distance(point, s->record[best]);
    for (uint32_t e = graph->first[p]; e < graph->first[p + 1]; e++) {
        if (graph->neighbour[e] >= p) continue;
        uint32_t v = brio_alive(s, graph->neighbour[e]);
        double square = brio_square_distance(point, s->record[v]);
        brio_touch_record(brio_touches_of(ins), v);
        if (square < least) best = v, least = square;
    }
    assert(s->representative[best] == best); /* a vertex has a tetrahedron */
    ins->walk.start = own->vertex_tet[best];
    *tet = brio_inserter_walk(ins, point, UINT64_MAX);
    return BRIO_OK;
}

static brio_status filled(brio_inserter *ins, uint32_t p) {
    neighbours *own = ins->location;
    BRIO_FORWARD(brio_count_insertion(ins, p));
    brio_vertex_tets_filled(ins, own->vertex_tet);
    own->last = p;
    return BRIO_OK;
}

static void free_neighbours(brio_inserter *ins) {
    const brio_store *s = ins->store;
    neighbours *own = ins->location;
    if (own) {
        brio_release(s->ctx, own->vertex_tet);
        brio_point_graph_free(s->ctx, &own->graph);
    }
    brio_release(s->ctx, own);
    ins->location = NULL;
}

const brio_strategy brio_strategy_neighbour = {start_neighbours, locate, filled, free_neighbours};
