/* brio subdivide: butterfly subdivision of a triangle mesh. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"

typedef struct arguments {
    int levels;
} arguments;

static const option options[] = {
    {"levels", 0, OPTION_INT, offsetof(arguments, levels), "N", "how many times each triangle becomes four (default 1)",
     0},
    {0},
};

static const arguments defaults = {.levels = 1};

enum { MOST_LEVELS = 15 };

static brio_status check_mesh(run *r, const arguments *a, const brio_mesh *mesh) {
    if (!mesh->num_faces) {
        cli_hint(r, HINT_SURFACE);
        return cli_fail(r, BRIO_ERR_NO_ANSWER, "%s: has no faces", r->operands[0]);
    }
    return cli_require_work(r, BRIO_OK, NULL, brio_estimate_mesh_subdivide(mesh->num_faces, a->levels));
}

static brio_status subdivide(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *mesh = NULL, *fine = NULL;
    brio_status status = BRIO_OK;
    if (a->levels < 1 || a->levels > MOST_LEVELS)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--levels: %d is not between 1 and %d", a->levels, MOST_LEVELS);
    TRY(cli_require_output(r, false));
    TRY(cli_read(r, r->operands[0], &mesh));
    TRY(check_mesh(r, a, mesh));
    TRY(brio_mesh_subdivide(r->ctx, mesh, a->levels, &fine));
    cli_lap(r, "subdivide");
    brio_mesh_free(mesh);
    mesh = NULL;
    cli_fact_integer(&r->facts, "levels", a->levels);
    cli_fact_count(&r->facts, "vertices", fine->num_vertices);
    cli_fact_count(&r->facts, "faces", fine->num_faces);
    TRY(cli_certify(r, fine, CERTIFY_OPEN | CERTIFY_INPUT));
    TRY(cli_write(r, fine));
done:
    brio_mesh_free(mesh);
    brio_mesh_free(fine);
    return status;
}

const command cli_subdivide = {
    .name = "subdivide",
    .operands = "IN",
    .summary = "smooth, denser mesh through the vertices of a triangle mesh",
    .examples = "brio subdivide mesh.ply --levels 2 -o fine.ply\neach triangle becomes sixteen\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = subdivide,
};
