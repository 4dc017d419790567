/* Point location by tracing edges: Tracing DT.
 *
 * When N(h) points are in, h = 1, 2, ..., a graph over all points is traced through the triangulation. The tracing
 * follows edges from the inserted vertices to all other points and remembers the tetrahedron of each point. Later the
 * history DAG locates a point from the tetrahedron where the point was last traced. N(h) = n / ln ln ... ln n, with h
 * logarithms, so there are log* n tracings. Between two tracings, locations cost O(n) together when points come in
 * random order. A tracing crosses O(n) triangles when the edges are Delaunay edges of all points and their degrees are
 * bounded.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms for surface reconstruction and related problems. 2003,
 * chapter 4.
 * Differs from the paper: the graph is traversed breadth first from all vertices at once. So each point that is not in
 * yet is the end of one walk, and no other edge is walked. A component of the graph without a vertex is entered by one
 * location in the history DAG. Points without edges are never traced. */
#include "base/memory.h"
#include "laboratory/location/history.h"
#include "laboratory/location/locate_segment.h"
#include "laboratory/location/point_graph.h"
#include "triangulation/vertex_tets.h"
#include <assert.h>

typedef struct {
    brio_history history;
    brio_point_graph graph;
    uint32_t *node;   /* node of the history DAG where each record was last traced */
    double logarithm; /* ln applied h times to the number of points, h being the next tracing's index */
} trace;

/* One tracing. */
typedef struct {
    brio_inserter *ins;
    trace *own;
    uint32_t *tet;   /* tetrahedron of each record found, else BRIO_NO_TET */
    uint32_t *queue; /* the records found; those in [0, head) have been traced from */
    size_t head, tail;
} tracing;

static brio_status start_trace(brio_inserter *ins) {
    const brio_store *s = ins->store;
    trace *own = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, own, 1));
    ins->location = own;
    own->logarithm = log((double)s->num_points);
    BRIO_FORWARD(brio_history_new(ins, &own->history));
    BRIO_FORWARD(brio_point_graph_new(s, brio_trial_of(ins)->options, &own->graph));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, own->node, s->num_points));
    for (size_t p = 0; p < s->num_points; p++) own->node[p] = BRIO_HISTORY_ROOT;
    return BRIO_OK;
}

static void found(tracing *t, uint32_t p, uint32_t tet) {
    assert(t->tail < t->ins->store->num_points && t->ins->store->state[tet] == TET_PLAIN);
    t->tet[p] = tet;
    t->queue[t->tail++] = p;
}

/* Traces from the records in the queue to all records that their edges reach. */
static void trace_edges(tracing *t) {
    brio_inserter *ins = t->ins;
    const brio_store *s = ins->store;
    const brio_point_graph *graph = &t->own->graph;
    while (t->head < t->tail) {
        uint32_t u = t->queue[t->head++];
        for (uint32_t e = graph->first[u]; e < graph->first[u + 1]; e++) {
            assert(t->tet[u] != BRIO_NO_TET);
            uint32_t w = graph->neighbour[e];
            if (t->tet[w] != BRIO_NO_TET) continue;
            uint64_t entered = 0;
            found(t, w, brio_locate_segment(ins, t->tet[u], s->record[u], s->record[w], &entered));
            t->own->history.stats->trace_intersections += entered;
            ins->searched += entered;
        }
    }
}

/* Traces from the vertices first, then from components of the graph without a vertex. */
static void trace_all(tracing *t) {
    brio_inserter *ins = t->ins;
    const brio_store *s = ins->store;
    const brio_point_graph *graph = &t->own->graph;
    for (size_t p = 0; p < s->num_points + 3; p++) t->tet[p] = BRIO_NO_TET;
    brio_vertex_tets_fill(s, t->tet);
    for (uint32_t p = 0; p < s->num_points; p++)
        if (t->tet[p] != BRIO_NO_TET) t->queue[t->tail++] = p;
    trace_edges(t);
    for (uint32_t p = 0; p < s->num_points; p++) {
        if (t->tet[p] != BRIO_NO_TET || graph->first[p] == graph->first[p + 1]) continue;
        found(t, p, brio_history_path(ins, &t->own->history, t->own->node[p], s->record[p]));
        trace_edges(t);
    }
    for (size_t i = 0; i < t->tail; i++) t->own->node[t->queue[i]] = t->own->history.node_of[t->tet[t->queue[i]]];
}

static brio_status trace_now(brio_inserter *ins, trace *own) {
    const brio_store *s = ins->store;
    tracing t = {.ins = ins, .own = own};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(s->ctx, t.tet, s->num_points + 3));
    BRIO_TRY(BRIO_ALLOC(s->ctx, t.queue, s->num_points));
    trace_all(&t);
done:
    brio_release(s->ctx, t.tet);
    brio_release(s->ctx, t.queue);
    return status;
}

static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    const brio_store *s = ins->store;
    trace *own = ins->location;
    if (own->logarithm > 1 && (double)p >= (double)s->num_points / own->logarithm) {
        brio_status status = trace_now(ins, own);
        if (status != BRIO_OK) return status;
        own->logarithm = log(own->logarithm);
    }
    return brio_history_locate(ins, &own->history, own->node[p], s->record[p], tet);
}

static brio_status filled(brio_inserter *ins, uint32_t p) {
    trace *own = ins->location;
    BRIO_FORWARD(brio_count_insertion(ins, p));
    return brio_history_add(ins, &own->history);
}

static void free_trace(brio_inserter *ins) {
    const brio_store *s = ins->store;
    trace *own = ins->location;
    if (own) {
        brio_history_free(s->ctx, &own->history);
        brio_point_graph_free(s->ctx, &own->graph);
        brio_release(s->ctx, own->node);
    }
    brio_release(s->ctx, own);
    ins->location = NULL;
}

const brio_strategy brio_strategy_trace = {start_trace, locate, filled, free_trace};
