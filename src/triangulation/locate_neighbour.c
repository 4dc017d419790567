/* Point location from a neighbour: the walk starts from the nearest of the point's neighbours along the caller's edges
 * that are in already, and of the last inserted vertex.
 *
 * Where the edges are those of a surface that the points were taken from, most of them are in the final triangulation,
 * and a walk has few tetrahedra to cross.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 4.5. */
#include "base/memory.h"
#include "triangulation/point_graph.h"
#include "triangulation/vertex_tets.h"

typedef struct {
    brio_point_graph graph;
    uint32_t *vertex_tet, last;
} neighbours;

static brio_status start_neighbours(brio_kernel *k, const brio_delaunay_options *options) {
    neighbours *own = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, own, 1));
    k->location = own;
    BRIO_TRY(BRIO_ALLOC(k->ctx, own->vertex_tet, k->num_points + 3));
    brio_vertex_tets_fill(k, own->vertex_tet);
    status = brio_point_graph_new(k, options, &own->graph);
done:
    return status;
}

static brio_status locate(brio_kernel *k, uint32_t p, uint32_t *tet) {
    const neighbours *own = k->location;
    const brio_point_graph *graph = &own->graph;
    const double *point = k->record[p];
    uint32_t best = own->last;
    double least = brio_square_distance(point, k->record[best]);
    for (uint32_t e = graph->first[p]; e < graph->first[p + 1]; e++) {
        if (graph->neighbour[e] >= p) continue;
        uint32_t v = brio_alive(k, graph->neighbour[e]);
        double square = brio_square_distance(point, k->record[v]);
        if (square < least) best = v, least = square;
    }
    k->walk.start = own->vertex_tet[best];
    *tet = k->engine->walk(&k->t, &k->filter, &k->walk, point, UINT64_MAX);
    return BRIO_OK;
}

static brio_status filled(brio_kernel *k, uint32_t p) {
    neighbours *own = k->location;
    brio_vertex_tets_filled(k, own->vertex_tet);
    own->last = p;
    return BRIO_OK;
}

static void free_neighbours(brio_kernel *k) {
    neighbours *own = k->location;
    if (own) {
        brio_release(k->ctx, own->vertex_tet);
        brio_point_graph_free(k->ctx, &own->graph);
    }
    brio_release(k->ctx, own);
    k->location = NULL;
}

const brio_locator brio_locator_neighbour = {start_neighbours, locate, filled, free_neighbours};
