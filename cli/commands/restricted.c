/* brio restricted: the restricted Delaunay triangulation of samples on a known surface, and whether it is homeomorphic
 * to it. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include <string.h>

typedef struct arguments {
    const char *surface;
} arguments;

static const option options[] = {
    {"surface", 0, OPTION_INPUT, offsetof(arguments, surface), "FILE", "the surface: triangles, closed", 0},
    {0},
};

static const arguments defaults = {0};

static void report(run *r, const brio_mesh *samples, const brio_mesh *triangles, const brio_restricted_stats *s) {
    facts *f = &r->facts;
    cli_stage(r, "insert", s->delaunay_seconds);
    cli_stage(r, "cut", s->cut_seconds);
    r->lap = cli_clock();
    cli_fact_count(f, "points", samples->num_vertices);
    cli_fact_count(f, "faces", triangles->num_faces);
    cli_fact_bool(f, "closed_ball", s->closed_ball != 0);
    cli_fact_bool(f, "homeomorphic", s->closed_ball != 0);
    cli_fact_count(f, "voronoi_cells", s->cells);
    cli_fact_count(f, "voronoi_facets", s->facets);
    cli_fact_count(f, "voronoi_edges", s->edges);
    cli_fact_count(f, "bad_cells", s->bad_cells);
    cli_fact_count(f, "bad_facets", s->bad_facets);
    cli_fact_count(f, "bad_edges", s->bad_edges);
    cli_fact_count(f, "crossings", s->crossings);
    cli_fact_count(f, "exact_calls", s->exact_calls);
    cli_fact_count(f, "ties", s->ties);
}

/* Fails without a certificate of the surface. What each line of the report stands on is in brio_restricted_delaunay. */
static brio_status refuse_uncertified(run *r, const brio_restricted_stats *s) {
    if (s->closed_ball) return BRIO_OK;
    return cli_fail(
        r, BRIO_ERR_CHECK,
        "no closed-ball property: %zu cells meet the surface in no disk, %zu facets in no arc, %zu edges in more "
        "than a point; so the triangles are not known to be homeomorphic to the surface",
        s->bad_cells, s->bad_facets, s->bad_edges);
}

static brio_status restricted(run *r) {
    const arguments *a = r->arguments;
    brio_restricted_stats s = {0};
    brio_delaunay_options o = {0};
    brio_mesh *samples = NULL, *surface = NULL, *triangles = NULL;
    brio_status status = BRIO_OK;
    double bytes;
    if (!a->surface) FAIL(r, BRIO_ERR_ARGUMENT, "no surface: --surface FILE is missing");
    if (!strcmp(r->operands[0], "-") && !strcmp(a->surface, "-"))
        FAIL(r, BRIO_ERR_ARGUMENT, "the samples and --surface both want standard input");
    TRY(cli_require_output(r, true));
    TRY(cli_read_points(r, r->operands[0], &samples));
    TRY(cli_read(r, a->surface, &surface));
    if (!surface->num_faces) {
        cli_hint(r, HINT_SURFACE);
        FAIL(r, BRIO_ERR_FORMAT, "%s: expected a surface, found no faces", a->surface);
    }
    TRY(cli_delaunay_bytes(r, samples, NULL, &o, &bytes));
    TRY(cli_require_memory(r, 2 * bytes + 100.0 * (double)surface->num_faces));
    TRY(brio_restricted_delaunay(r->ctx, samples->vertices, samples->num_vertices, surface, &triangles, &s));
    report(r, samples, triangles, &s);
    TRY(cli_check_interrupt(r));
    TRY(cli_certify(r, triangles, CERTIFY_ANYTHING));
    TRY(cli_write(r, triangles));
    TRY(refuse_uncertified(r, &s));
done:
    brio_mesh_free(samples);
    brio_mesh_free(surface);
    brio_mesh_free(triangles);
    return status;
}

const command cli_restricted = {
    .name = "restricted",
    .operands = "SAMPLES",
    .summary = "Delaunay triangles of samples restricted to a known surface; whether they are homeomorphic to it",
    .description =
        "A triangle is restricted when its Voronoi edge meets the surface. If each cell, facet and edge of the "
        "Voronoi diagram meets the surface in a closed ball (a disk, an arc, a point) or not at all, the triangles "
        "are homeomorphic to the surface. Both are decided exactly. Exit code 5 says that the property does not hold.",
    .examples =
        "brio restricted samples.ply --surface mesh.ply -o triangles.ply\nalso says whether they are proven right\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .output_optional = true,
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = restricted,
};
