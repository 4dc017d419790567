/* brio delaunay --plane: triangles of two coordinates of the points, over the points in space. */
#include "cli/steps/plane.h"
#include "cli/files/read_write.h"
#include "cli/steps/estimate.h"
#include "cli/steps/properties.h"
#include <math.h>
#include <stdlib.h>

const option_choice cli_planes[] = {{"xy", PLANE_XY}, {"yz", PLANE_YZ}, {"zx", PLANE_ZX}, {NULL, 0}};

static const double COORDINATES = 16, ROWS = 24; /* bytes of a point in the plane; of one as a point of space */

/* Copies two coordinates of each point; to be freed with free(). */
static brio_status project(run *r, int plane, const brio_mesh *mesh, double **out) {
    size_t n = mesh->num_vertices, first = (size_t)plane, second = (first + 1) % 3;
    double *p = malloc(n ? 2 * n * sizeof *p : 1);
    *out = p;
    if (!p) return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for %zu points of the plane", n);
    for (size_t i = 0; i < n; i++) {
        p[2 * i] = mesh->vertices[3 * i + first];
        p[2 * i + 1] = mesh->vertices[3 * i + second];
    }
    return BRIO_OK;
}

static brio_status report(run *r, const brio_triangulation2 *t, const double *points, bool weighted) {
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    facts *f = &r->facts;
    uint64_t checksum;
    brio_status status = brio_triangulation2_checksum(r->ctx, t, points, &checksum);
    if (status != BRIO_OK) return status;
    cli_lap(r, "checksum");
    cli_fact_bool(f, "weighted", weighted);
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "vertices", s->vertices);
    cli_fact_count(f, "duplicates", s->duplicates);
    cli_fact_count(f, "hidden", s->hidden);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "triangles", s->triangles);
    cli_fact_count(f, "hull_edges", s->hull_edges);
    cli_fact_checksum(f, "checksum", checksum);
    cli_fact_count(f, "created", s->created);
    cli_fact_count(f, "destroyed", s->destroyed);
    cli_fact_count(f, "walk_steps", s->walk_steps);
    cli_fact_count(f, "incircle_calls", s->incircle_calls);
    cli_fact_count(f, "exact_calls", s->exact_calls);
    return BRIO_OK;
}

/* Gives the mesh the triangles as its faces. */
static brio_status set_faces(run *r, brio_mesh *mesh, const brio_triangulation2 *t) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    size_t n = brio_triangulation2_stats(t)->triangles;
    uint64_t *offsets = malloc((n + 1) * sizeof *offsets);
    uint32_t *indices = malloc(n ? 3 * n * sizeof *indices : 1);
    brio_status status = BRIO_OK;
    if (offsets && indices) {
        for (size_t i = 0; i <= n; i++) offsets[i] = 3 * i;
        for (size_t i = 0; i < 3 * n; i++) indices[i] = triangle[i / 3].vertex[i % 3];
        status = brio_mesh_set_faces(mesh, offsets, indices, n);
    } else {
        status = cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for %zu triangles", n);
    }
    free(offsets);
    free(indices);
    return status;
}

static brio_status triangulate(run *r, const double *points, const double *weights, size_t n,
                               const order_options *order, brio_triangulation2 **t) {
    brio_delaunay2_options o = {.size = sizeof o};
    o.seed = r->common.seed;
    o.order = cli_library_order(cli_order_of(order));
    if (!isnan(order->round_ratio)) o.round_ratio = order->round_ratio;
    brio_laboratory_options lab = {0};
    cli_order_experiment(order, &lab);
    FORWARD(cli_experiment(r, &lab));
    brio_status status = brio_delaunay2(r->ctx, points, weights, n, &o, t);
    brio_laboratory_end(r->lab);
    if (status != BRIO_OK) return status;
    cli_stage(r, "order", brio_triangulation2_stats(*t)->order_seconds);
    cli_stage(r, "insert", brio_triangulation2_stats(*t)->insert_seconds);
    r->lap = cli_clock();
    return cli_check_interrupt(r);
}

static brio_status verify_result(run *r, const brio_triangulation2 *t, const double *points, const double *weights) {
    brio_status status = brio_triangulation2_check(r->ctx, t, points, weights, brio_triangulation2_stats(t)->points);
    cli_lap(r, "verify");
    if (status == BRIO_OK || status == BRIO_ERR_CHECK) cli_fact_bool(&r->facts, "verified", status == BRIO_OK);
    return status;
}

brio_status cli_plane(run *r, int plane, brio_mesh *mesh, const double *weights, const order_options *order,
                      bool verify) {
    brio_triangulation2 *t = NULL;
    double *points = NULL;
    size_t n = mesh->num_vertices;
    uint64_t work = brio_estimate_delaunay2(n, weights != NULL) +
                    (uint64_t)((COORDINATES + (cli_order_of(order) == BRIO_ORDER_BRIO ? 0 : ROWS)) * (double)n);
    brio_status status = BRIO_OK;
    TRY(cli_require_work(r, BRIO_OK, mesh, work));
    TRY(project(r, plane, mesh, &points));
    TRY(triangulate(r, points, weights, n, order, &t));
    TRY(report(r, t, points, weights != NULL));
    if (verify) TRY(verify_result(r, t, points, weights));
    if (!cli_wants_mesh(r)) goto done;
    TRY(cli_add_representatives(r, mesh, brio_triangulation2_representatives(t)));
    TRY(set_faces(r, mesh, t));
    TRY(cli_write(r, mesh));
done:
    brio_triangulation2_free(t);
    free(points);
    return status;
}
