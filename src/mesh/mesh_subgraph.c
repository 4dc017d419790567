/* Dispatches on the kind of subgraph. The trees use the list of all edges; the subgraph of bounded degree uses the
 * triangles. */
#include "mesh/spanning_subgraph.h"
#include "base/float_state.h"

static brio_status spanning_tree(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out) {
    brio_status status = BRIO_OK;
    brio_edges all = {0};
    BRIO_TRY(brio_mesh_edges(ctx, mesh, &all));
    BRIO_TRY(brio_progress(ctx, "subgraph", 0.5));
    if (kind == BRIO_SUBGRAPH_MINIMUM)
        BRIO_TRY(brio_minimum_spanning_tree(ctx, &all, mesh->vertices, mesh->num_vertices, out));
    else
        BRIO_TRY(brio_breadth_first_tree(ctx, &all, mesh->num_vertices, out));
done:
    brio_edges_free(&all);
    return status;
}

brio_status brio_mesh_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out) {
    BRIO_DOOR;
    *out = (brio_edges){.context = ctx};
    switch (kind) {
    case BRIO_SUBGRAPH_BOUNDED:
        return brio_spanning_subgraph(ctx, mesh, out, NULL);
    case BRIO_SUBGRAPH_MINIMUM:
    case BRIO_SUBGRAPH_TREE:
        return spanning_tree(ctx, mesh, kind, out);
    case BRIO_SUBGRAPH_ALL:
        return brio_mesh_edges(ctx, mesh, out);
    case BRIO_SUBGRAPH_END:
        break;
    }
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "no kind of subgraph %d", (int)kind);
}
