/* Chooses and makes the subgraph of a mesh's edges that a location goes along. */
#include "mesh_edges.h"
#include <stdlib.h>

const option_choice cli_subgraphs[] = {{"bounded", BRIO_SUBGRAPH_BOUNDED},
                                       {"mst", BRIO_SUBGRAPH_MINIMUM},
                                       {"tree", BRIO_SUBGRAPH_TREE},
                                       {"all", BRIO_SUBGRAPH_ALL},
                                       {NULL, 0}};

bool cli_needs_edges(brio_location location) {
    return location == BRIO_LOCATION_TRACE || location == BRIO_LOCATION_NEIGHBOUR;
}

static brio_status report(run *r, const brio_mesh *mesh, brio_subgraph kind, const brio_edges *edges) {
    uint32_t *degree = calloc(mesh->num_vertices + 1, sizeof *degree), most = 0;
    if (!degree)
        return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for the degrees of %zu vertices", mesh->num_vertices);
    for (size_t i = 0; i < 2 * edges->count; i++) {
        uint32_t d = ++degree[edges->ends[i]];
        if (d > most) most = d;
    }
    free(degree);
    const option_choice *name = cli_subgraphs;
    while (name->value != (int)kind) name++;
    cli_fact_open(&r->facts, "subgraph", FACT_OBJECT);
    cli_fact_text(&r->facts, "kind", name->name);
    cli_fact_count(&r->facts, "edges", edges->count);
    cli_fact_count(&r->facts, "max_degree", most);
    cli_fact_close(&r->facts);
    return BRIO_OK;
}

brio_status cli_mesh_edges(run *r, const brio_mesh *mesh, brio_location location, int subgraph, brio_edges *out) {
    brio_status status = BRIO_OK;
    bool fitting = subgraph == SUBGRAPH_FITTING;
    brio_subgraph kind = (brio_subgraph)subgraph;
    if (!mesh->num_faces)
        return cli_fail(r, BRIO_ERR_FORMAT, "%s: expected a surface mesh to go along, found no faces", r->operands[0]);
    if (fitting) kind = location == BRIO_LOCATION_TRACE ? BRIO_SUBGRAPH_BOUNDED : BRIO_SUBGRAPH_ALL;
    status = brio_mesh_subgraph(r->ctx, mesh, kind, out);
    if (status == BRIO_ERR_NO_ANSWER && fitting) {
        kind = BRIO_SUBGRAPH_MINIMUM;
        status = brio_mesh_subgraph(r->ctx, mesh, kind, out);
    }
    TRY(status);
    TRY(report(r, mesh, kind, out));
    cli_lap(r, "subgraph");
done:
    return status;
}
