/* brio check: the certificate of the faces of a file, the exact Delaunay check of its tetrahedra, or both; of a file of
 * edges alone the certificate of its curves. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/coverage.h"
#include "cli/steps/curve.h"
#include "cli/steps/hints.h"
#include "cli/steps/weights.h"
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    weights_options weights;
    bool open, self_intersections;
    const char *samples;
} arguments;

static const option options[] = {
    WEIGHTS_ROWS(arguments, weights),
    {"open", 0, OPTION_FLAG, offsetof(arguments, open), NULL, "a surface may have a boundary, curves ends", 0},
    {"self-intersections", 0, OPTION_FLAG, offsetof(arguments, self_intersections), NULL,
     "faces may not run through each other; counts the pairs that do", 0},
    {"samples", 0, OPTION_INPUT, offsetof(arguments, samples), "FILE",
     "points that the surface is to go through: what of it they do not show, and which it leaves", 0},
    {0},
};

static const arguments defaults = {.weights.exponent = NO_EXPONENT};

/* Reports a fault of the call as one of the file: an index out of range is a fault of the file here, not of the
 * call. */
static brio_status blame_file(run *r, brio_status status) {
    if (status != BRIO_ERR_ARGUMENT) return status;
    return cli_fail(r, BRIO_ERR_FORMAT, "%s: %s", r->operands[0], brio_message(r->ctx));
}

static brio_status check_tetrahedra(run *r, const arguments *a, const brio_mesh *mesh) {
    double *weights = NULL;
    int canonical = 0;
    brio_status status = BRIO_OK;
    TRY(cli_weights(r, &a->weights, mesh, &weights));
    r->lap = cli_clock();
    status = brio_tetrahedra_check(r->ctx, mesh->vertices, weights, mesh->num_vertices, mesh->tetrahedra, 4,
                                   mesh->num_tetrahedra, &canonical);
    cli_lap(r, "check");
    if (status == BRIO_OK || status == BRIO_ERR_CHECK) {
        cli_fact_bool(&r->facts, "weighted", weights != NULL);
        cli_fact_bool(&r->facts, "verified", status == BRIO_OK);
        cli_fact_bool(&r->facts, "canonical", status == BRIO_OK && canonical);
    }
    status = blame_file(r, status);
done:
    free(weights);
    return status;
}

/* Refuses options about what the file does not have. */
static brio_status refuse_idle(run *r, const arguments *a, const brio_mesh *mesh) {
    const struct {
        const char *name, *what;
        bool idle;
    } given[] = {{"weights", "tetrahedra", a->weights.file && !mesh->num_tetrahedra},
                 {"weights-mod", "tetrahedra", a->weights.exponent != NO_EXPONENT && !mesh->num_tetrahedra},
                 {"unweighted", "tetrahedra", a->weights.unweighted && !mesh->num_tetrahedra},
                 {"open", "faces or edges", a->open && !mesh->num_faces && !mesh->num_edges},
                 {"self-intersections", "faces", a->self_intersections && !mesh->num_faces},
                 {"samples", "faces", a->samples && !mesh->num_faces}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        if (given[i].idle)
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s is about %s, and %s has none", given[i].name, given[i].what,
                            r->operands[0]);
    return BRIO_OK;
}

/* Holds the surface against the points of a file. */
static brio_status compare_with_samples(run *r, const brio_mesh *mesh, const char *path) {
    brio_mesh *points = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_read_points(r, path, &points));
    if (!points->num_vertices) FAIL(r, BRIO_ERR_NO_ANSWER, "%s: no points", path);
    TRY(cli_report_coverage(r, mesh, points));
done:
    brio_mesh_free(points);
    return status;
}

/* Checks all that the file has: the edges of curves, or tetrahedra, then faces, then faces by samples. */
static brio_status judge(run *r, const arguments *a, const brio_mesh *mesh) {
    unsigned how = (a->open ? CERTIFY_OPEN : 0u) | (a->self_intersections ? CERTIFY_EMBEDDED : 0u);
    brio_status status = BRIO_OK;
    if (!mesh->num_faces && !mesh->num_tetrahedra) return blame_file(r, cli_check_edges(r, mesh, a->open));
    if (mesh->num_tetrahedra) FORWARD(check_tetrahedra(r, a, mesh));
    if (mesh->num_faces) status = blame_file(r, cli_certify(r, mesh, how | CERTIFY_INPUT));
    if (a->samples && (status == BRIO_OK || status == BRIO_ERR_CHECK))
        FORWARD(compare_with_samples(r, mesh, a->samples));
    return status;
}

/* Shows the mesh, right or wrong. The sentence of the failure is what was found of it, or why it cannot be shown. */
static brio_status show(run *r, brio_status judged, const brio_mesh *mesh) {
    const brio_failure why = r->failure;
    char found[sizeof r->message];
    if (judged != BRIO_OK && judged != BRIO_ERR_CHECK) return judged;
    memcpy(found, r->message, sizeof found);
    r->message[0] = 0;
    FORWARD(cli_show(r, mesh));
    memcpy(r->message, found, sizeof found);
    r->failure = why;
    return judged;
}

static brio_status check(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_check_weights_options(r, &a->weights));
    if (r->common.output) FAIL(r, BRIO_ERR_ARGUMENT, "check writes no file; -o has no meaning here");
    TRY(cli_read(r, r->operands[0], &mesh));
    bool curves = !mesh->num_faces && !mesh->num_tetrahedra;
    if (curves && !mesh->num_edges) {
        cli_hint(r, HINT_SURFACE);
        FAIL(r, BRIO_ERR_FORMAT, "%s: expected faces or tetrahedra to check, found points only", r->operands[0]);
    }
    TRY(refuse_idle(r, a, mesh));
    cli_fact_count(&r->facts, "vertices", mesh->num_vertices);
    cli_fact_count(&r->facts, "faces", mesh->num_faces);
    cli_fact_count(&r->facts, "tetrahedra", mesh->num_tetrahedra);
    if (curves) cli_fact_count(&r->facts, "edges", mesh->num_edges);
    status = judge(r, a, mesh);
    cli_examine(r, status, mesh);
    status = show(r, status, mesh);
done:
    brio_mesh_free(mesh);
    return status;
}

const command cli_check = {
    .name = "check",
    .operands = "FILE",
    .summary = "certificate of a surface or of curves, or exact Delaunay check of tetrahedra",
    .description =
        "Exit code 5 says that the file does not pass, the report and the message why. A file of edges alone "
        "has curves: whether they are closed, where they end, and whether they branch.",
    .examples = "brio check surface.ply\nclosed, manifold, oriented?\n"
                "brio check surface.ply --self-intersections\ndo faces run through each other, too?\n"
                "brio check surface.ply --open --samples scan.ply\nwhat of it did the scan see?\n"
                "brio check surface.ply --self-intersections --view flaws.html\na page that shows where it fails\n"
                "brio check tetrahedra.vtu\nare the tetrahedra Delaunay?\n",
    .shown = true,
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = check,
};
