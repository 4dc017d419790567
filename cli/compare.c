/* brio compare: distances and normal deviation between two surfaces; signed distances of points from a surface. */
#include "commands.h"
#include "compare_cloud.h"
#include "estimate.h"
#include <string.h>

typedef struct arguments {
    uint64_t samples;
    double within;
} arguments;

static const option options[] = {
    {"samples", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(arguments, samples), "N",
     "points on each of two surfaces (default 100000)", 0},
    {"within", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, within), "D",
     "exit with code 5 if a point is farther than D", 0},
    {0},
};

static const arguments defaults = {0};

static void report_distance(facts *f, const brio_distance *d) {
    const struct {
        const char *name;
        double distance;
    } rows[] = {{"mean", d->mean}, {"rms", d->rms}, {"p95", d->p95}, {"hausdorff", d->hausdorff}};
    for (int i = 0; i < 4; i++) cli_fact_real(f, rows[i].name, rows[i].distance);
    cli_fact_real(f, "normal_consistency", d->normal_consistency);
    cli_fact_real(f, "diagonal", d->diagonal);
    cli_fact_open(f, "percent_of_diagonal", FACT_OBJECT);
    for (int i = 0; i < 4; i++) cli_fact_real(f, rows[i].name, 100 * rows[i].distance / d->diagonal);
    cli_fact_close(f);
}

/* Compares two surfaces by points on both. */
static brio_status compare_surfaces(run *r, const brio_mesh *a, const brio_mesh *b) {
    const arguments *chosen = r->arguments;
    brio_distance d = {.size = sizeof d};
    brio_status status = BRIO_OK;
    if (r->common.output) FAIL(r, BRIO_ERR_ARGUMENT, "two surfaces: -o is for points compared with a surface");
    status = brio_mesh_distance(r->ctx, a, b, (size_t)chosen->samples, r->common.seed, &d);
    if (status == BRIO_ERR_ARGUMENT) /* faces without area, or of two corners */
        FAIL(r, BRIO_ERR_NO_ANSWER, "%s, %s: %s", r->operands[0], r->operands[1], brio_message(r->ctx));
    TRY(status);
    cli_lap(r, "compare");
    report_distance(&r->facts, &d);
    if (chosen->within > 0) {
        cli_fact_bool(&r->facts, "within", d.hausdorff <= chosen->within);
        if (d.hausdorff > chosen->within)
            FAIL(r, BRIO_ERR_CHECK, "the surfaces are %g apart, more than %g", d.hausdorff, chosen->within);
    }
done:
    return status;
}

static brio_status compare(run *r) {
    const arguments *chosen = r->arguments;
    brio_mesh *mesh[2] = {NULL, NULL};
    brio_status status = BRIO_OK;
    if (!strcmp(r->operands[0], "-") && !strcmp(r->operands[1], "-"))
        FAIL(r, BRIO_ERR_ARGUMENT, "both inputs want standard input");
    if (r->common.output) TRY(cli_require_output(r, cli_point_formats, false));
    for (int i = 0; i < 2; i++) TRY(cli_read(r, r->operands[i], &mesh[i]));
    if (mesh[0]->num_faces && mesh[1]->num_faces) {
        status = compare_surfaces(r, mesh[0], mesh[1]);
        goto done;
    }
    int cloud = mesh[0]->num_faces ? 1 : 0;
    if (!mesh[1 - cloud]->num_faces)
        FAIL(r, BRIO_ERR_FORMAT, "%s, %s: expected a surface at least once, found no faces", r->operands[0],
             r->operands[1]);
    if (chosen->samples)
        FAIL(r, BRIO_ERR_ARGUMENT, "--samples is for two surfaces, and %s has points alone", r->operands[cloud]);
    if (!mesh[cloud]->num_vertices) FAIL(r, BRIO_ERR_NO_ANSWER, "%s: no points", r->operands[cloud]);
    status = cli_compare_cloud(r, mesh[cloud], mesh[1 - cloud], chosen->within);
    if (status == BRIO_ERR_ARGUMENT)
        status = cli_fail(r, BRIO_ERR_NO_ANSWER, "%s: %s", r->operands[1 - cloud], brio_message(r->ctx));
done:
    brio_mesh_free(mesh[0]);
    brio_mesh_free(mesh[1]);
    return status;
}

const command cli_compare = {
    .name = "compare",
    .operands = "A B",
    .summary = "distances between two surfaces, or of points from a surface, with their sides",
    .description = "Points inside a closed surface, or behind the faces of another one, have negative distances. With "
                   "-o the points are "
                   "written with the property distance.",
    .examples =
        "brio compare surface.ply truth.ply\nhow far they are apart\n"
        "brio compare scan.ply part.stl --within 0.1 -o checked.ply\nis every point within a tenth of the part?\n",
    .outputs = "ply xyz pts txt csv asc tsv vtu vtp vtk las laz pcd npy glb",
    .output_optional = true,
    .group = GROUP_FILES,
    .min_operands = 2,
    .max_operands = 2,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = compare,
};
