/* brio tree: the Euclidean minimum spanning tree of the points of a file. */
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/steps/curve.h"
#include "cli/steps/estimate.h"
#include "cli/steps/plane.h"
#include "cli/steps/properties.h"
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    int plane;
} arguments;

static const option options[] = {
    {"plane", 0, OPTION_CHOICE, offsetof(arguments, plane), "NAME", "the tree of two coordinates of the points",
     cli_planes},
    {0},
};

static const arguments defaults = {.plane = NO_PLANE};

/* Bytes of an edge of the triangulation, which has about eight a point. */
static const double EDGE_BYTES = 32, EDGES = 8;

/* Copies the points, with 0 for the coordinate that is off the plane; to be freed with free(). */
static brio_status project(run *r, int plane, const brio_mesh *mesh, double **out) {
    size_t n = mesh->num_vertices, off = ((size_t)plane + 2) % 3;
    double *p = malloc(3 * n * sizeof *p + 1);
    *out = p;
    if (!p) return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for %zu points of the plane", n);
    memcpy(p, mesh->vertices, 3 * n * sizeof *p);
    for (size_t i = 0; i < n; i++) p[3 * i + off] = 0;
    return BRIO_OK;
}

static void report(run *r, const brio_spanning_tree_stats *s) {
    facts *f = &r->facts;
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "tree", s->tree_seconds);
    r->lap = cli_clock();
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "duplicates", s->points - s->vertices);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "vertices", s->vertices);
    cli_fact_count(f, "edges", s->edges);
    cli_fact_real(f, "length", s->length);
    cli_fact_count(f, "exact_calls", s->exact_calls);
}

/* Gives the vertices the places and the properties of their points. */
static brio_status complete(run *r, const brio_mesh *points, brio_mesh *tree) {
    const brio_property *sample = brio_mesh_property(tree, "sample");
    uint32_t *samples = malloc((tree->num_vertices + 1) * sizeof *samples);
    if (!samples) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", tree->num_vertices);
    for (size_t i = 0; i < tree->num_vertices; i++) {
        samples[i] = (uint32_t)brio_property_value(sample, i);
        memcpy(tree->vertices + 3 * i, points->vertices + 3 * (size_t)samples[i], 3 * sizeof *tree->vertices);
    }
    brio_status status = cli_carry_properties(r, points, samples, tree);
    free(samples);
    return status;
}

static brio_status spanning_tree(run *r) {
    const arguments *a = r->arguments;
    brio_delaunay_options o = {0};
    brio_spanning_tree_stats s = {0};
    brio_mesh *points = NULL, *result = NULL;
    double *projected = NULL, bytes;
    brio_status status = BRIO_OK;
    TRY(cli_require_output(r, true));
    TRY(cli_require_edges(r));
    TRY(cli_read_points(r, r->operands[0], &points));
    TRY(cli_delaunay_bytes(r, points, NULL, &o, &bytes));
    TRY(cli_require_memory(r, bytes + EDGES * EDGE_BYTES * (double)points->num_vertices));
    if (a->plane != NO_PLANE) TRY(project(r, a->plane, points, &projected));
    TRY(brio_spanning_tree(r->ctx, projected ? projected : points->vertices, points->num_vertices, &result, &s));
    report(r, &s);
    TRY(cli_check_interrupt(r));
    if (!cli_wants_mesh(r)) goto done;
    TRY(complete(r, points, result));
    TRY(cli_write(r, result));
done:
    free(projected);
    brio_mesh_free(points);
    brio_mesh_free(result);
    return status;
}

const command cli_tree = {
    .name = "tree",
    .operands = "IN",
    .summary = "Euclidean minimum spanning tree of points, in space or in a plane",
    .description =
        "Edges that join all points, with the least sum of lengths. Lengths are compared exactly, and the tree "
        "is the same for every order of the points. Without -o it is reported and not written.",
    .examples = "brio tree points.ply -o tree.vtp\nedges for ParaView\n"
                "brio tree lidar.las --plane xy -o tree.ply\nthe tree of the map, over the points in space\n",
    .has_output = true,
    .holds = CLI_EDGES,
    .output_optional = true,
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = spanning_tree,
};
