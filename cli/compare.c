/* brio compare: distances and normal deviation between two surfaces. */
#include "commands.h"
#include "estimate.h"
#include <string.h>

typedef struct arguments {
    uint64_t samples;
} arguments;

static const option options[] = {
    {"samples", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(arguments, samples), "N",
     "points on each surface (default 100000)", 0},
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

static brio_status read_surface(run *r, const char *path, brio_mesh **mesh) {
    brio_status status = cli_read(r, path, mesh);
    if (status == BRIO_OK && !(*mesh)->num_faces)
        return cli_fail(r, BRIO_ERR_FORMAT, "%s: expected a surface, found no faces", path);
    return status;
}

static brio_status compare(run *r) {
    const arguments *chosen = r->arguments;
    brio_mesh *a = NULL, *b = NULL;
    brio_distance distance = {.size = sizeof distance};
    brio_status status = BRIO_OK;
    if (r->common.output) FAIL(r, BRIO_ERR_ARGUMENT, "compare writes no file; -o has no meaning here");
    if (!strcmp(r->operands[0], "-") && !strcmp(r->operands[1], "-"))
        FAIL(r, BRIO_ERR_ARGUMENT, "both surfaces want standard input");
    TRY(read_surface(r, r->operands[0], &a));
    TRY(read_surface(r, r->operands[1], &b));
    status = brio_mesh_distance(r->ctx, a, b, (size_t)chosen->samples, r->common.seed, &distance);
    if (status == BRIO_ERR_ARGUMENT) /* faces without area, or of two corners */
        FAIL(r, BRIO_ERR_NO_ANSWER, "%s, %s: %s", r->operands[0], r->operands[1], brio_message(r->ctx));
    TRY(status);
    cli_lap(r, "compare");
    report_distance(&r->facts, &distance);
done:
    brio_mesh_free(a);
    brio_mesh_free(b);
    return status;
}

const command cli_compare = {
    .name = "compare",
    .operands = "A B",
    .summary = "distances and normal deviation between two surfaces, both ways",
    .examples = "brio compare surface.ply truth.ply\nhow far they are apart\n",
    .group = GROUP_FILES,
    .min_operands = 2,
    .max_operands = 2,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = compare,
};
